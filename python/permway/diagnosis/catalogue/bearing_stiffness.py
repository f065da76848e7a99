"""One bearing that is softer or stiffer than the others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.catalogue._change import REACH_M, with_factors
from permway.diagnosis.catalogue._roles import Layer, bearings
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.recordings.campaign import Campaign

ID = "bearing_stiffness"
DOMAIN: Domain = "path"
FAMILY = "bearing and pier"
SUMMARY = "The stiffness of the bearings at one station times a factor, the others as they are."
PARAMETERS = {"factor": "1, 0.01 to 98: on the stiffness"}
SIGNATURE = "Responses of the girder over one bearing, up to its second bending frequency, and little elsewhere."
CONFUSED_WITH = {
    "pier_soil": "both ends are alike there, and the stiffness falls with frequency",
    "girder_crack": "a sensor over each bearing",
}
SOURCE = "EN 1337-3: elastomeric bearings; Fryba, Dynamics of Railway Bridges (1996)"
MOST = 3


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each of the most telling bearings."""
    for layer in bearings(situation.campaign.model.line):
        told = [f.spot.x_m[0] for f in situation.joints(layer.law, most=MOST)]
        for x in dict.fromkeys((*told, *layer.x.tolist()[:MOST])) if told else layer.x.tolist()[:MOST]:
            if np.abs(layer.x - x).min() < REACH_M:
                yield _at(layer, float(x))


def _at(layer: Layer, place: float) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        def factors(x: Reals) -> Reals:
            return np.where(np.abs(x - place) < REACH_M, values["factor"], 1.0)

        return with_factors(campaign, layer.law, factors)

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("factor", "1", 1.0, 2.5),),
        amend=amend,
        locate=lambda _: Where(what=layer.law, x_m=(place, place)),
        starts=((-0.7,), (0.7,)),
        law=lambda v: f"{v['factor']:.2f} times as stiff as the others",
        size="factor",
        none=1.0,
    )
