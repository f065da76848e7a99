"""A time column: whether it is uniform, and the rate it means."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError

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
    """

    def __init__(self, resolution_s: float, place: Callable[[int], str]) -> None:
        self.resolution_s, self.place = resolution_s, place
        self.step_s: float | None = None
        self.start_s: float | None = None
        self._spread = 0.0
        self._next = 0
        self._last = 0.0

    def feed(self, times_s: Reals) -> None:
        """Check the times that follow those fed before.

        Raises
        ------
        InputError
            At the first that is not finite, does not rise, or is not one step after the one before.
        """
        if not times_s.size:
            return
        first = self._next
        bad = np.flatnonzero(~np.isfinite(times_s))
        if bad.size:
            raise self._error("not a finite time", first + int(bad[0]), float(times_s[bad[0]]))
        joined = times_s if first == 0 else np.concatenate(([self._last], times_s))
        offset = first if first == 0 else first - 1
        if self.start_s is None:
            self.start_s = float(joined[0])
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

    def _error(self, what: str, sample: int, value: float) -> InputError:
        return InputError(
            what,
            where=self.place(sample),
            value=value,
            remedy="give uniform samples, in parts if there are gaps; nothing is interpolated",
        )


def whole_rate(rate_Hz: float, relative: float) -> float:
    """The nearest whole number of hertz if it lies within a relative uncertainty, else the rate itself."""
    whole = round(rate_Hz)
    near = whole > 0 and abs(whole / rate_Hz - 1.0) <= min(relative + 1e-12, 1e-5)
    return float(whole) if near else rate_Hz
