"""A void below a slab, or below sleepers: the bed carries little or nothing over a stretch."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from permway.diagnosis.catalogue._interval import stations_of
from permway.diagnosis.catalogue._loss import local_loss, stretches
from permway.diagnosis.catalogue._roles import beds, carriers, laws_of
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation

ID = "mortar_void"
DOMAIN: Domain = "path"
FAMILY = "local loss of support"
SUMMARY = "The stiffness of the bed below slab or sleepers times a factor below 1 over a stretch."
PARAMETERS = {
    "centre_m": "m: middle of the stretch",
    "length_m": "m, 0 to 12 spacings: from the first station that is wholly changed to the last",
    "factor": "1, 0 to 1: what is left of the stiffness",
}
SIGNATURE = (
    "Responses of slab and rail over one place: the slab bends there as a free strip, from some ten hertz up; "
    "what lies below moves less."
)
CONFUSED_WITH = {
    "fastener_loss": "a sensor on the slab over the place",
    "slab_warping": "both ends of every slab are alike there",
}
SOURCE = "Zhu and Cai (2014), Int. J. Non-Linear Mechanics 58, 222-232: interface damage of slab track"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """At the most telling joints of the beds directly below what carries the rail."""
    line = situation.campaign.model.line
    for law in laws_of([bed for bed in beds(line) if bed.upper in carriers(line)]):
        x = stations_of(line, law)
        coarse = np.quantile(x, [0.5, 0.2, 0.8]).tolist()
        yield from local_loss(situation, law, ID, FAMILY, places=coarse)


def everywhere(situation: Situation) -> Iterator[Hypothesis]:
    """At every stretch of the joints of each such bed."""
    line = situation.campaign.model.line
    for law in laws_of([bed for bed in beds(line) if bed.upper in carriers(line)]):
        yield from stretches(law, stations_of(line, law), ID, FAMILY)
