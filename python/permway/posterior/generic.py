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
from permway.diagnosis.location import step_m
from permway.diagnosis.verdict import NOVEL
from permway.model.bodies import Beam, Shaft
from permway.model.joints import GROUND, Joints
from permway.model.segments import Segment

ID = NOVEL
DOMAIN: Domain = "path"
FAMILY = "no catalogue"

PRIOR = 0.05
"""Share of what is missing that no catalogue holds: as of the discrepancy."""

STEPS = 2.0
"""Standard deviation of an element's place, in steps of :func:`permway.diagnosis.location.step_m`; and how far
apart places are where an element is begun, unless joints are nearer: between two that are, an element shows no
farther than to the next."""

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
    temperature = situation.campaign.model.temperature_C
    typical = {layer.law: float(np.abs(line.laws[layer.law].complex(AT_HZ, temperature))) for layer in carrying}
    for body, segment in line.beams():
        stiffest = max(typical.values(), default=_bending(body, segment))
        if stiffest > 0.0:
            yield from _along(segment, GROUND, carrying, stiffest)
    for layer in carrying:
        if layer.lower == GROUND or not isinstance(line.bodies.get(layer.lower), Beam):
            continue
        for segment in (s for _, s in line.beams() if s.body == layer.upper):
            yield from _along(segment, layer.lower, [layer], typical[layer.law])


hypotheses = everywhere


def _bending(body: Beam | Shaft, segment: Segment) -> float:
    """Stiffness of a beam on its ends against a force in its middle, N/m; 0 of one without ends."""
    length = segment.stop - segment.start
    return abs(48.0 * body.bending_Nm2 / length**3) if isinstance(body, Beam) and np.isfinite(length) else 0.0


def _along(segment: Segment, lower: str, carrying: list[Layer], typical: float) -> Iterator[Hypothesis]:
    """Each element along a beam; what hangs on it by one spring is in the catalogue."""
    low, high = _reach(segment, lower, carrying)
    sigma = STEPS * step_m(segment.stop - segment.start)
    under = [np.unique(layer.x) for layer in carrying if layer.upper == segment.body]
    # Joints at one end alone say nothing of the rest.
    joints_m = [float(np.median(np.diff(x))) for x in under if x.size > 1 and np.ptp(x) > 0.5 * (high - low)]
    for element in (*ELEMENTS, *(STANDING if lower == GROUND else ())):
        # A springpot or Maxwell pair shows as a spring or dashpot there, and is then tried in its place.
        apart = min([sigma, *joints_m]) if element.name in SIMPLE else sigma
        count = max(1, round((high - low) / apart))
        for x in low + (np.arange(count) + 0.5) * (high - low) / count:
            for sign in (-1.0, 1.0) if element.name == "spring" else (1.0,):
                yield _of(segment, lower, float(x), sigma, typical, element, sign)


def _reach(segment: Segment, lower: str, carrying: list[Layer]) -> tuple[float, float]:
    """Of a beam to the ground, from end to end; else where joints are, m."""
    low, high = segment.start, segment.stop
    if carrying and not (lower == GROUND and np.isfinite([low, high]).all()):
        low = max(low, min(float(layer.x.min()) for layer in carrying))
        high = min(high, max(float(layer.x.max()) for layer in carrying))
    return low, high


def _of(
    segment: Segment, lower: str, x: float, sigma: float, typical: float, element: Element, sign: float
) -> Hypothesis:
    own = element.free(typical, AT_HZ)
    size = own[0].name
    scale = typical / (2.0 * np.pi * AT_HZ) ** _POWER.get(element.name, 0)
    free: tuple[Free, ...] = (
        log_free(size, own[0].unit, SIZE * scale, SIZE_FACTOR),
        *own[1:],
        linear_free("x_m", "m", x, sigma, segment.start + 1e-6, segment.stop - 1e-6),
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
