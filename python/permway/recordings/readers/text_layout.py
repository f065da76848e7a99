"""How a text table of samples is written: separator, decimal sign, names, units, remarks."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit, is_unit_row, split_header

_PIECE_BYTES = 2**20
_LONGEST_LINE = 2**20
_LINES_LOOKED_AT = 200
_REMARKS = ("#", "%", "//")
_RATE = re.compile(
    r"\b(?:fs|sr|f_s|sampling[ _-]?(?:rate|frequency|hz)|sample[ _-]?(?:rate|hz))\s*(?:\(Hz\)|\[Hz\])?"
    r"\s*[:=,;\t]\s*([0-9.eE+-]+)\s*(k?Hz)?",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Layout:
    """How a text table is written, found from its first lines."""

    separator: str | None
    decimal_comma: bool
    names: tuple[str, ...]
    units: tuple[str | None, ...]
    header_lines: int
    trailing: bool
    rate_Hz: float | None
    sample: tuple[str, ...]

    def cells(self, line: str) -> list[str]:
        """Cells of a line, without blanks, quotes and a separator at the end."""
        if self.separator is None:
            return line.split()
        cells = line.split(self.separator)
        if self.trailing and cells and not cells[-1].strip():
            cells.pop()
        return [cell.strip().strip('"').strip() for cell in cells]


def numbered_lines(source: Path) -> Iterator[tuple[int, str]]:
    """Lines of a text file with their numbers from 1, in pieces: UTF-8, or else Latin-1 as older loggers write.

    Raises
    ------
    InputError
        If it is not text, or a line is longer than any table's.
    """
    count, rest, first = 0, b"", True
    with source.open("rb") as file:
        while piece := file.read(_PIECE_BYTES):
            if first:
                piece, first = piece.removeprefix(b"\xef\xbb\xbf"), False
            # Up to the last line's end; what follows is the beginning of the next piece.
            whole, end, rest = (rest + piece).rpartition(b"\n")
            if end:
                for line in _decoded(whole, source, count):
                    count += 1
                    yield count, line
            elif len(rest) > _LONGEST_LINE:
                raise InputError("a line longer than a table's", where=f"{source}: line {count + 1}")
    if rest:
        for line in _decoded(rest, source, count):
            count += 1
            yield count, line


def _decoded(raw: bytes, source: Path, before: int) -> list[str]:
    if b"\x00" in raw:
        line = before + 1 + raw[: raw.index(b"\x00")].count(b"\n")
        what = "not a text: it holds zero bytes"
        raise InputError(what, where=f"{source}: line {line}", remedy="export it as CSV in UTF-8")
    try:
        text = raw.decode("utf-8")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    return [line.rstrip("\r") for line in text.split("\n")]


def is_remark(line: str) -> bool:
    """Whether a line says nothing of the table: empty, or a remark."""
    bare = line.lstrip()
    return not bare or bare.startswith(_REMARKS)


def is_number(cell: str) -> bool:
    """Whether a cell is a number, with point or comma, finite or not."""
    try:
        float(cell.strip().strip('"').replace(",", ".", 1))
    except ValueError:
        return False
    return True


def find_layout(source: Path) -> Layout:
    """See how a file is written from its first lines.

    Raises
    ------
    InputError
        For a file without rows, a header without names, units that contradict.
    """
    rate: float | None = None
    kept: list[tuple[int, str]] = []
    for index, line in numbered_lines(source):
        if is_remark(line):
            said = _RATE.search(line)
            if said is not None and rate is None:
                rate = _rate(said, f"{source}: line {index}")
            continue
        kept.append((index, line))
        if len(kept) == _LINES_LOOKED_AT:
            break
    if not kept:
        raise InputError("the file is empty", where=str(source), remedy="give a header and rows")
    separator = next((mark for mark in ("\t", ";", ",") if mark in kept[0][1]), None)
    cells = _header_cells(kept[0][1], separator)
    trailing = separator is not None and len(cells) > 1 and not cells[-1]
    if trailing:
        cells.pop()
    if not any(cells):
        raise InputError("a header without names", where=f"{source}: line {kept[0][0]}", value=kept[0][1])
    if all(is_number(cell) for cell in cells):
        names, header = [f"column {i + 1}" for i in range(len(cells))], 0
        units: list[str | None] = [None] * len(cells)
    else:
        names, units, header = _named(source, cells, kept, separator)
    if len(kept) <= header:
        raise InputError("a header but no rows", where=str(source), remedy="give the samples below it")
    sample = tuple(line for _, line in kept[header:])
    layout = Layout(separator, False, tuple(names), tuple(units), header, trailing, rate, sample)
    comma = separator != "," and any(
        is_number(cell) and "," in cell for line in sample for cell in layout.cells(line)
    )
    return replace(layout, decimal_comma=comma)


def _named(
    source: Path, cells: list[str], kept: list[tuple[int, str]], separator: str | None
) -> tuple[list[str], list[str | None], int]:
    pairs = [split_header(cell) for cell in cells]
    if separator is None and len(kept) > 1 and len(kept[1][1].split()) == 1:
        # One column: blanks in its header are part of its name.
        pairs = [split_header(kept[0][1])]
    names, units = [name for name, _ in pairs], [unit for _, unit in pairs]
    blank = next((i for i, name in enumerate(names) if not name), None)
    if blank is not None:
        raise InputError(f"column {blank + 1} has no name", where=f"{source}: line {kept[0][0]}", remedy="name it")
    if len(kept) < 2:
        return names, units, 1
    below = _header_cells(kept[1][1], separator)
    if len(below) == len(names) + 1 and not below[-1]:
        below.pop()
    if len(below) != len(names) or any(is_number(cell) for cell in below) or not is_unit_row(below):
        return names, units, 1
    rows = [clean_unit(cell) for cell in below]
    for i, unit in enumerate(rows):
        if unit is not None and units[i] is not None and unit != units[i]:
            raise InputError(
                f"the header says {units[i]!r}, the row of units {unit!r}",
                where=f"{source}: line {kept[1][0]}, column '{names[i]}'",
                remedy="keep one",
            )
    return names, [units[i] or unit for i, unit in enumerate(rows)], 2


def _header_cells(line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    try:
        # Only headers have quotes around separators: numbers never need them.
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error:
        cells = line.split(separator)
    return [cell.strip() for cell in cells]


def _rate(said: re.Match[str], where: str) -> float:
    try:
        value = float(said[1]) * (1e3 if (said[2] or "").lower() == "khz" else 1.0)
    except ValueError:
        value = 0.0
    if not (np.isfinite(value) and value > 0.0):
        what = "a sampling rate must be finite and above 0 Hz"
        raise InputError(what, where=where, value=said[1], remedy="correct or remove the remark")
    return value
