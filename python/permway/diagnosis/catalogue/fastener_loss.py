"""Fasteners that carry little or nothing over a stretch: hung, loose or missing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from permway.diagnosis.catalogue._interval import spacing_of, weakened
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, linear_free
from permway.recordings.campaign import Campaign

ID = "fastener_loss"
DOMAIN: Domain = "path"
FAMILY = "local loss of support"
SUMMARY = "The pads' stiffness times a factor below 1 over a stretch of rail."
PARAMETERS = {
    "centre_m": "m: middle of the stretch",
    "length_m": "m, 0 to 8: its length, between the outer fasteners that are wholly changed",
    "factor": "1, 0 to 0.9: what is left of the stiffness",
}
SIGNATURE = "Responses of the rail near one place, above 20 Hz, strongest between 50 Hz and the rail's resonance."
CONFUSED_WITH = {
    "mortar_void": "a sensor on the slab over the place",
    "support_scatter": "hammer points at every fastener nearby",
}
SOURCE = "Knothe and Grassie (1993), section 4; Zakeri and others (2016), hanging supports"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """At the most telling pads."""
    line = situation.campaign.model.line
    laws = dict.fromkeys(layer.law for layer in line.joints if layer.between[0].split("[")[0] == "rail")
    for law in laws:
        yield from local_loss(situation, law, ID, FAMILY)


def local_loss(situation: Situation, law: str, entry: str, family: str, most: int = 3) -> Iterator[Hypothesis]:
    """Of any layer, at its most telling joints that do not lie within a few spacings of each other."""
    step = spacing_of(situation.campaign.model.line, law)
    taken: list[float] = []
    for found in situation.joints(law, most=40):
        centre = found.spot.x_m[0]
        if any(abs(centre - other) < 4.0 * step for other in taken):
            continue
        taken.append(centre)

        def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
            return weakened(campaign, law, values["centre_m"], values["length_m"], values["factor"])

        def locate(values: Mapping[str, float]) -> Where:
            half = 0.5 * values["length_m"]
            return Where(what=law, x_m=(values["centre_m"] - half, values["centre_m"] + half))

        yield Hypothesis(
            entry=entry,
            domain=DOMAIN,
            family=family,
            free=(
                linear_free("centre_m", "m", centre, 2.0 * step, centre - 6.0 * step, centre + 6.0 * step),
                between_free("length_m", "m", 0.0, 12.0 * step),
                between_free("factor", "1", 0.0, 0.9),
            ),
            amend=amend,
            locate=locate,
            starts=((0.0, -1.3, -0.8), (-1.0, -0.8, -1.0), (1.0, -0.8, -1.0), (0.0, -0.6, -1.0)),
            law=lambda v: f"{v['factor']:.2f} of the stiffness is left",
        )
        if len(taken) == most:
            return
