"""Joints of a layer that carry little or nothing over a stretch: the hypotheses of any layer."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._interval import span_of, stations_of, weakened
from permway.diagnosis.catalogue._roles import spacing
from permway.diagnosis.fit import Free
from permway.diagnosis.glance import Glance
from permway.diagnosis.hypothesis import Hypothesis, Situation, Where, between_free, linear_free
from permway.diagnosis.recalibrate import UNFIT
from permway.diagnosis.spot import Found

LONGEST = 12.0
"""Of a stretch, in spacings."""

LOOKED, CENTRES, BEST = 7, 3, 2
"""Joints that a stretch is made of in the first look, at most, places that are looked at, and stretches told."""

FURTHER = (1, 2, 3)
"""Joints that an end of a stretch is moved by: one more may explain no more where three do."""

LEFT = (0.05, 0.001)
"""Of the stiffness, in the first look: a twentieth of a stiff bed still carries."""

LADDER = (0.001, 0.01, 0.05, 0.15, 0.3, 0.5, 0.7, 0.85)
"""Of the stiffness, along which the best stretch is followed: with another part left others explain more."""

HALF, EVERY = 0.5, 2
"""What joints all along keep, and every which is looked at, where the scan may lead astray."""

LONG, KEPT = 6, (0.4, 0.1, 0.01)
"""Joints of the stretches that a search begins from, at most, and what they keep: a fit reaches twice as long
ones, and shares between."""

TELLING = 0.4
"""Share of the most telling spot's surplus that a joint of the law must have for a first look."""

_Stretch = tuple[int, int, float]
"""First and last joint, and what is left."""

SURPLUS = 50.0
"""Of the law's most telling spot, below which a loss is small, and gradients lead to it."""


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
        Where to look if the scan names no joint of the law, m.
    """
    x = stations_of(situation.campaign.model.line, law)
    taken, looked = first_look(situation, law, places)
    for found in looked:
        yield _hypothesis(law, x, found[0], found, entry, family)
    telling = _telling(situation, situation.joints(law, most=1))
    for centre in [] if telling and looked else taken[:most]:
        yield _hypothesis(law, x, centre, None, entry, family)


def stretches(law: str, x: Reals, entry: str, family: str) -> Iterator[Hypothesis]:
    """Every stretch of up to :data:`LONG` neighbouring joints of a law, with each share of :data:`KEPT` left.

    Parameters
    ----------
    law : str
    x : ndarray, shape (J,)
        Places of its joints, ascending.
    entry, family : str
    """
    for first in range(x.size):
        for last in range(first, min(first + LONG, x.size)):
            ends = float(x[first]), float(x[last])
            found = _hypothesis(law, x, 0.5 * (ends[0] + ends[1]), (*ends, KEPT[0]), entry, family)
            yield replace(found, starts=tuple((0.0, 0.0, float(ndtri(left))) for left in KEPT))


def first_look(
    situation: Situation, law: str, places: Sequence[float] = ()
) -> tuple[list[float], list[tuple[float, float, float]]]:
    """Telling places of a law that are not neighbours, m, and the stretches whose loss explains most.

    Parameters
    ----------
    situation : Situation
    law : str
    places : sequence of float
        Where to look if the scan names no joint of the law, m.

    Returns
    -------
    list of float, list of (float, float, float)
        Places, and of each stretch its first and last joint, m, and what is left of the stiffness; no stretch if
        the law tells little, or no loss explains anything.
    """
    step = spacing(stations_of(situation.campaign.model.line, law))
    told = situation.joints(law, most=40)
    taken: list[float] = []
    for centre in [f.spot.x_m[0] for f in told] or places:
        if all(abs(centre - other) >= 4.0 * step for other in taken):
            taken.append(centre)
    telling = _telling(situation, told)
    # About a base that does not fit the scan of slopes may tell of what bent it.
    bent = bool(situation.found) and situation.fit.heat > UNFIT
    centres = taken[:CENTRES] if telling else []
    return taken, _looked(situation, law, centres, everywhere=bent) if telling or bent else []


def _telling(situation: Situation, told: Sequence[Found]) -> bool:
    return bool(told) and told[0].surplus > max(TELLING * situation.found[0].surplus, SURPLUS)


def _hypothesis(
    law: str, x: Reals, centre: float, found: tuple[float, float, float] | None, entry: str, family: str
) -> Hypothesis:
    step = spacing(x)

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return weakened(campaign, law, values["centre_m"], values["length_m"], values["factor"])

    def locate(values: Mapping[str, float]) -> Where:
        return Where(what=law, x_m=span_of(x, values["centre_m"], values["length_m"], step))

    if found is None:
        middle, length, sigma = centre, 3.0 * step, 2.0 * step
        # Both ends midway between two joints, where the model follows them.
        starts = tuple((z, w, -0.8) for z, w in ((0.0, 0.0), (0.0, 1.0), (0.0, 2.0), (-0.25, -0.5), (0.25, -0.5)))
    else:
        # The first look has told the joints; what remains open is how far the stretch reaches between two.
        middle, length, sigma = 0.5 * (found[0] + found[1]), found[1] - found[0], 0.75 * step
        # As looked at, with more left, and with the outer joints changed by half.
        left = float(ndtri(found[2]))
        starts = ((0.0, 0.0, left), (0.0, 0.0, 0.5 * left), (0.0, 1.33, left), (0.0, -1.33, left))
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
        law=lambda v: f"{v['factor']:.2g} of the stiffness is left",
        size="factor",
        none=1.0,
    )


def _length(length: float, sigma: float, step: float) -> Free:
    made = linear_free("length_m", "m", length, sigma, 0.0, LONGEST * step)
    return replace(made, limits=(min(made.limits[0], 0.0), max(made.limits[1], 0.0)))


def _looked(
    situation: Situation, law: str, centres: Sequence[float], *, everywhere: bool
) -> list[tuple[float, float, float]]:
    """First and last joint of the stretches whose loss explains most, and what is left; none if no loss explains.

    All short stretches about each place, and the joint there alone by whatever it keeps; from the best of either
    on by a few joints more or less at an end, or by more or less that is left. What a few lost joints do shows
    beside them, too: the most telling place need not be among them. And every second joint by half, if asked for.
    """
    campaign, glance = situation.campaign, Glance(situation.fit)
    x = stations_of(campaign.model.line, law)
    known: dict[_Stretch, float] = {}

    def lost(first: int, last: int, left: float) -> Campaign:
        low, high = float(x[first]), float(x[last])
        return weakened(campaign, law, 0.5 * (low + high), high - low, left)

    def best_of(stretches: Sequence[_Stretch]) -> _Stretch:
        new = [one for one in stretches if one not in known]
        known.update(zip(new, glance.objectives([lost(*one) for one in new]), strict=True))
        return min(stretches, key=lambda one: known[one])

    def nearby(centre: float) -> list[_Stretch]:
        near = int(np.argmin(np.abs(x - centre)))
        firsts = range(max(0, near - LOOKED + 2), min(x.size, near + 2))
        return [
            (first, last, left)
            for first in firsts
            for last in range(max(first, near - 1), min(x.size, first + LOOKED))
            for left in LEFT
        ]

    def followed(best: _Stretch) -> _Stretch:
        first, last, left = best
        ends = [
            pair for k in (*FURTHER, *(-k for k in FURTHER)) for pair in ((first + k, last), (first, last + k))
        ]
        beside = [(start, stop, left) for start, stop in ends if 0 <= start <= stop < x.size]
        rung = LADDER.index(left)
        beside += [(first, last, other) for other in LADDER[max(0, rung - 1) : rung + 2] if other != left]
        better = best_of(beside)
        return followed(better) if known[better] < known[best] else best

    for centre in centres:
        followed(best_of(nearby(centre)))
        # By little that is left many joints about one that keeps half look better than that one.
        near = int(np.argmin(np.abs(x - centre)))
        followed(best_of([(near, near, left) for left in LADDER]))
    if everywhere:
        followed(best_of([(index, index, HALF) for index in range(0, x.size, EVERY)]))
    least = glance.objective(campaign)
    best: dict[tuple[int, int], float] = {}
    for first, last, left in sorted(known, key=lambda key: known[key]):
        if known[first, last, left] < least and len(best) < BEST:
            best.setdefault((first, last), left)
    return [(float(x[first]), float(x[last]), left) for (first, last), left in best.items()]
