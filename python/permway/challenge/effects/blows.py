"""Effects that strike again and again: flats of wheels, joints of rails."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, size
from permway.challenge.layout import WHEEL_RADIUS_M
from permway.challenge.plan import Plan

HIGHEST_HZ = 500.0
"""Of a profile's series, below half the sampling rate."""

POINTS = 4096
"""Of a period, from which its series is made."""


def series(shape: Reals, at: Reals, most: int) -> Reals:
    """A periodic shape by its first harmonics: what is shorter would fold over when sampled.

    Parameters
    ----------
    shape : ndarray, shape (POINTS,)
        Of one period.
    at : ndarray
        Places in periods.
    most : int
        Harmonics.
    """
    terms = np.fft.rfft(shape)[: most + 1] / shape.size
    found = np.full(at.shape, terms[0].real)
    for order in range(1, terms.size):
        found = found + 2.0 * (terms[order] * np.exp(2j * np.pi * order * at)).real
    return np.asarray(found)


@dataclass(frozen=True)
class WheelFlat(Effect):
    """A worn flat on one wheel: it drops by d over the length l, once a turn."""

    KIND = "wheel_flat"
    ID = "wheel_flat"
    FAMILY = "lines over wavelength"
    DOMAIN = "irregularity"
    ALTERNATIVES = ("wheel_flat", "wheel_polygon")
    FADES = (("depth_m", 0.0),)

    wheelset: int
    depth_m: float
    length_m: float
    phase: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Depth by strength; its length is a chord's, worn to twice that."""
        depth = size(random, strength, 2e-5, 6e-5, 2e-4)
        length = round(2.0 * float(np.sqrt(8.0 * WHEEL_RADIUS_M * depth)), 4)
        return cls(int(random.integers(1, 5)), depth, length, round(float(random.random()), 3))

    def apply(self, plan: Plan) -> None:
        """Add the dip under that wheel."""
        turn_m = 2.0 * np.pi * WHEEL_RADIUS_M
        along = np.clip((np.arange(POINTS) / POINTS - 0.5) * turn_m / self.length_m, -0.5, 0.5)
        shape = 0.5 * self.depth_m * (1.0 + np.cos(2.0 * np.pi * along))

        def dip(times: Reals, speed: float) -> Reals:
            under = np.zeros((4, times.size))
            most = int(HIGHEST_HZ * turn_m / speed)
            under[self.wheelset - 1] = series(shape, speed * times / turn_m + self.phase, most)
            return under

        plan.wheel_profiles.append(dip)

    @property
    def place(self) -> dict[str, Any]:
        """The wheelset."""
        return {"body": "wheelset", "channels": [f"axlebox{self.wheelset}"]}

    @property
    def mechanical(self) -> str:
        """In words."""
        depth, length = 1e3 * self.depth_m, 1e3 * self.length_m
        return f"a flat of wheelset {self.wheelset}, {depth:.3g} mm deep over {length:.3g} mm"


@dataclass(frozen=True)
class RailJoints(Effect):
    """Rails of one length whose ends are dipped."""

    KIND = "rail_joints"
    ID = "rail_joint"
    FAMILY = "tied to speed over length"
    DOMAIN = "irregularity"
    FADES = (("depth_m", 0.0),)

    every_m: float
    depth_m: float
    length_m: float
    phase: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Depth by strength."""
        every = float(random.choice([12.5, 15.0, 18.0, 25.0]))
        depth = size(random, strength, 4e-5, 1.2e-4, 4e-4)
        return cls(every, depth, between(random, 0.3, 0.9), round(float(random.random()), 3))

    def apply(self, plan: Plan) -> None:
        """Two quarter waves that meet in a kink, under all wheels."""
        along = np.clip(
            np.abs((np.arange(POINTS) / POINTS - 0.5) * self.every_m / (0.5 * self.length_m)), 0.0, 1.0
        )
        shape = self.depth_m * (1.0 - np.sin(0.5 * np.pi * along))
        wheels = np.array(plan.layout.wheels_m(plan.values["vehicle"]))

        def dips(times: Reals, speed: float) -> Reals:
            at = (speed * times + (wheels - wheels[0])[:, None]) / self.every_m + self.phase
            return series(shape, at, int(HIGHEST_HZ * self.every_m / speed))

        plan.wheel_profiles.append(dips)

    @property
    def place(self) -> dict[str, Any]:
        """Under all wheels."""
        return {"body": "profile", "channels": "on board"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"joints every {self.every_m:g} m, dipped by {1e3 * self.depth_m:.3g} mm over {self.length_m:g} m"
