"""Ballast whose stiffness and loss depend on frequency, where the model has them constant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._relaxing import relaxing
from permway.diagnosis.catalogue._roles import beds, laws_of, sleepers
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, log_free
from permway.laws import Hysteretic

ID = "ballast_frequency"
DOMAIN: Domain = "path"
FAMILY = "bed law"
SUMMARY = "A springpot beside a spring for the bed below sleepers: k (1 - s) + k s (i f / f0)^a, f0 = 60 Hz."
PARAMETERS = {
    "stiffness_factor": "1, 0.2 to 5: stiffness at 60 Hz over the constant one",
    "order": "1, 0.02 to 0.9: order a of the springpot",
    "share": "1, 0 to 0.98: share s of the springpot",
}
SIGNATURE = (
    "Responses of sleepers and rail, from the sleepers' resonance on the ballast to either side, all alike."
)
CONFUSED_WITH = {
    "pad_frequency": "a sensor on a sleeper",
    "layer_damping": "the stiffness stays as it is there",
}
SOURCE = "Knothe and Wu (1998), Archive of Applied Mechanics 68, 457-470: receptance of track and subgrade"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each hysteretic law of the bed below sleepers."""
    line = situation.campaign.model.line
    carried = sleepers(line)
    for name in laws_of([bed for bed in beds(line) if bed.upper in carried]):
        if isinstance(line.laws[name], Hysteretic):
            yield _of(name)


def everywhere(situation: Situation) -> Iterator[Hypothesis]:
    """One for each hysteretic law of any bed: mats below a slab relax, too."""
    line = situation.campaign.model.line
    for name in laws_of(beds(line)):
        if isinstance(line.laws[name], Hysteretic):
            yield _of(name)


def _of(name: str) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return relaxing(campaign, name, **values)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("stiffness_factor", "1", 1.0, 1.35),
            between_free("order", "1", 0.02, 0.9),
            between_free("share", "1", 0.0, 0.98),
        ),
        amend=amend,
        locate=lambda _: Where(what=name),
        starts=((0.0, -0.4, 0.0), (0.0, -1.2, 1.0)),
        law=lambda v: (
            f"spring ({1 - v['share']:.2f} of the stiffness) beside a springpot of order {v['order']:.2f}"
        ),
        size="share",
        none=0.0,
    )
