"""Masses on springs that were found twice at one place, or all along one body."""

from __future__ import annotations

from collections.abc import Sequence

from permway.diagnosis.hypothesis import Where
from permway.diagnosis.search import Finalist

RESONANCE, MASSES = ("frequency_Hz", "loss_factor"), ("mass_kg", "mass_share")
"""What a mass on a spring is known by."""

SPREAD = {"mass_share", *RESONANCE}
"""Of one all along a body."""

ONE_PLACE_M = 0.5
"""Between two effects that are at one place."""


def twice_of(accepted: Sequence[Finalist]) -> Finalist | None:
    """The heavier of two masses on springs that hang at one place, or all along one body."""
    for index, one in enumerate(accepted):
        for other in accepted[:index]:
            places = [f.hypothesis.locate(f.values) for f in (other, one)]
            alike = other.hypothesis.entry == one.hypothesis.entry and places[0].what == places[1].what
            for mass in MASSES:
                if alike and {mass, *RESONANCE} <= other.values.keys() and _at_one_place(places[0], places[1]):
                    return max(other, one, key=lambda f: f.values[mass])
    return None


def _at_one_place(first: Where, second: Where) -> bool:
    if first.x_m is None or second.x_m is None:
        return first.x_m is second.x_m
    return abs(first.x_m[0] - second.x_m[0]) < ONE_PLACE_M
