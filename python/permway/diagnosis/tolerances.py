"""Which parameters of a campaign lie so far from what is stated that the tolerances cannot be right."""

from __future__ import annotations

from collections.abc import Mapping

from scipy.special import ndtri

from permway.diagnosis.verdict_parts import Moved

CHANCE = 0.0455
"""Share of campaigns with right tolerances in which some parameter lies farther out than the limit.

It is that of two standard deviations, which a tolerance is: the limit of a single parameter is its tolerance. Of 5
parameters the limit is 2.6, of 36 it is 3.2 standard deviations. Halved: 2.3 of one, 2.8 of 5, and fewer wrong
values are reported. Doubled: 1.7 of one, 2.4 of 5, and one right campaign in eleven has a value reported."""


def limit(count: int) -> float:
    """Standard deviations within which all of so many parameters lie, but for :data:`CHANCE`."""
    return -float(ndtri(0.5 * CHANCE / max(1, count)))


def outside(moved: Mapping[str, Moved]) -> tuple[str, ...]:
    """Names of the parameters beyond the limit, the farthest first."""
    most = limit(len(moved))
    found = [name for name, one in moved.items() if abs(one.z) > most]
    return tuple(sorted(found, key=lambda name: -abs(moved[name].z)))
