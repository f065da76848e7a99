"""Lines and cells of a text table: character set, remarks, quotes."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from pathlib import Path

from permway.errors import InputError

_PIECE_BYTES = 2**20
_LONGEST_LINE = 2**20
_REMARKS = ("#", "%", "//")
_MINUS = "\N{MINUS SIGN}"
_FORTRAN = re.compile(r"\s*([-+]?(?:\d+[.,]?\d*|[.,]\d+))[dD]([-+]?\d{1,3})\s*")


def numbered_lines(source: Path, encoding: str | None = None) -> Iterator[tuple[int, str]]:
    """Lines of a text file with their numbers from 1, in pieces.

    Parameters
    ----------
    source : Path
    encoding : str, optional
        By default UTF-8, or else Latin-1 as older loggers write.

    Raises
    ------
    InputError
        If it is not text, or not of that character set, or a line is longer than any table's.
    """
    if encoding is not None:
        yield from _as_stated(source, encoding)
        return
    count, rest, first, old_mac = 0, b"", True, False
    with source.open("rb") as file:
        while piece := file.read(_PIECE_BYTES):
            if first:
                piece, first = piece.removeprefix(b"\xef\xbb\xbf"), False
                # Programs of old Macs, and Excel's "CSV (Macintosh)", end lines by a carriage return alone.
                old_mac = b"\r" in piece and b"\n" not in piece
            if old_mac:
                piece = piece.replace(b"\r", b"\n")
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


def _as_stated(source: Path, encoding: str) -> Iterator[tuple[int, str]]:
    try:
        with source.open(encoding=encoding, newline="\n") as file:
            for index, line in enumerate(iter(lambda: file.readline(_LONGEST_LINE), ""), start=1):
                yield index, line.rstrip("\r\n").removeprefix("\ufeff").replace(_MINUS, "-")
    except UnicodeError as error:
        remedy = "give the encoding in which it was written: utf-8, latin-1, cp1252 or utf-16"
        raise InputError(
            "is no text of this encoding", where=str(source), value=encoding, remedy=remedy
        ) from error


def _decoded(raw: bytes, source: Path, before: int) -> list[str]:
    if b"\x00" in raw:
        line = before + 1 + raw[: raw.index(b"\x00")].count(b"\n")
        what = "not a text: it holds zero bytes"
        raise InputError(what, where=f"{source}: line {line}", remedy="export it as CSV in UTF-8")
    try:
        text = raw.decode("utf-8")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    return [line.rstrip("\r") for line in text.replace(_MINUS, "-").split("\n")]


def is_remark(line: str) -> bool:
    """Whether a line states nothing of the table: empty, or a remark."""
    bare = line.lstrip()
    return not bare or bare.startswith(_REMARKS)


def without_mark(line: str) -> str:
    """A remark without the sign that makes it one."""
    return line.lstrip().lstrip("#%/").strip()


def is_number(cell: str) -> bool:
    """Whether a cell is a number, with point or comma, finite or not."""
    try:
        float(with_e(cell.strip().strip('"')).replace(",", ".", 1))
    except ValueError:
        return False
    return True


def with_e(cell: str) -> str:
    """A number of Fortran, as 1.2D-03, with E before its exponent; other cells as they are."""
    found = _FORTRAN.fullmatch(cell) if "D" in cell or "d" in cell else None
    return cell if found is None else f"{found[1]}E{found[2]}"


def cells_of(line: str, separator: str | None) -> list[str]:
    """Cells of a line, without blanks and quotes around them; separators in quotes are part of a cell."""
    if separator is None:
        return line.split()
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    try:
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except (csv.Error, StopIteration):
        cells = line.split(separator)
    return [cell.strip().strip('"').strip() for cell in cells]
