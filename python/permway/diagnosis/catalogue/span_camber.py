"""Spans that are cambered, or have sagged: a profile that repeats with the span."""

from __future__ import annotations

from collections.abc import Iterator

from permway.diagnosis.catalogue._excite import spans, stays
from permway.diagnosis.catalogue._lines import FACTOR, coordinate, repeats
from permway.diagnosis.catalogue._runs import combs, excesses
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, between_free, log_free

ID = "span_camber"
DOMAIN: Domain = "irregularity"
FAMILY = "tied to speed over length"
SUMMARY = "Lines a n^-p in the profile at all multiples n of V / L, L the length of a span."
PARAMETERS = {
    "amplitude_m": "m, 1.2e-6 to 7.3e-2: a, of the first line; of a parabola of rise h it is 0.41 h",
    "decay": "1, 1 to 4: p; 2 for a parabola with kinks at the bearings",
}
SIGNATURE = "Lines below some 30 Hz of all on-board channels, car body first, that go with the speed."
CONFUSED_WITH = {
    "moving_load": "a run with another axle load: camber does not follow it",
    "rail_joint": "the length, and how far up the lines reach",
    "irregularity_level": "lines, not all of a band",
}
SOURCE = "Yang, Yau and Wu, Vehicle-Bridge Interaction Dynamics (2004)"
AMPLITUDE_M = 3e-4


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """For the first span; all are taken to be alike."""
    runs, model = excesses(situation), situation.campaign.model
    if not runs or model.train is None:
        return
    for name, start, stop in spans(model.line, model.train.body)[:1]:
        length = stop - start
        (found,) = combs(runs, [1.0 / length], harmonics=8, decay=2.0, most=1)
        seen = coordinate(found.amplitude_m, AMPLITUDE_M, FACTOR)
        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(log_free("amplitude_m", "m", AMPLITUDE_M, FACTOR), between_free("decay", "1", 1.0, 4.0)),
            amend=repeats(length),
            locate=stays(name, (start, stop)),
            starts=((seen, -0.5), (seen - 2.0, -0.5)),
            law=lambda v: f"{1e3 * v['amplitude_m']:.3g} mm at V / span, line n lower by n^-{v['decay']:.2f}",
            size="amplitude_m",
        )
