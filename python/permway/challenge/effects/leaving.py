"""Effects that make wheels leave the rail."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Reals
from permway.challenge.contact import Hertz
from permway.challenge.effects.base import Effect, Site, Strength, between, size
from permway.challenge.plan import CONTACT_N_PER_M, Plan
from permway.challenge.vehicle import wheel_load

SCATTER = 0.3
"""Of the distance from weld to weld, relative."""


@dataclass(frozen=True)
class DippedWelds(Effect):
    """Welds that lie so deep that wheels fly over them."""

    KIND = "dipped_welds"
    ID = "dipped_welds"
    FAMILY = "dips of the rail"
    DOMAIN = "irregularity"

    depth_m: float
    length_m: float
    every_m: float
    scatter_seed: int

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Depth by strength: one of 0.37 mm let wheels leave the rail at 300 km/h, and all but never at 200."""
        return cls(
            size(random, strength, 3e-4, 6e-4, 1.2e-3),
            between(random, 0.25, 0.45),
            between(random, 12.0, 36.0),
            int(random.integers(2**31)),
        )

    def apply(self, plan: Plan) -> None:
        """Dips along the rail that all wheels meet, and contacts that only press."""
        plan.vehicle.hertz = Hertz(wheel_load(plan.values), CONTACT_N_PER_M)
        wheels = np.array(plan.layout.wheels_m(plan.values["vehicle"]))

        def dips(times: Reals, speed: float) -> Reals:
            at = speed * times + (wheels - wheels[0])[:, None]
            count = int(np.ceil((at.max() - at.min()) / self.every_m)) + 1
            random = np.random.default_rng(self.scatter_seed)
            off = SCATTER * random.uniform(-0.5, 0.5, count)
            welds = at.min() + self.every_m * (np.arange(count) + 0.5 + off)
            nearest = welds[np.clip(np.round((at - at.min()) / self.every_m - 0.5).astype(int), 0, count - 1)]
            along = np.clip((at - nearest) / self.length_m, -0.5, 0.5)
            return np.asarray(0.5 * self.depth_m * (1.0 + np.cos(2.0 * np.pi * along)))

        plan.wheel_profiles.append(dips)

    @property
    def place(self) -> dict[str, Any]:
        """Under all wheels."""
        return {"body": "rail", "channels": "on board"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return (
            f"welds dipped by {1e3 * self.depth_m:.3g} mm over {self.length_m:g} m, "
            f"every {self.every_m:g} m, from which wheels take off"
        )
