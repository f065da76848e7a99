"""Mechanics of no catalogue: a spring, dashpot, springpot, Maxwell pair, inertance or standing rod at a place.

It ties two bodies that a layer ties, or a body to the ground. What fits is a description and no name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import fresh, with_joints
from permway.diagnosis.catalogue._roles import Layer, layers
from permway.diagnosis.elements import ELEMENTS, STANDING, Element
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free
from permway.diagnosis.verdict import NOVEL
from permway.model.bodies import Beam
from permway.model.joints import GROUND, Joints
from permway.model.segments import Segment

ID = NOVEL
DOMAIN: Domain = "path"
FAMILY = "no catalogue"

PRIOR = 0.05
"""Share of what is missing that no catalogue holds: as of the discrepancy."""

SPACING_M = 2.0
"""Standard deviation of an element's place, m; and how far apart places are where an element is begun, unless
joints are nearer: between two that are, an element shows no farther than to the next."""

AT_HZ = 50.0
"""Where the stiffness of a layer is taken for a typical one."""

SIMPLE = ("spring", "dashpot", "inerter")
"""Elements that are begun between any two joints."""

SIZE, SIZE_FACTOR = 0.1, 3.0
"""Of an element over what a joint beside it has: median, and the factor of one standard deviation, before
:data:`permway.posterior.spans.WIDER`."""


def everywhere(situation: Situation) -> Iterator[Hypothesis]:
    """Each element along each beam: to the ground, and to what a layer ties it to."""
    line = situation.campaign.model.line
    carrying = [layer for layer in layers(line) if isinstance(line.bodies.get(layer.upper), Beam)]
    if not carrying:
        return
    temperature = situation.campaign.model.temperature_C
    typical = {layer.law: float(np.abs(line.laws[layer.law].complex(AT_HZ, temperature))) for layer in carrying}
    stiffest = max(typical.values())
    for _, segment in line.beams():
        yield from _along(segment, GROUND, carrying, stiffest)
    for layer in carrying:
        if layer.lower == GROUND or not isinstance(line.bodies.get(layer.lower), Beam):
            continue
        for segment in (s for _, s in line.beams() if s.body == layer.upper):
            yield from _along(segment, layer.lower, [layer], typical[layer.law])


hypotheses = everywhere


def _along(segment: Segment, lower: str, carrying: list[Layer], typical: float) -> Iterator[Hypothesis]:
    """Each element along a beam; what hangs on it by one spring is in the catalogue."""
    under = [np.diff(np.unique(layer.x)) for layer in carrying if layer.upper == segment.body]
    joints_m = [float(np.median(steps)) for steps in under if steps.size]
    for element in (*ELEMENTS, *(STANDING if lower == GROUND else ())):
        # A springpot or Maxwell pair shows as a spring or dashpot there, and is then tried in its place.
        apart = min([SPACING_M, *joints_m]) if element.name in SIMPLE else SPACING_M
        for x in _places(segment, carrying, apart):
            if element.name == "spring":
                yield _of(segment, lower, x, typical, element, -1.0)
            yield _of(segment, lower, x, typical, element, 1.0)


def _places(segment: Segment, carrying: list[Layer], apart: float) -> list[float]:
    """Along a beam, where joints are."""
    low = max(segment.start, min(float(layer.x.min()) for layer in carrying))
    high = min(segment.stop, max(float(layer.x.max()) for layer in carrying))
    count = max(1, round((high - low) / apart))
    return [low + (index + 0.5) * (high - low) / count for index in range(count)]


def _of(segment: Segment, lower: str, x: float, typical: float, element: Element, sign: float) -> Hypothesis:
    own = element.free(typical, AT_HZ)
    size = own[0].name
    scale = typical / (2.0 * np.pi * AT_HZ) ** _POWER.get(element.name, 0)
    free: tuple[Free, ...] = (
        log_free(size, own[0].unit, SIZE * scale, SIZE_FACTOR),
        *own[1:],
        linear_free("x_m", "m", x, SPACING_M, segment.start + 1e-6, segment.stop - 1e-6),
    )

    def signed(values: Mapping[str, float]) -> dict[str, float]:
        return {**values, size: sign * values[size]}

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        law = fresh(NOVEL, campaign.model.line.laws)
        joint = Joints(between=(segment.name, lower), law=law, at=(values["x_m"],))
        return with_joints(campaign, joint, laws={law: element.law(signed(values))})

    made = Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=free,
        amend=amend,
        locate=lambda v: Where(segment.name, (v["x_m"], v["x_m"])),
        starts=((0.0,) * len(free),),
        law=lambda v: f"{element.words(signed(v))}, from {segment.body} to {lower}",
        size=size,
        none=0.0,
        variant=f"{element.name} {sign:+g} from {segment.name} to {lower}",
    )
    return replace(made, starts=(*made.starts, (1.0, *made.starts[0][1:])))


_POWER = {"dashpot": 1, "inerter": 2, "rod": 2}
"""By which power of an angular frequency an element's constant is less than a stiffness."""
