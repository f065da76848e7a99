"""TDMS by npTDMS: the channels of one group, or of all."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from nptdms import TdmsFile
from nptdms.log import log_manager

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit, split_header
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.tdms_times import time_channels, timing_of
from permway.recordings.readers.timefile import TimeFile, Timing

_UNITS = ("unit_string", "NI_UnitDescription", "unit", "Unit", "units")


@contextmanager
def open_time(source: Path, *, group: str | None = None, hints: Hints = NO_HINTS) -> Iterator[TimeFile]:
    """Open the channels of a TDMS file, scaled as the file itself states.

    With more than one group, and none chosen, channels are named "group/channel". A channel that is named as a
    time holds the times of channels that have none of their own.
    """
    # Opened here, so that an index file beside it, which may be of another recording, is not used.
    with _complaints(source) as check, source.open("rb") as raw, TdmsFile.open(raw) as file:
        check()
        groups = [item for item in file.groups() if group is None or item.name == group]
        if not groups:
            known = [item.name for item in file.groups()]
            raise InputError(
                "there is no such group", where=str(source), value=group, remedy=f"it has {known[:12]}"
            )
        several = len([item for item in groups if item.channels()]) > 1
        channels: dict[str, Any] = {}
        for item in groups:
            for channel in item.channels():
                if len(channel):
                    channels[f"{item.name}/{channel.name}" if several else str(channel.name)] = channel
        if not channels:
            raise InputError("holds no channel with samples", where=str(source), remedy="record it again")
        times = time_channels(channels, hints, source)
        names = [name for name in channels if name not in times]
        found = [channels[name] for name in names]
        pairs = [
            split_header(name) if _unit(channel) is None else (name, None)
            for name, channel in zip(names, found, strict=True)
        ]

        @cache
        def timing(row: int) -> Timing:
            where = f"{source}: channel '{names[row]}'"
            _check(source, where, found[row])
            return timing_of(found[row], where, times, channels, hints)

        def read(rows: Sequence[int], first: int, stop: int) -> Reals:
            values = np.empty((len(rows), stop - first))
            for i, row in enumerate(rows):
                piece = np.asarray(found[row][first:stop], dtype=np.float64)
                check()
                if piece.shape != (stop - first,):
                    what = f"{len(found[row])} samples announced, fewer there"
                    raise InputError(
                        what, where=f"{source}: channel '{names[row]}'", remedy="the file is cut short"
                    )
                values[i] = piece
            return values

        yield TimeFile(
            source=str(source),
            channels=tuple(names),
            units=tuple(_unit(channel) or unit for channel, (_, unit) in zip(found, pairs, strict=True)),
            timing=timing,
            read=read,
            times=", ".join(times) or None,
        )


@contextmanager
def _complaints(source: Path) -> Iterator[Callable[[], None]]:
    """What the library only writes to its log (a last segment cut short, a text that is none) is an error here."""
    messages: list[str] = []
    ear = logging.Handler(logging.WARNING)
    ear.emit = lambda record: messages.append(record.getMessage())  # type: ignore[method-assign]
    logger, console = logging.getLogger("nptdms"), log_manager.console_handler
    level = console.level
    logger.addHandler(ear)
    console.setLevel(logging.CRITICAL)

    def check() -> None:
        if messages and "scale" in messages[0].lower():
            what = "a channel is scaled in a way that is not known, so that its samples have no unit"
            remedy = "export it as CSV, or with a linear, polynomial or table scale"
            raise InputError(what, where=str(source), value=messages[0], remedy=remedy)
        if messages:
            remedy = "the file is cut short or damaged; export what is sound"
            raise InputError("the file is not whole", where=str(source), value=messages[0], remedy=remedy)

    try:
        yield check
    finally:
        logger.removeHandler(ear)
        console.setLevel(level)


def _check(source: Path, where: str, channel: Any) -> None:
    if channel.dtype.kind not in "fiu":
        what, remedy = "samples must be real numbers", "leave the channel out, or choose a group: part = ..."
        raise InputError(what, where=where, value=str(channel.dtype), remedy=remedy)
    if len(channel) > source.stat().st_size:
        what = "more samples announced than the file holds"
        raise InputError(what, where=where, value=len(channel), remedy="the file is damaged")


def _unit(channel: Any) -> str | None:
    return next((unit for key in _UNITS if (unit := clean_unit(channel.properties.get(key))) is not None), None)
