"""What a small campaign conceals: kinds of effect with stated shares, and how strong each is."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.graded import sought
from permway.challenge.small.concealed import Concealed
from permway.challenge.small.strength import Scale
from permway.errors import InputError, SolveError

SHARES: dict[str, float] = {"null": 0.2, "single": 0.5, "fault": 0.12, "several": 0.1, "outside": 0.08}
"""Of what is concealed: nothing, an effect, a fault of a channel, two or three, a mechanism of no catalogue."""

THREE = 0.3
"""Share of three effects among those of several."""

LEAST, MOST = 5.0, 1.0e4
"""Deviances that are drawn, evenly in their logarithm: from what no record shows to what stands far out."""

OFF = 1.5
"""Factor by which a deviance may be off what was drawn; else the effect cannot be so weak: another is drawn."""

TRIES = 12
"""Effects that are drawn until one is possible and shows at its largest size."""

FAULTS = ("sensor_gain", "sensor_polarity", "sensor_delay", "sensor_mounting", "noise_floor")

NoiseTells = Callable[[dict[str, float]], float]
"""Deviance of factors on the noise of sensors, by name."""

Chosen = list[tuple[Concealed, float, float]]
"""Effects, each with its share and its deviance alone."""


class Maker(Protocol):
    """What computes the records."""

    name: str
    base: list[Complexes]

    def responses(self, effects: Sequence[tuple[Concealed, float]]) -> list[Complexes]:
        """Of all records."""

    def slopes(self) -> list[list[Complexes]]:
        """One step away in each parameter."""

    def draw(self, random: np.random.Generator, name: str | None) -> Concealed | None:
        """An effect; None if there can be none of that name."""

    def in_detail(self, effects: Sequence[tuple[Concealed, float]]) -> tuple[Reals, Complexes]:
        """Lines and densities of the run."""


def draw_kind(random: np.random.Generator) -> str:
    """One of :data:`SHARES`."""
    return str(random.choice(list(SHARES), p=list(SHARES.values())))


def conceal(
    random: np.random.Generator, maker: Maker, scale: Scale, kind: str, names: Sequence[str], noise: NoiseTells
) -> Chosen:
    """Draw effects of a kind, each as strong as a deviance that is drawn for it.

    Parameters
    ----------
    random : Generator
    maker : Maker
    scale : Scale
    kind : str
        One of :data:`SHARES`.
    names : sequence of str
        Entries of the catalogue that may be tried.
    noise : callable
        Deviance of factors on the noise of sensors.
    """
    found: Chosen = []
    wanted = {"null": 0, "several": 2 + int(random.random() < THREE)}.get(kind, 1)
    families: set[str] = set()
    for _ in range(TRIES * wanted):
        if len(found) == wanted:
            break
        effect = _drawn(random, maker, kind, names)
        # Of one family two effects would be one to any diagnosis.
        if effect is None or effect.family in families:
            continue
        sized = _sized(random, maker, scale, effect, noise)
        if sized is not None and _together(maker, [*((e, share) for e, share, _ in found), (effect, sized[0])]):
            found.append((effect, *sized))
            families.add(effect.family)
    return found


def _together(maker: Maker, effects: Sequence[tuple[Concealed, float]]) -> bool:
    """Whether effects can act at once: a law that one replaces may be one that another has factors for."""
    try:
        maker.responses(effects)
    except (InputError, SolveError):
        return len(effects) < 2
    return True


def _drawn(random: np.random.Generator, maker: Maker, kind: str, names: Sequence[str]) -> Concealed | None:
    pool = FAULTS if kind == "fault" else tuple(name for name in names if name not in FAULTS or kind == "several")
    name = None if kind == "outside" else pool[int(random.integers(len(pool)))]
    try:
        return maker.draw(random, name)
    except (InputError, SolveError):
        # An entry of the catalogue may need what this layout has not.
        return None


def _sized(
    random: np.random.Generator, maker: Maker, scale: Scale, effect: Concealed, noise: NoiseTells
) -> tuple[float, float] | None:
    """A share and the deviance there; None if the effect hardly shows at its largest, or cannot be solved."""

    def weight(share: float) -> float:
        value = scale.deviance(maker.responses([(effect, share)])) + noise(dict(effect.noise(share)))
        if not math.isfinite(value):
            raise SolveError("no deviance")
        return value

    try:
        largest = weight(1.0)
        if largest < LEAST:
            return None
        if not effect.scales:
            return 1.0, largest
        target = float(np.exp(random.uniform(math.log(LEAST), math.log(min(MOST, largest)))))
        share, found = sought(weight, target)
        return (share, found) if abs(math.log(found / target)) < math.log(OFF) else None
    except (InputError, SolveError, np.linalg.LinAlgError):
        return None
