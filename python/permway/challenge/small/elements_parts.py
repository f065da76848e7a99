"""What effects of the finite elements' line share: how one is made, and what parts a layout has."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from permway.challenge.effects.fasteners import resonator
from permway.challenge.small.concealed import Concealed, displaced
from permway.challenge.small.elements_line import Line, line_of
from permway.challenge.small.layouts import Layout
from permway.challenge.track import Scalar

Draw = Callable[[np.random.Generator, Layout, float], Concealed | None]
"""From random numbers, a layout and a place (m) to an effect; None if the layout has no such part."""


BED = {"ballast": "ballast", "slab": "mortar"}


GIRDER = {"deck": "deck", "slab": "girder", "beam": "beam"}


BEARING = {"deck": "bearing", "slab": "bearing", "beam": "support"}


Number = Callable[[float], dict[str, float]]


def made(
    name: str | None,
    family: str,
    apply: Callable[[Line, Mapping[str, float]], None],
    at: Number,
    place: Mapping[str, Any],
    *,
    scales: bool = True,
    words: tuple[str, ...] = (),
    kind: str = "",
) -> Concealed:
    """An effect of the line that changes it by parameters at a share."""

    def change(line: Line, share: float) -> Line:
        apply(line, at(share))
        return line

    return Concealed(
        id=name,
        kind=f"elements: {kind or name}",
        family=family,
        domain="path",
        change=change,
        parameters=at,
        place=lambda _: place,
        scales=scales,
        words=words,
        mechanical=kind or str(name),
    )


def sized(values: Mapping[str, float], size: str, none: float) -> Number:
    """Parameters of which one is the size, moved towards nothing."""
    return lambda share: {**values, size: displaced(values[size], none, share)}


def pad_of(layout: Layout) -> str | None:
    """The law of a layout's fasteners."""
    return "pad" if layout.name in ("deck", "ballast", "slab") else None


def bed_of(layout: Layout) -> str | None:
    """The law of a layout's bed."""
    return BED.get(layout.name)


def rubber_of(layout: Layout) -> str | None:
    """The law of a layout's rubber."""
    return "pad" if layout.name != "beam" else None


def stations_of(layout: Layout, law: str) -> list[float]:
    """Places of the joints of a law, m."""
    return line_of(layout.line).stations[law]


def resonator_of(mass: float, frequency_Hz: float, loss: float) -> Scalar:
    """What a mass on a spring makes a point feel, N/m."""
    block = resonator(mass, frequency_Hz, loss)
    return lambda f, t: np.asarray(block(f, t)[:, 0, 0])
