"""Joints that carry less over a stretch, by the tool's own model."""

from __future__ import annotations

from typing import Any

import numpy as np

from permway.campaign.campaign import Campaign
from permway.challenge.small.concealed import Concealed, displaced
from permway.challenge.small.draws import log_between
from permway.diagnosis.catalogue._interval import span_of, stations_of, weakened
from permway.diagnosis.catalogue._roles import beds, carriers, laws_of, pads, spacing

FAMILY = "local loss of support"


def lost(random: np.random.Generator, campaign: Campaign, name: str, place_m: float) -> Concealed | None:
    """One to five neighbouring joints of a layer that keep part of their stiffness; None without such a layer.

    Parameters
    ----------
    random : Generator
    campaign : Campaign
    name : "fastener_loss" or "mortar_void"
    place_m : float
        The joint next to it is one of them.
    """
    line = campaign.model.line
    layers = pads(line) if name == "fastener_loss" else [b for b in beds(line) if b.upper in carriers(line)]
    if not layers:
        return None
    laws = laws_of(layers)
    law = laws[int(random.integers(len(laws)))]
    x = stations_of(line, law)
    count = int(random.integers(1, 6))
    near = int(np.argmin(np.abs(x - place_m)))
    first = int(np.clip(near - random.integers(count), 0, x.size - count))
    last = first + count - 1
    factor = log_between(random, 0.01, 0.3)
    centre, length = float(x[first] + x[last]) / 2.0, float(x[last] - x[first])

    def at(share: float) -> dict[str, float]:
        return {"centre_m": centre, "length_m": length, "factor": displaced(factor, 1.0, share)}

    def place(_: float) -> dict[str, Any]:
        low, high = span_of(x, centre, length, spacing(x))
        return {"joint": law, "x_m": [round(low, 4), round(high, 4)]}

    return Concealed(
        id=name,
        kind=f"catalogue: {name}",
        family=FAMILY,
        domain="path",
        change=lambda c, share: weakened(c, law, centre, length, at(share)["factor"]),
        parameters=at,
        place=place,
        mechanical=f"{count} joints of {law} about {centre:g} m carry less",
    )
