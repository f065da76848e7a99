"""Fasteners that carry little or nothing over a stretch: hanging, loose or missing."""

from __future__ import annotations

from collections.abc import Iterator

from permway.diagnosis.catalogue._interval import stations_of
from permway.diagnosis.catalogue._loss import local_loss, stretches
from permway.diagnosis.catalogue._roles import laws_of, pads
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation

ID = "fastener_loss"
DOMAIN: Domain = "path"
FAMILY = "local loss of support"
SUMMARY = "The pads' stiffness times a factor below 1 over a stretch of rail."
PARAMETERS = {
    "centre_m": "m: middle of the stretch",
    "length_m": "m, 0 to 12 spacings: from the first fastener that is wholly changed to the last",
    "factor": "1, 0 to 1: what is left of the stiffness",
}
SIGNATURE = "Responses of the rail near one place, above 20 Hz, strongest between 50 Hz and the rail's resonance."
CONFUSED_WITH = {
    "mortar_void": "a sensor on the slab over the place",
    "support_scatter": "hammer points at every fastener nearby",
}
SOURCE = "Knothe and Grassie (1993), section 4; Zakeri and others (2016), hanging supports"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """At the most telling pads of each law."""
    for law in laws_of(pads(situation.campaign.model.line)):
        yield from local_loss(situation, law, ID, FAMILY)


def everywhere(situation: Situation) -> Iterator[Hypothesis]:
    """At every stretch of pads of each law."""
    line = situation.campaign.model.line
    for law in laws_of(pads(line)):
        yield from stretches(law, stations_of(line, law), ID, FAMILY)
