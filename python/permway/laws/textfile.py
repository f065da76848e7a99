"""Lines and cells of a text table, with their places for errors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from permway.errors import InputError
from permway.reading import LARGEST_TABLE, read_bytes


@dataclass(frozen=True)
class Line:
    """One line of a table: its number in the file, from 1, and its cells."""

    number: int
    cells: tuple[str, ...]


def read_lines(path: Path) -> list[Line]:
    """Read the lines of a CSV or TSV file, without remarks (#) and empty lines.

    Raises
    ------
    InputError
        If the file is missing, unreadable, larger than :data:`~permway.reading.LARGEST_TABLE`, not text, or empty.
    """
    try:
        text = read_bytes(path, LARGEST_TABLE).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError("not a text file in UTF-8", where=str(path), remedy="export it as CSV") from error
    kept = [
        (index, line)
        for index, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not kept:
        raise InputError("the file is empty", where=str(path), remedy="give a header and rows")
    separator = next((mark for mark in ("\t", ";", ",") if mark in kept[0][1]), None)
    return [
        Line(index, tuple(cell.strip().strip('"').strip() for cell in line.split(separator)))
        for index, line in kept
    ]


def number(cell: str, place: str) -> float:
    """Read one cell as a finite number.

    Raises
    ------
    InputError
        If the cell is empty, not a number, or not finite.
    """
    try:
        value = float(cell)
    except ValueError:
        comma = "," in cell
        raise InputError(
            "the cell is empty" if not cell else "not a number",
            where=place,
            value=cell,
            remedy="use a decimal point, not a comma" if comma else "give a plain number, units in the header",
        ) from None
    if not math.isfinite(value):
        raise InputError("not a finite number", where=place, value=cell, remedy="remove the row or measure it")
    return value
