"""Effects of girder, bearings and piers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.effects.base import Effect, Site, Strength, between, interval, size, three
from permway.challenge.effects.fasteners import resonator
from permway.challenge.plan import Plan
from permway.challenge.track import Link, grounded


@dataclass(frozen=True)
class DeckAttachment(Effect):
    """A mass on a spring, attached to the girder."""

    KIND = "attached_resonator"
    ID = "deck_attachment"
    FAMILY = "resonator"
    FADES = (("mass_kg", 0.0),)

    x_m: float
    mass_kg: float
    tuned_Hz: float
    loss: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Mass by strength; away from supports, where there would be no effect."""
        layout = site.layout
        span = int(random.integers(layout.spans)) + float(random.uniform(0.15, 0.85))
        x = layout.station(round(layout.bays * span / layout.spans))
        mass = size(random, strength, 2000.0, 6000.0, 16000.0)
        return cls(x, mass, between(random, 5.0, 80.0), between(random, 0.02, 0.08))

    def apply(self, plan: Plan) -> None:
        """Hang it on."""
        plan.track.laws["attachment"] = resonator(self.mass_kg, self.tuned_Hz, self.loss)
        plan.track.links.append(Link((("girder", self.x_m),), "attachment"))

    @property
    def place(self) -> dict[str, Any]:
        """Where it hangs."""
        return {"body": "girder", "x_m": [self.x_m, self.x_m]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return (
            f"a resonator of {self.mass_kg:g} kg at {self.tuned_Hz:g} Hz, loss factor {self.loss:g}, "
            f"on the girder at {self.x_m:g} m"
        )


@dataclass(frozen=True)
class GirderCrack(Effect):
    """The girder's section is weaker over a stretch."""

    KIND = "girder_crack"
    ID = "girder_crack"
    FAMILY = "girder"
    FADES = (("factor", 1.0),)

    stretch_m: tuple[float, float]
    factor: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """What is left of the bending stiffness by strength."""
        bays = int(random.integers(3, 8))
        margin = max(4, site.layout.bays // 6)
        return cls(interval(random, site, bays, margin=margin), size(random, strength, 0.85, 0.6, 0.25))

    def apply(self, plan: Plan) -> None:
        """Weaken it."""
        plan.track.stretch("girder", (*self.stretch_m, self.factor, 1.0))

    @property
    def place(self) -> dict[str, Any]:
        """The stretch."""
        return {"body": "girder", "x_m": list(self.stretch_m)}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"the girder keeps {self.factor:g} of E I from {self.stretch_m[0]:g} to {self.stretch_m[1]:g} m"


@dataclass(frozen=True)
class BearingStiffness(Effect):
    """One bearing is softer than the others."""

    KIND = "bearing"
    ID = "bearing_stiffness"
    FAMILY = "bearing"
    ALTERNATIVES = ("bearing_stiffness", "pier_soil")
    FADES = (("factor", 1.0),)

    bearing: int
    x_m: float
    factor: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """What is left of the stiffness by strength."""
        bearing = int(random.integers(2 * site.layout.spans))
        x = round((bearing + 1) // 2 * site.layout.span_m, 6)
        return cls(bearing, x, size(random, strength, 0.55, 0.3, 0.1))

    def apply(self, plan: Plan) -> None:
        """Scale that one."""
        index = plan.track.stations("bearing")[self.bearing]
        link = plan.track.links[index]
        plan.track.links[index] = replace(link, scale=link.scale * self.factor)

    @property
    def place(self) -> dict[str, Any]:
        """Where it stands."""
        return {"joint": "bearing", "x_m": [self.x_m, self.x_m]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"the bearing at {self.x_m:g} m has {self.factor:g} of the stiffness"


@dataclass(frozen=True)
class PierSoil(Effect):
    """Bearings stand on piers that move on soil."""

    KIND = "pier_soil"
    ID = "pier_soil"
    FAMILY = "bearing"
    ALTERNATIVES = ("bearing_stiffness", "pier_soil")
    FADES = (("soil_N_per_m", math.inf), ("soil_Ns_per_m", math.inf))

    pier_kg: float
    soil_N_per_m: float
    soil_Ns_per_m: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """The soil's stiffness by strength."""
        soil = size(random, strength, 3.0e10, 1.0e10, 3.0e9)
        pier = between(random, 8.0e4, 2.5e5)
        damping = three(2.0 * between(random, 0.08, 0.3) * float(np.sqrt(soil * pier)))
        return cls(pier, soil, damping)

    def apply(self, plan: Plan) -> None:
        """Put a pier on soil in series with each bearing."""
        bearing = plan.track.springs["bearing"]

        def law(f: Reals, t: float) -> Complexes:
            omega = 2.0 * np.pi * f
            below = self.soil_N_per_m + 1j * omega * self.soil_Ns_per_m - self.pier_kg * omega**2
            above = bearing(f, t)
            return np.asarray(above * below / (above + below))

        plan.track.springs["bearing"] = law

    @property
    def place(self) -> dict[str, Any]:
        """All bearings."""
        return {"joint": "bearing", "x_m": None}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"a pier of {self.pier_kg:g} kg on soil of {self.soil_N_per_m:.3g} N/m under each bearing"


@dataclass(frozen=True)
class SecondTrack(Effect):
    """The other track's mass on the girder, part of it on its pads."""

    KIND = "second_track"
    ID = "second_track"
    FAMILY = "girder"
    FADES = (("mass_kg_per_m", 0.0),)

    mass_kg_per_m: float
    sprung: float
    tuned_Hz: float
    loss: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Mass by strength: a girder has some 12 t/m."""
        mass = size(random, strength, 400.0, 1200.0, 3500.0)
        return cls(mass, between(random, 0.05, 0.3), between(random, 60.0, 250.0), between(random, 0.1, 0.3))

    def apply(self, plan: Plan) -> None:
        """Lay it on the girder at each station, with the share of the length between the middles of its bays."""
        spring = self.sprung * (2.0 * np.pi * self.tuned_Hz) ** 2 * (1.0 + 1j * self.loss)

        def law(f: Reals, _: float) -> Complexes:
            square = (2.0 * np.pi * f) ** 2
            sprung = spring * self.sprung * square / (spring - self.sprung * square)
            return np.asarray(-self.mass_kg_per_m * ((1.0 - self.sprung) * square + sprung))

        plan.track.laws["second_track"] = grounded(law)
        deck, spacing = plan.layout.deck, plan.layout.spacing_m
        for index, x in enumerate(deck):
            share = spacing * (0.5 if index in (0, len(deck) - 1) else 1.0)
            plan.track.links.append(Link((("girder", x),), "second_track", share))

    @property
    def place(self) -> dict[str, Any]:
        """The whole girder."""
        return {"body": "girder", "x_m": None}

    @property
    def mechanical(self) -> str:
        """In words."""
        return (
            f"a second track of {self.mass_kg_per_m:g} kg/m on the girder, {self.sprung:g} of it on pads at "
            f"{self.tuned_Hz:g} Hz"
        )
