"""What every concealed effect is."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Literal, Self

import numpy as np

from permway.challenge.layout import Layout, Tests
from permway.challenge.plan import Plan

Strength = Literal["weak", "medium", "strong"]
Domain = Literal["path", "irregularity", "vehicle", "measurement"]
STRENGTHS: tuple[Strength, ...] = ("weak", "medium", "strong")


@dataclass(frozen=True)
class Site:
    """Where an effect may be: layout and tests."""

    layout: Layout
    tests: Tests


@dataclass(frozen=True)
class Effect(ABC):
    """One effect with its parameters; subclasses name them as fields.

    Attributes
    ----------
    KIND : str
        Its name here.
    ID : str or None
        Its entry in the catalogue; None for what is in no catalogue.
    FAMILY, DOMAIN : str
    ALTERNATIVES : tuple of str
        Entries that the data may hardly distinguish from it.
    TEMPERATURES : int
        Hammer tests at different temperatures that it needs.
    WORDS : tuple of str
        Of an effect of no catalogue, words of which a right description of its mechanics uses one.
    FADES : tuple of (parameter, float)
        Parameters that make it strong or weak, and their value where there is nothing: 0, 1 or infinity. Empty
        where it is there or not.
    """

    KIND: ClassVar[str]
    ID: ClassVar[str | None] = None
    FAMILY: ClassVar[str]
    DOMAIN: ClassVar[Domain] = "path"
    ALTERNATIVES: ClassVar[tuple[str, ...]] = ()
    TEMPERATURES: ClassVar[int] = 1
    WORDS: ClassVar[tuple[str, ...]] = ()
    FADES: ClassVar[tuple[tuple[str, float], ...]] = ()

    @classmethod
    @abstractmethod
    def draw(cls, random: np.random.Generator, strength: Strength, site: Site) -> Self:
        """Draw its parameters."""

    @abstractmethod
    def apply(self, plan: Plan) -> None:
        """Put it into a plan."""

    @property
    @abstractmethod
    def mechanical(self) -> str:
        """What it is, in words."""

    @property
    def place(self) -> dict[str, Any]:
        """Where it is: body or joint, x from and to (m), channels."""
        return {}

    def faded(self, share: float) -> Self:
        """The same effect, weaker: with a share of 1 as it is, towards 0 as if it were not.

        Parameters
        ----------
        share : float
            Above 0, at most 1.
        """
        return replace(self, **{name: _faded(getattr(self, name), none, share) for name, none in self.FADES})

    def truth(self) -> dict[str, Any]:
        """Its entry in a truth file."""
        return {
            "id": self.ID,
            "kind": self.KIND,
            "family": self.FAMILY,
            "domain": self.DOMAIN,
            "place": self.place,
            "parameters": {item.name: getattr(self, item.name) for item in fields(self)},
            "mechanical": self.mechanical,
            "alternatives": list(self.ALTERNATIVES),
            "words": list(self.WORDS),
        }


def _faded(value: float, none: float, share: float) -> float:
    """A value moved towards what it is where there is nothing: a factor by its logarithm."""
    if none == 1.0:
        return float(value**share)
    return value * share if none == 0.0 else value / share


def size(random: np.random.Generator, strength: Strength, weak: float, medium: float, strong: float) -> float:
    """A value of a strength, with a scatter of about 10 %, to three digits."""
    value = {"weak": weak, "medium": medium, "strong": strong}[strength] * float(
        np.exp(0.1 * random.standard_normal())
    )
    return three(value)


def between(random: np.random.Generator, low: float, high: float) -> float:
    """A value between two, equally likely in its logarithm, to three digits."""
    return three(float(np.exp(random.uniform(np.log(low), np.log(high)))))


def three(value: float) -> float:
    """Three significant digits."""
    return float(f"{value:.3g}")


def interval(random: np.random.Generator, site: Site, bays: int, *, margin: int = 4) -> tuple[float, float]:
    """From and to of a stretch of some bays, each halfway between two stations of the deck."""
    layout = site.layout
    last = layout.bays - margin - bays
    start = int(random.integers(margin, last + 1))
    half = 0.5 * layout.spacing_m
    return round(layout.station(start) - half, 4), round(layout.station(start + bays) - half, 4)


def inside(x: float, stretch: tuple[float, float]) -> bool:
    """Whether a place lies in a stretch."""
    return stretch[0] <= x <= stretch[1]
