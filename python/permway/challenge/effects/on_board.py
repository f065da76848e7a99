"""Effects of the vehicle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, size
from permway.challenge.plan import Plan
from permway.challenge.vehicle import WHEELS

BODY_LENGTH_M = 25.0
FREE_FREE = 4.730040745
"""First root of cos x cosh x = 1: the first bending of a free beam."""


def hysteretic_tie(mass: float, tuned_Hz: float, loss: float) -> Any:
    """A spring on which a mass is tuned."""
    value = mass * (2.0 * np.pi * tuned_Hz) ** 2 * (1.0 + 1j * loss)
    return lambda f: np.full(f.shape, value)


@dataclass(frozen=True)
class DamperSeries(Effect):
    """The primary dampers have springs in series."""

    KIND = "damper_series"
    ID = "damper_series_stiffness"
    FAMILY = "suspension"
    DOMAIN = "vehicle"
    FADES = (("corner_Hz", math.inf),)

    corner_Hz: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Where the damper begins to act as a spring, by strength."""
        return cls(size(random, strength, 60.0, 20.0, 5.0))

    def apply(self, plan: Plan) -> None:
        """Replace the damper by a Maxwell element."""
        v = plan.values["vehicle"]

        def law(f: Reals) -> Complexes:
            return np.asarray(v["kp"] + 2j * np.pi * f * v["cp"] / (1.0 + 1j * f / self.corner_Hz))

        plan.vehicle.laws["primary"] = law

    @property
    def place(self) -> dict[str, Any]:
        """The primary suspension."""
        return {"joint": "primary suspension", "channels": "on board"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"primary dampers with a spring in series, corner at {self.corner_Hz:g} Hz"


@dataclass(frozen=True)
class AxleboxAbsorber(Effect):
    """Something swings on the axle boxes."""

    KIND = "axlebox_absorber"
    ID = "axlebox_absorber"
    FAMILY = "resonator"
    DOMAIN = "vehicle"
    FADES = (("mass_kg", 0.0),)

    wheelsets: tuple[int, ...]
    mass_kg: float
    tuned_Hz: float
    loss: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """On one wheelset or all; mass by strength."""
        some = (1, 2, 3, 4) if random.random() < 0.5 else (int(random.integers(1, 5)),)
        mass = size(random, strength, 20.0, 60.0, 150.0)
        return cls(some, mass, between(random, 35.0, 180.0), between(random, 0.03, 0.2))

    def apply(self, plan: Plan) -> None:
        """Hang it on."""
        plan.vehicle.laws["absorber"] = hysteretic_tie(self.mass_kg, self.tuned_Hz, self.loss)
        for wheelset in self.wheelsets:
            attached = plan.vehicle.add(self.mass_kg)
            plan.vehicle.ties.append(({WHEELS[wheelset - 1]: 1.0, attached: -1.0}, "absorber"))

    @property
    def place(self) -> dict[str, Any]:
        """The wheelsets."""
        return {"body": "wheelset", "channels": [f"axlebox{i}" for i in self.wheelsets]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return (
            f"a resonator of {self.mass_kg:g} kg at {self.tuned_Hz:g} Hz, loss factor {self.loss:g}, "
            f"on wheelsets {', '.join(map(str, self.wheelsets))}"
        )


@dataclass(frozen=True)
class BodyBending(Effect):
    """The car body bends."""

    KIND = "body_bending"
    ID = "body_bending"
    FAMILY = "vehicle bending"
    DOMAIN = "vehicle"
    FADES = (("frequency_Hz", math.inf),)

    frequency_Hz: float
    loss: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Frequency by strength."""
        return cls(size(random, strength, 28.0, 17.0, 9.0), between(random, 0.02, 0.08))

    def apply(self, plan: Plan) -> None:
        """Add the first mode of a free beam of the body's mass."""
        vehicle, v = plan.vehicle, plan.values["vehicle"]
        mass = 0.25 * v["half"] * v["Mc"]
        number = vehicle.add(mass)
        vehicle.laws["bending"] = hysteretic_tie(mass, self.frequency_Hz, self.loss)
        at_bogie = first_bending(0.5 + 0.5 * v["lc"] / BODY_LENGTH_M)
        for arm, name in vehicle.ties:
            if name == "secondary":
                arm[number] = at_bogie
        vehicle.ties.append(({number: 1.0}, "bending"))
        vehicle.channels["carbody"][number] = first_bending(0.5)

    @property
    def place(self) -> dict[str, Any]:
        """The body."""
        return {"body": "car body", "channels": ["carbody"]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"the car body bends at {self.frequency_Hz:g} Hz, loss factor {self.loss:g}"


def first_bending(share: float) -> float:
    """Shape of the first bending of a free beam, 1 at its ends, at a share of its length."""
    x = FREE_FREE * share
    ratio = (np.cosh(FREE_FREE) - np.cos(FREE_FREE)) / (np.sinh(FREE_FREE) - np.sin(FREE_FREE))
    return float(0.5 * (np.cosh(x) + np.cos(x) - ratio * (np.sinh(x) + np.sin(x))))


@dataclass(frozen=True)
class WheelsetBending(Effect):
    """Wheelsets bend: the axle boxes move on the wheels by a spring."""

    KIND = "wheelset_bending"
    ID = "wheelset_bending"
    FAMILY = "vehicle bending"
    DOMAIN = "vehicle"
    FADES = (("frequency_Hz", math.inf),)

    frequency_Hz: float
    share: float
    loss: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Frequency of the parted masses by strength."""
        return cls(size(random, strength, 550.0, 300.0, 140.0), between(random, 0.25, 0.5), 0.02)

    def apply(self, plan: Plan) -> None:
        """Part each wheelset into what rolls and what carries the boxes."""
        vehicle, v = plan.vehicle, plan.values["vehicle"]
        whole = v["half"] * v["Mw"]
        boxes = self.share * whole
        joint = boxes * (whole - boxes) / whole
        vehicle.laws["axle"] = hysteretic_tie(joint, self.frequency_Hz, self.loss)
        displaced = {}
        for index, wheel in enumerate(WHEELS):
            vehicle.masses[wheel] = whole - boxes
            displaced[wheel] = vehicle.add(boxes)
            vehicle.channels[f"axlebox{index + 1}"] = {displaced[wheel]: 1.0}
        vehicle.ties = [
            ({displaced.get(number, number): factor for number, factor in arm.items()}, name)
            for arm, name in vehicle.ties
        ]
        vehicle.ties += [({wheel: 1.0, boxes_at: -1.0}, "axle") for wheel, boxes_at in displaced.items()]

    @property
    def place(self) -> dict[str, Any]:
        """All wheelsets."""
        return {"body": "wheelset", "channels": [f"axlebox{i}" for i in range(1, 5)]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"wheelsets part at {self.frequency_Hz:g} Hz, {self.share:g} of the mass with the axle boxes"
