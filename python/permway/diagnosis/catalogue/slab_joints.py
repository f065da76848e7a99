"""A slab that is cut at regular lengths, where the model has it in one piece."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.diagnosis.catalogue._change import with_fields
from permway.diagnosis.catalogue._roles import reaches, slabs
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, linear_free, log_free
from permway.model.bodies import Beam, BeamChange
from permway.model.segments import Segment
from permway.recordings.campaign import Campaign

ID = "slab_joints"
DOMAIN: Domain = "path"
FAMILY = "slab"
SUMMARY = "At every length L of slab a joint that bends as easily as so many metres of slab; very many for a cut."
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

SHORTEST_M = 3.0
"""Of the equal parts that are tried."""

LONG_M = 10.0
"""A slab shorter than this is in one piece."""

USUAL_M = (4.0, 5.0, 5.6, 6.45, 8.0)
"""Lengths that slabs are made in: where the search starts, beside equal parts of the whole."""

PARTS = (4, 5, 6)
OFFSETS = (0.0, 0.33, -0.33)


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each row of slabs that are long."""
    line = situation.campaign.model.line
    for name in slabs(line):
        segments = reaches(line, name)
        longest = max(segments, key=lambda s: s.stop - s.start)
        if np.isfinite([longest.start, longest.stop]).all() and longest.stop - longest.start >= LONG_M:
            yield _of(name, segments, longest.stop - longest.start)


def _of(name: str, segments: list[Segment], extent: float) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        length, flexibility = values["length_m"], values["flexibility_m"]
        factor = JOINT_M / (JOINT_M + flexibility)
        beam = campaign.model.line.bodies[name]
        assert isinstance(beam, Beam)
        changes = list(beam.changes)
        for segment in segments:
            first = segment.start + length * values["offset"]
            places = first + length * np.arange(np.ceil((segment.stop - first) / length))
            for x in places[(places > segment.start + JOINT_M) & (places < segment.stop - JOINT_M)].tolist():
                low, high = x - 0.5 * JOINT_M, x + 0.5 * JOINT_M
                changes.append(BeamChange(from_m=low, to_m=high, bending_factor=factor))
        return with_fields(campaign, name, changes=tuple(changes), modes=None)

    length = log_free("length_m", "m", 6.0, 1.33)
    tried = [(m, offset) for m in USUAL_M for offset in OFFSETS]
    tried += [(extent / parts, 0.0) for parts in PARTS if extent / parts >= SHORTEST_M]
    starts = tuple((float(np.log(m / 6.0) / np.log(1.33)), offset / 0.3, 0.5) for m, offset in tried)
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            length,
            linear_free("offset", "1", 0.0, 0.3, -0.5, 0.5),
            log_free("flexibility_m", "m", 3.0, 10.0, lowest=1e-4),
        ),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=starts,
        law=lambda v: f"joints every {v['length_m']:.3g} m that bend as {v['flexibility_m']:.2g} m of slab",
        size="flexibility_m",
        none=0.0,
    )
