"""MDF 3 and 4 (.mf4, .mdf) by asammdf, which is not installed with permway: `pip install 'permway[mdf]'`.

Source: ASAM MDF 4.2; asammdf of version 8 reads channels with their conversions.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.timebase import TimeBase
from permway.recordings.readers.timefile import TimeFile, Timing

_TIME = 1
_OVER = {2: "angle", 3: "distance", 4: "a counted index"}
_HELD = 64
"""Channels whose samples are kept in memory at once: each is read as a whole, for its times and its values."""

Place = tuple[int, int]
"""Of a channel: its group and its number there."""


@contextmanager
def open_time(
    source: Path, *, group: str | None = None, hints: Hints = NO_HINTS, max_bytes: int = MOST_BYTES
) -> Iterator[TimeFile]:
    """Open the channels of an MDF file, in the units that their conversions give.

    Each group of channels has times of its own. A name that several groups have is "group/name".

    Raises
    ------
    InputError
        If asammdf is not installed; for a group that is not there.
    """
    # Of a file that is opened here the library leaves nothing open after a fault.
    with source.open("rb") as raw, _library(source).MDF(raw) as file:
        names = _groups(file)
        places = [
            (index, number)
            for index, item in enumerate(file.groups)
            if group is None or names[index] == group
            for number in range(len(item.channels))
            if file.masters_db.get(index) != number and item.channel_group.cycles_nr
        ]
        if group is not None and group not in names:
            raise InputError(
                "there is no such group", where=str(source), value=group, remedy=f"it has {names[:12]}"
            )
        bare = [str(file.groups[at].channels[number].name) for at, number in places]
        labels = [
            f"{names[at]}/{name}" if bare.count(name) > 1 else name
            for (at, _), name in zip(places, bare, strict=True)
        ]

        @lru_cache(maxsize=_HELD)
        def signal(place: Place) -> Any:
            check_size(2 * int(file.groups[place[0]].channel_group.cycles_nr), str(source), max_bytes=max_bytes)
            return file.get(group=place[0], index=place[1], ignore_invalidation_bits=True)

        @cache
        def timing(row: int) -> Timing:
            where = f"{source}: channel '{labels[row]}'"
            return _timing(file, places[row], _sound(signal(places[row]), where), where, hints)

        def read(rows: Sequence[int], first: int, stop: int) -> Reals:
            return np.stack(
                [
                    np.asarray(_sound(signal(places[row]), labels[row]).samples[first:stop], dtype=np.float64)
                    for row in rows
                ]
            )

        yield TimeFile(
            source=str(source),
            channels=tuple(labels),
            units=tuple(_unit(file, place) for place in places),
            timing=timing,
            read=read,
        )


def _library(source: Path) -> Any:
    try:
        return importlib.import_module("asammdf")
    except ImportError as error:
        what = "MDF is read by asammdf, which is not installed"
        remedy = "pip install 'permway[mdf]', or export it as TDMS, HDF5 or CSV"
        raise InputError(what, where=str(source), remedy=remedy) from error


def _groups(file: Any) -> list[str]:
    """A name for each group: as acquisition has it if that is its own, else its number from 1."""
    found = [str(getattr(item.channel_group, "acq_name", "") or "") for item in file.groups]
    return [name if name and found.count(name) == 1 else str(i + 1) for i, name in enumerate(found)]


def _unit(file: Any, place: Place) -> str | None:
    channel = file.groups[place[0]].channels[place[1]]
    conversion = channel.conversion
    return clean_unit(getattr(channel, "unit", "")) or clean_unit(getattr(conversion, "unit", ""))


def _sound(signal: Any, where: str) -> Any:
    """A channel of real numbers, all of them valid.

    Raises
    ------
    InputError
        Otherwise.
    """
    samples = signal.samples
    if samples.ndim != 1 or samples.dtype.kind not in "fiu":
        what = "samples must be real numbers"
        raise InputError(what, where=where, value=str(samples.dtype), remedy="leave the channel out")
    bits = signal.invalidation_bits
    if bits is not None and np.any(bits):
        what = f"{int(np.count_nonzero(bits))} samples are marked as invalid"
        first = int(np.flatnonzero(np.asarray(bits))[0])
        raise InputError(what, where=where, value=f"the first is sample {first}", remedy="cut the record there")
    return signal


def _timing(file: Any, place: Place, signal: Any, where: str, hints: Hints) -> Timing:
    samples = int(signal.samples.size)
    master = file.masters_db.get(place[0])
    if hints.no_times or master is None:
        return Timing(samples=samples, sampling_Hz=None)
    kind = int(getattr(file.groups[place[0]].channels[master], "sync_type", _TIME))
    if kind not in (0, _TIME):
        remedy = 'leave it out, or state time_column = "none" and sampling_Hz'
        raise InputError(f"stands over {_OVER.get(kind, 'no time')}", where=where, value=kind, remedy=remedy)
    times = np.asarray(signal.timestamps, dtype=np.float64)
    if times.size != samples:
        raise InputError(f"{times.size} times for {samples} samples", where=where, remedy="export it again")
    worth = 2.0 * float(np.finfo(np.float64).eps) * float(np.abs(times).max(initial=0.0))
    base = TimeBase(worth, lambda sample: f"{where}, sample {sample}", 1.0)
    base.feed(times)
    return base.timing(samples)
