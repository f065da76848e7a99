"""LabVIEW measurement files (.lvm): a head for the file, one for the segment, and rows of samples.

Source: National Instruments, "Specification for the LabVIEW Measurement File (.lvm)". Read here and not with
lvm_read, which loads a pickle that lies beside a file, and makes what is no number NaN in silence.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.laws.textfile import number
from permway.recordings.readers.headers import clean_unit
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.text_lines import is_number, numbered_lines
from permway.recordings.readers.timefile import TimeFile, Timing

START = b"LabVIEW Measurement"
_END = "***End_of_Header***"
_SEPARATORS = {"Tab": "\t", "Comma": ",", "": "\t"}
_X_OFF, _X_DIGIT_S = 0.05, 1e-6
"""Steps by which printed x values may differ from start and step, beside their last digit of a microsecond.

A rate that is off by a relative e shows after 0.05/e samples, a missing row at once; half or twice of it needs
half or twice as many.
"""

Row = tuple[int, list[str]]


@dataclass(frozen=True)
class _Segment:
    """One segment: its head by key, the columns of x and y values of each channel, and the rows."""

    head: Mapping[str, list[str]]
    names: tuple[str, ...]
    columns: tuple[tuple[int | None, int], ...]
    rows: list[Row]
    comma: bool
    where: str

    def stated(self, key: str, channel: int) -> str:
        """What the head states of a channel, empty if nothing."""
        cells = self.head.get(key, [])
        return cells[channel].strip() if channel < len(cells) else ""

    def real(self, key: str, channel: int) -> float | None:
        """A number that the head states of a channel."""
        text = self.stated(key, channel)
        return None if not text else number(text.replace(",", ".") if self.comma else text, f"{self.where}: {key}")

    def values(self, column: int) -> Reals:
        """The numbers of a column; a channel ends where its cells are empty."""
        found: list[float] = []
        for line, cells in self.rows:
            cell = cells[column].strip() if column < len(cells) else ""
            if (
                not cell
                and len(found) >= 1
                and not any(self._cell(row, column) for _, row in self.rows[len(found) :])
            ):
                break
            place = f"{self.where}: line {line}, column {column + 1}"
            found.append(number(cell.replace(",", ".") if self.comma else cell, place))
        return np.array(found)

    def _cell(self, cells: list[str], column: int) -> str:
        return cells[column].strip() if column < len(cells) else ""


@contextmanager
def open_time(
    source: Path, hints: Hints = NO_HINTS, *, part: str | None = None, max_bytes: int = MOST_BYTES
) -> Iterator[TimeFile]:
    """Open one segment of a LabVIEW measurement file, the number of which `part` is if there are several.

    Rates are by `Delta_X` of each channel, and starts by `X0`, `Date` and `Time`; x values, where they are
    printed, are compared with both.
    """
    check_size(source.stat().st_size, str(source), max_bytes=max_bytes, item=8)
    segment = _segment(source, hints, part)

    def timing(row: int) -> Timing:
        return _timing(segment, row, hints)

    def read(rows: Sequence[int], first: int, stop: int) -> Reals:
        return np.stack([segment.values(segment.columns[row][1])[first:stop] for row in rows])

    yield TimeFile(
        source=str(source),
        channels=segment.names,
        units=tuple(clean_unit(segment.stated("Y_Unit_Label", i)) for i in range(len(segment.names))),
        timing=timing,
        read=read,
    )


def _segment(source: Path, hints: Hints, part: str | None) -> _Segment:
    lines = list(numbered_lines(source, hints.encoding))
    ends = [at for at, (_, line) in enumerate(lines) if line.strip().startswith(_END)]
    if len(ends) < 2:
        raise InputError("has no segment of samples", where=str(source), remedy="record it again")
    words = [line for _, line in lines[: ends[0]]]
    separator = _separator(words, str(source))
    head = {cells[0].strip(): cells[1:] for cells in (line.split(separator) for line in words) if cells[0].strip()}
    sign = (head.get("Decimal_Separator") or ["."])[0].strip() or "."
    heads = _heads(lines, ends, separator, str(source))
    number = _number(heads, lines, part, str(source))
    start, end = heads[number - 1]
    stop = heads[number][0] if number < len(heads) else len(lines)
    inner = [line.split(separator) for _, line in lines[start:end]]
    table = {cells[0].strip(): cells[1:] for cells in inner if cells[0].strip()}
    if end + 1 >= stop:
        raise InputError("has no row of names", where=str(source), remedy="record it again")
    _, titles = lines[end + 1]
    names, columns = _columns(titles.split(separator), head, str(source))
    rows = [(index, line.split(separator)) for index, line in lines[end + 2 : stop] if line.strip()]
    return _Segment(table, names, columns, rows, (hints.decimal or sign) == ",", str(source))


def _heads(lines: list[tuple[int, str]], ends: list[int], separator: str, where: str) -> list[tuple[int, int]]:
    """First line and end of the head of each segment: that of a later one begins with a word, which no row does.

    Raises
    ------
    InputError
        For a segment without a head, whose rows would be taken for those of the one before.
    """
    found = [(ends[0] + 1, ends[1])]
    for before, end in pairwise(ends[1:]):
        first = next((i for i in range(before + 2, end) if _is_word(lines[i][1].split(separator)[0])), None)
        if first is None:
            what = "a segment without its head"
            raise InputError(what, where=f"{where}: line {lines[end][0]}", remedy="export each segment by itself")
        found.append((first, end))
    return found


def _is_word(cell: str) -> bool:
    """Whether the first cell of a line is the key of a head rather than a value of x or empty."""
    return bool(cell.strip()) and not is_number(cell)


def _number(heads: list[tuple[int, int]], lines: list[tuple[int, str]], part: str | None, where: str) -> int:
    """Number of the segment that is meant, from 1."""
    if part is None and len(heads) == 1:
        return 1
    numbers = [str(i + 1) for i in range(len(heads))]
    if part in numbers:
        return int(part)
    begins = ", ".join(f'"{i}" from line {lines[start][0]}' for i, (start, _) in zip(numbers, heads, strict=True))
    what = f"holds {len(heads)} segments" if part is None else "there is no such segment"
    remedy = 'say which in the record, as in part = "1"'
    raise InputError(what, where=where, value=part or begins, remedy=remedy)


def _separator(words: list[str], where: str) -> str:
    for line in words:
        if line.startswith("Separator"):
            name = line[len("Separator") :].strip(" \t,")
            if name not in _SEPARATORS:
                raise InputError("separates its cells by a sign that is not known", where=where, value=name)
            # The line itself is written with the separator.
            return line[len("Separator")] if line[len("Separator") :][:1] in ("\t", ",") else _SEPARATORS[name]
    return "\t"


def _columns(
    titles: list[str], head: Mapping[str, list[str]], where: str
) -> tuple[tuple[str, ...], tuple[tuple[int | None, int], ...]]:
    """Names of the channels, and for each its column of x, None where none is written, and that of y."""
    kind = (head.get("X_Columns") or ["One"])[0].strip()
    if kind not in ("No", "One", "Multi"):
        raise InputError("X_Columns must be No, One or Multi", where=where, value=kind)
    names: list[str] = []
    columns: list[tuple[int | None, int]] = []
    x: int | None = None
    for at, title in enumerate(cell.strip() for cell in titles):
        if title == "X_Value":
            x = None if kind == "No" else at
        elif title and title != "Comment":
            names.append(title)
            columns.append((x, at))
    return tuple(names), tuple(columns)


def _timing(segment: _Segment, row: int, hints: Hints) -> Timing:
    where = f"{segment.where}: channel '{segment.names[row]}'"
    x_column, y_column = segment.columns[row]
    samples = segment.values(y_column).size
    announced = segment.real("Samples", row)
    if announced is not None and announced != samples:
        what = f"{announced:g} samples announced, {samples} there"
        raise InputError(what, where=where, remedy="the file is cut short or damaged; record it again")
    if hints.no_times:
        return Timing(samples=samples, sampling_Hz=None)
    dimension = segment.stated("X_Dimension", row)
    if dimension and dimension != "Time":
        remedy = 'leave it out, or state time_column = "none" and sampling_Hz'
        raise InputError("does not stand over time", where=where, value=dimension, remedy=remedy)
    step, start = segment.real("Delta_X", row), segment.real("X0", row) or 0.0
    if step is None or not step > 0.0:
        raise InputError("the step in time must be above 0 s", where=f"{where}: Delta_X", value=step)
    if x_column is not None:
        x = segment.values(x_column)
        line = start + step * np.arange(x.size)
        # Seconds from the start, or from X0: which of them programs write is not the same everywhere.
        off = min(float(np.abs(x - line).max()), float(np.abs(x - line + start).max())) if x.size else 0.0
        if x.size != samples or off > _X_OFF * step + _X_DIGIT_S:
            what = f"the x values do not follow the step of {step:g} s"
            raise InputError(what, where=where, value=f"off by {off:g} s", remedy="export it again")
    begins = " ".join(text for key in ("Date", "Time") if (text := segment.stated(key, row)))
    return Timing(samples=samples, sampling_Hz=1.0 / step, start_s=start, begins=begins)
