"""Joints that answer otherwise the harder they are driven: linear under each condition, and other between them.

What a nonlinear joint does to a response at its own frequency stands as a linear one, given level by level: see
Krylov and Bogoliubov (1947), Introduction to Non-Linear Mechanics, chapter 10.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._pads import STIFFNESS, factors, keys_of, measured_under, with_factors
from permway.diagnosis.catalogue._roles import laws_of, layers
from permway.diagnosis.hypothesis import Situation

Law = Callable[[float], tuple[float, float]]
"""From a level over the largest to factors on stiffness, and on loss over stiffness."""


def levels(campaign: Campaign) -> dict[str, float]:
    """Level over the largest, of each condition that states one; empty where fewer than two differ."""
    stated = {c.name: c.level for c in measured_under(campaign) if c.level is not None}
    if len(set(stated.values())) < 2:
        return {}
    largest = max(stated.values())
    return {name: level / largest for name, level in stated.items()}


def driven(situation: Situation) -> Iterator[str]:
    """Laws of joints that may answer to the level: those whose numbers can be scaled."""
    line = situation.campaign.model.line
    if levels(situation.campaign):
        yield from (name for name in laws_of(layers(line)) if keys_of(line.laws[name], STIFFNESS))


def answering(campaign: Campaign, name: str, law: Law) -> Campaign:
    """The campaign with a joint's law that is another under each condition with a level."""
    line = campaign.model.line
    return with_factors(
        campaign, {under: factors(line, name, *law(level)) for under, level in levels(campaign).items()}
    )
