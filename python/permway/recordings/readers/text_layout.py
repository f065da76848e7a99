"""How a text table of samples is written: separator, decimal sign, names, units, remarks."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit, is_unit_row, split_header
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.text_lines import (
    cells_of,
    is_number,
    is_remark,
    numbered_lines,
    without_mark,
)
from permway.recordings.readers.text_rate import RateRemark, rate_in

Line = TypeVar("Line")

_LINES_LOOKED_AT = 200
_LINES_WEIGHED = 40
"""Of the last lines of those looked at, which are samples if any are; at most half of them, three at least.

Half or twice of it changes nothing in files of more than a hundred rows.
"""
SEPARATOR_LINE = re.compile(r'"?sep=(.)"?\s*', re.IGNORECASE)
_OCTAVE = re.compile(r"[#%] (?:Created by Octave|type: (?:\w+ )*(?:matrix|scalar|cell|struct|string|range)\b)")
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+")


@dataclass(frozen=True)
class Layout:
    """How a text table is written, found from its first lines.

    Attributes
    ----------
    separator : str or None
        None for blanks.
    decimal_comma : bool
    names : tuple of str
    units : tuple of (str or None)
    first_row : int
        Number of the line of the first row of samples.
    rate : RateRemark
        What a remark states about the sampling rate.
    sample : tuple of str
        The first rows.
    encoding : str or None
    """

    separator: str | None
    decimal_comma: bool
    names: tuple[str, ...]
    units: tuple[str | None, ...]
    first_row: int
    rate: RateRemark
    sample: tuple[str, ...]
    encoding: str | None

    def cells(self, line: str) -> list[str]:
        """Cells of a line, without an empty one beyond the last column, which a separator at the end makes."""
        cells = cells_of(line, self.separator)
        if len(cells) == len(self.names) + 1 and not cells[-1]:
            cells.pop()
        return cells


def find_layout(source: Path, hints: Hints = NO_HINTS) -> Layout:
    """See how a file is written from its first lines.

    Raises
    ------
    InputError
        For a file without rows, lines before the header that nobody stated to skip, units that contradict.
    """
    rate = RateRemark()
    kept: list[tuple[int, str]] = []
    stated: str | None = None
    skipped = max(hints.skip_rows or 0, (hints.header_row or 0) - 1)
    for index, line in numbered_lines(source, hints.encoding):
        found = SEPARATOR_LINE.fullmatch(line) if index == 1 else None
        if found is not None:
            stated = found[1]
            continue
        if index == hints.header_row:
            kept.append((index, without_mark(line) if is_remark(line) else line))
            continue
        if is_remark(line):
            if _OCTAVE.match(line):
                raise InputError(
                    "is text as Octave saves its variables, which is no table",
                    where=f"{source}: line {index}",
                    value=line[:80],
                    remedy="save it in Octave by save -7, and give that as MAT",
                )
            rate = rate.and_then(rate_in(without_mark(line), f"{source}: line {index}"))
            continue
        if index > skipped:
            kept.append((index, line))
        if len(kept) == _LINES_LOOKED_AT:
            break
    if not kept:
        raise InputError("the file is empty", where=str(source), remedy="give a header and rows")
    separator = stated or separator_of([line for _, line in kept], hints.decimal)
    rows = [cells_of(line, separator) for _, line in kept]
    first = _first_row(source, kept, rows, hints)
    names, units = _named(source, kept, rows, first, separator, hints)
    sample = tuple(line for _, line in kept[first:])
    layout = Layout(separator, False, names, units, kept[first][0], rate, sample, hints.encoding)
    comma = hints.decimal == "," if hints.decimal is not None else _decimal_comma(source, layout)
    if comma:
        rate = rate.in_decimal_commas()
    return Layout(separator, comma, names, units, kept[first][0], rate, sample, hints.encoding)


def _weighed(lines: Sequence[Line]) -> Sequence[Line]:
    return lines[-min(_LINES_WEIGHED, max(3, len(lines) // 2)) :]


def separator_of(lines: list[str], decimal: str | None = None) -> str | None:
    """The sign between cells: that which cuts the last of these lines into equally many, numbers among them."""
    last = _weighed(lines)
    quoted = any('"' in line for line in last)
    for mark in ("\t", ";", None) if decimal == "," and not quoted else ("\t", ";", ",", None):
        rows = [cells_of(line, mark) for line in last]
        count, times = Counter(len(row) for row in rows).most_common(1)[0]
        numeric = sum(any(is_number(cell) for cell in row) for row in rows)
        if count > 1 and 2 * times > len(rows) and 2 * numeric >= len(rows):
            return mark
    marks = ("\t", ";") if decimal == "," and not quoted else ("\t", ";", ",")
    return next((mark for mark in marks if mark in lines[0]), None)


def _first_row(source: Path, kept: list[tuple[int, str]], rows: list[list[str]], hints: Hints) -> int:
    """Position of the first row of numbers.

    Raises
    ------
    InputError
        If there is none.
    """
    last = _weighed(rows)
    count = Counter(len(row) for row in last).most_common(1)[0][0]
    # Columns that mostly hold numbers: what is a row of samples has one in each of them, or leaves it empty.
    table = [row for row in last if len(row) == count]
    numeric = [i for i in range(count) if 2 * sum(is_number(row[i]) for row in table) > len(table)]

    def is_data(row: list[str]) -> bool:
        if not any(is_number(cell) for cell in row):
            return False
        if len(row) != count or not numeric:
            return all(is_number(cell) for cell in row if cell)
        return all(is_number(row[i]) or not row[i] for i in numeric)

    start = 1 if hints.header_row and kept[0][0] == hints.header_row else 0
    first = next((i for i in range(start, len(rows)) if is_data(rows[i])), None)
    if first is not None:
        return first
    if len(rows) == 1 or (len(rows) == 2 and is_unit_row(rows[1])):
        raise InputError("a header but no rows", where=str(source), remedy="give the samples below it")
    loose = next((i for i in range(start, len(rows)) if any(is_number(cell) for cell in rows[i])), None)
    if loose is not None:
        return loose
    raise InputError(
        "no row of numbers among the first lines",
        where=f"{source}: line {kept[-1][0]}",
        value=kept[-1][1][:80],
        remedy="say in the record where the table begins: skip_rows or header_row, and its decimal sign: decimal",
    )


def _named(
    source: Path,
    kept: list[tuple[int, str]],
    rows: list[list[str]],
    first: int,
    separator: str | None,
    hints: Hints,
) -> tuple[tuple[str, ...], tuple[str | None, ...]]:
    """Names and units of the columns, from the lines above the first row."""
    count = len(rows[first])
    if first == 0 or hints.header_row == 0:
        if hints.header_row != 0 or first == 0:
            _check_preamble(source, kept, 0, hints)
        return tuple(f"column {i + 1}" for i in range(count)), (None,) * count
    top = first - 1
    while top > 0 and _goes_on(rows[top]) and _is_header(rows[top - 1], rows[top]):
        top -= 1
    at = 0 if hints.header_row else top
    if hints.header_row is None and hints.skip_rows is None:
        _check_preamble(source, kept, at, hints)
    cells = rows[at] if at < top else _joined(rows[top:first])
    if separator is None and count == 1:
        # One column: blanks in its header are part of its name.
        cells = [kept[at][1].strip().strip('"')]
    if len(cells) > 1 and len(cells) == count + 1 and not cells[-1]:
        cells = cells[:-1]
    if len(cells) > 1 and not cells[-1] and all(len(row) < len(cells) or not row[-1] for row in rows[first:]):
        # A separator at the end of every line.
        cells = cells[:-1]
    if not any(cells):
        raise InputError("a header without names", where=f"{source}: line {kept[at][0]}", value=kept[at][1])
    pairs = [split_header(cell) for cell in cells]
    names = [name or f"column {i + 1}" for i, (name, _) in enumerate(pairs)]
    units = [unit for _, unit in pairs]
    for line in range(at + 1, first):
        below = rows[line]
        if len(below) == len(names) + 1 and not below[-1]:
            below = below[:-1]
        if len(below) != len(names) or not is_unit_row(below):
            continue
        for i, cell in enumerate(below):
            unit = clean_unit(cell)
            if unit is not None and units[i] is not None and unit != units[i]:
                raise InputError(
                    f"the header states {units[i]!r}, the row of units {unit!r}",
                    where=f"{source}: line {kept[line][0]}, column '{names[i]}'",
                    remedy="keep one",
                )
            units[i] = units[i] or unit
    return tuple(names), tuple(units)


def _is_header(row: list[str], below: list[str]) -> bool:
    """Whether a line may be the upper part of a header; over units, names may be numbers of channels."""
    numbers = sum(is_number(cell) for cell in row)
    return abs(len(row) - len(below)) <= 1 and (not numbers or (numbers < len(row) and is_unit_row(below)))


def _goes_on(row: list[str]) -> bool:
    """Whether a line of a header leaves something to the lines above: units alone, or columns without a name."""
    return is_unit_row(row) or not all(row)


def _joined(rows: list[list[str]]) -> list[str]:
    """Names that stand in several lines, rows of units left out."""
    named = [rows[0], *(row for row in rows[1:] if not is_unit_row(row))]
    return [" ".join(row[i] for row in named if i < len(row) and row[i]) for i in range(len(rows[0]))]


def _check_preamble(source: Path, kept: list[tuple[int, str]], at: int, hints: Hints) -> None:
    """Refuse lines above the header that nobody stated to leave out.

    Raises
    ------
    InputError
        With these lines, and the key that states where the header is.
    """
    if at == 0 or hints.skip_rows is not None:
        return
    first, last = kept[0][0], kept[at - 1][0]
    lines = f"line {first} is" if first == last else f"lines {first} to {last} are"
    raise InputError(
        f"{lines} no part of a table that seems to begin with line {kept[at][0]}",
        where=f"{source}: line {first}",
        value=kept[0][1][:80],
        remedy=f"if line {kept[at][0]} names the columns ({kept[at][1][:60]!r}), say so in the record: "
        f"header_row = {kept[at][0]}",
    )


def _decimal_comma(source: Path, layout: Layout) -> bool:
    """Whether numbers have a decimal comma; if the first rows have neither comma nor point, all rows are seen.

    Raises
    ------
    InputError
        If a comma may as well part thousands.
    """
    odd = _split_decimals(layout)
    if odd is not None:
        raise InputError(
            "a comma that may part decimals or cells",
            where=str(source),
            value=odd,
            remedy='if it parts decimals, say so in the record: decimal = ","; if cells, write 5 for 05',
        )
    found = _commas(layout, layout.sample)
    if not found and not any("." in line for line in layout.sample) and layout.separator != ",":
        last = 0
        rest: list[str] = []
        for index, line in numbered_lines(source, layout.encoding):
            if index < layout.first_row or is_remark(line) or not ("," in line or "." in line):
                continue
            rest.append(line)
            last += 1
            if last == _LINES_LOOKED_AT:
                break
        found = _commas(layout, tuple(rest))
    if found and all(_THOUSANDS.fullmatch(cell) for cell in found):
        raise InputError(
            "a comma that may part decimals or thousands",
            where=str(source),
            value=found[0],
            remedy='say in the record which sign parts decimals: decimal = "," (or export without thousands)',
        )
    return bool(found)


def _split_decimals(layout: Layout) -> str | None:
    """A line of whole numbers between commas, one of them as "05", which only decimals are; else None."""
    if layout.separator != "," or any('"' in line or "." in line for line in layout.sample):
        return None
    for line in layout.sample:
        if any(re.fullmatch(r"0\d+", cell) for cell in layout.cells(line)):
            return line
    return None


def _commas(layout: Layout, lines: tuple[str, ...]) -> list[str]:
    """Cells that are numbers with a comma."""
    if layout.separator == ",":
        lines = tuple(line for line in lines if '"' in line)
    return [cell for line in lines for cell in layout.cells(line) if "," in cell and is_number(cell)]
