"""Neighbouring spans that are joined, where the model has them apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import fresh, with_joints
from permway.diagnosis.catalogue._roles import girders, layers, reaches
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, log_free
from permway.laws import Hysteretic
from permway.model.joints import Joints
from permway.model.stations import MEETINGS, TOUCH_M

ID = "span_coupling"
DOMAIN: Domain = "path"
FAMILY = "span coupling"
SUMMARY = "Springs with loss between the ends of neighbouring girders."
PARAMETERS = {
    "stiffness": "N/m, 3e5 to 3e12: of each link, across the joint",
    "loss_factor": "1, 0.003 to 3",
}
SIGNATURE = "Responses of one span to a blow on the next; pairs of girder frequencies move apart."
CONFUSED_WITH = {
    "deck_attachment": "a hammer test on the neighbouring span",
    "pier_soil": "a sensor on the pier",
}
SOURCE = "Rauert and others (2010), Engineering Structures 32, 3981-3988: bridges coupled by continuous ballast"


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each row of girders that meet and are not joined; none for a single span."""
    line = situation.campaign.model.line
    for name in girders(line):
        segments = reaches(line, name)
        met = [b.start for a, b in pairwise(segments) if b.start - a.stop < TOUCH_M]
        joined = any(layer.upper == layer.lower == name for layer in layers(line))
        if met and not joined:
            yield _of(name, (min(met), max(met)))


def _of(name: str, reach: tuple[float, float]) -> Hypothesis:
    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        link = fresh("link", campaign.model.line.laws)
        return with_joints(
            campaign,
            Joints(between=(name, name), law=link, at=MEETINGS),
            laws={link: Hysteretic(stiffness=values["stiffness"], loss_factor=values["loss_factor"])},
        )

    octaves = float(np.log(10.0))
    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            log_free("stiffness", "N/m", 1e9, float(np.exp(0.7 * octaves))),
            log_free("loss_factor", "1", 0.1, 2.0),
        ),
        amend=amend,
        locate=lambda _: Where(what=name, x_m=reach),
        starts=((-0.7, 0.0), (0.7, 0.0)),
        law=lambda v: f"{v['stiffness']:.3g} N/m between girders, loss factor {v['loss_factor']:.2g}",
        size="stiffness",
        none=0.0,
    )
