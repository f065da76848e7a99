"""One bearing that is softer or stiffer than the others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import REACH_M, fresh, with_factors, with_joints
from permway.diagnosis.catalogue._roles import Layer, bearings
from permway.diagnosis.hypothesis import Amend, Domain, Hypothesis, Situation, Where, log_free
from permway.laws import Scaled
from permway.model.joints import Joints
from permway.model.line import Line

ID = "bearing_stiffness"
DOMAIN: Domain = "path"
FAMILY = "bearing and pier"
SUMMARY = (
    "The stiffness of the bearings at one station, or of one girder there, times a factor, the others as they are."
)
PARAMETERS = {"factor": "1, 0.01 to 98: on the stiffness"}
SIGNATURE = "Responses of the girder over one bearing, up to its second bending frequency, and little elsewhere."
CONFUSED_WITH = {
    "pier_soil": "both ends are alike there, and the stiffness falls with frequency",
    "girder_crack": "a sensor over each bearing",
}
SOURCE = "EN 1337-3: elastomeric bearings; Fryba, Dynamics of Railway Bridges (1996)"
MOST = 3


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each of the first stations, and where two girders meet one for each of them."""
    line = situation.campaign.model.line
    for layer in bearings(line):
        located = [at.x_m for at in situation.joints(layer.law, most=MOST)]
        for x in dict.fromkeys((*located, *layer.x.tolist()[:MOST])) if located else layer.x.tolist()[:MOST]:
            if np.abs(layer.x - x).min() < REACH_M:
                yield _station(layer, float(x))
                held = _held(line, layer, float(x))
                if len(held) > 1:
                    yield from (_girder(layer, float(x), name, held) for name in held)


def _held(line: Line, layer: Layer, place: float) -> dict[str, float]:
    """Beams that the layer holds at a station, and the scale of the joint there."""
    table = line.joint_table()
    here = (table.layer == layer.index) & (np.abs(table.x - place) < REACH_M)
    segments = line.segments()
    return {segments[int(table.upper[j])].name: float(table.scale[j]) for j in np.flatnonzero(here)}


def _station(layer: Layer, place: float) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return _all_there(campaign, layer, place, values["factor"])

    return _made(layer, place, amend, "the others")


def _all_there(campaign: Campaign, layer: Layer, place: float, factor: float) -> Campaign:
    def factors(x: Reals) -> Reals:
        return np.where(np.abs(x - place) < REACH_M, factor, 1.0)

    return with_factors(campaign, layer.law, factors)


def _girder(layer: Layer, place: float, girder: str, held: Mapping[str, float]) -> Hypothesis:
    """No law may create energy, so nothing is taken away: what is softer leaves the others there as much more."""

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        factor = values["factor"]
        if factor == 1.0:
            return campaign
        more = (girder,) if factor > 1.0 else tuple(name for name in held if name != girder)
        if factor < 1.0:
            campaign = _all_there(campaign, layer, place, factor)
        laws = campaign.model.line.laws
        name = fresh(f"{layer.law}_more", laws)
        lower = layer.joints.between[1]
        joints = tuple(Joints(between=(one, lower), law=name, at=(place,), scale=held[one]) for one in more)
        return with_joints(campaign, *joints, laws={name: Scaled(law=laws[layer.law], factor=abs(factor - 1.0))})

    return _made(layer, place, amend, f"the others, under {girder} alone", variant="one girder")


def _made(layer: Layer, place: float, amend: Amend, others: str, variant: str = "") -> Hypothesis:
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(log_free("factor", "1", 1.0, 2.5),),
        amend=amend,
        locate=lambda _: Where(what=layer.law, x_m=(place, place)),
        starts=((-0.7,), (0.7,)),
        law=lambda v: f"{v['factor']:.2f} times as stiff as {others}",
        size="factor",
        none=1.0,
        variant=variant,
    )
