"""Effects that depend on amplitude: forces of the primary suspension that no frequency response describes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, size
from permway.challenge.plan import Plan
from permway.challenge.sliders import Slider


@dataclass(frozen=True)
class PrimaryFriction(Effect):
    """Dry friction beside the primary suspension."""

    KIND = "primary_friction"
    ID = "suspension_friction"
    FAMILY = "friction"
    DOMAIN = "vehicle"

    friction_N: float
    rounding_m_per_s: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Friction by strength."""
        return cls(size(random, strength, 100.0, 300.0, 1000.0), between(random, 0.005, 0.02))

    def apply(self, plan: Plan) -> None:
        """Put a slider beside each primary spring."""

        def force(velocity: Reals) -> Reals:
            return np.asarray(self.friction_N * np.tanh(velocity / self.rounding_m_per_s))

        plan.vehicle.slider = Slider("primary", force, self.friction_N / self.rounding_m_per_s)

    @property
    def place(self) -> dict[str, Any]:
        """The primary suspension."""
        return {"joint": "primary suspension", "channels": "on board"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"dry friction of {self.friction_N:g} N in the primary suspension"


@dataclass(frozen=True)
class BlowOffDamper(Effect):
    """Primary dampers that give way above some force."""

    KIND = "blow_off_damper"
    ID = "suspension_friction"
    FAMILY = "friction"
    DOMAIN = "vehicle"

    most_N: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Largest force by strength: the smaller, the sooner it gives way."""
        return cls(size(random, strength, 900.0, 450.0, 150.0))

    def apply(self, plan: Plan) -> None:
        """Replace the dampers: as the campaign file states at rest, bounded in motion."""
        v = plan.values["vehicle"]

        def force(velocity: Reals) -> Reals:
            return np.asarray(self.most_N * np.tanh(v["cp"] * velocity / self.most_N))

        plan.vehicle.laws["primary"] = lambda f: np.full(f.shape, v["kp"] + 0j)
        plan.vehicle.slider = Slider("primary", force, v["cp"])

    @property
    def place(self) -> dict[str, Any]:
        """The primary suspension."""
        return {"joint": "primary suspension", "channels": "on board"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"primary dampers that blow off at {self.most_N:g} N"
