"""A record in time that was opened, and not yet read: what every format offers, and what is made of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from permway.arrays import Reals, is_real
from permway.errors import InputError
from permway.recordings.readers.limits import MOST_CHANNELS
from permway.units import check_same

RATES_AGREE = 1e-4
"""Relative difference up to which two statements of a sampling rate are one: clocks and printed digits."""

_LESSER_NAMES_SHOWN = 12


@dataclass(frozen=True, kw_only=True)
class TimeFile:
    """What a file says of itself, and how to read samples.

    Attributes
    ----------
    source : str
    channels : tuple of str
    units : tuple of (str or None)
    samples : int
        Of each channel.
    sampling_Hz, start_s : float or None
    read : callable
        From rows of channels, first sample and the one after the last, to values, shape (channel, sample).
    place : callable
        From a row and a sample to its place in the file, for messages.
    notes : tuple of str
    """

    source: str
    channels: tuple[str, ...]
    units: tuple[str | None, ...]
    samples: int
    sampling_Hz: float | None
    read: Callable[[Sequence[int], int, int], Reals]
    start_s: float | None = None
    place: Callable[[int, int], str] | None = None
    notes: tuple[str, ...] = field(default=())

    def where(self, row: int, sample: int) -> str:
        """Place of a sample, for messages."""
        if self.place is not None:
            return f"{self.source}: {self.place(row, sample)}"
        time = "" if self.sampling_Hz is None else f" ({(self.start_s or 0.0) + sample / self.sampling_Hz:.6g} s)"
        return f"{self.source}: channel '{self.channels[row]}', sample {sample}{time}"


def check_channels(file: TimeFile) -> None:
    """Refuse a file without channels or samples, or with two channels of one name.

    Raises
    ------
    InputError
        With the name that stands twice.
    """
    names = file.channels
    if not names:
        raise InputError("holds no channel in time", where=file.source, remedy="is it a record in time?")
    if len(names) > MOST_CHANNELS:
        raise InputError("more channels than can be", where=file.source, value=len(names))
    seen: set[str] = set()
    for row, name in enumerate(names):
        if name in seen:
            raise InputError(
                "a channel named twice",
                where=f"{file.source}: channel {row + 1}",
                value=name,
                remedy="give each a name of its own",
            )
        seen.add(name)
    if file.samples < 1:
        raise InputError("holds no sample", where=file.source, value=file.samples, remedy="record it again")


def rows_of(file: TimeFile, channels: Sequence[str] | None) -> list[int]:
    """Rows of the channels asked for, in their order; by default all.

    Raises
    ------
    InputError
        For a name the file does not have, or one asked for twice.
    """
    if channels is None:
        return list(range(len(file.channels)))
    if isinstance(channels, str) or not channels:
        raise InputError("must be a list of names", where="channels", value=channels)
    rows = []
    for name in channels:
        if name not in file.channels:
            known = ", ".join(file.channels[:_LESSER_NAMES_SHOWN])
            more = ", ..." if len(file.channels) > _LESSER_NAMES_SHOWN else ""
            raise InputError(
                "there is no such channel", where=file.source, value=name, remedy=f"it has {known}{more}"
            )
        row = file.channels.index(name)
        if row in rows:
            raise InputError("a channel asked for twice", where="channels", value=name)
        rows.append(row)
    return rows


def agreed_rate(file: TimeFile, said: float | None) -> float | None:
    """The sampling rate of the file and the caller, if they are one.

    Raises
    ------
    InputError
        If they differ by more than 1e-4, relative.
    """
    if said is None:
        return file.sampling_Hz
    if not is_real(said) or not (np.isfinite(said) and said > 0.0):
        raise InputError("must be finite and above 0 Hz", where="sampling_Hz", value=said)
    found = file.sampling_Hz
    if found is not None and abs(found / said - 1.0) > RATES_AGREE:
        raise InputError(
            f"the file says {found:.9g} Hz, but was said to be sampled at {said:.9g} Hz",
            where=f"{file.source}: sampling_Hz",
            remedy="correct whichever is wrong; nothing is resampled",
        )
    return float(said)


def agreed_units(
    file: TimeFile, rows: Sequence[int], said: str | Mapping[str, str] | None
) -> tuple[str | None, ...]:
    """The unit of each channel as found, or as said where the file has none.

    Raises
    ------
    InputError
        If the file's own means another.
    """
    units: list[str | None] = []
    for row in rows:
        name, found = file.channels[row], file.units[row]
        told = said if isinstance(said, str) or said is None else said.get(name)
        if found is not None and told is not None:
            check_same(found, told, where=f"{file.source}: channel '{name}'")
        units.append(told if found is None else found)
    return tuple(units)


def check_finite(file: TimeFile, rows: Sequence[int], values: Reals, first: int) -> None:
    """Refuse samples that are not finite, with the place of the first and their number.

    Raises
    ------
    InputError
        If there is one.
    """
    # One sum tells whether to look: it is finite if all values are, but for an overflow.
    with np.errstate(over="ignore", invalid="ignore"):
        total = np.sum(values)
    if np.isfinite(total):
        return
    bad = ~np.isfinite(values)
    if bad.any():
        sample = int(np.flatnonzero(bad.any(axis=0))[0])
        row = int(np.flatnonzero(bad[:, sample])[0])
        count = int(bad.sum())
        raise InputError(
            f"not a finite number ({count} such sample{'s' if count > 1 else ''} here)",
            where=file.where(rows[row], first + sample),
            value=float(values[row, sample]),
            remedy="cut the record there or leave the channel out; to look at it, keep_nonfinite=True",
        )
