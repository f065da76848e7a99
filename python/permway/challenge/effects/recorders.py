"""Faults of recorders: converters that run out of range, clocks that run apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from scipy.interpolate import CubicSpline

from permway.challenge.beams import Reals
from permway.challenge.effects.base import Effect, Site, Strength, size
from permway.challenge.plan import Plan

FINER = 8
"""Times as many samples, between which a record is taken by cubics."""


@dataclass(frozen=True)
class Clipping(Effect):
    """A channel on board whose range was set too small."""

    KIND = "clipping"
    ID = "clipping"
    FAMILY = "clipping"
    DOMAIN = "measurement"

    channel: str
    times_rms: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Range over what is read by strength."""
        return cls(str(random.choice(list(site.tests.channels))), size(random, strength, 3.0, 2.0, 1.0))

    def apply(self, plan: Plan) -> None:
        """Cut what is beyond."""

        def recorder(channel: str, values: Reals) -> Reals:
            if channel != self.channel:
                return values
            most = self.times_rms * float(np.sqrt(np.mean(values**2)))
            return np.clip(values, -most, most)

        plan.recorders.append(recorder)

    @property
    def place(self) -> dict[str, Any]:
        """The channel."""
        return {"channels": [self.channel]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"{self.channel} is cut off at {self.times_rms:g} times its own root mean square"


@dataclass(frozen=True)
class ClockDrift(Effect):
    """A channel on a recorder of its own, whose clock runs slow: it lags ever more."""

    KIND = "clock_drift"
    ID = "sensor_delay"
    FAMILY = "sensor phase"
    DOMAIN = "measurement"

    channel: str
    slow: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Relative error by strength: quartz is good to some 5e-5."""
        return cls(str(random.choice(list(site.tests.channels))), size(random, strength, 6e-6, 2e-5, 6e-5))

    def apply(self, plan: Plan) -> None:
        """Take the record's values at that clock's times; it is periodic."""

        def recorder(channel: str, values: Reals) -> Reals:
            if channel != self.channel:
                return values
            count = values.size
            spectrum = np.fft.rfft(values)
            fine = np.fft.irfft(spectrum, n=FINER * count) * FINER
            around = CubicSpline(
                np.arange(FINER * count + 1) / FINER, np.append(fine, fine[0]), bc_type="periodic"
            )
            return np.asarray(around(np.arange(count) * (1.0 - self.slow)))

        plan.recorders.append(recorder)

    @property
    def place(self) -> dict[str, Any]:
        """The channel."""
        return {"channels": [self.channel]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"the clock of {self.channel} is slow by {1e6 * self.slow:.3g} in a million"
