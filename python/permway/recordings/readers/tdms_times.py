"""When the samples of a TDMS channel were taken: by the properties of a waveform, or by a channel of times.

Source: National Instruments, "LabVIEW waveform data in TDMS files": wf_start_time, wf_start_offset, wf_increment.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit, split_header, time_scale
from permway.recordings.readers.hints import Hints
from permway.recordings.readers.scales import seconds_in
from permway.recordings.readers.timebase import TimeBase, check_unstated, unstated_scale
from permway.recordings.readers.timefile import Timing

_UNTIMED = 1.0
"""Increment that LabVIEW writes where nothing was timed: no rate, unless a start shows that there was a clock."""


def time_channels(channels: Mapping[str, Any], hints: Hints, source: Path) -> list[str]:
    """Names of the channels that hold times: as stated, else by their names and their having no step in time."""
    if hints.no_times:
        return []
    if hints.time_column is not None:
        if hints.time_column not in channels:
            remedy = f"it has {list(channels)[:12]}"
            raise InputError("there is no such channel", where=str(source), value=hints.time_column, remedy=remedy)
        return [hints.time_column]
    return [name for name, channel in channels.items() if _is_time(name, channel)]


def _is_time(name: str, channel: Any) -> bool:
    if channel.properties.get("wf_increment") is not None:
        return False
    bare, unit = split_header(name.rpartition("/")[2])
    kind = channel.dtype.kind
    try:
        return kind in "fiuM" and time_scale(bare, None if kind == "M" else unit, name)[0]
    except InputError:
        return False


def timing_of(channel: Any, where: str, times: list[str], channels: Mapping[str, Any], hints: Hints) -> Timing:
    """Samples, rate and start of a channel.

    Raises
    ------
    InputError
        If what it states is no step in time, or the times are not even.
    """
    samples = len(channel)
    if hints.no_times:
        return Timing(samples=samples, sampling_Hz=None)
    step = channel.properties.get("wf_increment")
    if step is None or hints.time_column is not None:
        return _by_channel(channel, where, times, channels, hints)
    if isinstance(step, str) or not (np.isfinite(float(step)) and float(step) > 0.0):
        raise InputError("the step in time must be a number above 0 s", where=f"{where}: wf_increment", value=step)
    name, unit = (clean_unit(channel.properties.get(key)) for key in ("wf_xname", "wf_xunit_string"))
    if unit is None and name is not None and not time_scale(name, "s", where)[0]:
        what, remedy = "does not stand over time", 'leave it out, or state time_column = "none" and sampling_Hz'
        raise InputError(what, where=f"{where}: wf_xname", value=name, remedy=remedy)
    scale = seconds_in(hints.unit_of("time") or unit or "s", f"{where}: wf_xunit_string")
    offset = channel.properties.get("wf_start_offset")
    begin = 0.0 if offset is None or isinstance(offset, str) or not np.isfinite(float(offset)) else float(offset)
    clock = _since_1970(channel) is not None
    if float(step) * scale == _UNTIMED and unit is None and not clock:
        fault = InputError(
            "a step of 1 s without a start is what LabVIEW writes where nothing was timed",
            where=f"{where}: wf_increment",
            value=float(step),
            remedy="state the rate in the record, as in sampling_Hz = 512.0",
        )
        return Timing(samples=samples, sampling_Hz=None, start_s=begin, fault=fault)
    # Counted from the channel that began first, so that starts can be compared with each other.
    dates = [_since_1970(other) for other in channels.values()]
    earliest = min((date for date in dates if date is not None), default=0.0)
    start: float | None = begin * scale
    if clock:
        start = begin * scale + (_since_1970(channel) or 0.0) - earliest
    elif any(date is not None for date in dates):
        start = None
    return Timing(samples=samples, sampling_Hz=1.0 / (float(step) * scale), start_s=start)


def _since_1970(channel: Any) -> float | None:
    """Seconds from 1970 to a channel's start, None where it has none: LabVIEW writes 1904 for that."""
    date = channel.properties.get("wf_start_time")
    if date is None or isinstance(date, str):
        return None
    seconds = float(np.datetime64(date, "us").astype(np.int64)) * 1e-6
    return seconds if seconds > 0.0 else None


def _by_channel(channel: Any, where: str, times: list[str], channels: Mapping[str, Any], hints: Hints) -> Timing:
    """By the channel of times of its group that has as many samples, if there is one."""
    samples = len(channel)
    mates = [name for name in times if channels[name].group_name == channel.group_name] or times
    if not mates:
        return Timing(samples=samples, sampling_Hz=None)
    found = channels[mates[0]]
    if len(mates) > 1 or len(found) != samples:
        what = f"{len(found)} times in '{mates[0]}' for {samples} samples"
        what = what if len(mates) == 1 else f"more than one channel of times: {mates}"
        remedy = 'say which in the record: time_column = ..., or "none" and sampling_Hz'
        raise InputError(what, where=where, remedy=remedy)
    name = mates[0]
    place = f"{where.rpartition(': channel')[0]}: channel '{name}'"
    raw, scale, worth, unstated = _numbers(found, name, place, hints)
    base = TimeBase(worth * scale, lambda sample: f"{place}, sample {sample}", scale)
    base.feed(raw)
    if unstated:
        check_unstated(base, name)
    return base.timing(samples)


def _numbers(channel: Any, name: str, place: str, hints: Hints) -> tuple[Reals, float, float, bool]:
    """Times as they stand, seconds in one, what their last digit is worth, and whether no unit is stated."""
    values = np.asarray(channel[:])
    if values.dtype.kind == "M":
        micro = values.astype("datetime64[us]").astype(np.int64)
        return (micro - micro[0]).astype(np.float64), 1e-6, 1.0, False
    plain = values.astype(np.float64)
    bare, unit = split_header(name.rpartition("/")[2])
    unit = (
        hints.unit_of(name) or hints.unit_of("time") or clean_unit(channel.properties.get("unit_string")) or unit
    )
    known, scale = time_scale(bare, unit, place)
    if not known and unit is not None:
        scale = seconds_in(unit, place)
    unstated = scale is None
    if scale is None:
        scale = unstated_scale(plain)
    top = float(np.abs(plain).max(initial=0.0, where=np.isfinite(plain)))
    eps = np.finfo(values.dtype).eps if values.dtype.kind == "f" else 0.0
    return plain, scale, max(2.0 * float(eps) * top, 1.0 if values.dtype.kind in "iu" else 0.0), unstated
