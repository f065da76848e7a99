"""Tables in text, as decay rates in bands or modulus against frequency: columns of numbers or of texts."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from permway.errors import InputError
from permway.laws.textfile import Line, number
from permway.recordings.readers.headers import clean_unit, is_unit_row, split_header
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.text_layout import SEPARATOR_LINE, separator_of
from permway.recordings.readers.text_lines import cells_of, is_number, is_remark, numbered_lines, without_mark
from permway.recordings.record import Cells, TableRecord

_LINES_LOOKED_AT = 200


def read_text_table(
    source: Path, *, texts: Sequence[str] = (), hints: Hints = NO_HINTS, max_bytes: int = MOST_BYTES
) -> TableRecord:
    """Read a table with a header, or one of numbers alone, whose columns are then "column 1" and on.

    A column whose first cell that is not empty is a number is a column of numbers, and every other cell of it must
    be one or empty (NaN); other columns are texts, and so are those named in `texts`.
    """
    check_size(source.stat().st_size, str(source), max_bytes=max_bytes, item=32)
    lines = lines_of(source, hints)
    names, units, rows = _head(source, lines)
    if not rows:
        raise InputError("a header but no rows", where=str(source), remedy="give at least one row")
    for name in texts:
        if name not in names:
            raise InputError("there is no such column", where=str(source), value=name, remedy=f"it has {names}")
    check_rows(source, names, rows)
    comma = hints.decimal == "," if hints.decimal is not None else _decimal_comma(source, rows)
    columns: dict[str, Cells] = {}
    for index, name in enumerate(names):
        first = next((row.cells[index] for row in rows if row.cells[index]), "")
        if name in texts or not is_number(first) or ("," in first and not comma):
            columns[name] = tuple(row.cells[index] for row in rows)
            continue
        columns[name] = np.array(
            [_cell(row.cells[index], f"{source}: line {row.number}, column '{name}'", comma) for row in rows]
        )
    return TableRecord(columns=columns, units=dict(zip(names, units, strict=True)), source=str(source))


def lines_of(source: Path, hints: Hints) -> list[Line]:
    """Lines without remarks, cut into cells.

    Raises
    ------
    InputError
        If there is none, or the file is no text.
    """
    skipped = max(hints.skip_rows or 0, (hints.header_row or 0) - 1)
    kept: list[tuple[int, str]] = []
    mark: str | None = None
    for index, line in numbered_lines(source, hints.encoding):
        if index == 1 and (found := SEPARATOR_LINE.fullmatch(line)) is not None:
            mark = found[1]
        elif index == hints.header_row and is_remark(line):
            kept.append((index, without_mark(line)))
        elif index > skipped and line.strip() and not line.lstrip().startswith("#"):
            kept.append((index, line))
    if not kept:
        raise InputError("the file is empty", where=str(source), remedy="give a header and rows")
    mark = mark or separator_of([line for _, line in kept[:_LINES_LOOKED_AT]])
    return [Line(index, tuple(cells_of(line, mark))) for index, line in kept]


def _head(source: Path, lines: list[Line]) -> tuple[list[str], list[str | None], list[Line]]:
    first = lines[0]
    if all(is_number(cell) for cell in first.cells):
        return [f"column {i + 1}" for i in range(len(first.cells))], [None] * len(first.cells), lines
    pairs = [split_header(cell) for cell in first.cells]
    names, units, rows = [name for name, _ in pairs], [unit for _, unit in pairs], lines[1:]
    where = f"{source}: line {first.number}"
    for index, name in enumerate(names):
        if not name:
            raise InputError(f"column {index + 1} has no name", where=where, remedy="name it")
        if name in names[:index]:
            raise InputError("a column named twice", where=where, value=name, remedy="give each a name of its own")
    if rows and len(rows[0].cells) == len(names):
        below = list(rows[0].cells)
        if not any(is_number(cell) for cell in below) and is_unit_row(below):
            return names, [unit or clean_unit(below[i]) for i, unit in enumerate(units)], rows[1:]
    return names, units, rows


def check_rows(source: Path, names: list[str], rows: list[Line]) -> None:
    """Refuse rows that have not a cell for each name.

    Raises
    ------
    InputError
        With the line of the first.
    """
    for row in rows:
        if len(row.cells) != len(names):
            raise InputError(
                f"{len(row.cells)} cells where there are {len(names)} columns",
                where=f"{source}: line {row.number}",
                value=",".join(row.cells),
                remedy=_begins(names, rows) or "complete or remove the line (a file cut short ends like this)",
            )
        bad = next((cell for cell in row.cells if "\x00" in cell), None)
        if bad is not None:
            raise InputError("not a text: it holds zero bytes", where=f"{source}: line {row.number}", value=bad)


def _begins(names: list[str], rows: list[Line]) -> str:
    """That the header may stand further down, where it has as many cells as the last row, and no numbers."""
    width = len(rows[-1].cells)
    head = next((row for row in rows if len(row.cells) == width), rows[-1])
    if width == len(names) or any(is_number(cell) for cell in head.cells):
        return ""
    return f"if line {head.number} names the columns, say so in the record: header_row = {head.number}"


def _decimal_comma(source: Path, rows: list[Line]) -> bool:
    """Whether numbers are written with a comma, which only another separator leaves room for."""
    kinds = {",": "", ".": ""}
    for row in rows:
        for cell in row.cells:
            if is_number(cell):
                for mark in kinds:
                    if mark in cell:
                        kinds[mark] = kinds[mark] or f"line {row.number}: {cell}"
    if kinds[","] and kinds["."]:
        raise InputError(
            "decimal points and decimal commas in one table",
            where=str(source),
            value=f"{kinds['.']} and {kinds[',']}",
            remedy="write all numbers alike",
        )
    return bool(kinds[","])


def _cell(cell: str, place: str, comma: bool) -> float:
    if not cell:
        return float("nan")
    if not re.fullmatch(r"[-+0-9.eE,]+", cell):
        number(cell, place)
        raise InputError(
            "not a number", where=place, value=cell, remedy="give a plain number, units in the header"
        )
    return number(cell.replace(",", ".", 1) if comma else cell, place)
