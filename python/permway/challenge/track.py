"""The track: beams, links between them, and their laws."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from permway.challenge.beams import Complexes, Reals, Section

Location = tuple[str, float]
"""Body and x, m."""

Matrix = Callable[[Reals, float], Complexes]
"""Dynamic stiffness (F, n, n) of n points, of frequencies (Hz) and a temperature (degrees Celsius)."""

Scalar = Callable[[Reals, float], Complexes]
"""Complex stiffness (F,), N/m, of frequencies and a temperature."""

BODIES = ("rail", "slab", "base", "girder", "cable")
TOUCH_M = 1e-4


@dataclass(frozen=True)
class Beam:
    """A body that bends.

    Parameters
    ----------
    section : Section
    start, stop : float
        m.
    breaks : tuple of float
        Where it is cut through; a link at a break holds the part before it.
    endless : bool
        Whether it goes on to both sides.
    stretches : tuple of (float, float, float, float)
        From, to, factor on the bending stiffness, factor on the mass.
    tension : float
        N.
    viscous : (float, float, float)
        Losses beside the section's: in proportion to mass (1/s) and to stiffness (s), and by dashpots against the
        slope (N s).
    """

    section: Section
    start: float
    stop: float
    breaks: tuple[float, ...] = ()
    endless: bool = False
    stretches: tuple[tuple[float, float, float, float], ...] = ()
    tension: float = 0.0
    viscous: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def part(self, left: float, right: float) -> Section:
        """The section of an element."""
        section = self.section
        for start, stop, bending, mass in self.stretches:
            if start - TOUCH_M < left and right < stop + TOUCH_M:
                section = replace(section, bending=section.bending * bending, mass=section.mass * mass)
        return section


@dataclass(frozen=True)
class Link:
    """What ties points to each other or to the ground.

    Parameters
    ----------
    locations : tuple of Location
        Points; near each other along x, or the bandwidth suffers.
    law : str
        Name of a law in the track's `laws`.
    scale : float or complex
        Factor on the law.
    after : tuple of bool
        At a break: whether the point is on the part behind it. Empty for before.
    """

    locations: tuple[Location, ...]
    law: str
    scale: complex = 1.0
    after: tuple[bool, ...] = ()


@dataclass
class Track:
    """Bodies, links and laws, which effects may alter before anything is solved.

    `springs` are the layers' complex stiffnesses by name, of which `laws` are made.
    """

    beams: dict[str, Beam]
    step_m: float
    links: list[Link] = field(default_factory=list)
    laws: dict[str, Matrix] = field(default_factory=dict)
    springs: dict[str, Scalar] = field(default_factory=dict)

    def stations(self, layer: str) -> list[int]:
        """Places in `links` of a layer's joints."""
        return [index for index, link in enumerate(self.links) if link.law == layer]

    def scale(self, layer: str, factor: Callable[[float], float]) -> None:
        """Multiply a layer's joints by a factor of x."""
        for index in self.stations(layer):
            link = self.links[index]
            self.links[index] = replace(link, scale=link.scale * factor(link.locations[0][1]))

    def stretch(self, body: str, stretch: tuple[float, float, float, float]) -> None:
        """Change a body's section from place to place."""
        beam = self.beams[body]
        self.beams[body] = replace(beam, stretches=(*beam.stretches, stretch))

    def cut(self, body: str, places: Sequence[float]) -> None:
        """Cut a body through."""
        beam = self.beams[body]
        self.beams[body] = replace(beam, breaks=tuple(sorted({*beam.breaks, *places})))


def spring(law: Scalar) -> Matrix:
    """Two points tied by a complex stiffness (F,)."""
    pattern = np.array([[1.0, -1.0], [-1.0, 1.0]])
    return lambda f, t: law(f, t)[:, None, None] * pattern


def grounded(law: Scalar) -> Matrix:
    """One point held by a complex stiffness (F,)."""
    return lambda f, t: law(f, t)[:, None, None]
