"""How a DMA table is written: character set, separator, lines above the header, a row of units, decimal sign."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from permway.errors import InputError
from permway.laws.column_units import bare, is_any_unit
from permway.laws.columns import Recognised, recognise
from permway.laws.textfile import Line
from permway.reading import LARGEST_TABLE, read_bytes

_HEAD_LINES = 200
"""Lines among which the header is looked for. Half is more than any export's head; twice takes twice as long."""
_NUMBER = re.compile(r"[-+−]?(\d|[.,]\d)")
_SHEET_FAULT = re.compile(r"#(REF!|DIV/0!|N/A|NAME\?|VALUE!|NUM!|NULL!)")
"""What a spreadsheet writes for a cell without a value: no remark."""
_THOUSANDS = re.compile(r"[-+−]?[1-9]\d{0,2}(,\d{3})+")
_SIGNATURES = {b"PK\x03\x04": "an Excel or a zip file", b"\xd0\xcf\x11\xe0": "an Excel file of the old kind"}


@dataclass(frozen=True)
class Layout:
    """A table with its header understood.

    Attributes
    ----------
    header : Line
    recognised : Recognised
    rows : list of Line
        Cells as written.
    decimal_comma : bool
    notes : tuple of str
        What was passed over.
    """

    header: Line
    recognised: Recognised
    rows: list[Line]
    decimal_comma: bool
    notes: tuple[str, ...]


def read_layout(path: Path, *, decimal: str | None = None) -> Layout:
    """Find header, rows and decimal sign of a text table.

    Parameters
    ----------
    path : Path
    decimal : {".", ","}, optional
        Stated by the user; else found from the cells.

    Raises
    ------
    InputError
        If the file is missing, larger than :data:`~permway.reading.LARGEST_TABLE`, not text, or empty; for lines
        below the header that are neither units nor numbers; for a decimal sign that can be read two ways.
    """
    if decimal not in (None, ".", ","):
        raise InputError("is no decimal sign", where="decimal", value=decimal, remedy='use "." or ","')
    text = _text(path)
    split, remarks, header, recognised = _header(path, text)
    lines = list(_lines(text, split, remarks=remarks))
    at = next(index for index, line in enumerate(lines) if line.number == header.number)
    rows, notes = _rows(path, lines, at)
    if at:
        notes = (f"{at} lines above the header (line {header.number}) are no part of the table", *notes)
    comma = _decimal_comma(path, recognised, rows, decimal)
    return Layout(header, recognised, rows, comma, notes)


def _text(path: Path) -> str:
    content = read_bytes(path, LARGEST_TABLE)
    for signature, what in _SIGNATURES.items():
        if content.startswith(signature):
            raise InputError(f"is {what}, no text", where=str(path), remedy="export it as CSV")
    encodings = ("utf-16",) if content[:2] in (b"\xff\xfe", b"\xfe\xff") else ("utf-8-sig", "cp1252")
    for encoding in encodings:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if not re.search(r"[\x00-\x08\x0e-\x1f]", text):
            return text
    raise InputError("not a text file", where=str(path), remedy="export it as CSV in UTF-8")


Split = Callable[[str], list[str]]


def _header(path: Path, text: str) -> tuple[Split, bool, Line, Recognised]:
    """How lines are split, whether the header is a remark, the header, and what it names."""
    best: tuple[int, Split, bool, Line, Recognised] | None = None
    first: tuple[Split, bool, Line, Recognised] | None = None
    fault: InputError | None = None
    for remarks in (False, True):
        for split in (*map(_by, "\t;,|"), _by_gaps, _by_blanks):
            lines = list(islice(_lines(text, split, remarks=remarks), _HEAD_LINES + 1))
            for at, line in enumerate(lines[:_HEAD_LINES]):
                if len(line.cells) < 2:
                    continue
                if first is None and not remarks:
                    first = split, remarks, line, Recognised(unread=line.cells)
                if any(_NUMBER.match(cell) for cell in line.cells):
                    continue
                units = lines[at + 1].cells if at + 1 < len(lines) and _is_units(lines[at + 1].cells) else None
                try:
                    recognised = recognise(line.cells, units, where=f"{path}: line {line.number}")
                except InputError as error:
                    fault = fault or error
                    continue
                count = len(recognised.columns)
                known = recognised.columns.keys() | recognised.faults.keys()
                # A storage modulus and how it turns make a header; else the line that names most.
                score = count + (10 if _complete(recognised) else 0) + (5 if len(known) > 1 else 0)
                if known and (best is None or score > best[0]):
                    best = score, split, remarks, line, recognised
                if _complete(recognised):
                    break
        if best is not None and (best[0] > 5 or fault is None):
            break
    if best is not None and (best[0] > 10 or fault is None):
        return best[1:]
    if fault is not None:
        raise fault
    if first is not None:
        return first
    if best is not None:
        return best[1:]
    only = next(_lines(text, _by(","), remarks=False), None)
    if only is None:
        raise InputError("the file is empty", where=str(path), remedy="give a header and rows")
    return _by(","), False, only, Recognised(unread=only.cells)


def _complete(recognised: Recognised) -> bool:
    found = recognised.columns.keys()
    return (
        len(found & {"storage", "loss", "magnitude"}) > 0
        and len(found & {"storage", "loss", "magnitude", "loss_factor", "phase"}) > 1
    )


def _by(mark: str) -> Callable[[str], list[str]]:
    def split(line: str) -> list[str]:
        # Nearly all lines have no quotes, and most tables many lines.
        cells = next(csv.reader([line], delimiter=mark), []) if '"' in line else line.split(mark)
        return [cell.strip() for cell in cells]

    return split


def _by_gaps(line: str) -> list[str]:
    return re.split(r"\s{2,}", line.strip())


def _by_blanks(line: str) -> list[str]:
    return line.split()


def _lines(text: str, split: Callable[[str], list[str]], *, remarks: bool) -> Iterator[Line]:
    """Lines with their cells; with `remarks` also those that begin with #, without it."""
    for index, (number, line) in enumerate(_joined(text)):
        if index == 0 and re.fullmatch(r"\"?sep=.\"?", line.strip()):
            continue
        if line.lstrip().startswith("#") and not _SHEET_FAULT.match(line.lstrip()):
            if not remarks:
                continue
            line = line.lstrip().lstrip("#")
        if not line.strip():
            continue
        try:
            cells = split(line)
        except csv.Error:
            cells = [line]
        if any(cells):
            yield Line(number, tuple(cells))


def _joined(text: str) -> Iterator[tuple[int, str]]:
    """Lines with their numbers; a cell in quotes may hold line ends, which become blanks."""
    held, start = "", 0
    for number, line in enumerate(re.split(r"\r\n|\n|\r", text), start=1):
        held, start = (f"{held} {line}", start) if held else (line, number)
        # Quotes open a cell only at its beginning; E" in the middle is a double prime.
        opened = held.count('"') % 2 and re.search(r'(?:^|[,;\t|])\s*"(?:[^"]|"")*$', held)
        if opened and number - start < 4:
            continue
        yield start, held
        held = ""
    if held:
        yield start, held


def _is_units(cells: tuple[str, ...]) -> bool:
    """Whether a row holds units: no cell a number but for the unit 1, one at least a unit."""
    if any(_NUMBER.match(cell) and not (cell == "1" or cell.startswith("1/")) for cell in cells):
        return False
    return any(bare(cell) not in ("", "1") and is_any_unit(cell) for cell in cells)


def _rows(path: Path, lines: list[Line], at: int) -> tuple[list[Line], tuple[str, ...]]:
    """The rows below a header, without a row of units and without the header where it comes again."""
    header = lines[at]
    rows: list[Line] = []
    index, repeated = at + 1, 0
    if index < len(lines) and _is_units(lines[index].cells):
        index += 1
    width = len(header.cells)
    while index < len(lines):
        line = lines[index]
        cells = line.cells
        # A separator at the end of every row is no cell.
        while len(cells) > width and not cells[-1]:
            cells = cells[:-1]
        if len(cells) == width and any(_NUMBER.match(cell) for cell in cells):
            rows.append(Line(line.number, cells))
            index += 1
            continue
        again = next((k for k in range(index, min(index + 6, len(lines))) if lines[k].cells == header.cells), None)
        if again is not None:
            index, repeated = again + 1, repeated + 1
            if index < len(lines) and _is_units(lines[index].cells):
                index += 1
            continue
        if len(cells) != width:
            raise InputError(
                f"{len(cells)} cells where the header has {width}",
                where=f"{path}: line {line.number}",
                value=",".join(cells),
                remedy="complete or remove the line (a file cut short ends like this; decimal commas need ;)",
            )
        raise InputError(
            "the line holds neither units nor numbers",
            where=f"{path}: line {line.number}",
            value=",".join(cells),
            remedy="remove it, or begin it with #",
        )
    notes = (f"the header comes {repeated + 1} times; all rows were taken as one table",) if repeated else ()
    return rows, notes


def _decimal_comma(path: Path, recognised: Recognised, rows: list[Line], decimal: str | None) -> bool:
    commas: list[tuple[str, str]] = []
    point: tuple[str, str] | None = None
    for row in rows:
        for column in recognised.columns.values():
            cell = row.cells[column.index]
            place = f"{path}: line {row.number}, column '{column.header}'"
            if "." in cell and point is None:
                point = place, cell
            if "," in cell:
                commas.append((place, cell))
    if decimal is not None or not commas:
        return decimal == ","
    if point is not None:
        place, cell = commas[0]
        raise InputError(
            f"a comma here and a decimal point in '{point[1]}' ({point[0].rsplit(': ', 1)[-1]})",
            where=place,
            value=cell,
            remedy="write all numbers alike, with a decimal point and without marks between thousands",
        )
    if all(_THOUSANDS.fullmatch(cell) for _, cell in commas):
        place, cell = commas[0]
        raise InputError(
            "the comma can be a decimal sign or a mark between thousands",
            where=place,
            value=cell,
            remedy='say which: --decimal "," or --decimal "." (Python: decimal="," ), or write a decimal point',
        )
    return True
