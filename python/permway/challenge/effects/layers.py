"""Effects of slab, mortar and layers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, inside, interval, size
from permway.challenge.plan import Plan


@dataclass(frozen=True)
class MortarVoid(Effect):
    """Mortar that carries next to nothing over a stretch."""

    KIND = "mortar_void"
    ID = "mortar_void"
    FAMILY = "local loss of support"
    ALTERNATIVES = ("fastener_loss", "mortar_void")
    FADES = (("factor", 1.0),)

    stretch_m: tuple[float, float]
    factor: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Two, four or eight stations by strength, and what is left of them."""
        bays, left = {"weak": (2, 1e-2), "medium": (4, 3e-3), "strong": (8, 1e-3)}[strength]
        return cls(interval(random, site, bays), between(random, 0.4 * left, 2.0 * left))

    def apply(self, plan: Plan) -> None:
        """Scale the mortar there."""
        plan.track.scale("mortar", lambda x: self.factor if inside(x, self.stretch_m) else 1.0)

    @property
    def place(self) -> dict[str, Any]:
        """The stretch."""
        return {"joint": "mortar", "x_m": list(self.stretch_m)}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"mortar between {self.stretch_m[0]:g} and {self.stretch_m[1]:g} m keeps {self.factor:g} of k"


@dataclass(frozen=True)
class SlabJoints(Effect):
    """The slab is cut through between fasteners."""

    KIND = "slab_joints"
    ID = "slab_joints"
    FAMILY = "slab joints"

    cuts_m: tuple[float, ...]

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """The slab's length by strength."""
        layout = site.layout
        bays = {"weak": 16, "medium": 10, "strong": 7}[strength]
        half = 0.5 * layout.spacing_m
        last = layout.bays
        return cls(tuple(round(layout.station(i) + half, 4) for i in range(bays, last - 2, bays)))

    def apply(self, plan: Plan) -> None:
        """Cut it."""
        plan.track.cut("slab", self.cuts_m)

    @property
    def place(self) -> dict[str, Any]:
        """Where the cuts are."""
        return {"body": "slab", "x_m": list(self.cuts_m)}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"the slab is cut through at {len(self.cuts_m)} places"


@dataclass(frozen=True)
class ViscousLayer(Effect):
    """Pads lose by viscosity, in proportion to frequency."""

    KIND = "viscous_layer"
    ID = "layer_damping"
    FAMILY = "pad law"
    ALTERNATIVES = ("layer_damping", "pad_frequency")

    equal_Hz: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Where the loss equals the nominal by strength: the lower, the more is lost above."""
        return cls(size(random, strength, 160.0, 90.0, 40.0))

    def apply(self, plan: Plan) -> None:
        """Replace the loss."""
        before = plan.track.springs["pad"]

        def law(f: Reals, t: float) -> Complexes:
            value = before(f, t)
            return np.asarray(value.real + 1j * value.imag * f / self.equal_Hz)

        plan.track.springs["pad"] = law

    @property
    def place(self) -> dict[str, Any]:
        """All fasteners."""
        return {"joint": "pad", "x_m": None}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"pads: a dashpot instead of hysteretic loss, equal at {self.equal_Hz:g} Hz"
