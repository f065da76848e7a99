"""Records in time in text: CSV, TSV and their kin, read in pieces."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.laws.textfile import number
from permway.recordings.readers.headers import time_scale
from permway.recordings.readers.text_layout import Layout, find_layout, is_remark, numbered_lines
from permway.recordings.readers.timebase import TimeBase
from permway.recordings.readers.timefile import TimeFile

_PIECE_BYTES = 2**22


@contextmanager
def open_time(source: Path, keep_nonfinite: bool = False) -> Iterator[TimeFile]:
    """Open a text table of samples, one row each.

    The header, if there is one, names the columns, with units in brackets or in a row below. Separators are tab,
    semicolon, comma or blanks; with tab or semicolon numbers may have a decimal comma. Lines that begin with #, %
    or // are remarks; one that says "fs = 1024" is heard. A column named time (or t, time_s, "Time [ms]") must be
    uniform, and gives the rate.
    """
    layout = find_layout(source)
    time = _time_column(source, layout)
    columns = [i for i in range(len(layout.names)) if time is None or i != time[0]]
    reader = _Reader(source, layout, columns, time, keep_nonfinite)
    rows = reader.count()
    rate, start = layout.rate_Hz, None
    if time is not None:
        base = reader.first_times()
        start = base.start_s
        rate = _one_rate(source, base.sampling_Hz, layout.rate_Hz)
    yield TimeFile(
        source=str(source),
        channels=tuple(layout.names[i] for i in columns),
        units=tuple(layout.units[i] for i in columns),
        samples=rows,
        sampling_Hz=rate,
        start_s=start,
        read=reader.read,
    )


def _one_rate(source: Path, column: float | None, remark: float | None) -> float | None:
    if column is None or remark is None:
        return remark if column is None else column
    if abs(column / remark - 1.0) > 1e-4:
        raise InputError(
            f"the time column means {column:.9g} Hz, a remark says {remark:.9g} Hz",
            where=str(source),
            remedy="correct whichever is wrong",
        )
    return remark


def _time_column(source: Path, layout: Layout) -> tuple[int, float] | None:
    found = []
    for index, name in enumerate(layout.names):
        where = f"{source}: column '{name}'"
        scale = time_scale(name, layout.units[index], where)
        if scale is not None:
            found.append((index, scale))
    if len(found) > 1:
        names = [layout.names[index] for index, _ in found]
        raise InputError("more than one time column", where=str(source), value=names, remedy="keep one")
    return found[0] if found else None


class _Reader:
    """Rows in pieces, going on where it stopped so that blocks in turn cost one pass."""

    def __init__(
        self, source: Path, layout: Layout, columns: list[int], time: tuple[int, float] | None, keep: bool
    ) -> None:
        self.source, self.layout, self.columns, self.time, self.keep = source, layout, columns, time, keep
        self._pieces: Iterator[Reals] | None = None
        self._at = 0
        self._rest: Reals | None = None

    def count(self) -> int:
        rows = sum(1 for _, line in numbered_lines(self.source) if not is_remark(line)) - self.layout.header_lines
        return max(rows, 0)

    def first_times(self) -> TimeBase:
        base = self._base()
        piece = next(self._rows(), None)
        assert self.time is not None
        if piece is not None:
            base.feed(piece[:, self.time[0]] * self.time[1])
        return base

    def read(self, rows: Sequence[int], first: int, stop: int) -> Reals:
        if self._pieces is None or first < self._at:
            self._pieces, self._at, self._rest = self._checked(), 0, None
        wanted = [self.columns[row] for row in rows]
        values = np.empty((len(wanted), stop - first))
        filled = 0
        while filled < stop - first:
            piece = next(self._pieces) if self._rest is None else self._rest
            skip = first + filled - self._at
            if skip >= len(piece):
                self._at, self._rest = self._at + len(piece), None
                continue
            taken = piece[skip : skip + stop - first - filled]
            values[:, filled : filled + len(taken)] = taken[:, wanted].T
            filled += len(taken)
            self._at += skip + len(taken)
            self._rest = piece[skip + len(taken) :]
        return values

    def _base(self) -> TimeBase:
        assert self.time is not None
        index, scale = self.time
        name = self.layout.names[index]
        resolution = self._resolution(index) * scale
        return TimeBase(resolution, lambda sample: f"{self.source}: {self._line_of(sample)}, column '{name}'")

    def _resolution(self, index: int) -> float:
        """What the last digit of the column is worth: the most that any of the first cells is rounded by."""
        worth = []
        for line in self.layout.sample:
            cells = self.layout.cells(line)
            cell = cells[index] if index < len(cells) else ""
            digits = re.fullmatch(r"[-+]?\d*(?:[.,](\d*))?(?:[eE]([-+]?\d{1,3}))?", cell)
            if digits is not None:
                power = int(digits[2] or 0) - len(digits[1] or "")
                worth.append(10.0 ** min(max(power, -300), 300))
        # Where trailing zeros are left out ("0.5") the longest cell tells; with exponents the largest number does.
        exponents = any("e" in line.lower() for line in self.layout.sample)
        return (max(worth) if exponents else min(worth)) if worth else 0.0

    def _line_of(self, sample: int) -> str:
        for seen, (index, _) in enumerate(self._data_lines()):
            if seen == sample:
                return f"line {index}"
        return f"sample {sample}"

    def _data_lines(self) -> Iterator[tuple[int, str]]:
        left = self.layout.header_lines
        for index, line in numbered_lines(self.source):
            if is_remark(line):
                continue
            if left:
                left -= 1
                continue
            yield index, line

    def _checked(self) -> Iterator[Reals]:
        base = None if self.time is None else self._base()
        for piece in self._rows():
            if base is not None and self.time is not None:
                base.feed(piece[:, self.time[0]] * self.time[1])
            yield piece

    def _rows(self) -> Iterator[Reals]:
        numbers: list[int] = []
        lines: list[str] = []
        size = 0
        for index, line in self._data_lines():
            numbers.append(index)
            lines.append(line)
            size += len(line)
            if size > _PIECE_BYTES:
                yield self._parse(numbers, lines)
                numbers, lines, size = [], [], 0
        if lines:
            yield self._parse(numbers, lines)

    def _parse(self, numbers: list[int], lines: list[str]) -> Reals:
        layout = self.layout
        plain = lines
        if layout.decimal_comma:
            joined = "\n".join(lines)
            if "." not in joined:
                plain = joined.replace(",", ".").split("\n")
        if layout.trailing and layout.separator is not None:
            plain = [line.rstrip().removesuffix(layout.separator) for line in plain]
        try:
            table = np.loadtxt(plain, delimiter=layout.separator, comments=None, dtype=np.float64, ndmin=2)
        except ValueError:
            table = None
        sound = table is not None and table.shape == (len(lines), len(layout.names))
        if table is not None and sound and (self.keep or np.isfinite(table).all()):
            return table
        # Slower, and telling the line of the first fault.
        return np.array([self._row(index, line) for index, line in zip(numbers, lines, strict=True)])

    def _row(self, index: int, line: str) -> list[float]:
        layout = self.layout
        cells = layout.cells(line)
        if len(cells) != len(layout.names):
            raise InputError(
                f"{len(cells)} cells where there are {len(layout.names)} columns",
                where=f"{self.source}: line {index}",
                value=line,
                remedy="complete or remove the line (a file cut short ends so; a decimal comma needs ; or tab)",
            )
        values = []
        for cell, name in zip(cells, layout.names, strict=True):
            place = f"{self.source}: line {index}, column '{name}'"
            if "_" in cell or (layout.decimal_comma and "," in cell and "." in cell):
                raise InputError("not a number", where=place, value=cell, remedy="give a plain number")
            if layout.decimal_comma and "." in cell:
                what = "a decimal point in a table with decimal commas"
                raise InputError(what, where=place, value=cell, remedy="write all numbers alike")
            if self.keep and cell.lower().strip("+-") in ("nan", "inf", "infinity"):
                values.append(float(cell))
                continue
            values.append(number(cell.replace(",", ".", 1) if layout.decimal_comma else cell, place))
        return values
