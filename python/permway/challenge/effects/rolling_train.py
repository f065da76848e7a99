"""A train that moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.effects.base import Effect, Site, Strength
from permway.challenge.plan import Plan


@dataclass(frozen=True)
class RollingTrain(Effect):
    """Wheels roll over fasteners and spans, where the model has them stand on a profile that moves."""

    KIND = "rolling_train"
    ID = "parametric_support"
    FAMILY = "tied to speed over length"
    DOMAIN = "irregularity"

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """It is or is not."""
        return cls()

    def apply(self, plan: Plan) -> None:
        """Let it roll."""
        plan.rolls = True

    @property
    def place(self) -> dict[str, Any]:
        """On board."""
        return {"channels": "on board"}

    @property
    def mechanical(self) -> str:
        """In words."""
        return "wheels roll over fasteners and spans, which give way unequally under their load"
