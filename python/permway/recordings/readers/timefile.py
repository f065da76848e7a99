"""A record in time that was opened, and not yet read: what every format offers, and what is made of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from permway.arrays import Reals, is_real
from permway.errors import InputError
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_CHANNELS
from permway.units import check_same

RATES_AGREE = 1e-4
"""Relative difference up to which two statements of a sampling rate are one: clocks and printed digits.

Half of it refuses rates printed with four digits; twice of it lets a line at 500 Hz move by a tenth of a hertz.
"""

START_OFF = 0.01
"""Samples by which channels may lie apart at their beginning or, by their rates, at their end, and be one record.

It is 3.6 degrees at the sampling rate and less than one below a quarter of it. Half of it refuses clocks that are
written in microseconds at 5 kHz and more; twice of it is seen in no phase either.
"""

_LESSER_NAMES_SHOWN = 12


@dataclass(frozen=True, kw_only=True)
class Timing:
    """When the samples of one channel were taken.

    Attributes
    ----------
    samples : int
    sampling_Hz : float or None
    start_s : float or None
        Of the first sample.
    uncertainty : float
        Of the rate, relative: of times that are printed with few digits.
    remark : bool
        Whether the rate is only a remark in a text, which a statement of the caller replaces.
    begins : str
        When the first sample was taken by a clock, as the file states it; empty if it does not.
    fault : InputError or None
        Why the rate is not known, or not well enough: to be raised if the caller does not give one.
    """

    samples: int
    sampling_Hz: float | None
    start_s: float | None = None
    uncertainty: float = 0.0
    remark: bool = False
    begins: str = ""
    fault: InputError | None = field(default=None, compare=False)


@dataclass(frozen=True, kw_only=True)
class TimeFile:
    """What a file states about itself, and how to read samples.

    Attributes
    ----------
    source : str
    channels : tuple of str
    units : tuple of (str or None)
    timing : callable
        From the row of a channel to its timing; raises `InputError` for a channel that cannot be used.
    read : callable
        From rows of channels, first sample and the one after the last, to values, shape (channel, sample).
    place : callable
        From a row and a sample to its place in the file, for messages.
    times : str or None
        What holds the times: a column or an array.
    notes : tuple of str
        What is to be known beside, such as what was left aside.
    """

    source: str
    channels: tuple[str, ...]
    units: tuple[str | None, ...]
    timing: Callable[[int], Timing]
    read: Callable[[Sequence[int], int, int], Reals]
    place: Callable[[int, int], str] | None = None
    times: str | None = None
    notes: tuple[str, ...] = field(default=())

    def where(self, row: int, sample: int, timing: Timing) -> str:
        """Place of a sample, for messages."""
        if self.place is not None:
            return f"{self.source}: {self.place(row, sample)}"
        rate = timing.sampling_Hz
        time = "" if rate is None else f" ({(timing.start_s or 0.0) + sample / rate:.6g} s)"
        return f"{self.source}: channel '{self.channels[row]}', sample {sample}{time}"


def check_channels(file: TimeFile) -> None:
    """Refuse a file without channels, or with more than can be.

    Raises
    ------
    InputError
        If so.
    """
    if not file.channels:
        raise InputError("holds no channel in time", where=file.source, remedy="is it a record in time?")
    if len(file.channels) > MOST_CHANNELS:
        raise InputError("more channels than can be", where=file.source, value=len(file.channels))


def rows_of(file: TimeFile, channels: Sequence[str] | None) -> list[int]:
    """Rows of the channels asked for, in their order; by default all.

    Raises
    ------
    InputError
        For a name the file does not have or has twice, or one asked for twice.
    """
    if channels is None:
        channels = file.channels
        twice = next((row for row, name in enumerate(channels) if name in channels[:row]), None)
        if twice is not None:
            raise _twice(file, twice)
    if isinstance(channels, str) or not channels:
        raise InputError("must be a list of names", where="channels", value=channels)
    rows: list[int] = []
    for name in channels:
        if name not in file.channels:
            known = ", ".join(file.channels[:_LESSER_NAMES_SHOWN])
            more = ", ..." if len(file.channels) > _LESSER_NAMES_SHOWN else ""
            raise InputError(
                "there is no such channel", where=file.source, value=name, remedy=f"it has {known}{more}"
            )
        if file.channels.count(name) > 1:
            raise _twice(file, len(file.channels) - 1 - file.channels[::-1].index(name))
        row = file.channels.index(name)
        if row in rows:
            raise InputError("a channel asked for twice", where="channels", value=name)
        rows.append(row)
    return rows


def _twice(file: TimeFile, row: int) -> InputError:
    return InputError(
        "a channel named twice",
        where=f"{file.source}: channel {row + 1}",
        value=file.channels[row],
        remedy="give each a name of its own",
    )


def agreed_timing(file: TimeFile, rows: Sequence[int]) -> Timing:
    """The timing that all channels asked for have.

    Raises
    ------
    InputError
        If they differ in number of samples, rate or start, or one cannot be used.
    """
    first = file.timing(rows[0])
    name = file.channels[rows[0]]
    remedy = "ask for channels that go together (in a campaign, channels = {...}); nothing is resampled"
    for row in rows[1:]:
        other = file.timing(row)
        where = f"{file.source}: channel '{file.channels[row]}'"
        if other.samples != first.samples:
            what = f"{other.samples} samples where '{name}' has {first.samples}"
            raise InputError(what, where=where, remedy=remedy)
        if not _together(other, first):
            what = (
                f"sampled at {_stated(other.sampling_Hz)} Hz from {_stated(other.start_s)} s, "
                f"'{name}' at {_stated(first.sampling_Hz)} Hz from {_stated(first.start_s)} s"
            )
            raise InputError(what, where=where, remedy=remedy)
        if other.begins != first.begins:
            what = (
                f"begins at {other.begins or 'an unknown time'}, '{name}' at {first.begins or 'an unknown time'}"
            )
            raise InputError(what, where=where, remedy=remedy)
    if first.samples < 1:
        raise InputError("holds no sample", where=file.source, value=first.samples, remedy="record it again")
    return first


def _together(one: Timing, other: Timing) -> bool:
    """Whether two channels were sampled at one rate and begin together, to :data:`START_OFF` of a sample."""
    rate = one.sampling_Hz
    if rate is None or other.sampling_Hz is None:
        return (rate, one.start_s) == (other.sampling_Hz, other.start_s)
    if abs(rate / other.sampling_Hz - 1.0) * max(one.samples, 1) > START_OFF:
        return False
    if one.start_s is None or other.start_s is None:
        return one.start_s == other.start_s
    return abs(one.start_s - other.start_s) * rate <= START_OFF


def _stated(value: float | None) -> str:
    return "an unknown number of" if value is None else f"{value:.9g}"


def agreed_rate(file: TimeFile, timing: Timing, expected: float | None) -> float | None:
    """The sampling rate of the file and the caller, if they are one.

    Raises
    ------
    InputError
        If they differ by more than 1e-4, relative, or what the file's times leave open; if only the file could say
        it and does not say it plainly.
    """
    found = timing.sampling_Hz
    if expected is None:
        if timing.fault is not None:
            raise timing.fault
        return found
    if not is_real(expected) or not (np.isfinite(expected) and expected > 0.0):
        raise InputError("must be finite and above 0 Hz", where="sampling_Hz", value=expected)
    if (
        found is not None
        and not timing.remark
        and abs(found / expected - 1.0) > max(RATES_AGREE, timing.uncertainty)
    ):
        raise InputError(
            f"the file states {found:.9g} Hz, but was stated to be sampled at {expected:.9g} Hz",
            where=f"{file.source}: sampling_Hz",
            remedy="correct whichever is wrong; nothing is resampled. "
            'time_column = "none" leaves the times of the file aside, and sampling_Hz holds',
        )
    return float(expected)


def agreed_units(
    file: TimeFile, rows: Sequence[int], expected: str | Mapping[str, str] | None, hints: Hints = NO_HINTS
) -> tuple[str | None, ...]:
    """The unit of each channel as found, or as stated where the file has none, or as a hint has it in any case.

    Raises
    ------
    InputError
        If the file's own, or the hint, means another than what was stated.
    """
    units: list[str | None] = []
    for row in rows:
        name = file.channels[row]
        stated = hints.channel_unit(name)
        found = file.units[row] if stated is None else stated
        reported = expected if isinstance(expected, str) or expected is None else expected.get(name)
        if found is not None and reported is not None:
            check_unit(found, reported, f"{file.source}: channel '{name}'", name, stated is not None)
        units.append(reported if found is None else found)
    return tuple(units)


def check_unit(found: str, reported: str, where: str, label: str, hinted: bool) -> None:
    """Refuse a unit of a file, or of a hint, that means another than what was stated.

    Raises
    ------
    InputError
        If so, naming the key of the campaign file that would settle it.
    """
    try:
        check_same(found, reported, where=where)
    except InputError as error:
        if hinted:
            what = f"the record states {found!r}, the sensor {reported!r}"
            raise InputError(what, where=where, remedy="correct whichever is wrong") from error
        remedy = (
            f'{error.remedy}. If the file is wrong, say so in the record: unit = {{ "{label}" = "{reported}" }}'
        )
        raise InputError(error.what, where=error.where, value=error.value, remedy=remedy) from error


def check_finite(file: TimeFile, rows: Sequence[int], values: Reals, first: int, timing: Timing) -> None:
    """Refuse samples that are not finite, with the place of the first and their number.

    Raises
    ------
    InputError
        If there is one.
    """
    # One sum shows whether to look: it is finite if all values are, but for an overflow.
    with np.errstate(over="ignore", invalid="ignore"):
        total = np.sum(values)
    if np.isfinite(total):
        return
    bad = ~np.isfinite(values)
    if bad.any():
        samples = np.flatnonzero(bad.any(axis=0))
        sample, last = int(samples[0]), int(samples[-1])
        row = int(np.flatnonzero(bad[:, sample])[0])
        count = int(bad.sum())
        reach = f", the last is sample {first + last}" if last > sample else ""
        raise InputError(
            f"not a finite number ({count} such sample{'s' if count > 1 else ''} here{reach})",
            where=file.where(rows[row], first + sample, timing),
            value=float(values[row, sample]),
            remedy="cut the record there or leave the channel out; to look at it, keep_nonfinite=True",
        )
