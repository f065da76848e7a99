"""A time column: whether it is uniform, and the rate it means."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.timefile import RATES_AGREE, Timing

LEAST_UNSTATED_HZ, MOST_UNSTATED_HZ = 20.0, 1e6
"""Rates outside are not believed of times without a unit: they may count samples, milliseconds or days.

Below 20 Hz hardly a line from 4 Hz on is left, which is where a campaign begins, and milliseconds of all rates up
to 20 kHz would be read as seconds. Half of it lets those of 10 to 20 kHz pass; twice of it asks slow monitors for
their unit, too. The upper one lies above what
accelerometers are sampled with, and below times in days or hours that were taken for seconds (1.7e6 Hz and more).
"""

_EPOCHS = tuple((946_684_800.0 / scale, 4_102_444_800.0 / scale, scale) for scale in (1e-3, 1e-6, 1e-9))
"""Times since 1970 in ms, us and ns, from 2000 to 2100: no two of these ranges meet, nor does another clock's."""

_MOST_UNSTATED_S = 1e11
"""Larger times without a unit are no seconds, of whatever clock: 3,000 years."""

_STEP_OFF = 0.01
"""Share of a step by which one may differ from the others."""


class TimeBase:
    """Checks a time column as it is read, piece by piece.

    Parameters
    ----------
    resolution_s : float
        Of the column: what its last printed digit, or the precision of its numbers, is worth.
    place : callable
        From a sample to its place in the file.
    scale : float
        Seconds in one of what is fed.
    rounded : bool
        Whether times may be rounded though their steps are even.
    """

    def __init__(
        self, resolution_s: float, place: Callable[[int], str], scale: float = 1.0, *, rounded: bool = False
    ) -> None:
        self.resolution_s, self.place, self.scale, self.rounded = resolution_s, place, scale, rounded
        self._origin: float | None = None
        self.step_s: float | None = None
        self.start_s: float | None = None
        self._spread = 0.0
        self._even = True
        self._next = 0
        self._last = 0.0

    def feed(self, times: Reals) -> None:
        """Check the times that follow those fed before.

        They are counted from the first: of a date in milliseconds, seconds alone would lose the digits of a step.

        Raises
        ------
        InputError
            At the first that is not finite, does not rise, or is not one step after the one before.
        """
        if not times.size:
            return
        first = self._next
        bad = np.flatnonzero(~np.isfinite(times))
        if bad.size:
            raise self._error("not a finite time", first + int(bad[0]), float("nan"))
        if self._origin is None:
            self._origin = float(times[0])
        times_s: Reals = (times - self._origin) * self.scale
        joined = times_s if first == 0 else np.concatenate(([self._last], times_s))
        offset = first if first == 0 else first - 1
        if self.start_s is None:
            self.start_s = self._origin * self.scale
        if joined.size > 1:
            self._check(joined, offset)
        self._next, self._last = first + times_s.size, float(times_s[-1])

    def _check(self, times_s: Reals, offset: int) -> None:
        steps = np.diff(times_s)
        low = np.flatnonzero(steps <= 0.0)
        if low.size:
            at = int(low[0]) + 1
            raise self._error("time must rise strictly", offset + at, float(times_s[at]))
        usual = float(np.median(steps)) if self.step_s is None else self.step_s
        # The mean of the usual steps is free of the rounding that each of them has.
        near = steps[np.abs(steps - usual) <= _STEP_OFF * usual + 2.0 * self.resolution_s]
        mean = float(near.mean()) if near.size else usual
        if self.step_s is None:
            self.step_s, self._spread = mean, self.resolution_s / (mean * steps.size)
            self._even = bool(np.all(np.abs(steps - usual) <= 1e-3 * self.resolution_s + 1e-9 * usual))
        allowed = _STEP_OFF * self.step_s + 1.001 * self.resolution_s
        off = np.flatnonzero(np.abs(steps - self.step_s) > allowed)
        if off.size:
            at = int(off[0]) + 1
            what = f"a step of {steps[at - 1]:.6g} s where the others are {self.step_s:.6g} s: not uniform"
            raise self._error(what, offset + at, float(times_s[at]))
        line = times_s[0] + mean * np.arange(times_s.size)
        away = np.flatnonzero(np.abs(times_s - line) > 0.1 * self.step_s + self.resolution_s)
        if away.size or abs(mean / self.step_s - 1.0) > max(1e-4, 2.0 * self._spread):
            at = int(away[0]) if away.size else 0
            raise self._error("the steps change slowly: not uniform", offset + at, float(times_s[at]))

    @property
    def sampling_Hz(self) -> float | None:
        """The rate; a whole number of hertz if the column, as exactly as it is printed, allows it."""
        return None if self.step_s is None else whole_rate(1.0 / self.step_s, self._spread)

    def timing(self, samples: int) -> Timing:
        """What was found; where the printed digits leave the rate open, with the error that says so."""
        rate = self.sampling_Hz
        fault = None
        if rate is not None and (self.rounded or not self._even) and self._spread > RATES_AGREE:
            low, high = rate * (1.0 - self._spread), rate * (1.0 + self._spread)
            fault = InputError(
                f"the times are printed so coarsely that the rate may be {low:.6g} to {high:.6g} Hz",
                where=self.place(0),
                remedy="state it in the record, as in sampling_Hz = 512.0",
            )
        return Timing(
            samples=samples, sampling_Hz=rate, start_s=self.start_s, uncertainty=self._spread, fault=fault
        )

    def _error(self, what: str, sample: int, value: float) -> InputError:
        return InputError(
            what,
            where=self.place(sample),
            value=value / self.scale + (self._origin or 0.0),
            remedy="give uniform samples, in parts if there are gaps; nothing is interpolated",
        )


def whole_rate(rate_Hz: float, relative: float) -> float:
    """The nearest whole number of hertz if it lies within a relative uncertainty, else the rate itself."""
    whole = round(rate_Hz)
    near = whole > 0 and abs(whole / rate_Hz - 1.0) <= min(relative + 1e-12, 1e-5)
    return float(whole) if near else rate_Hz


def unstated_scale(times: Reals) -> float:
    """Seconds in one of a time without a unit, by its first value: a date of a computer's clock, or seconds."""
    finite = times[np.isfinite(times)]
    first = float(finite[0]) if finite.size else 0.0
    return next((scale for least, most, scale in _EPOCHS if least <= first <= most), 1.0)


def check_unstated(base: TimeBase, label: str) -> None:
    """Refuse times without a unit where seconds are not to be believed.

    Parameters
    ----------
    base : TimeBase
        That has seen the times, taken for seconds.
    label : str
        Of the column, for the remedy.

    Raises
    ------
    InputError
        If the rate is none of vibration.
    """
    step = base.step_s
    far = abs(base.start_s or 0.0) > _MOST_UNSTATED_S
    if step is None or base.scale != 1.0 or (LEAST_UNSTATED_HZ <= 1.0 / step <= MOST_UNSTATED_HZ and not far):
        return
    key = label if re.fullmatch(r"[A-Za-z0-9_-]+", label) else f'"{label}"'
    raise InputError(
        f"times without a unit, a step of {step:.6g}: as seconds {1.0 / step:.6g} Hz",
        where=base.place(0),
        remedy=f'state the unit in the header, or in the record: unit = {{ {key} = "ms" }}; '
        'or leave the times aside: time_column = "none" and sampling_Hz',
    )
