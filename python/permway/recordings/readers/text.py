"""Records in time in text: CSV, TSV and their kin, read in pieces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from permway.errors import InputError
from permway.recordings.readers.clock import is_clock
from permway.recordings.readers.headers import time_scale
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.scales import seconds_in, seconds_of
from permway.recordings.readers.store import OVER_FREQUENCY
from permway.recordings.readers.stored import is_one_of
from permway.recordings.readers.text_layout import Layout, find_layout
from permway.recordings.readers.text_lines import is_number
from permway.recordings.readers.text_rows import Rows, Times
from permway.recordings.readers.timebase import unstated_scale
from permway.recordings.readers.timefile import TimeFile, Timing


@contextmanager
def open_time(source: Path, keep_nonfinite: bool = False, hints: Hints = NO_HINTS) -> Iterator[TimeFile]:
    """Open a text table of samples, one row each.

    The header, if there is one, names the columns, with units in brackets or in a row below. Separators are tab,
    semicolon, comma or blanks; with tab or semicolon, or in quotes, numbers may have a decimal comma. Lines that
    begin with #, % or // are remarks; one that states "fs = 1024" is read. A column named time (or t, time_s,
    "Time [ms]"), or the first one if its unit is one of time, must be uniform, and gives the rate. Only the
    columns that are asked for, and the times, have to be sound.
    """
    layout = find_layout(source, hints)
    time = _time_column(source, layout, hints)
    columns = [i for i in range(len(layout.names)) if time is None or i != time]
    rows = Rows(source, layout, keep_nonfinite)
    count = rows.count()

    @cache
    def checked() -> Times | None:
        return None if time is None else _times(source, rows, time, hints)

    @cache
    def timing() -> Timing:
        remark, times = layout.rate, checked()
        if times is None:
            fault = None if hints.no_times else remark.fault
            value = None if hints.no_times else remark.value_Hz
            return Timing(samples=count, sampling_Hz=value, remark=True, fault=fault)
        found = times.first().timing(count)
        if found.sampling_Hz is None:
            return Timing(
                samples=count, sampling_Hz=remark.value_Hz, start_s=found.start_s, remark=True, fault=remark.fault
            )
        if remark.value_Hz is None:
            return found
        if abs(found.sampling_Hz / remark.value_Hz - 1.0) > max(1e-4, found.uncertainty):
            raise InputError(
                f"the time column means {found.sampling_Hz:.9g} Hz, a remark states {remark.value_Hz:.9g} Hz",
                where=str(source),
                remedy='correct either, or leave the times aside: time_column = "none" and sampling_Hz',
            )
        return Timing(
            samples=count, sampling_Hz=remark.value_Hz, start_s=found.start_s, uncertainty=found.uncertainty
        )

    def read(wanted: Sequence[int], first: int, stop: int) -> object:
        return rows.read([columns[row] for row in wanted], first, stop, checked())

    yield TimeFile(
        source=str(source),
        channels=tuple(layout.names[i] for i in columns),
        units=tuple(layout.units[i] for i in columns),
        timing=lambda _: timing(),
        read=read,  # type: ignore[arg-type]
        times=None if time is None else layout.names[time],
    )


def _time_column(source: Path, layout: Layout, hints: Hints) -> int | None:
    """Position of the column of times.

    Raises
    ------
    InputError
        If there are several, or none of the name that was stated.
    """
    if hints.no_times:
        return None
    names = layout.names
    if hints.time_column is not None:
        if names.count(hints.time_column) != 1:
            what = "there is no such column" if hints.time_column not in names else "several columns of this name"
            raise InputError(what, where=str(source), value=hints.time_column, remedy=f"it has {list(names)[:12]}")
        return names.index(hints.time_column)
    found = []
    for index, name in enumerate(names):
        unit = hints.unit_of(name) or layout.units[index]
        if time_scale(name, unit, f"{source}: column '{name}'")[0]:
            found.append(index)
    if len(found) > 1:
        value = [names[index] for index in found]
        remedy = f'keep one, or say which in the record: time_column = "{value[0]}"'
        raise InputError("more than one time column", where=str(source), value=value, remedy=remedy)
    first = hints.unit_of(names[0]) or layout.units[0]
    over = is_one_of(names[0], OVER_FREQUENCY - {"f"}) or (first or "").lower() in ("hz", "khz", "rad/s")
    if not found and len(names) > 1 and over:
        remedy = (
            'is it a table of frequency responses? use statistic = "frf"; '
            'if the column is a channel, state time_column = "none" and sampling_Hz'
        )
        raise InputError("stands over frequency, not over time", where=str(source), value=names[0], remedy=remedy)
    if not found and len(names) > 1 and first is not None and seconds_of(first) is not None:
        return 0
    return found[0] if found else None


def _times(source: Path, rows: Rows, index: int, hints: Hints) -> Times:
    """The column of times, with what one of its unit is in seconds."""
    name = rows.layout.names[index]
    where = f"{source}: column '{name}'"
    unit = hints.unit_of(name) or hints.unit_of("time") or rows.layout.units[index]
    cells = [rows.layout.cells(line) for line in rows.layout.sample[:2]]
    if cells and all(index < len(row) and is_clock(row[index]) for row in cells):
        return Times(rows, index, 1.0, clock=True)
    if cells and index < len(cells[0]) and not is_number(cells[0][index]):
        raise InputError(
            "times that are neither numbers nor times of day",
            where=where,
            value=cells[0][index],
            remedy='leave them aside in the record: time_column = "none" and sampling_Hz',
        )
    known, scale = time_scale(name, unit, where)
    if not known and unit is not None:
        scale = seconds_in(unit, where)
    if scale is None:
        first = next(iter(rows.pieces([index])), None)
        return Times(rows, index, 1.0 if first is None else unstated_scale(first[:, 0]), unstated=True)
    return Times(rows, index, scale)
