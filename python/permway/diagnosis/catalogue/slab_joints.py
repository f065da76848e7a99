"""A slab that is cut at regular lengths, where the model has it in one piece."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from itertools import pairwise

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import fresh, with_factors, with_fields, with_joints
from permway.diagnosis.catalogue._roles import fasteners, reaches, slabs, spacing
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free
from permway.laws import Hysteretic
from permway.model.bodies import Beam, BeamChange
from permway.model.joints import Joints
from permway.model.segments import Segment
from permway.model.stations import MEETINGS

ID = "slab_joints"
DOMAIN: Domain = "path"
FAMILY = "slab"
SUMMARY = (
    "At every length L of slab a cut, over which nothing passes or dowels hold against shear, or a joint that "
    "bends as easily as so many metres of slab."
)
PARAMETERS = {
    "length_m": "m, 0.8 to 46: from joint to joint",
    "offset": "1, -0.5 to 0.5: place of the joints, in lengths from the slab's start",
    "dowels_N_per_m": "N/m, 1e3 to 1e13: shear stiffness of the dowels of one cut",
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

TOUCHING_M, APART_M = 0.05, 0.002
"""How near a cut is at a fastener, and how far apart the two ends are put that share it."""

ASIDE_M = 0.002
"""By which a cut is beside a sensor or a hammer point: which side of it these are on, nobody states."""

DOWEL_LOSS = 0.05
"""Loss factor of dowels."""

SHORT = 0.25
"""Of the length of a slab: shorter pieces at the ends are no slabs of their own."""

SHORTEST_M = 2.0
"""Of the parts that are tried: half of the shortest that are usual."""

LONG_M = 2.0 * SHORTEST_M
"""A slab shorter than this is in one piece."""

USUAL_M = (4.0, 5.0, 5.6, 6.45, 8.0)
"""Lengths that slabs are made in: where the search starts, beside equal parts of the whole, and whole bays."""

PARTS = (2, 3, 4, 5, 6)
CENTRE_M, FACTOR, OFFSET = 6.0, 1.5, 0.3
LONGEST_M = 12.0
"""Of slabs with a whole number of fasteners, joints midway between two, where the search starts, too."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """For each row of slabs that are long: cuts and bending joints anywhere, and cuts at fasteners."""
    line = situation.campaign.model.line
    for name in slabs(line):
        segments = reaches(line, name)
        longest = max(segments, key=lambda s: s.stop - s.start)
        if np.isfinite([longest.start, longest.stop]).all() and longest.stop - longest.start >= LONG_M:
            above = [layer.x for layer in fasteners(line) if layer.lower == name]
            starts = [*_usual(longest), *(start for x in above for start in _between(x, longest))]
            yield _cut(name, segments, _either_side(starts, longest, _measured(situation.campaign, name)))
            yield _bending(name, segments, starts)
            if len(segments) > 1:
                leading = min(segments, key=lambda s: s.start)
                starts = [*_usual(leading), *(start for x in above for start in _between(x, leading))]
                yield _cut(name, segments, starts, through=True)
            for x in above:
                first = float(x[x > longest.start - TOUCHING_M].min())
                for length in _whole_bays(spacing(x), longest):
                    yield _at_fasteners(name, segments, length, first - longest.start)


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


def _whole_bays(bay: float, slab: Segment) -> Iterator[float]:
    """Lengths of whole bays that divide the slab evenly, or are next to a usual one."""
    extent = slab.stop - slab.start
    for count in range(int(np.ceil(SHORTEST_M / bay)), int(LONGEST_M / bay) + 1):
        parts = extent / (count * bay)
        if abs(parts - round(parts)) < 1e-6 or any(abs(count * bay - usual) <= 0.5 * bay for usual in USUAL_M):
            yield round(count * bay, 9)


def _joints(segment: Segment, values: Mapping[str, float], begin_m: float | None = None) -> list[float]:
    """Where the joints of a slab are, m: a piece that would be short belongs to its neighbour.

    Counted from its start, or from another place.
    """
    length = values["length_m"]
    if np.isinf(length):
        return []
    first = (segment.start if begin_m is None else begin_m) + length * values["offset"]
    counts = np.arange(np.ceil((segment.start - first) / length), np.ceil((segment.stop - first) / length))
    places = first + length * counts
    least = max(SHORT * length, JOINT_M)
    return [float(x) for x in places[(places > segment.start + least) & (places < segment.stop - least)]]


def _at(name: str, segments: list[Segment], values: Mapping[str, float], begin_m: float | None = None) -> Where:
    """From the first joint to the last."""
    x = [joint for segment in segments for joint in _joints(segment, values, begin_m)]
    return Where(name, (min(x), max(x))) if x else Where(name)


def _start(length: float, offset: float) -> tuple[float, float]:
    return float(np.log(length / CENTRE_M) / np.log(FACTOR)), offset / OFFSET


def _free() -> tuple[Free, Free]:
    return log_free("length_m", "m", CENTRE_M, FACTOR), linear_free("offset", "1", 0.0, OFFSET, -0.5, 0.5)


def _cut(
    name: str, segments: list[Segment], tried: list[tuple[float, float]], *, through: bool = False
) -> Hypothesis:
    """Each slab by itself, from its start; or all by one measure, as where they are cut after they are laid."""
    begin_m = min(segment.start for segment in segments) if through else None

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        pieces: list[tuple[float, float]] = []
        measured = _measured(campaign, name)
        for segment in segments:
            cuts = [_aside(x, measured) for x in _joints(segment, values, begin_m)]
            pieces += pairwise([segment.start, *cuts, segment.stop])
        return with_fields(campaign, name, intervals_m=tuple(pieces), modes=None)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=_free(),
        amend=amend,
        locate=partial(_at, name, segments, begin_m=begin_m),
        starts=tuple(_start(*one) for one in tried),
        law=lambda v: f"cut through every {v['length_m']:.3g} m" + (", from slab to slab" if through else ""),
        size="length_m",
        none=np.inf,
        variant="through" if through else "",
    )


def _measured(campaign: Campaign, name: str) -> Reals:
    """Where sensors and hammer points are on a body, m."""
    stated = campaign.stated
    places = [(one.body, one.x_m) for one in stated.sensors] + [(one.body, one.x_m) for one in stated.forces]
    return np.array([x for body, x in places if body == name and x is not None])


def _aside(x: float, measured: Reals) -> float:
    """A cut to the nearer side of what is measured there."""
    near = measured[np.abs(measured - x) < ASIDE_M]
    return x if not near.size else float(near[0] + np.copysign(ASIDE_M, x - near[0]))


def _either_side(tried: list[tuple[float, float]], segment: Segment, measured: Reals) -> list[tuple[float, float]]:
    """Starts, and where cuts of one fall on what is measured, that start with its cuts just before it, too."""
    found = list(tried)
    for length, offset in tried:
        x = np.array(_joints(segment, {"length_m": length, "offset": offset}))
        if x.size and (np.abs(x[:, None] - measured) < 1e-6).any():
            found.append((length, offset - 0.5 * ASIDE_M / length))
    return found


def _at_fasteners(name: str, segments: list[Segment], length: float, start: float) -> Hypothesis:
    """Cut through at fasteners, each of which then holds both ends by halves, as does the bed; dowels or none.

    Which fasteners, no slope shows: a hypothesis for each length of so many bays.
    """

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        shared = dict(
            values, offset=start / length, length_m=length if np.isfinite(values["length_m"]) else np.inf
        )
        line = campaign.model.line
        x = np.array([joint for segment in segments for joint in _joints(segment, shared)])
        if x.size == 0:
            return campaign

        def near(places: Reals) -> np.ndarray:
            return np.asarray(np.abs(places[:, None] - x).min(axis=1) < TOUCHING_M)

        halves: list[Joints] = []
        table = line.joint_table()
        for index, layer in enumerate(line.joints):
            at = (table.layer == index) & near(table.x)
            if name in layer.between and at.any():
                halves += [
                    Joints(
                        between=layer.between,
                        law=layer.law,
                        at=tuple(float(one) - APART_M for one in table.x[at & (table.scale == scale)]),
                        scale=0.5 * float(scale),
                    )
                    for scale in np.unique(table.scale[at])
                ]
        for law in {half.law for half in halves}:
            campaign = with_factors(campaign, law, lambda at: np.where(near(at), 0.5, 1.0), holding=name)
        pieces: list[tuple[float, float]] = []
        for segment in segments:
            cuts = [round(one - 0.5 * APART_M, 9) for one in _joints(segment, shared)]
            pieces += pairwise([segment.start, *cuts, segment.stop])
        campaign = with_fields(campaign, name, intervals_m=tuple(pieces), modes=None)
        law = fresh("dowels", line.laws)
        dowels = Joints(between=(name, name), law=law, at=MEETINGS)
        stiffness = Hysteretic(stiffness=values["dowels_N_per_m"], loss_factor=DOWEL_LOSS)
        return with_joints(campaign, *halves, dowels, laws={law: stiffness})

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            linear_free("length_m", "m", length, 0.1 * TOUCHING_M, length - TOUCHING_M, length + TOUCHING_M),
            log_free("dowels_N_per_m", "N/m", 1e8, 10.0),
        ),
        amend=amend,
        locate=lambda v: _at(name, segments, dict(v, offset=start / length)),
        starts=((0.0, -2.0), (0.0, 1.0)),
        law=lambda v: (
            f"cut through every {v['length_m']:.3g} m, at fasteners, dowels of {v['dowels_N_per_m']:.2g} N/m"
        ),
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
        locate=partial(_at, name, segments),
        starts=tuple((*_start(*one), 0.5) for one in tried),
        law=lambda v: f"joints every {v['length_m']:.3g} m that bend as {v['flexibility_m']:.2g} m of slab",
        size="flexibility_m",
        none=0.0,
    )
