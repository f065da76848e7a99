"""Effects of the vehicle above its wheelsets: air springs, frames that bend, what shakes it beside the track."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, size
from permway.challenge.effects.on_board import first_bending, hysteretic_tie
from permway.challenge.plan import Plan
from permway.challenge.vehicle import Force

BOGIES = (2, 4)

FRAME_LENGTH_M = 3.6


@dataclass(frozen=True)
class AirSpring(Effect):
    """The secondary springs are bellows beside a reservoir at the end of a pipe.

    Berg, Vehicle System Dynamics 33 (1999) 158-169; the pipe's air has inertia, and its loss is linear here.
    """

    KIND = "air_spring"
    ID = "air_spring"
    FAMILY = "suspension"
    DOMAIN = "vehicle"
    FADES = (("rise", 0.0),)

    rise: float
    settles_Hz: float
    sways_Hz: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Stiffness of fast motion over that at rest, less one, by strength."""
        return cls(size(random, strength, 0.4, 1.0, 2.5), between(random, 1.0, 5.0), between(random, 8.0, 20.0))

    def apply(self, plan: Plan) -> None:
        """Put bellows and pipe in series beside what is there at rest."""
        before, at_rest = plan.vehicle.laws["secondary"], plan.values["vehicle"]["ks"]
        bellows = self.rise * at_rest

        def law(f: Reals) -> Complexes:
            pipe = bellows * (1j * f / self.settles_Hz - (f / self.sways_Hz) ** 2)
            return np.asarray(before(f) + bellows * pipe / (bellows + pipe))

        plan.vehicle.laws["secondary"] = law

    @property
    def place(self) -> dict[str, Any]:
        """The secondary suspension."""
        return {"joint": "secondary suspension", "channels": "on board"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"air springs, {1.0 + self.rise:.3g} times as stiff in fast motion, from {self.settles_Hz:g} Hz"


@dataclass(frozen=True)
class BogieBending(Effect):
    """Both bogie frames bend."""

    KIND = "bogie_bending"
    ID = "bogie_modes"
    FAMILY = "vehicle bending"
    DOMAIN = "vehicle"
    FADES = (("frequency_Hz", math.inf),)

    frequency_Hz: float
    loss: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Frequency by strength."""
        return cls(size(random, strength, 95.0, 60.0, 38.0), between(random, 0.02, 0.08))

    def apply(self, plan: Plan) -> None:
        """Add the first mode of a free beam of each frame's mass; the body rests on its middle."""
        vehicle, v = plan.vehicle, plan.values["vehicle"]
        mass = 0.25 * v["half"] * v["Mt"]
        vehicle.laws["frame"] = hysteretic_tie(mass, self.frequency_Hz, self.loss)
        at_wheel = first_bending(0.5 + 0.5 * v["lt"] / FRAME_LENGTH_M)
        middle = first_bending(0.5)
        for bogie in BOGIES:
            number = vehicle.add(mass)
            for arm, name in vehicle.ties:
                if bogie in arm:
                    arm[number] = at_wheel if name == "primary" else -middle
            vehicle.ties.append(({number: 1.0}, "frame"))
            if bogie == BOGIES[0]:
                vehicle.channels["bogie1"][number] = middle

    @property
    def place(self) -> dict[str, Any]:
        """The frames."""
        return {"body": "bogie frame", "channels": ["bogie1"]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"bogie frames bend at {self.frequency_Hz:g} Hz, loss factor {self.loss:g}"


@dataclass(frozen=True)
class SecondSource(Effect):
    """A machine shakes bogie or body at random, in a band."""

    KIND = "second_source"
    ID = "second_source"
    FAMILY = "noise"
    DOMAIN = "measurement"
    FADES = (("rms_N", 0.0),)

    channel: str
    rms_N: float
    centre_Hz: float
    quality: float
    seed: int

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Force by strength."""
        on_body = bool(random.random() < 0.5)
        rms = size(random, strength, 30.0, 120.0, 500.0) * (1.0 if on_body else 2.0)
        where, centre = (
            ("carbody", between(random, 15.0, 90.0)) if on_body else ("bogie1", between(random, 60.0, 250.0))
        )
        return cls(where, rms, centre, between(random, 2.0, 6.0), int(random.integers(2**31)))

    def apply(self, plan: Plan) -> None:
        """Noise through a resonance, another in each run."""
        random = np.random.default_rng(self.seed)

        def spectrum(f: Reals) -> Complexes:
            ratio = f / self.centre_Hz
            shape = ratio / np.abs(1.0 - ratio**2 + 1j * ratio / self.quality)
            level = self.rms_N / np.sqrt(2.0 * np.sum(shape**2))
            noise = random.standard_normal((2, f.size))
            return np.asarray(level * shape * (noise[0] + 1j * noise[1]) / np.sqrt(2.0))

        plan.vehicle.forces.append(Force(plan.vehicle.channels[self.channel], spectrum))

    @property
    def place(self) -> dict[str, Any]:
        """What is shaken."""
        return {"body": self.channel, "channels": [self.channel]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"a random force of {self.rms_N:.3g} N about {self.centre_Hz:g} Hz on {self.channel}"
