"""Files of named arrays (MAT, NPZ, HDF5, NetCDF) seen alike, and what in them is samples, time, rate and names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit, split_header, time_scale
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_CHANNELS
from permway.recordings.readers.scales import hertz_in, seconds_in
from permway.recordings.readers.store_beside import check_counts
from permway.recordings.readers.store_columns import Column, columns_of, rank, read_columns
from permway.recordings.readers.stored import UNITS, Store, Variable, is_one_of
from permway.recordings.readers.timebase import LEAST_UNSTATED_HZ, TimeBase, check_unstated, unstated_scale
from permway.recordings.readers.timefile import TimeFile, Timing

RATES = {
    "fs",
    "f_s",
    "sr",
    "sampling_hz",
    "sampling_rate",
    "sampling_rate_hz",
    "samplerate",
    "sample_rate",
    "fsample",
}
RATES |= {"sampling_frequency", "sampling_frequency_hz", "sample_rate_hz", "sampling"}
STEPS = {"dt", "ts", "sample_interval", "sampling_interval", "dt_s"}
STARTS = {"start_time", "starttime", "t0", "start", "time_zero", "wf_start_time", "start_s"}
NAMES = {"channels", "channel", "channel_names", "channel_name", "names", "labels", "sensors", "sensor"}

OVER_FREQUENCY = {"f", "freq", "freqs", "frequency", "frequencies", "frequency_hz", "freq_hz", "f_hz"}
OVER_FREQUENCY |= {"coh", "coherence", "gamma2", "g2", "coherence2"}
REMARKS = {"description", "comment", "title", "date", "name", "note", "notes"}


def as_time(store: Store, part: str | None = None, hints: Hints = NO_HINTS) -> TimeFile:
    """Find the samples among the arrays: one table with a list of names, or arrays of one axis.

    Parameters
    ----------
    store : Store
    part : str, optional
        Name of the array that holds the samples, or of the struct or group, if there are several.
    hints : Hints

    Raises
    ------
    InputError
        If nothing, or more than one thing, can be meant.
    """
    if part is not None and part not in store.variables:
        inner = store.within(part)
        if inner is not None:
            store, part = inner, None
    times = _times(store, hints)
    data = _data(store, part, {variable.name for variable in times})
    folders = {variable.folder for variable in data}
    near = folders.pop() if len(folders) == 1 else None
    time = _one_time(store, times, near, hints)
    names = store.texts(NAMES, near)
    tables = [variable for variable in data if rank(variable) == 2]
    if len(tables) > 1:
        raise InputError(
            "several arrays could be the samples",
            where=store.source,
            value=[variable.name for variable in data],
            remedy='say which one, as in part="acceleration"',
        )
    columns = columns_of(store, data, names, None if time is None else time.size)
    labels, units = _labels(store, columns, near)

    @cache
    def of_times(rate: float | None) -> Timing:
        assert time is not None
        return _timing_of(store, time, rate, hints)

    def timing(row: int) -> Timing:
        samples, attributes = columns[row].samples, columns[row].attributes
        begins = next((str(value) for key, value in attributes.items() if key.lower() in STARTS), "")
        if hints.no_times:
            return Timing(samples=samples, sampling_Hz=None, begins=begins)
        rate = _rate(store, attributes, columns[row].folder)
        if time is None:
            return Timing(samples=samples, sampling_Hz=rate, begins=begins)
        if time.size != samples:
            what = f"{time.size} times for {samples} samples"
            where = f"{store.source}: '{time.name}', channel '{labels[row]}'"
            raise InputError(what, where=where, remedy="give one each")
        return replace(of_times(rate), begins=begins)

    def read(rows: Sequence[int], first: int, stop: int) -> Reals:
        for row in rows:
            if columns[row].counts:
                stated = hints.channel_unit(labels[row])
                check_counts(store, labels[row], columns[row].attributes, columns[row].folder, stated)
        return read_columns([columns[row] for row in rows], first, stop)

    return TimeFile(
        source=store.source,
        channels=labels,
        units=units,
        timing=timing,
        read=read,
        times=None if time is None else time.name,
        notes=tuple(
            f"left aside: '{name}', {x.reason}" for name, x in store.variables.items() if x.kind == "unread"
        ),
    )


def _timing_of(store: Store, variable: Variable, rate: float | None, hints: Hints) -> Timing:
    """The timing that an array of times means, compared with the rate that the file states elsewhere."""
    where = f"{store.source}: '{variable.name}'"
    raw = np.ravel(variable.all(store.source)).astype(np.float64)
    if rate is not None and _only_numbers_samples(raw):
        return Timing(samples=variable.size, sampling_Hz=rate, start_s=float(raw[0]) / rate)
    unit = hints.unit_of(variable.leaf) or variable.unit()
    known, scale = time_scale(variable.leaf, unit, where)
    if not known:
        scale = None if unit is None else seconds_in(unit, where)
    unstated = scale is None
    if scale is None:
        scale = unstated_scale(raw)
    resolution = variable.step * scale * float(np.abs(raw).max(initial=0.0, where=np.isfinite(raw)))
    base = TimeBase(
        max(2.0 * resolution, variable.resolution * scale), lambda sample: f"{where}, sample {sample}", scale
    )
    base.feed(raw)
    if unstated:
        check_unstated(base, variable.leaf)
    found = base.timing(variable.size)
    if rate is None or found.sampling_Hz is None:
        return found if rate is None else Timing(samples=variable.size, sampling_Hz=rate, start_s=found.start_s)
    if abs(found.sampling_Hz / rate - 1.0) > max(1e-4, found.uncertainty):
        raise InputError(
            f"the times mean {found.sampling_Hz:.9g} Hz, but the file also states {rate:.9g} Hz",
            where=where,
            remedy='correct whichever is wrong, or leave the times aside: time_column = "none" and sampling_Hz',
        )
    return Timing(samples=variable.size, sampling_Hz=rate, start_s=found.start_s, uncertainty=found.uncertainty)


def _only_numbers_samples(raw: Reals) -> bool:
    """Whether what is named as a time only counts samples: 0, 1, 2 and on."""
    return bool(raw.size > 1 and np.array_equal(np.diff(raw), np.ones(raw.size - 1)) and raw[0] in (0.0, 1.0))


def _rate(store: Store, attributes: Mapping[str, object], near: str | None) -> float | None:
    """The rate that the file states of an array: in its attributes, in arrays beside it, or of the whole file."""
    rate = _scaled(store, RATES, attributes, near, lambda unit, where: hertz_in(unit, where))
    step = _scaled(store, STEPS, attributes, near, lambda unit, where: seconds_in(unit or "s", where))
    if rate is not None and step is not None and abs(rate * step - 1.0) > 1e-4:
        what = f"a rate of {rate:g} Hz and a step of {step:g} s contradict"
        raise InputError(what, where=store.source, remedy="correct whichever is wrong")
    if rate is None and step is not None and 1.0 / step < LEAST_UNSTATED_HZ and not _has_unit(store, STEPS, near):
        raise InputError(
            f"a step without a unit of {step:g}: as seconds {1.0 / step:g} Hz",
            where=store.source,
            remedy='state the rate in the record, as in sampling_Hz = 512.0, with time_column = "none"',
        )
    return rate if rate is not None else (None if step is None else 1.0 / step)


def _scaled(
    store: Store,
    names: set[str],
    attributes: Mapping[str, object],
    near: str | None,
    scale: Callable[[str | None, str], float],
) -> float | None:
    own = Store(store.source, {}, {}).number(names, attributes)
    if own is None and names is RATES:
        _check_one_rate(store, near)
    value = own if own is not None else store.number(names, near=near)
    if value is None or own is not None:
        return value
    unit = next((x.unit() for x in store.named(names, near) if x.kind == "real" and x.size == 1), None)
    return value * scale(unit, f"{store.source}: {sorted(names)[0]}")


def _check_one_rate(store: Store, near: str | None) -> None:
    """Refuse a list of several rates, of which nobody states whose each is."""
    for variable in store.named(RATES, near):
        if variable.kind != "real" or not 1 < variable.size <= MOST_CHANNELS:
            continue
        rates = np.unique(np.ravel(variable.all(store.source)))
        if rates.size > 1:
            raise InputError(
                "several sampling rates",
                where=f"{store.source}: '{variable.name}'",
                value=[float(rate) for rate in rates[:4]],
                remedy='state that of the channels asked for: sampling_Hz, with time_column = "none"',
            )


def _has_unit(store: Store, names: set[str], near: str | None) -> bool:
    return any(variable.unit() is not None or variable.leaf == "dt_s" for variable in store.named(names, near))


def _times(store: Store, hints: Hints) -> list[Variable]:
    """The arrays that hold times, by their names or as was stated."""
    long = [x for x in store.variables.values() if x.kind == "real" and x.size > 1 and rank(x) == 1]
    if hints.time_column is not None and not hints.no_times:
        found = [x for x in long if hints.time_column in (x.name, x.leaf)]
        if not found:
            known = [variable.name for variable in long]
            remedy = f"arrays of one axis are {known[:12]}"
            raise InputError(
                "there is no such array of times", where=store.source, value=hints.time_column, remedy=remedy
            )
        return found
    return [x for x in long if time_scale(x.leaf, "s", store.source)[0]]


def _one_time(store: Store, times: list[Variable], near: str | None, hints: Hints) -> Variable | None:
    here = [variable for variable in times if variable.folder == near] or times
    if len(here) > 1 and not hints.no_times:
        value = [variable.name for variable in here]
        remedy = f'keep one, or say which in the record: time_column = "{value[0]}"'
        if len({variable.folder for variable in here}) == len(here):
            remedy = f'say in the record which group, struct or table is meant: part = "{here[0].folder}"'
        raise InputError("more than one array of times", where=store.source, value=value, remedy=remedy)
    return here[0] if len(here) == 1 else None


def _data(store: Store, part: str | None, times: set[str]) -> list[Variable]:
    if part is not None:
        if part not in store.variables or store.variables[part].kind != "real":
            real = [name for name, variable in store.variables.items() if variable.kind == "real"]
            raise InputError(
                "there is no such array", where=store.source, value=part, remedy=f"it has {real[:12]}"
            )
        return [store.variables[part]]
    known = RATES | STEPS | NAMES | UNITS | REMARKS
    if any(variable.kind == "complex" for variable in store.variables.values()):
        # What stands beside frequency responses is not samples.
        known = known | OVER_FREQUENCY
    data = [
        variable
        for name, variable in store.variables.items()
        if variable.kind == "real"
        and name not in times
        and variable.size > 1
        and not is_one_of(variable.leaf, known)
    ]
    if not data:
        aside = store.left_aside()
        if aside is not None:
            raise aside
        what = "holds no samples: no array of real numbers"
        remedy = 'is it a frequency response? use read_frf, in a campaign statistic = "frf"'
        raise InputError(what, where=store.source, value=store.held(), remedy=remedy)
    flat = [variable for variable in data if rank(variable) <= 2]
    if not flat:
        where = f"{store.source}: '{data[0].name}'"
        raise InputError(
            "samples have one or two axes", where=where, value=data[0].shape, remedy="give (sample, channel)"
        )
    return flat


def _labels(
    store: Store, columns: list[Column], near: str | None
) -> tuple[tuple[str, ...], tuple[str | None, ...]]:
    """Names without the units in them, and the units: in the names, in a list beside, or one for all."""
    pairs = [split_header(column.name) for column in columns]
    listed = store.texts(UNITS, near)
    in_table = [i for i, column in enumerate(columns) if column.in_table] or list(range(len(columns)))
    if listed is not None and len(listed) not in (1, len(in_table)):
        what = f"{len(listed)} units for {len(in_table)} channels"
        raise InputError(what, where=store.source, value=listed, remedy="give one each, or one for all")
    units = []
    for i, (name, unit) in enumerate(pairs):
        beside = None
        if listed is not None and i in in_table:
            beside = clean_unit(listed[in_table.index(i) if len(listed) > 1 else 0])
        if unit is not None and beside is not None and unit != beside:
            what = f"the name states {unit!r}, the list of units {beside!r}"
            raise InputError(what, where=f"{store.source}: channel '{name}'", remedy="keep one")
        units.append(unit or beside or columns[i].unit)
    return tuple(name for name, _ in pairs), tuple(units)
