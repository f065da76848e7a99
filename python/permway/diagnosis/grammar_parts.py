"""Parts of what joints have: more or less of one, of a stretch, of those that a first look says are lost.

Or another law in place of a part of it, in a whole layer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_law
from permway.diagnosis.catalogue._interval import spacing_of, weakened
from permway.diagnosis.catalogue._loss import first_look
from permway.diagnosis.catalogue._roles import ROOM_C
from permway.diagnosis.elements import AT_HZ, PART, Values, coordinate_of
from permway.diagnosis.grammar_made import STRETCHES, hypothesis_of, over_joints
from permway.diagnosis.hypothesis import Hypothesis, Situation, Where, between_free
from permway.diagnosis.spot import Found
from permway.diagnosis.verdict import NOVEL
from permway.laws import Parallel, Scaled, Springpot
from permway.laws.base import Law

SHARES = (0.25, -0.25, -0.75)
"""That a part of one joint's law is looked for with."""

ORDERS = ((0.0, -1.5), (0.0, -0.5), (1.0, -1.0), (-1.0, 0.0))
"""Coordinates of share and order that a springpot in place of a part is looked for with: half by 0.08, say."""


def part_of_one(found: Found) -> Hypothesis:
    """More or less of what one joint has: of joints that are few, as bearings, a stretch has all."""
    law, x = found.spot.name, found.spot.x_m[0]

    def amend(campaign: Campaign, values: Values) -> Campaign:
        return weakened(campaign, law, x, 0.0, 1.0 + values["share"])

    made = hypothesis_of(PART, "beside one joint", PART.free(1.0, 1.0), Where(law, (x, x)), amend)
    return replace(made, starts=tuple((coordinate_of(share),) for share in SHARES))


def part(situation: Situation, found: Found) -> Hypothesis:
    """More or less of what the joints of a stretch have; of one, if the stretch is short."""

    def amend(campaign: Campaign, values: Values) -> Campaign:
        law, factor = found.spot.name, 1.0 + values["share"]
        return weakened(campaign, law, values["centre_m"], values["length_m"], factor)

    return replace(over_joints(situation, PART, found), amend=amend)


def parts_lost(situation: Situation, found: Found) -> Iterator[Hypothesis]:
    """As much less as a first look says, over the stretches whose loss explains most.

    What hardly holds bends a base so far that the scan tells of another layer, and no small change leads there.
    """
    law = found.spot.name
    step = spacing_of(situation.campaign.model.line, law)
    for first, last, left in first_look(situation, law)[1]:
        middle = 0.5 * (first + last)
        about = replace(found, spot=replace(found.spot, x_m=(middle, middle)))
        one = part(situation, about)
        share, length = coordinate_of(left - 1.0), (last - first) / step / STRETCHES[0] - 1.0
        yield replace(one, starts=((share, 0.0, length), (0.5 * share, 0.0, length)))


def springpot_instead(found: Found) -> Hypothesis:
    """A springpot in place of a share of what every joint of a layer has, as stiff at 100 Hz.

    Beside it, as elements are, it would ask its owner's stiffness to be as much less.
    """
    name = found.spot.name

    def amend(campaign: Campaign, values: Values) -> Campaign:
        law = campaign.model.line.laws[name]
        return with_law(campaign, name, partly_springpot(law, values["share"], values["order"]))

    return Hypothesis(
        entry=NOVEL,
        domain="path",
        family="springpot in place of a part of every joint of the layer",
        free=(between_free("share", "1", 0.0, 1.0), between_free("order", "1", 0.02, 0.98)),
        amend=amend,
        locate=lambda _: Where(name),
        starts=ORDERS,
        law=lambda v: (
            f"a springpot of order {v['order']:.2g} in place of {v['share']:.2g} of what every joint of "
            f"the layer has, as stiff at {AT_HZ:g} Hz"
        ),
        size="share",
        none=0.0,
    )


def partly_springpot(law: Law, share: float, order: float) -> Law:
    """A law of which a springpot has taken a share, of the same modulus at 100 Hz and 20 °C."""
    modulus = share * float(np.abs(law.complex(AT_HZ, ROOM_C)))
    springpot = Springpot(coefficient=modulus / float((2.0 * np.pi * AT_HZ) ** order), order=order)
    return Parallel(first=Scaled(law=law, factor=1.0 - share), second=springpot)
