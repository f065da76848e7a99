"""TDMS by npTDMS: the channels of one group, or of all."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from nptdms import TdmsFile
from nptdms.log import log_manager

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit
from permway.recordings.readers.timefile import TimeFile

_UNITS = ("unit_string", "NI_UnitDescription", "unit", "Unit", "units")


@contextmanager
def open_time(source: Path, *, group: str | None = None) -> Iterator[TimeFile]:
    """Open the channels of a TDMS file, scaled as the file itself says.

    With more than one group, and none chosen, channels are named "group/channel".
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
        names, found = [], []
        for item in groups:
            for channel in item.channels():
                if not len(channel):
                    continue
                names.append(f"{item.name}/{channel.name}" if several else str(channel.name))
                found.append(channel)
        if not found:
            raise InputError("holds no channel with samples", where=str(source), remedy="record it again")
        _check(source, names, found)
        rates = {
            name: _rate(channel, f"{source}: channel '{name}'") for name, channel in zip(names, found, strict=True)
        }
        rate, start = _one(source, rates)

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
            units=tuple(_unit(channel) for channel in found),
            samples=len(found[0]),
            sampling_Hz=rate,
            start_s=start,
            read=read,
        )


@contextmanager
def _complaints(source: Path) -> Iterator[Callable[[], None]]:
    """What the library only writes to its log (a last segment cut short, a text that is none) is an error here."""
    heard: list[str] = []
    ear = logging.Handler(logging.WARNING)
    ear.emit = lambda record: heard.append(record.getMessage())  # type: ignore[method-assign]
    logger, console = logging.getLogger("nptdms"), log_manager.console_handler
    level = console.level
    logger.addHandler(ear)
    console.setLevel(logging.CRITICAL)

    def check() -> None:
        if heard:
            remedy = "the file is cut short or damaged; export what is sound"
            raise InputError("the file is not whole", where=str(source), value=heard[0], remedy=remedy)

    try:
        yield check
    finally:
        logger.removeHandler(ear)
        console.setLevel(level)


def _check(source: Path, names: list[str], found: list[Any]) -> None:
    size = source.stat().st_size
    for name, channel in zip(names, found, strict=True):
        where = f"{source}: channel '{name}'"
        if channel.dtype.kind not in "fiu":
            raise InputError(
                "samples must be real numbers", where=where, value=str(channel.dtype), remedy="choose a group="
            )
        if len(channel) > size:
            what = "more samples announced than the file holds"
            raise InputError(what, where=where, value=len(channel), remedy="the file is damaged")
        if len(channel) != len(found[0]):
            raise InputError(
                f"{len(channel)} samples where '{names[0]}' has {len(found[0])}",
                where=where,
                remedy="choose one group of channels by group=, or record them alike",
            )


def _unit(channel: Any) -> str | None:
    return next((unit for key in _UNITS if (unit := clean_unit(channel.properties.get(key))) is not None), None)


def _rate(channel: Any, where: str) -> tuple[float | None, float | None]:
    """Rate and first time of a waveform, where it is one."""
    step, start = channel.properties.get("wf_increment"), channel.properties.get("wf_start_offset")
    if step is None:
        return None, None
    if isinstance(step, str) or not (np.isfinite(float(step)) and float(step) > 0.0):
        raise InputError("the step in time must be a number above 0 s", where=f"{where}: wf_increment", value=step)
    offset = 0.0 if start is None or isinstance(start, str) else float(start)
    return 1.0 / float(step), offset if np.isfinite(offset) else None


def _one(source: Path, rates: dict[str, tuple[float | None, float | None]]) -> tuple[float | None, float | None]:
    first, (rate, start) = next(iter(rates.items()))
    for name, (other, begin) in rates.items():
        if other != rate or begin != start:
            raise InputError(
                f"sampled at {other} Hz from {begin} s, '{first}' at {rate} Hz from {start} s",
                where=f"{source}: channel '{name}'",
                remedy="choose one group of channels by group=; nothing is resampled",
            )
    return rate, start
