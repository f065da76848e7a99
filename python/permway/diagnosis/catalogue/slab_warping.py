"""Slabs that curl: their ends lose contact with the bed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_factors
from permway.diagnosis.catalogue._roles import beds, laws_of, reaches, slabs
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free
from permway.model.segments import Segment

ID = "slab_warping"
DOMAIN: Domain = "path"
FAMILY = "slab"
SUMMARY = (
    "The bed's stiffness falls to a factor c over a length at both ends of every slab: times c^((1 - d)^p), d the "
    "distance from the end over that length."
)
PARAMETERS = {
    "length_m": "m, 0.1 to 37: over which the bed carries less, at each end",
    "factor": "1, 1e-6 to 1: c, what is left of the stiffness at the very end",
    "sharpness": "1, 0.23 to 9.8: p, how sharply it falls towards the end",
}
SIGNATURE = "Responses of slab and rail near slab ends, as of a cantilever's; grows and falls with the day's heat."
CONFUSED_WITH = {
    "slab_joints": "the slab's bending is cut there; the bed stays",
    "mortar_void": "one place only",
}
SOURCE = "Song, Zhao and Zhu (2014), Sci. China Technol. Sci. 57, 1917-1924; Westergaard (1927), curling of slabs"

LEAST = 1e-6
"""Of the stiffness, so that it has a logarithm."""


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each law of a bed below slabs with ends."""
    line = situation.campaign.model.line
    for name in slabs(line):
        segments = [s for s in reaches(line, name) if np.isfinite([s.start, s.stop]).all()]
        if segments:
            for law in laws_of([bed for bed in beds(line) if bed.upper == name]):
                yield _of(law, name, segments)


def _of(law: str, name: str, segments: list[Segment]) -> Hypothesis:
    ends = np.unique([end for s in segments for end in (s.start, s.stop)])

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        def factors(x: Reals) -> Reals:
            away = np.abs(x[:, None] - ends[None, :]).min(axis=1) / values["length_m"]
            return np.asarray(values["factor"] ** (np.clip(1.0 - away, 0.0, 1.0) ** values["sharpness"]))

        return with_factors(campaign, law, factors)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("length_m", "m", 1.5, 1.9, lowest=0.1),
            between_free("factor", "1", LEAST, 1.0),
            log_free("sharpness", "1", 1.5, 1.6),
        ),
        amend=amend,
        locate=lambda _: Where(what=name),
        # A bed is so stiff that half of it is hardly missed, and a hundredth is.
        starts=((0.0, -0.8, 0.0), (1.2, -0.8, 0.0), (0.5, -2.2, 0.0), (1.4, -2.5, 0.0)),
        law=lambda v: (
            f"{v['factor']:.2g} of the bed's stiffness is left at slab ends, all of it {v['length_m']:.2g} m in"
        ),
        size="factor",
        none=1.0,
    )
