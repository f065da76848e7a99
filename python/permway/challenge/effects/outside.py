"""Mechanisms that are in no catalogue."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from permway.challenge.beams import Complexes, Reals, Section
from permway.challenge.effects.base import Effect, Site, Strength, between, inside, interval, size, three
from permway.challenge.plan import Plan
from permway.challenge.track import Beam, Link, Scalar, grounded, spring


@dataclass(frozen=True)
class Inerter(Effect):
    """A force proportional to the relative acceleration of slab and girder."""

    KIND = "inerter"
    FAMILY = "inertia between bodies"
    WORDS = ("inertance",)

    x_m: float
    inertance_kg: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Inertance by strength."""
        layout = site.layout
        x = layout.station(round(layout.bays * float(random.uniform(0.15, 0.85))))
        return cls(x, size(random, strength, 100.0, 350.0, 1500.0))

    def apply(self, plan: Plan) -> None:
        """Tie slab and girder by it."""
        plan.track.laws["inerter"] = spring(_inertia(self.inertance_kg))
        plan.track.links.append(Link((("slab", self.x_m), ("girder", self.x_m)), "inerter"))

    @property
    def place(self) -> dict[str, Any]:
        """Where it is."""
        return {"joint": "slab to girder", "x_m": [self.x_m, self.x_m]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"an inerter of {self.inertance_kg:g} kg between slab and girder at {self.x_m:g} m"


@dataclass(frozen=True)
class RailInerter(Effect):
    """Inerters between rail and slab, over a stretch of fasteners."""

    KIND = "rail_inerter"
    FAMILY = "inertia between bodies"
    WORDS = ("inertance",)

    stretch_m: tuple[float, float]
    inertance_kg: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Inertance by strength."""
        return cls(interval(random, site, int(random.integers(6, 16))), size(random, strength, 3.0, 10.0, 40.0))

    def apply(self, plan: Plan) -> None:
        """Put one beside each pad there."""
        plan.track.laws["inerter"] = spring(_inertia(self.inertance_kg))
        for x in plan.layout.deck:
            if inside(x, self.stretch_m):
                plan.track.links.append(Link((("rail", x), ("slab", x)), "inerter"))

    @property
    def place(self) -> dict[str, Any]:
        """The stretch."""
        return {"joint": "rail to slab", "x_m": list(self.stretch_m)}

    @property
    def mechanical(self) -> str:
        """In words."""
        return (
            f"an inerter of {self.inertance_kg:g} kg beside each pad from {self.stretch_m[0]:g} to "
            f"{self.stretch_m[1]:g} m"
        )


@dataclass(frozen=True)
class NegativeStrip(Effect):
    """A strip under the girder that pushes it the further away the further it has gone."""

    KIND = "negative_strip"
    FAMILY = "negative stiffness to ground"
    WORDS = ("spring of -",)

    stretch_m: tuple[float, float]
    total_N_per_m: float
    loss: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Stiffness by strength, less than the girder's own (about 7e8 N/m at mid-span)."""
        stretch = interval(random, site, int(random.integers(4, 12)), margin=site.layout.bays // 5)
        return cls(stretch, -size(random, strength, 6e7, 1.3e8, 2.5e8), between(random, 0.02, 0.2))

    def apply(self, plan: Plan) -> None:
        """Share it out over the stations there."""
        places = [x for x in plan.layout.deck if inside(x, self.stretch_m)]
        value = self.total_N_per_m / len(places) * (1.0 - 1j * self.loss)
        plan.track.laws["strip"] = grounded(lambda f, _: np.full(f.shape, value))
        plan.track.links += [Link((("girder", x),), "strip") for x in places]

    @property
    def place(self) -> dict[str, Any]:
        """The stretch."""
        return {"joint": "girder to ground", "x_m": list(self.stretch_m)}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"a negative stiffness of {self.total_N_per_m:.3g} N/m in all under the girder"


@dataclass(frozen=True)
class Cable(Effect):
    """A tight cable along the girder, on posts: a second beam with waves of its own."""

    KIND = "cable"
    FAMILY = "second beam"
    WORDS = (
        "resonator",
        "rod",
        "beam",
    )

    stretch_m: tuple[float, float]
    mass_kg_per_m: float
    tension_N: float
    post_bays: int

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Mass by strength; the first resonance between posts is drawn, the tension follows."""
        layout = site.layout
        post_bays = int(random.integers(4, 8))
        fields = min(int(random.integers(3, 7)), (layout.bays - 6) // post_bays)
        stretch = _posts(random, site, fields, post_bays)
        mass = size(random, strength, 150.0, 400.0, 900.0)
        first = between(random, 8.0, 40.0)
        tension = mass * (2.0 * post_bays * layout.spacing_m * first) ** 2
        return cls(stretch, mass, three(tension), post_bays)

    def apply(self, plan: Plan) -> None:
        """Add the beam, its ends and posts on stiff springs."""
        start, stop = self.stretch_m
        section = Section(bending=2.0e3, mass=self.mass_kg_per_m, loss=0.03)
        plan.track.beams["cable"] = Beam(section, start, stop, tension=self.tension_N)
        plan.track.laws["post"] = spring(lambda f, _: np.full(f.shape, 5.0e8 * (1.0 + 0.05j)))
        places = [x for x in plan.layout.deck if start - 1e-6 < x < stop + 1e-6][:: self.post_bays]
        plan.track.links += [Link((("girder", x), ("cable", x)), "post") for x in places]

    @property
    def place(self) -> dict[str, Any]:
        """The stretch."""
        return {"body": "girder", "x_m": list(self.stretch_m)}

    @property
    def mechanical(self) -> str:
        """In words."""
        return (
            f"a cable of {self.mass_kg_per_m:g} kg/m under {self.tension_N:.3g} N on posts on the girder from "
            f"{self.stretch_m[0]:g} to {self.stretch_m[1]:g} m"
        )


def _inertia(mass: float) -> Scalar:
    return lambda f, _: np.asarray(-mass * (2.0 * np.pi * f) ** 2, dtype=np.complex128)


def _posts(random: np.random.Generator, site: Site, fields: int, bays: int) -> tuple[float, float]:
    layout = site.layout
    start = int(random.integers(2, layout.bays - fields * bays - 1))
    return layout.station(start), layout.station(start + fields * bays)


@dataclass(frozen=True)
class MortarDelay(Effect):
    """Mortar that waves need time to cross, as a soft thick layer: it delays what it passes on."""

    KIND = "mortar_delay"
    FAMILY = "delay"
    WORDS = (
        "rod",
        "delay",
    )

    stretch_m: tuple[float, float]
    delay_s: float
    softer: float
    loss: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Delay and length by strength; the layer's static stiffness is a small part of the mortar's."""
        delay = size(random, strength, 5e-4, 1e-3, 2e-3)
        bays = {"weak": 2, "medium": 4, "strong": 10}[strength]
        return cls(interval(random, site, bays), delay, between(random, 5e-3, 2e-2), between(random, 0.1, 0.3))

    def apply(self, plan: Plan) -> None:
        """Replace the mortar there by a rod whose waves take that long, fixed to slab and base."""
        mortar, track = plan.track.springs["mortar"], plan.track

        def rod(f: Reals, t: float) -> Complexes:
            turn = 2.0 * np.pi * f * self.delay_s / np.sqrt(1.0 + 1j * self.loss)
            static = mortar(f, t).real * self.softer * (1.0 + 1j * self.loss)
            block = np.empty((f.size, 2, 2), dtype=np.complex128)
            block[:, 0, 0] = block[:, 1, 1] = static * turn / np.tan(turn)
            block[:, 0, 1] = block[:, 1, 0] = -static * turn / np.sin(turn)
            return block

        track.laws["rod"] = rod
        for index in track.stations("mortar"):
            if inside(track.links[index].locations[0][1], self.stretch_m):
                track.links[index] = replace(track.links[index], law="rod")

    @property
    def place(self) -> dict[str, Any]:
        """The stretch."""
        return {"joint": "mortar", "x_m": list(self.stretch_m)}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"mortar delays by {1e3 * self.delay_s:g} ms from {self.stretch_m[0]:g} to {self.stretch_m[1]:g} m"


@dataclass(frozen=True)
class FractionalGround(Effect):
    """The girder leans on the ground by a force between a spring's and a dashpot's."""

    KIND = "fractional_ground"
    FAMILY = "damping to ground"
    WORDS = ("springpot",)

    x_m: float
    order: float
    stiffness_N_per_m: float
    reference_Hz: float

    @classmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Stiffness at the reference by strength."""
        layout = site.layout
        x = layout.station(round(layout.bays * float(random.uniform(0.2, 0.8))))
        stiffness = size(random, strength, 1e8, 2.5e8, 6e8)
        return cls(x, round(float(random.uniform(0.4, 0.9)), 2), stiffness, between(random, 8.0, 25.0))

    def apply(self, plan: Plan) -> None:
        """Hold the girder there."""
        plan.track.laws["lean"] = grounded(
            lambda f, _: np.asarray(self.stiffness_N_per_m * (1j * f / self.reference_Hz) ** self.order)
        )
        plan.track.links.append(Link((("girder", self.x_m),), "lean"))

    @property
    def place(self) -> dict[str, Any]:
        """Where it leans."""
        return {"joint": "girder to ground", "x_m": [self.x_m, self.x_m]}

    @property
    def mechanical(self) -> str:
        """In words."""
        return f"a springpot of order {self.order:g} from the girder to the ground at {self.x_m:g} m"
