"""Effects of supports that differ from place to place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, size
from permway.challenge.plan import Plan


@dataclass(frozen=True)
class SupportScatter(Effect):
    """Pads differ along the deck, neighbours less than those far apart."""

    KIND = "support_scatter"
    ID = "support_scatter"
    FAMILY = "support along x"
    ALTERNATIVES = ("support_scatter", "support_gradient")
    FADES = (("sigma", 0.0),)

    sigma: float
    length_m: float
    seed: int

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Standard deviation of the stiffness's logarithm by strength."""
        sigma = size(random, strength, 0.08, 0.18, 0.4)
        return cls(sigma, between(random, 3.0, 12.0), int(random.integers(2**31)))

    def apply(self, plan: Plan) -> None:
        """Scale each pad by a draw of a field that is correlated over the length; its mean stays."""
        x = np.array(plan.layout.deck)
        apart = np.abs(x[:, None] - x[None, :]) / self.length_m
        # Matern's of order 3/2: rougher than any sum of some cosines.
        root = np.linalg.cholesky((1.0 + apart) * np.exp(-apart) + 1e-9 * np.eye(x.size))
        draw = root @ np.random.default_rng(self.seed).standard_normal(x.size)
        field: Reals = np.exp(self.sigma * (draw - draw.mean()))
        plan.track.scale("pad", lambda at: float(field[int(np.argmin(np.abs(x - at)))]))

    @property
    def place(self) -> dict[str, Any]:
        """The pads on the deck."""
        return {"joint": "pad", "x_m": None}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"pads on the deck scatter by {100.0 * self.sigma:.3g} %, alike over some {self.length_m:g} m"


@dataclass(frozen=True)
class SlabWarping(Effect):
    """Slabs that curl up at their ends, where mortar carries less."""

    KIND = "slab_warping"
    ID = "slab_warping"
    FAMILY = "slab joints"
    FADES = (("factor", 1.0),)

    length_m: float
    factor: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """How far from the ends by strength, and what is left there."""
        left = {"weak": 3e-2, "medium": 8e-3, "strong": 2e-3}[strength]
        return cls(size(random, strength, 1.5, 2.5, 4.0), between(random, 0.5 * left, 2.0 * left))

    def apply(self, plan: Plan) -> None:
        """Let the mortar's logarithm fall off with the square of the distance, as a curled slab lifts."""
        ends = np.arange(plan.layout.spans + 1) * plan.layout.span_m

        def left(x: float) -> float:
            share = min(1.0, float(np.abs(x - ends).min()) / self.length_m)
            return float(self.factor ** ((1.0 - share) ** 2))

        plan.track.scale("mortar", left)

    @property
    def place(self) -> dict[str, Any]:
        """The mortar of every slab's ends."""
        return {"joint": "mortar", "x_m": None}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"slabs curl over {self.length_m:g} m at their ends, where mortar keeps {self.factor:g} of k"
