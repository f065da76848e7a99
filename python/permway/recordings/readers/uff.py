"""Universal files: their datasets one after another, with checked fields and line numbers.

Source: Structural Dynamics Research Laboratory, University of Cincinnati, "Universal File Formats for Modal
Analysis Testing". Read here and not with pyuff, which does not compare the number of values with the number
announced, and passes over a dataset that is not closed: a file cut short would be a short record in silence. The
tests hold both against each other.
"""

from __future__ import annotations

import mmap
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from permway.arrays import Reals
from permway.errors import InputError

_FENCE = re.compile(rb" *-1[ \t]*(?:\r?\n|\r|$)")
_MOST_LINE = 4096
_SHORT_EXPONENT = re.compile(r"([-+]?\d*\.\d+)([-+]\d{3})")


@dataclass(frozen=True)
class Text:
    """The bytes of a universal file, read by position."""

    source: str
    data: mmap.mmap | bytes
    encoding: str | None = None

    def decoded(self, raw: bytes) -> str:
        """Text of some bytes, for fields are counted in characters: as was stated, else UTF-8, else Latin-1.

        Raises
        ------
        InputError
            For bytes that are not of the character set that was stated.
        """
        try:
            return raw.decode(self.encoding or "utf-8")
        except UnicodeDecodeError:
            if self.encoding is not None:
                remedy = "give the encoding in which it was written"
                raise InputError(
                    f"is not in {self.encoding}", where=self.source, value=raw[:40], remedy=remedy
                ) from None
            return raw.decode("latin-1")

    def line(self, at: int) -> tuple[str, int]:
        """The line at a position, without its end, and the position of the next.

        Raises
        ------
        InputError
            At the end of the file, or for a line that cannot be one of a header.
        """
        if at >= len(self.data):
            raise self.error("the file ends within a dataset: cut short", at, remedy="export it again")
        end = self.data.find(b"\n", at, at + _MOST_LINE)
        if end < 0:
            if len(self.data) - at > _MOST_LINE:
                raise self.error("no line of a universal file", at, value=self.data[at : at + 20])
            end = len(self.data)
        return self.decoded(self.data[at:end].rstrip(b"\r")), end + 1

    def fence(self, at: int) -> int | None:
        """The position after the line "    -1", if it stands here."""
        found = _FENCE.match(self.data[at : at + 90])
        return None if found is None else at + found.end()

    def field(self, line: str, at: int, first: int, width: int, name: str) -> int:
        """A whole number of a fixed-width field; 0 if it is blank."""
        cell = line[first : first + width].strip()
        try:
            return int(cell) if cell else 0
        except ValueError:
            raise self.error(f"{name} is no whole number", at, value=cell) from None

    def real(self, line: str, at: int, first: int, width: int, name: str) -> float:
        """A finite number of a fixed-width field; 0 if it is blank."""
        cell = line[first : first + width].strip().replace("D", "E").replace("d", "e")
        try:
            value = float(cell) if cell else 0.0
        except ValueError:
            raise self.error(f"{name} is no number", at, value=cell) from None
        if not np.isfinite(value):
            raise self.error(f"{name} is not finite", at, value=cell)
        return value

    def numbers(self, at: int, widths: tuple[int, ...], count: int, *, keep: bool = False) -> tuple[Reals, int]:
        """So many numbers in lines of fixed-width fields, and the position after them.

        Where the last line has room left, fields of zeros beyond the last number are fill.

        Parameters
        ----------
        keep : bool
            Keep numbers that are not finite, else they are refused.

        Raises
        ------
        InputError
            With the line of the first that is missing or not a finite number.
        """
        lines = -(-count // len(widths))
        # No value takes less than a digit and a separator.
        if count > (len(self.data) - at):
            raise self.error(f"{count} values announced, more than the file holds: cut short", at)
        end = at
        rows: list[bytes] = []
        starts: list[int] = []
        for _ in range(lines):
            stop = self.data.find(b"\n", end)
            stop = len(self.data) if stop < 0 else stop
            rows.append(self.data[end:stop])
            starts.append(end)
            if end >= len(self.data):
                raise self.error("the file ends within a dataset: cut short", end, remedy="export it again")
            end = min(stop + 1, len(self.data))
        values = _at_once(b" ".join(rows), count)
        if values is None or not (keep or np.isfinite(values).all()):
            values = self._slowly(rows, starts, widths, count, keep)
        return values, end

    def loose(self, at: int, end: int, fields: int, count: int, *, keep: bool = False) -> Reals | None:
        """So many numbers in lines of whole points, however many to a line; None if they do not stand so.

        Parameters
        ----------
        fields : int
            Numbers of one point.
        """
        rows = [row for row in self.data[at:end].splitlines() if row.strip()]
        each = {len(row.split()) for row in rows[:-1]}
        whole = len(each) <= 1 and all(number % fields == 0 for number in each)
        values = (
            _at_once(b" ".join(rows), count) if whole and sum(len(row.split()) for row in rows) == count else None
        )
        return values if values is not None and (keep or np.isfinite(values).all()) else None

    def _slowly(
        self, rows: list[bytes], starts: list[int], widths: tuple[int, ...], count: int, keep: bool
    ) -> Reals:
        values: list[float] = []
        for row, at in zip(rows, starts, strict=True):
            line = row.rstrip(b"\r").decode("latin-1")
            expected = min(len(widths), count - len(values))
            cells = line.split()
            fill = cells[expected:] if expected < len(widths) else []
            if fill and all(_is_zero(cell) for cell in fill) and len(cells) <= len(widths):
                cells = cells[:expected]
            if len(cells) != expected:
                edges = np.concatenate(([0], np.cumsum(widths)))
                cells = [line[edges[i] : edges[i + 1]].strip() for i in range(expected)]
                if line[edges[expected] :].strip():
                    raise self.error(f"more than {expected} values in a line", at, value=line.strip())
            for cell in cells:
                try:
                    value = _number(cell)
                except ValueError:
                    what = "a value is missing: cut short" if not cell or cell == "-1" else "not a number"
                    raise self.error(what, at, value=cell or line.strip()) from None
                if not (keep or np.isfinite(value)):
                    raise self.error("not a finite number", at, value=cell)
                values.append(value)
        return np.array(values)

    def binary(self, at: int, kind: str, count: int) -> NDArray[np.floating]:
        """So many binary numbers, in a copy: what points into a mapped file keeps it from being closed."""
        size = count * np.dtype(kind).itemsize
        if size > len(self.data) - at:
            what = f"{count} values announced, {max(len(self.data) - at, 0)} bytes left: cut short"
            raise self.error(what, at, remedy="export it again")
        return np.frombuffer(self.data[at : at + size], dtype=kind, count=count)

    def error(self, what: str, at: int, *, value: object = None, remedy: str = "correct the line") -> InputError:
        """An error with the line of a position."""
        line = self.data[: min(at, len(self.data))].count(b"\n") + 1
        return InputError(what, where=f"{self.source}: line {line}", value=value, remedy=remedy)


def _at_once(body: bytes, count: int) -> Reals | None:
    """All numbers of a text, if there are so many of them and nothing else."""
    cells = body.replace(b"D", b"E").replace(b"d", b"e").split()
    if len(cells) != count:
        return None
    try:
        return np.array(cells, dtype="S").astype(np.float64)
    except ValueError:
        return None


def _number(cell: str) -> float:
    """A number as Fortran prints it: with D before the exponent, or without a letter where it has three digits."""
    if "_" in cell:
        raise ValueError(cell)
    short = _SHORT_EXPONENT.fullmatch(cell)
    return float(f"{short[1]}E{short[2]}" if short else cell.replace("D", "E").replace("d", "e"))


def _is_zero(cell: str) -> bool:
    try:
        return _number(cell) == 0.0
    except ValueError:
        return False


@dataclass(frozen=True)
class Block:
    """A dataset: its type, whether it is binary, its first line, and where its second begins."""

    kind: int
    head: str
    head_at: int
    body: int


@contextmanager
def open_text(source: Path, encoding: str | None = None) -> Iterator[Text]:
    """The file, mapped and not loaded."""
    with source.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        yield Text(str(source), data, encoding)


def next_block(text: Text, at: int) -> Block | None:
    """The dataset that begins at a position, or None at the end of the file.

    Raises
    ------
    InputError
        For anything but a dataset there.
    """
    data = text.data
    while at < len(data) and data[at : at + 1] in (b"\r", b"\n", b" ", b"\x1a", b"\x00"):
        if data[at : at + 1] == b" " and text.fence(at) is not None:
            break
        at += 1
    if at >= len(data):
        return None
    start = text.fence(at)
    if start is None:
        raise text.error('a dataset must begin with a line "    -1"', at, value=data[at : at + 20])
    head, body = text.line(start)
    found = re.match(r"\s*(\d{1,6})(b?)", head, re.IGNORECASE)
    if found is None:
        raise text.error("a dataset must begin with its number", start, value=head)
    return Block(int(found[1]), head, start, body)


def skip_block(text: Text, block: Block) -> int:
    """The position after a dataset that is not read.

    Raises
    ------
    InputError
        If it is not closed.
    """
    at = block.body
    while True:
        found = text.data.find(b"    -1", at)
        if found < 0:
            raise text.error("a dataset is not closed: cut short", block.head_at, value=block.head.strip())
        after = text.fence(found)
        if after is not None and (found == 0 or text.data[found - 1 : found] in (b"\n", b"\r")):
            return after
        at = found + 1
