"""Joints of a layer that carry little or nothing over a stretch: the hypotheses of any layer."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from scipy.special import ndtri

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._interval import span_of, stations_of, weakened
from permway.diagnosis.catalogue._roles import spacing
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Hypothesis, Situation, Where, between_free, linear_free

LONGEST = 12.0
"""Of a stretch, in spacings."""

LONG, KEPT = 6, (0.4, 0.1, 0.01)
"""Joints of the stretches that a search begins from, at most, and what they keep: a fit reaches twice as long
ones, and shares between."""


def local_loss(
    situation: Situation, law: str, entry: str, family: str, *, most: int = 2, places: Sequence[float] = ()
) -> Iterator[Hypothesis]:
    """At the most telling joints of a law that do not lie within a few spacings of each other.

    Parameters
    ----------
    situation : Situation
    law, entry, family : str
    most : int
        Number of hypotheses.
    places : sequence of float
        Where to look if the situation names no joint of the law, m.
    """
    x = stations_of(situation.campaign.model.line, law)
    step = spacing(x)
    taken: list[float] = []
    for centre in [at.x_m for at in situation.joints(law, most=40)] or places:
        if all(abs(centre - other) >= 4.0 * step for other in taken):
            taken.append(centre)
    for centre in taken[:most]:
        middle, sigma = centre, 2.0 * step
        # Both ends midway between two joints, where the model follows them.
        starts = tuple((z, w, -0.8) for z, w in ((0.0, 0.0), (0.0, 1.0), (0.0, 2.0), (-0.25, -0.5), (0.25, -0.5)))
        yield _hypothesis(law, x, middle, 3.0 * step, sigma, starts, entry, family)


def stretches(law: str, x: Reals, entry: str, family: str) -> Iterator[Hypothesis]:
    """Every stretch of up to :data:`LONG` neighbouring joints of a law, with each share of :data:`KEPT` left.

    Parameters
    ----------
    law : str
    x : ndarray, shape (J,)
        Places of its joints, ascending.
    entry, family : str
    """
    sigma = 0.75 * spacing(x)
    starts = tuple((0.0, 0.0, float(ndtri(left))) for left in KEPT)
    for first in range(x.size):
        for last in range(first, min(first + LONG, x.size)):
            low, high = float(x[first]), float(x[last])
            yield _hypothesis(law, x, 0.5 * (low + high), high - low, sigma, starts, entry, family)


def _hypothesis(
    law: str,
    x: Reals,
    middle: float,
    length: float,
    sigma: float,
    starts: tuple[tuple[float, ...], ...],
    entry: str,
    family: str,
) -> Hypothesis:
    step = spacing(x)

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return weakened(campaign, law, values["centre_m"], values["length_m"], values["factor"])

    def locate(values: Mapping[str, float]) -> Where:
        return Where(what=law, x_m=span_of(x, values["centre_m"], values["length_m"], step))

    free = (
        linear_free("centre_m", "m", middle, sigma, middle - 6.0 * step, middle + 6.0 * step),
        _length(length, sigma, step),
        between_free("factor", "1", 0.0, 1.0),
    )
    return Hypothesis(
        entry=entry,
        domain="path",
        family=family,
        free=free,
        amend=amend,
        locate=locate,
        starts=starts,
        law=lambda v: _words(x, span_of(x, v["centre_m"], v["length_m"], step), v["factor"]),
        size="factor",
        none=1.0,
    )


def _words(x: Reals, span: tuple[float, float], factor: float) -> str:
    """As an engineer says it: how many joints, and how much of their stiffness is gone."""
    count = int(((x >= span[0] - 1e-9) & (x <= span[1] + 1e-9)).sum())
    lost = 100.0 * (1.0 - factor)
    share = "more than 99 %" if lost > 99.0 else f"{lost:.2g} %"
    return (
        f"{count} joints have lost {share} of their stiffness"
        if count > 1
        else (f"one joint has lost {share} of its stiffness")
    )


def _length(length: float, sigma: float, step: float) -> Free:
    made = linear_free("length_m", "m", length, sigma, 0.0, LONGEST * step)
    return replace(made, limits=(min(made.limits[0], 0.0), max(made.limits[1], 0.0)))
