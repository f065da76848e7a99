"""Joints or dipped welds at the ends of rails."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.excitation import TrackLines
from permway.diagnosis.catalogue._excite import stays, with_irregularity
from permway.diagnosis.catalogue._lines import FACTOR, coordinate, repeats
from permway.diagnosis.catalogue._runs import combs, excesses
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, between_free, log_free

ID = "rail_joint"
DOMAIN: Domain = "irregularity"
FAMILY = "tied to speed over length"
SUMMARY = (
    "Lines in the profile at all multiples n of V / L, L the length of a rail: a n^-p, or those of dips of length "
    "d, each two quarter waves that meet in a kink."
)
PARAMETERS = {
    "length_m": "m, 5 to 120, and no longer than a run resolves: L",
    "amplitude_m": "m, 4.1e-8 to 2.4e-3: a, of the first line, or of all that are far longer than a dip",
    "decay": "1, 0 to 2: p; 0 for short dips, 2 for a kink",
    "dip_m": "m, 0.05 to 9: d",
}
SIGNATURE = "A comb of lines of all on-board channels that goes with the speed; no frequency response."
CONFUSED_WITH = {
    "span_camber": "the length is the span's there, and lines fall fast",
    "wheel_flat": "one wheelset, and the length of its turn",
    "parametric_support": "the length is the fasteners' spacing there",
}
SOURCE = (
    "Jenkins and others, The effect of track and vehicle parameters on wheel/rail vertical dynamic forces (1974)"
)
CENTRE_M, LENGTH_FACTOR, AMPLITUDE_M = 25.0, 2.0, 1e-5
USUAL_M = (10.0, 12.0, 12.5, 15.0, 18.0, 20.0, 24.0, 25.0, 30.0, 36.0, 50.0, 60.0, 100.0, 120.0)
"""Usual lengths of rails, slabs and panels: tried also where no comb stands out in power."""


DIP_M, DIP_FACTOR = 0.6, 1.9
"""Length of a dip as known beforehand, and to which factor."""

RESOLVED = 3.0
"""Lines of an estimate between two of a comb, at least: closer, a comb is a level and no more."""

SHORTEST_M = 5.0


def _longest(situation: Situation) -> float:
    """Of which the fastest and finest run resolves the comb, m."""
    datasets = [d for d in situation.fit.observations.datasets if d.record.spectral]
    reach = [(d.condition.speed_m_per_s or 0.0) * d.record.segment_s for d in datasets]
    return max(reach, default=0.0) / RESOLVED


def _length(longest: float) -> Free:
    made = log_free("length_m", "m", CENTRE_M, LENGTH_FACTOR, lowest=SHORTEST_M)
    return replace(made, limits=(made.limits[0], coordinate(longest, CENTRE_M, LENGTH_FACTOR)))


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """From the lengths whose combs stand out most, and from usual ones."""
    runs = excesses(situation)
    if not runs:
        return
    longest = _longest(situation)
    if longest <= SHORTEST_M:
        return
    every = (1.0 / np.geomspace(SHORTEST_M, min(longest, 120.0), 1600)).tolist()
    found = combs(runs, every, harmonics=None, decay=0.7, most=4)
    for length in [usual for usual in USUAL_M if usual <= longest]:
        found += combs(runs, [1.0 / length], harmonics=None, decay=0.7, most=1)
    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            _length(longest),
            log_free("amplitude_m", "m", AMPLITUDE_M, FACTOR),
            between_free("decay", "1", 0.0, 2.0),
        ),
        amend=repeats(),
        locate=stays("rail"),
        starts=tuple(
            (
                coordinate(1.0 / c.per_speed, CENTRE_M, LENGTH_FACTOR),
                coordinate(c.amplitude_m, AMPLITUDE_M, FACTOR),
                -0.4,
            )
            for c in found
        ),
        law=lambda v: (
            f"{1e6 * v['amplitude_m']:.3g} um every {v['length_m']:.4g} m, line n lower by n^-{v['decay']:.2f}"
        ),
        size="amplitude_m",
        power=2.0,
    )
    yield Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            _length(longest),
            log_free("amplitude_m", "m", AMPLITUDE_M, FACTOR),
            log_free("dip_m", "m", DIP_M, DIP_FACTOR),
        ),
        amend=_dips,
        locate=stays("rail"),
        starts=tuple(
            (
                coordinate(1.0 / c.per_speed, CENTRE_M, LENGTH_FACTOR),
                coordinate(c.amplitude_m, AMPLITUDE_M, FACTOR),
                z,
            )
            for c in combs(runs, every, harmonics=None, decay=0.2, most=3) + found
            for z in (0.0, 1.0)
        ),
        law=lambda v: (
            f"{1e6 * v['amplitude_m']:.3g} um every {v['length_m']:.4g} m, of dips {v['dip_m']:.2g} m long"
        ),
        size="amplitude_m",
        power=2.0,
        variant="dips",
    )


def _dips(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
    added = TrackLines(
        length_m=values["length_m"],
        amplitude_m=values["amplitude_m"],
        dip_m=values["dip_m"],
    )
    return with_irregularity(campaign, series=(*campaign.stated.irregularity.series, added))
