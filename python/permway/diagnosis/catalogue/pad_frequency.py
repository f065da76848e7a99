"""The pad relaxes: its stiffness and loss depend on frequency."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._relaxing import relaxing, relaxing_once, springpot_free
from permway.diagnosis.catalogue._roles import rubbers
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free
from permway.laws import Hysteretic

ID = "pad_frequency"
DOMAIN: Domain = "path"
FAMILY = "pad law"
SUMMARY = (
    "A springpot beside a spring, k (1 - s) + k s (i f / f0)^a, f0 = 60 Hz, or a spring and a dashpot in series "
    "beside a spring, c + c r i f / (f1 + i f), for the constant stiffness k; of its constant loss a part stays."
)
PARAMETERS = {
    "stiffness_factor": "1, 0.33 to 3.05: stiffness at 60 Hz over the constant one",
    "order": "1, 0.02 to 0.8: order a of the springpot",
    "share": "1, 0 to 0.98: share s of the springpot",
    "rise": "1, 0.02 to 10: r, what the stiffness rises by through the relaxation, over that below it",
    "relaxation_Hz": "Hz, 4 to 1000: f1, where the loss of the relaxing branch is largest",
    "rest": "1, 0 to 1: part of the constant loss that stays, on all that relaxes too",
}
SIGNATURE = (
    "All channels from the rail, all pads alike; grows with distance from the frequency that the constant was "
    "fitted at; the same at all speeds; moves with temperature."
)
CONFUSED_WITH = {
    "pad_temperature": "hammer tests at two temperatures",
    "layer_damping": "phase above 200 Hz, where a dashpot's loss keeps rising",
    "pad_preload": "tests with and without a standing vehicle",
}
SOURCE = "Bagley and Torvik (1983); seed paper, equations (17) to (22)"


def _at(name: str, _: Mapping[str, float]) -> Where:
    return Where(what=name)


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Two for each law of pads, or of a rig's rubber, that is constant."""
    line = situation.campaign.model.line
    for name in rubbers(line):
        if not isinstance(line.laws[name], Hysteretic):
            continue

        yield _springpot(name)
        yield _relaxation(name)


def _springpot(name: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return relaxing(campaign, name, **values)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=springpot_free(),
        amend=amend,
        locate=partial(_at, name),
        starts=((0.0, -0.6, 0.5, -1.0), (0.0, -1.2, 1.2, -1.0), (0.0, 0.2, -0.7, 0.0), (0.0, -1.2, -1.0, 1.0)),
        law=lambda v: (
            f"spring ({1 - v['share']:.2f} of the stiffness) beside a springpot of order {v['order']:.2f}"
        ),
        size="share",
        none=0.0,
    )


def _relaxation(name: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return relaxing_once(campaign, name, **values)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("stiffness_factor", "1", 1.0, 1.25),
            log_free("rise", "1", 0.4, 2.0),
            log_free("relaxation_Hz", "Hz", 70.0, 2.0),
            between_free("rest", "1", 0.0, 1.0),
        ),
        amend=amend,
        locate=partial(_at, name),
        # Sharp responses lead astray from what is far too strong: weak ones below, at and above the middle, too.
        starts=(
            (0.0, 0.0, 0.0, 1.0),
            (0.0, 0.0, 1.0, 1.0),
            (0.0, -1.5, 0.0, 1.0),
            *((0.0, -3.0, z, 1.0) for z in (-1.0, 0.0, 1.0)),
        ),
        law=lambda v: (
            f"relaxes about {v['relaxation_Hz']:.3g} Hz, where the stiffness rises by {100.0 * v['rise']:.0f} %"
        ),
        size="rise",
        none=0.0,
    )
