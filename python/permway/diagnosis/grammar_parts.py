"""More or less of what joints have: of one, of those of a stretch, or of those that a first look says are lost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from permway.diagnosis.catalogue._interval import spacing_of, weakened
from permway.diagnosis.catalogue._loss import first_look
from permway.diagnosis.elements import PART, Values, coordinate_of
from permway.diagnosis.grammar_made import STRETCHES, hypothesis_of, over_joints
from permway.diagnosis.hypothesis import Hypothesis, Situation, Where
from permway.diagnosis.spot import Found
from permway.recordings.campaign import Campaign

SHARES = (0.25, -0.25, -0.75)
"""That a part of one joint's law is looked for with."""


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
