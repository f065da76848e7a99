"""Effects of rail's and wheels' running surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, size, three
from permway.challenge.layout import WHEEL_RADIUS_M
from permway.challenge.plan import Plan

HIGHEST_ORDER_M = 0.24
"""Shortest wavelength of a polygon, so that its line stays below 370 Hz at 89 m/s."""


@dataclass(frozen=True)
class WheelPolygon(Effect):
    """One wheelset is out of round, of one order and a little of twice."""

    KIND = "wheel_polygon"
    ID = "wheel_polygon"
    FAMILY = "lines over wavelength"
    DOMAIN = "irregularity"
    ALTERNATIVES = ("wheel_polygon", "rail_corrugation")
    FADES = (("amplitude_m", 0.0),)

    wheelset: int
    order: int
    amplitude_m: float
    phase: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Amplitude by strength, over what the rail has at that wavelength."""
        order = int(random.integers(4, int(2.0 * np.pi * WHEEL_RADIUS_M / HIGHEST_ORDER_M) + 1))
        amplitude = size(random, strength, 1.5e-6, 4e-6, 1.2e-5) * (8.0 / order) ** 1.5
        return cls(int(random.integers(1, 5)), order, three(amplitude), round(float(random.uniform(0.0, 6.28)), 3))

    def apply(self, plan: Plan) -> None:
        """Add its waves under that wheel."""

        def waves(times: Reals, speed: float) -> Reals:
            turn = self.order * speed * times / WHEEL_RADIUS_M + self.phase
            under = np.zeros((4, times.size))
            under[self.wheelset - 1] = self.amplitude_m * (np.cos(turn) + 0.15 * np.cos(2.0 * turn + 1.0))
            return under

        plan.wheel_profiles.append(waves)

    @property
    def place(self) -> dict[str, Any]:
        """The wheelset."""
        return {"body": "wheelset", "channels": [f"axlebox{self.wheelset}"]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"wheelset {self.wheelset} out of round, order {self.order}, {1e6 * self.amplitude_m:.3g} um"


@dataclass(frozen=True)
class RailCorrugation(Effect):
    """A band of wavelengths stands out of the rail's profile."""

    KIND = "rail_corrugation"
    ID = "rail_corrugation"
    FAMILY = "lines over wavelength"
    DOMAIN = "irregularity"
    ALTERNATIVES = ("rail_corrugation", "wheel_polygon")
    FADES = (("gain_dB", 0.0),)

    wavelength_m: float
    width: float
    gain_dB: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Height over the spectrum by strength."""
        return cls(between(random, 0.26, 1.2), between(random, 0.03, 0.1), size(random, strength, 4.0, 8.0, 15.0))

    def apply(self, plan: Plan) -> None:
        """Raise the profile there."""

        def shape(f: Reals, speed: float) -> Reals:
            off = np.log(np.maximum(f, 1e-6) * self.wavelength_m / speed) / self.width
            return np.asarray(np.sqrt(1.0 + (10.0 ** (0.1 * self.gain_dB) - 1.0) * np.exp(-0.5 * off**2)))

        plan.shapes.append(shape)

    @property
    def place(self) -> dict[str, Any]:
        """The rail's surface."""
        return {"body": "profile"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"corrugation of {self.wavelength_m:g} m, {self.gain_dB:g} dB above the spectrum"


@dataclass(frozen=True)
class ContactFilter(Effect):
    """Wheels do not follow waves shorter than their contact."""

    KIND = "contact_filter"
    ID = "contact_filter"
    FAMILY = "spectrum's slope"
    DOMAIN = "irregularity"
    FADES = (("half_length_m", 0.0),)

    half_length_m: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Half length of the contact by strength."""
        return cls(size(random, strength, 0.018, 0.03, 0.05))

    def apply(self, plan: Plan) -> None:
        """Filter as Remington (J. Acoust. Soc. Am. 81 (1987) 1805) approximates it."""

        def shape(f: Reals, speed: float) -> Reals:
            waves = 2.0 * np.pi * f * self.half_length_m / speed
            return np.asarray(1.0 / np.sqrt(1.0 + 0.25 * np.pi * waves**3))

        plan.shapes.append(shape)

    @property
    def place(self) -> dict[str, Any]:
        """All wheels."""
        return {"body": "profile"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"contacts of {2e3 * self.half_length_m:.3g} mm take the short waves out"


@dataclass(frozen=True)
class IrregularityLevel(Effect):
    """The profile is rougher than believed, or smoother, at all wavelengths."""

    KIND = "irregularity_level"
    ID = "irregularity_level"
    FAMILY = "spectrum's level"
    DOMAIN = "irregularity"
    ALTERNATIVES = ("irregularity_level", "sensor_gain")
    FADES = (("gain_dB", 0.0),)

    gain_dB: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Level by strength."""
        return cls(size(random, strength, 3.0, 5.0, 8.0) * float(random.choice([-1.0, 1.0])))

    def apply(self, plan: Plan) -> None:
        """Scale the profile."""
        plan.shapes.append(lambda f, _: np.full(f.shape, 10.0 ** (0.05 * self.gain_dB)))

    @property
    def place(self) -> dict[str, Any]:
        """The rail's surface."""
        return {"body": "profile"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"the profile is {self.gain_dB:+g} dB from the sheet's spectrum"
