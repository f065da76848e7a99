"""A girder that bends more easily over a length: cracked, or its tendons lost."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_fields
from permway.diagnosis.catalogue._roles import girders, reaches
from permway.diagnosis.hypothesis import (
    Domain,
    Hypothesis,
    Situation,
    Where,
    between_free,
    linear_free,
    log_free,
)
from permway.model.bodies import Beam, BeamChange
from permway.model.segments import Segment

ID = "girder_crack"
DOMAIN: Domain = "path"
FAMILY = "girder"
SUMMARY = "The girder's bending stiffness times a factor below 1 over a length."
PARAMETERS = {
    "centre_m": "m: middle of the length",
    "length_m": "m, 0.1 to 6",
    "factor": "1, 0.01 to 1: what is left of the bending stiffness",
}
SIGNATURE = (
    "The girder's bending frequencies fall, each by the curvature of its mode at the place; a crack at midspan "
    "leaves the second bending frequency where it is."
)
CONFUSED_WITH = {
    "bearing_stiffness": "a sensor over each bearing",
    "second_track": "all bending frequencies fall by one factor there",
}
SOURCE = (
    "Salawu (1997), Engineering Structures 19, 718-723; Friswell and Penny (2002), Struct. Health Monitoring 1"
)
SHORTEST_M, SHORTEST = 0.1, 0.01
"""Of a crack's reach, m, and of a short span."""

STARTS = 7
"""Along a span: the fit goes to the nearest of places that explain some bending frequencies."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each row of girders, on the beam of the row that is looked at, else on the first."""
    line = situation.campaign.model.line
    for name in girders(line):
        located = situation.bodies(name, most=1)
        segments = reaches(line, name)
        segment = next((s for s in segments if located and s.name == located[0].name), segments[0])
        yield _on(name, segment, located[0].x_m if located else None)


def _on(name: str, segment: Segment, located: float | None) -> Hypothesis:
    start, stop = segment.start, segment.stop
    span = stop - start
    shortest = min(SHORTEST_M, SHORTEST * span)

    def stretch(values: Mapping[str, float]) -> tuple[float, float]:
        half = 0.5 * max(values["length_m"], shortest)
        middle = min(max(values["centre_m"], start + 0.5 * shortest), stop - 0.5 * shortest)
        return max(start, middle - half), min(stop, middle + half)

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        low, high = stretch(values)
        beam = campaign.model.line.bodies[name]
        assert isinstance(beam, Beam)
        cracked = BeamChange(from_m=low, to_m=high, bending_factor=values["factor"])
        # A sum of modes is of uniform beams only.
        return with_fields(campaign, name, changes=(*beam.changes, cracked), modes=None)

    middle, sigma = 0.5 * (start + stop), 0.25 * span
    places = [*np.linspace(-1.8, 1.8, STARTS)]
    if located is not None:
        places.insert(0, (located - middle) / sigma)
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            linear_free("centre_m", "m", middle, sigma, start, stop),
            log_free("length_m", "m", min(1.0, 0.1 * span), 1.6, lowest=shortest),
            between_free("factor", "1", 0.01, 1.0),
        ),
        amend=amend,
        locate=lambda v: Where(what=segment.name, x_m=stretch(v)),
        starts=tuple((float(z), 0.0, 0.5) for z in places),
        law=lambda v: f"{v['factor']:.2f} of the bending stiffness is left over {v['length_m']:.2g} m",
        size="factor",
        none=1.0,
    )
