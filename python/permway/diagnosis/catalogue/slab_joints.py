"""A slab that is cut at regular lengths, where the model has it in one piece."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.catalogue._change import with_fields
from permway.diagnosis.catalogue._roles import fasteners, reaches, slabs, spacing
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free
from permway.model.bodies import Beam, BeamChange
from permway.model.segments import Segment
from permway.recordings.campaign import Campaign

ID = "slab_joints"
DOMAIN: Domain = "path"
FAMILY = "slab"
SUMMARY = (
    "At every length L of slab a cut, over which nothing passes, or a joint that bends as easily as so many "
    "metres of slab and holds against shear."
)
PARAMETERS = {
    "length_m": "m, 1.5 to 26: from joint to joint",
    "offset": "1, -0.5 to 0.5: place of the joints, in lengths from the slab's start",
    "flexibility_m": "m: of slab, that bend as much as one joint",
}
SIGNATURE = "Responses of slab and rail, above the slab's resonance on its bed, by place in the pattern of joints."
CONFUSED_WITH = {
    "slab_warping": "contact is lost on the bed there; the slab's own bending stays",
    "mortar_void": "the effect is of one place there",
}
SOURCE = "Esveld, Modern Railway Track (2001): prefabricated slab track"
JOINT_M = 0.1
"""Length over which the bending stiffness is lowered."""

SHORT = 0.25
"""Of the length of a slab: shorter pieces at the ends are no slabs of their own."""

SHORTEST_M = 3.0
"""Of the equal parts that are tried."""

LONG_M = 10.0
"""A slab shorter than this is in one piece."""

USUAL_M = (4.0, 5.0, 5.6, 6.45, 8.0)
"""Lengths that slabs are made in: where the search starts, beside equal parts of the whole, and whole bays."""

PARTS = (4, 5, 6)
CENTRE_M, FACTOR, OFFSET = 6.0, 1.33, 0.3
LONGEST_M = 12.0
"""Of slabs with a whole number of fasteners, joints midway between two, where the search starts, too."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Two for each row of slabs that are long."""
    line = situation.campaign.model.line
    for name in slabs(line):
        segments = reaches(line, name)
        longest = max(segments, key=lambda s: s.stop - s.start)
        if np.isfinite([longest.start, longest.stop]).all() and longest.stop - longest.start >= LONG_M:
            above = [layer.x for layer in fasteners(line) if layer.lower == name]
            starts = [*_usual(longest), *(start for x in above for start in _between(x, longest))]
            yield _cut(name, segments, starts)
            yield _bending(name, segments, starts)


def _usual(slab: Segment) -> Iterator[tuple[float, float]]:
    """Length and offset of joints at usual lengths and at equal parts, from the slab's start."""
    extent = slab.stop - slab.start
    yield from ((length, 0.0) for length in USUAL_M)
    yield from ((extent / parts, 0.0) for parts in PARTS if extent / parts >= SHORTEST_M)


def _between(x: Reals, slab: Segment) -> Iterator[tuple[float, float]]:
    """Of joints midway between fasteners: the first slab with as many as the others, or with one more."""
    bay = spacing(x)
    for count in range(int(np.ceil(SHORTEST_M / bay)), int(LONGEST_M / bay) + 1):
        length = count * bay
        for side in (0.5, -0.5):
            offset = (x.min() + side * bay - slab.start) / length
            yield length, float(offset - np.round(offset))


def _joints(segment: Segment, values: Mapping[str, float]) -> list[float]:
    """Where the joints of a slab are, m: a piece that would be short belongs to its neighbour."""
    length = values["length_m"]
    if np.isinf(length):
        return []
    first = segment.start + length * values["offset"]
    places = first + length * np.arange(np.ceil((segment.stop - first) / length))
    least = max(SHORT * length, JOINT_M)
    return [float(x) for x in places[(places > segment.start + least) & (places < segment.stop - least)]]


def _start(length: float, offset: float) -> tuple[float, float]:
    return float(np.log(length / CENTRE_M) / np.log(FACTOR)), offset / OFFSET


def _free() -> tuple[Free, Free]:
    return log_free("length_m", "m", CENTRE_M, FACTOR), linear_free("offset", "1", 0.0, OFFSET, -0.5, 0.5)


def _cut(name: str, segments: list[Segment], tried: list[tuple[float, float]]) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        pieces: list[tuple[float, float]] = []
        for segment in segments:
            ends = [segment.start, *_joints(segment, values), segment.stop]
            pieces += pairwise(ends)
        return with_fields(campaign, name, intervals_m=tuple(pieces), modes=None)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=_free(),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=tuple(_start(*one) for one in tried),
        law=lambda v: f"cut through every {v['length_m']:.3g} m",
        size="length_m",
        none=np.inf,
    )


def _bending(name: str, segments: list[Segment], tried: list[tuple[float, float]]) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        factor = JOINT_M / (JOINT_M + values["flexibility_m"])
        beam = campaign.model.line.bodies[name]
        assert isinstance(beam, Beam)
        changes = list(beam.changes)
        for segment in segments:
            for x in _joints(segment, values):
                low, high = x - 0.5 * JOINT_M, x + 0.5 * JOINT_M
                changes.append(BeamChange(from_m=low, to_m=high, bending_factor=factor))
        return with_fields(campaign, name, changes=tuple(changes), modes=None)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(*_free(), log_free("flexibility_m", "m", 3.0, 10.0, lowest=1e-4)),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=tuple((*_start(*one), 0.5) for one in tried),
        law=lambda v: f"joints every {v['length_m']:.3g} m that bend as {v['flexibility_m']:.2g} m of slab",
        size="flexibility_m",
        none=0.0,
    )
