"""Files of named arrays (MAT, NPZ, HDF5, NetCDF) seen alike, and what in them is samples, time, rate and names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit, split_header, time_scale
from permway.recordings.readers.limits import MOST_CHANNELS
from permway.recordings.readers.stored import UNITS, Store, Variable
from permway.recordings.readers.timebase import TimeBase
from permway.recordings.readers.timefile import TimeFile

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
NAMES = {"channels", "channel", "channel_names", "channel_name", "names", "labels", "sensors", "sensor"}

REMARKS = {"description", "comment", "title", "date", "name", "note", "notes"}


def as_time(store: Store, part: str | None = None) -> TimeFile:
    """Find the samples among the arrays: one table with a list of names, or arrays of one length.

    Parameters
    ----------
    store : Store
    part : str, optional
        Name of the array that holds the samples, if there are several.

    Raises
    ------
    InputError
        If nothing, or more than one thing, can be meant.
    """
    time = _time(store)
    names = store.texts(NAMES)
    data = _data(store, part, None if time is None else time[0].name)
    tables = [variable for variable in data if _rank(variable) == 2]
    if tables and len(data) > 1:
        raise InputError(
            "several arrays could be the samples",
            where=store.source,
            value=[variable.name for variable in data],
            remedy='say which one, as in part="acceleration"',
        )
    file = _from_table(store, tables[0], names, time) if tables else _from_vectors(store, data, names)
    rate = _rate(store, data[0].attributes)
    if time is None:
        return _with(file, rate, None, store)
    variable, scale = time
    if variable.size != file.samples:
        what = f"{variable.size} times for {file.samples} samples"
        raise InputError(what, where=f"{store.source}: '{variable.name}'", remedy="give one each")
    times = np.ravel(variable.all(store.source)).astype(np.float64) * scale
    resolution = variable.step * float(np.abs(times).max(initial=0.0, where=np.isfinite(times)))
    base = TimeBase(2.0 * resolution, lambda sample: f"{store.source}: '{variable.name}', sample {sample}")
    base.feed(times)
    found = base.sampling_Hz
    if rate is not None and found is not None and abs(found / rate - 1.0) > 1e-4:
        raise InputError(
            f"the times mean {found:.9g} Hz, but the file also says {rate:.9g} Hz",
            where=f"{store.source}: '{variable.name}'",
            remedy="correct whichever is wrong",
        )
    return _with(file, rate if rate is not None else found, base.start_s, store)


def _with(file: TimeFile, rate: float | None, start: float | None, store: Store) -> TimeFile:
    return TimeFile(
        source=store.source,
        channels=file.channels,
        units=file.units,
        samples=file.samples,
        sampling_Hz=rate,
        start_s=start,
        read=file.read,
    )


def _rate(store: Store, attributes: Mapping[str, object]) -> float | None:
    rate, step = store.number(RATES, attributes), store.number(STEPS, attributes)
    if rate is not None and step is not None and abs(rate * step - 1.0) > 1e-4:
        what = f"a rate of {rate:g} Hz and a step of {step:g} s contradict"
        raise InputError(what, where=store.source, remedy="correct whichever is wrong")
    return rate if rate is not None else (None if step is None else 1.0 / step)


def _time(store: Store) -> tuple[Variable, float] | None:
    found = []
    for name, variable in store.variables.items():
        if variable.kind == "real" and variable.size > 1 and _rank(variable) == 1:
            scale = time_scale(name, variable.unit(), f"{store.source}: '{name}'")
            if scale is not None:
                found.append((variable, scale))
    if len(found) > 1:
        value = [variable.name for variable, _ in found]
        raise InputError("more than one array of times", where=store.source, value=value, remedy="keep one")
    return found[0] if found else None


def _rank(variable: Variable) -> int:
    """Axes that are longer than one."""
    return sum(length > 1 for length in variable.shape)


def _data(store: Store, part: str | None, time: str | None) -> list[Variable]:
    if part is not None:
        if part not in store.variables or store.variables[part].kind != "real":
            real = [name for name, variable in store.variables.items() if variable.kind == "real"]
            raise InputError(
                "there is no such array", where=store.source, value=part, remedy=f"it has {real[:12]}"
            )
        return [store.variables[part]]
    known = RATES | STEPS | NAMES | UNITS | REMARKS
    data = [
        variable
        for name, variable in store.variables.items()
        if variable.kind == "real" and name != time and variable.size > 1 and name.lower() not in known
    ]
    if not data:
        kinds = {name: variable.kind for name, variable in list(store.variables.items())[:12]}
        what = "holds no samples: no array of real numbers"
        raise InputError(what, where=store.source, value=kinds, remedy="is it a frequency response? use read_frf")
    deep = next((variable for variable in data if _rank(variable) > 2), None)
    if deep is not None:
        where = f"{store.source}: '{deep.name}'"
        raise InputError(
            "samples have one or two axes", where=where, value=deep.shape, remedy="give (sample, channel)"
        )
    return data


def _from_table(
    store: Store, table: Variable, names: tuple[str, ...] | None, time: tuple[Variable, float] | None
) -> TimeFile:
    where = f"{store.source}: '{table.name}'"
    axes = [axis for axis, length in enumerate(table.shape) if length > 1]
    along = _channel_axis(table, axes, names, time, where)
    channel_axis, sample_axis = axes[along], axes[1 - along]
    count, samples = table.shape[channel_axis], table.shape[sample_axis]
    if count > MOST_CHANNELS:
        what = "more channels than can be"
        raise InputError(what, where=where, value=table.shape, remedy="name the channels in an array 'channels'")
    if names is None:
        names = tuple(f"{table.name} {i + 1}" for i in range(count))
    labels, units = _labels(store, names, table.unit())

    def read(rows: Sequence[int], first: int, stop: int) -> Reals:
        span = range(min(rows), max(rows) + 1)
        slices = [slice(None)] * len(table.shape)
        slices[sample_axis] = slice(first, stop)
        slices[channel_axis] = slice(span.start, span.stop)
        piece = np.asarray(table.read(tuple(slices)))
        piece = np.moveaxis(piece, (channel_axis, sample_axis), (0, 1)).reshape(len(span), stop - first)
        return np.ascontiguousarray(piece[[row - span.start for row in rows]], dtype=np.float64)

    return TimeFile(
        source=store.source, channels=labels, units=units, samples=samples, sampling_Hz=None, read=read
    )


def _channel_axis(
    table: Variable,
    axes: list[int],
    names: tuple[str, ...] | None,
    time: tuple[Variable, float] | None,
    where: str,
) -> int:
    """Which of the two axes counts the channels: by names of axes, by number of names or times, or the shorter."""
    lengths = [table.shape[axis] for axis in axes]
    if table.axes:
        named = [
            time_scale(table.axes[axis], None, where) is not None or table.axes[axis] == "sample" for axis in axes
        ]
        if sum(named) == 1:
            return named.index(False)
        known = [table.axes[axis].lower() in NAMES for axis in axes]
        if sum(known) == 1:
            return known.index(True)
    if names is not None:
        fits = [length == len(names) for length in lengths]
        if not any(fits):
            what = f"{len(names)} names for an array of {lengths[0]} x {lengths[1]}"
            raise InputError(what, where=where, value=names, remedy="give one name for each channel")
        if sum(fits) == 1:
            return fits.index(True)
    if time is not None:
        fits = [length == time[0].size for length in lengths]
        if sum(fits) == 1:
            return fits.index(False)
    if lengths[0] == lengths[1]:
        what = "which axis counts the channels cannot be told"
        raise InputError(what, where=where, value=table.shape, remedy="give another number of samples, or times")
    return lengths.index(min(lengths))


def _from_vectors(store: Store, data: list[Variable], names: tuple[str, ...] | None) -> TimeFile:
    first = data[0]
    for variable in data[1:]:
        if variable.size != first.size:
            raise InputError(
                f"{variable.size} samples where '{first.name}' has {first.size}",
                where=f"{store.source}: '{variable.name}'",
                remedy="give channels of one length, or say which array is meant by part=",
            )
    own = tuple(variable.name for variable in data)
    if names is not None and len(names) == 1 == len(data):
        own = names
    labels, units = _labels(store, own, None)
    units = tuple(unit or variable.unit() for unit, variable in zip(units, data, strict=True))

    def read(rows: Sequence[int], first_sample: int, stop: int) -> Reals:
        values = np.empty((len(rows), stop - first_sample))
        for i, row in enumerate(rows):
            slices = tuple(slice(first_sample, stop) if n > 1 else slice(None) for n in data[row].shape)
            values[i] = np.ravel(data[row].read(slices))
        return values

    return TimeFile(
        source=store.source, channels=labels, units=units, samples=first.size, sampling_Hz=None, read=read
    )


def _labels(
    store: Store, names: tuple[str, ...], common: str | None
) -> tuple[tuple[str, ...], tuple[str | None, ...]]:
    """Names without the units in them, and the units: in the names, in a list beside, or one for all."""
    pairs = [split_header(name) for name in names]
    listed = store.texts(UNITS)
    if listed is not None and len(listed) not in (1, len(names)):
        what = f"{len(listed)} units for {len(names)} channels"
        raise InputError(what, where=store.source, value=listed, remedy="give one each, or one for all")
    units = []
    for i, (name, unit) in enumerate(pairs):
        beside = None if listed is None else clean_unit(listed[i if len(listed) > 1 else 0])
        if unit is not None and beside is not None and unit != beside:
            what = f"the name says {unit!r}, the list of units {beside!r}"
            raise InputError(what, where=f"{store.source}: channel '{name}'", remedy="keep one")
        units.append(unit or beside or common)
    return tuple(name for name, _ in pairs), tuple(units)
