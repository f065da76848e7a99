"""Rows of a text table of samples, in pieces: only the columns that are wanted are numbers that must be sound."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.laws.textfile import number
from permway.recordings.readers.clock import Clock, digits_of
from permway.recordings.readers.text_layout import Layout
from permway.recordings.readers.text_lines import is_remark, numbered_lines, with_e
from permway.recordings.readers.timebase import TimeBase, check_unstated

_PIECE_BYTES = 2**22
_QUOTED_COMMA = re.compile(r'"([^",]*),([^",]*)"')


class Rows:
    """Rows in pieces, going on where it stopped so that blocks in turn cost one pass."""

    def __init__(self, source: Path, layout: Layout, keep: bool) -> None:
        self.source, self.layout, self.keep = source, layout, keep
        self.clocks: dict[int, Clock] = {}
        self._pieces: Iterator[Reals] | None = None
        self._wanted: list[int] = []
        self._at = 0
        self._rest: Reals | None = None

    def count(self) -> int:
        """Number of rows."""
        return sum(1 for _ in self._lines())

    def read(self, wanted: Sequence[int], first: int, stop: int, times: Times | None) -> Reals:
        """Samples of some columns, shape (column, sample), the times checked on the way."""
        if self._pieces is None or first < self._at or list(wanted) != self._wanted:
            self._pieces, self._at, self._rest = self._checked(wanted, times), 0, None
            self._wanted = list(wanted)
        values = np.empty((len(wanted), stop - first))
        filled = 0
        while filled < stop - first:
            piece = next(self._pieces) if self._rest is None else self._rest
            skip = first + filled - self._at
            if skip >= len(piece):
                self._at, self._rest = self._at + len(piece), None
                continue
            taken = piece[skip : skip + stop - first - filled]
            values[:, filled : filled + len(taken)] = taken[:, : len(wanted)].T
            filled += len(taken)
            self._at += skip + len(taken)
            self._rest = piece[skip + len(taken) :]
        return values

    def _checked(self, wanted: Sequence[int], times: Times | None) -> Iterator[Reals]:
        if times is None:
            yield from self.pieces(wanted)
            return
        base = times.base()
        for piece in self.pieces([*wanted, times.index]):
            base.feed(piece[:, -1])
            yield piece

    def pieces(self, wanted: Sequence[int]) -> Iterator[Reals]:
        """Some columns in pieces, shape (row, column)."""
        numbers: list[int] = []
        lines: list[str] = []
        size = 0
        for index, line in self._lines():
            numbers.append(index)
            lines.append(line)
            size += len(line)
            if size > _PIECE_BYTES:
                yield self._parse(numbers, lines, wanted)
                numbers, lines, size = [], [], 0
        if lines:
            yield self._parse(numbers, lines, wanted)

    def line_of(self, sample: int) -> str:
        """The line of a sample, for messages."""
        for seen, (index, _) in enumerate(self._lines()):
            if seen == sample:
                return f"line {index}"
        return f"sample {sample}"

    def _lines(self) -> Iterator[tuple[int, str]]:
        for index, line in numbered_lines(self.source, self.layout.encoding):
            if index >= self.layout.first_row and not is_remark(line):
                yield index, line

    def _parse(self, numbers: list[int], lines: list[str], wanted: Sequence[int]) -> Reals:
        table = self._quickly(lines, wanted)
        if table is not None and (self.keep or np.isfinite(table).all()):
            return table
        # Slower, and informative the line of the first fault.
        return np.array([self._row(index, line, wanted) for index, line in zip(numbers, lines, strict=True)])

    def _quickly(self, lines: list[str], wanted: Sequence[int]) -> Reals | None:
        """The columns at once, None where a line is not plainly of the table's form."""
        layout = self.layout
        mark, count = layout.separator, len(layout.names)
        plain = "\n".join(lines)
        if layout.decimal_comma:
            if "." in plain:
                return None
            plain = _QUOTED_COMMA.sub(r"\1.\2", plain) if mark == "," else plain.replace(",", ".")
        if '"' in plain:
            plain = plain.replace('"', "") if not re.search(r'"[^"\n]*[,;\t][^"\n]*"', plain) else ""
        rows = plain.split("\n")
        if len(rows) != len(lines):
            return None
        if mark is not None:
            counts = {row.count(mark) for row in rows}
            if counts - {count - 1, count} or (
                count in counts
                and any(row.count(mark) == count and not row.rstrip().endswith(mark) for row in rows)
            ):
                return None
        elif any(len(row.split()) != count for row in rows):
            return None
        try:
            table = np.loadtxt(
                rows,
                delimiter=mark,
                comments=None,
                dtype=np.float64,
                ndmin=2,
                usecols=tuple(wanted),
                converters={i: clock for i, clock in self.clocks.items() if i in wanted} or None,
            )
        except ValueError:
            return None
        return table if table.shape == (len(lines), len(wanted)) else None

    def _row(self, index: int, line: str, wanted: Sequence[int]) -> list[float]:
        layout = self.layout
        cells = layout.cells(line)
        if len(cells) != len(layout.names):
            raise InputError(
                f"{len(cells)} cells where there are {len(layout.names)} columns",
                where=f"{self.source}: line {index}",
                value=line,
                remedy="complete or remove the line (a file cut short ends so; a decimal comma needs ; or tab)",
            )
        return [
            self._cell(cells[i], f"{self.source}: line {index}, column '{layout.names[i]}'", self.clocks.get(i))
            for i in wanted
        ]

    def _cell(self, cell: str, place: str, clock: Clock | None) -> float:
        comma = self.layout.decimal_comma
        cell = cell if clock is not None else with_e(cell)
        if clock is not None:
            try:
                return clock(cell)
            except ValueError:
                remedy = 'write all alike, or leave the times aside: time_column = "none" and sampling_Hz'
                raise InputError("not a time of day", where=place, value=cell, remedy=remedy) from None
        if "_" in cell or (comma and "," in cell and "." in cell):
            raise InputError("not a number", where=place, value=cell, remedy="give a plain number")
        if comma and "." in cell:
            what = "a decimal point in a table with decimal commas"
            raise InputError(what, where=place, value=cell, remedy="write all numbers alike")
        if self.keep and cell.lower().strip("+-") in ("nan", "inf", "infinity"):
            return float(cell)
        if not comma and "," in cell:
            remedy = 'if the comma parts decimals, say so in the record: decimal = ","'
            raise InputError("not a number", where=place, value=cell, remedy=remedy)
        return number(cell.replace(",", ".", 1) if comma else cell, place)


class Times:
    """A column of times.

    Parameters
    ----------
    rows : Rows
    index : int
        Of the column.
    scale : float
        Seconds in one of its unit.
    clock : bool
        Whether they are dates or times of day. Loggers round these, so that even steps do not make a rate certain.
    unstated : bool
        Whether no unit is stated.
    """

    def __init__(
        self, rows: Rows, index: int, scale: float, *, clock: bool = False, unstated: bool = False
    ) -> None:
        self.rows, self.index, self.scale, self.clock, self.unstated = rows, index, scale, clock, unstated

    def base(self) -> TimeBase:
        """A check that has seen nothing yet."""
        name = self.rows.layout.names[self.index]
        if self.clock:
            self.rows.clocks[self.index] = Clock()
        return TimeBase(
            self._resolution() * self.scale,
            lambda sample: f"{self.rows.source}: {self.rows.line_of(sample)}, column '{name}'",
            self.scale,
            rounded=self.clock,
        )

    def first(self) -> TimeBase:
        """The check after the first rows."""
        base = self.base()
        piece = next(iter(self.rows.pieces([self.index])), None)
        if piece is not None:
            base.feed(piece[:, 0])
        if self.unstated:
            check_unstated(base, self.rows.layout.names[self.index])
        return base

    def _resolution(self) -> float:
        """What the last digit is worth: the most that any of the first cells is rounded by."""
        layout, worth, top = self.rows.layout, [], 0.0
        if self.clock:
            rows = [layout.cells(line) for line in layout.sample]
            return float(
                10.0 ** -max((digits_of(row[self.index]) for row in rows if self.index < len(row)), default=0)
            )
        exponents = False
        for line in layout.sample:
            cells = layout.cells(line)
            cell = with_e(cells[self.index]) if self.index < len(cells) else ""
            digits = re.fullmatch(r"[-+]?\d*(?:[.,](\d*))?(?:[eE]([-+]?\d{1,3}))?", cell)
            if digits is not None and cell:
                power = int(digits[2] or 0) - len(digits[1] or "")
                worth.append(10.0 ** min(max(power, -300), 300))
                exponents |= digits[2] is not None
                top = max(top, abs(float(cell.replace(",", "."))) if cell.strip("+-.,") else 0.0)
        # Where trailing zeros are left out ("0.5") the longest cell decides; with exponents the largest number
        # does.
        printed = (max(worth) if exponents else min(worth)) if worth else 0.0
        # Nanoseconds since 1970 have more digits than a number of double precision.
        return max(printed, 2.0**-52 * top)
