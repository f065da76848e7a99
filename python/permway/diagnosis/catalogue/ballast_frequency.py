"""Ballast whose stiffness and loss depend on frequency, where the model has them constant."""

from __future__ import annotations

from collections.abc import Iterator

from permway.diagnosis.catalogue._relaxing import FORMS, relaxations
from permway.diagnosis.catalogue._relaxing import PARAMETERS as PARAMETERS
from permway.diagnosis.catalogue._roles import beds, laws_of, rubbers, sleepers
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation
from permway.laws import Hysteretic

ID = "ballast_frequency"
DOMAIN: Domain = "path"
FAMILY = "bed law"
SUMMARY = f"The bed below sleepers relaxes. {FORMS}"
SIGNATURE = (
    "Responses of sleepers and rail, from the sleepers' resonance on the ballast to either side, all alike."
)
CONFUSED_WITH = {
    "pad_frequency": "a sensor on a sleeper",
    "layer_damping": "the stiffness stays as it is there",
}
SOURCE = "Knothe and Wu (1998), Archive of Applied Mechanics 68, 457-470: receptance of track and subgrade"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Two for each hysteretic law of the bed below sleepers."""
    line = situation.campaign.model.line
    carried = sleepers(line)
    for name in laws_of([bed for bed in beds(line) if bed.upper in carried]):
        if isinstance(line.laws[name], Hysteretic):
            yield from relaxations(ID, FAMILY, name)


def everywhere(situation: Situation) -> Iterator[Hypothesis]:
    """Two for each hysteretic law of any bed but rubber: mats below a slab relax, too."""
    line = situation.campaign.model.line
    for name in laws_of(beds(line)):
        if name not in rubbers(line) and isinstance(line.laws[name], Hysteretic):
            yield from relaxations(ID, FAMILY, name)
