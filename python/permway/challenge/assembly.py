"""The line of a layout as finite elements, with nothing concealed in it."""

from __future__ import annotations

import numpy as np

from permway.challenge.beams import Complexes, Reals, Section
from permway.challenge.layout import Layout, Values
from permway.challenge.track import Beam, Link, Scalar, Track, grounded, spring

PARTS = 4
"""Elements to a fastener bay, at least."""


def assemble(layout: Layout, values: Values) -> Track:
    """Rail, slabs, base and girders with fasteners, mortar, sliding layer and bearings.

    Slabs are as long as spans. Mortar's and sliding layer's stiffness are totals over the deck; each station has
    the share of the length between the middles of its bays, so that the first and the last have half.
    """
    length = layout.length_m
    piers = tuple(round(i * layout.span_m, 6) for i in range(1, layout.spans))
    reach = layout.approach_m + layout.spacing_m
    track = Track(
        beams={
            "rail": Beam(_rail(values), -reach, length + reach, endless=True),
            "slab": Beam(_euler(values, "slab"), 0.0, length, breaks=piers),
            "base": Beam(_euler(values, "base"), 0.0, length),
            "girder": Beam(_euler(values, "girder"), 0.0, length, breaks=piers),
        },
        step_m=layout.spacing_m / PARTS,
    )
    for layer in ("pad", "mortar", "sliding", "bearing"):
        track.springs[layer] = lossy(**values[layer])

    def named(layer: str) -> Scalar:
        return lambda f, t: track.springs[layer](f, t)

    track.laws = {layer: spring(named(layer)) for layer in ("pad", "mortar", "sliding")}
    track.laws |= {"approach": grounded(named("pad")), "bearing": grounded(named("bearing"))}
    deck = layout.deck
    track.links += [Link((("rail", x),), "approach") for x in layout.approaches]
    track.links += [Link((("rail", x), ("slab", x)), "pad") for x in deck]
    share = np.full(len(deck), 1.0 / (len(deck) - 1))
    share[[0, -1]] *= 0.5
    for layer, upper, lower in (("mortar", "slab", "base"), ("sliding", "base", "girder")):
        track.links += [
            Link(((upper, x), (lower, x)), layer, float(part)) for x, part in zip(deck, share, strict=True)
        ]
    for span in range(layout.spans):
        ends = (round(span * layout.span_m, 6), round((span + 1) * layout.span_m, 6))
        track.links.append(Link((("girder", ends[0]),), "bearing", after=(span > 0,)))
        track.links.append(Link((("girder", ends[1]),), "bearing"))
    return track


def lossy(k: float, eta: float, viscous_at_Hz: float | None = None) -> Scalar:
    """A stiffness k (1 + i eta) at all frequencies, or one with a dashpot that loses as much at one of them."""

    def law(frequency_Hz: Reals, _: float) -> Complexes:
        share = 1.0 if viscous_at_Hz is None else frequency_Hz / viscous_at_Hz
        return np.full(frequency_Hz.shape, k) + 1j * k * eta * share

    return law


def _rail(values: Values) -> Section:
    rail = values["rail"]
    return Section(
        bending=rail["E"] * rail["I"],
        mass=rail["rho"] * rail["A"],
        shear=rail["kappa"] * rail["G"] * rail["A"],
        rotary=rail["rho"] * rail["I"],
        loss=rail["eta"],
    )


def _euler(values: Values, body: str) -> Section:
    beam = values[body]
    return Section(bending=beam["E"] * beam["I"], mass=beam["rho"] * beam["A"], loss=beam["eta"])
