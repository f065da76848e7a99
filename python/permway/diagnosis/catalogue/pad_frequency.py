"""The pad relaxes: its stiffness and loss depend on frequency."""

from __future__ import annotations

from collections.abc import Iterator

from permway.diagnosis.catalogue._relaxing import FORMS, relaxations
from permway.diagnosis.catalogue._relaxing import PARAMETERS as PARAMETERS
from permway.diagnosis.catalogue._roles import rubbers
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation
from permway.laws import Hysteretic

ID = "pad_frequency"
DOMAIN: Domain = "path"
FAMILY = "pad law"
SUMMARY = FORMS
SIGNATURE = (
    "All channels from the rail, all pads alike; grows with distance from the frequency that the constant was "
    "fitted at; the same at all speeds; moves with temperature."
)
CONFUSED_WITH = {
    "pad_temperature": "hammer tests at two temperatures",
    "layer_damping": "phase above 200 Hz, where a dashpot's loss keeps rising",
    "pad_preload": "tests with and without a standing vehicle",
}
SOURCE = (
    "Bagley and Torvik (1983); the paper, Insights into Underrail Rubber Pad's Effect on Vehicle-Track-Viaduct "
    "System Dynamics (2021), equations (17) to (22)"
)


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """Two for each law of pads, or of a rig's rubber, that is constant."""
    line = situation.campaign.model.line
    for name in rubbers(line):
        if isinstance(line.laws[name], Hysteretic):
            yield from relaxations(ID, FAMILY, name)
