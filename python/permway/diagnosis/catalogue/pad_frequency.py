"""The pad relaxes: its stiffness and loss depend on frequency."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from permway.diagnosis.catalogue._relaxing import relaxing
from permway.diagnosis.catalogue._roles import laws_of, pads
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free
from permway.laws import Hysteretic
from permway.recordings.campaign import Campaign

ID = "pad_frequency"
DOMAIN: Domain = "path"
FAMILY = "pad law"
SUMMARY = "A springpot beside a spring: k (1 - s) + k s (i f / f0)^a, f0 = 60 Hz, for the constant stiffness k."
PARAMETERS = {
    "stiffness_factor": "1, 0.3 to 3: stiffness at 60 Hz over the constant one",
    "order": "1, 0.02 to 0.8: order a of the springpot",
    "share": "1, 0 to 0.98: share s of the springpot",
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
    """One for each law between a rail and what lies below that is constant."""
    line = situation.campaign.model.line
    for name in laws_of(pads(line)):
        if not isinstance(line.laws[name], Hysteretic):
            continue

        def amend(campaign: Campaign, values: Mapping[str, float], name: str = name) -> Campaign:
            return relaxing(campaign, name, **values)

        yield Hypothesis(
            entry=ID,
            domain=DOMAIN,
            family=FAMILY,
            free=(
                log_free("stiffness_factor", "1", 1.0, 1.25),
                between_free("order", "1", 0.02, 0.8),
                between_free("share", "1", 0.0, 0.98),
            ),
            amend=amend,
            locate=partial(_at, name),
            starts=((0.0, -0.6, 0.5), (0.0, -1.2, 1.2), (0.0, 0.2, -0.7)),
            law=lambda v: (
                f"spring ({1 - v['share']:.2f} of the stiffness) beside a springpot of order {v['order']:.2f}"
            ),
            size="share",
            none=0.0,
        )
