"""Effects of the load: supports that a train finds otherwise than a hammer does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, inside, interval, size
from permway.challenge.effects.fasteners import FASTENERS
from permway.challenge.plan import Plan
from permway.challenge.track import Track
from permway.challenge.under_train import Worked

TOE_LOAD_N = 2.0e4
"""What clips press on a pad without a train."""

PADS = ("pad", "approach")


def _pads(track: Track) -> Reals:
    """1 for every link that is a pad, 0 for others."""
    return np.array([1.0 if link.law in PADS else 0.0 for link in track.links])


@dataclass(frozen=True)
class PadPreload(Effect):
    """Pads that stiffen with a power of the load on them."""

    KIND = "pad_preload"
    ID = "pad_preload"
    FAMILY = "load-dependent pad"
    ALTERNATIVES = ("pad_preload", "pad_amplitude")
    FADES = (("exponent", 0.0),)

    exponent: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Exponent by strength: from 20 kN of the clips to some 45 under a wheel."""
        return cls(size(random, strength, 0.12, 0.3, 0.7))

    def apply(self, plan: Plan) -> None:
        """Let each pad be as stiff as its load makes it."""

        def support(track: Track, worked: Worked) -> Complexes:
            more = np.maximum(worked.carried, 0.0) * _pads(track) / TOE_LOAD_N
            return np.asarray((1.0 + more) ** self.exponent, dtype=np.complex128)

        plan.supports.append(support)

    @property
    def place(self) -> dict[str, Any]:
        """All fasteners."""
        return dict(FASTENERS)

    @property
    def mechanical(self) -> str:
        """In words."""
        return (
            f"pads stiffen with the power {self.exponent:g} of their load, {TOE_LOAD_N / 1e3:g} kN without a train"
        )


@dataclass(frozen=True)
class PadFriction(Effect):
    """Filled pads: part of their stiffness is friction, and goes as they are shaken (Berg 1998).

    Berg, Vehicle System Dynamics 30, 197-212: a non-linear rubber spring model for rail vehicle dynamics analysis.
    """

    KIND = "pad_friction"
    ID = "pad_amplitude"
    FAMILY = "load-dependent pad"

    share: float
    half_at_m: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Share of friction in the stiffness of a pad at rest by strength."""
        return cls(size(random, strength, 0.12, 0.3, 0.6), between(random, 1e-5, 6e-5))

    def apply(self, plan: Plan) -> None:
        """Take friction's share as it is at each pad's motion, as a sine of the same mean square."""

        def support(track: Track, worked: Worked) -> Complexes:
            left = berg(np.sqrt(2.0) * worked.shaken / self.half_at_m)
            return np.asarray(1.0 + _pads(track) * self.share * (left - 1.0))

        plan.supports.append(support)

    @property
    def place(self) -> dict[str, Any]:
        """All fasteners."""
        return dict(FASTENERS)

    @property
    def mechanical(self) -> str:
        """In words."""
        where = f"half of its largest force is reached at {1e6 * self.half_at_m:g} um"
        return f"pads: {self.share:g} of the stiffness is friction, {where}"


def berg(amplitude: Reals) -> Complexes:
    """Stiffness of Berg's friction at amplitudes over x2, over that at none; its imaginary part is lost.

    Parameters
    ----------
    amplitude : ndarray
        At or above 0.
    """
    x = np.maximum(amplitude, 1e-4)
    u = 0.5 * (np.sqrt(1.0 + x**2 + 6.0 * x) - 1.0 - x)
    lost = 2.0 * x - (1.0 + u) ** 2 * np.log1p(2.0 * x / (1.0 + u))
    return np.asarray(u / x + 2j * lost / (np.pi * x**2))


@dataclass(frozen=True)
class ClosingGap(Effect):
    """Slabs that lie hollow until a train presses them down."""

    KIND = "closing_gap"
    ID = "mortar_void"
    FAMILY = "local loss of support"
    ALTERNATIVES = ("fastener_loss", "mortar_void")

    stretch_m: tuple[float, float]
    open_factor: float
    gap_m: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Length by strength; a hammer does not close the gap."""
        bays = {"weak": 3, "medium": 5, "strong": 9}[strength]
        return cls(interval(random, site, bays), between(random, 2e-4, 1e-3), between(random, 2e-5, 5e-4))

    def apply(self, plan: Plan) -> None:
        """Open it; a train closes it where its weight presses the slab down so far."""
        plan.track.scale("mortar", lambda x: self.open_factor if inside(x, self.stretch_m) else 1.0)

        def support(track: Track, worked: Worked) -> Complexes:
            hollow = [
                link.law == "mortar" and inside(link.locations[0][1], self.stretch_m) for link in track.links
            ]
            closed = np.array(hollow) & (worked.would_press > self.gap_m)
            return np.where(closed, 1.0 / self.open_factor, 1.0).astype(np.complex128)

        plan.supports.append(support)

    @property
    def place(self) -> dict[str, Any]:
        """The stretch."""
        return {"joint": "mortar", "x_m": list(self.stretch_m)}

    @property
    def mechanical(self) -> str:
        """In words."""
        first, last = self.stretch_m
        return (
            f"mortar between {first:g} and {last:g} m is open by {1e3 * self.gap_m:.3g} mm until a train closes it"
        )
