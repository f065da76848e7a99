"""Fasteners one by one, where the model has a continuous support."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_line
from permway.diagnosis.catalogue._roles import DENSE_M, Layer, pads, spacing
from permway.diagnosis.hypothesis import Domain, Hypothesis, Situation, Where, between_free, linear_free
from permway.model.joints import Joints

ID = "discrete_support"
DOMAIN: Domain = "path"
FAMILY = "support modelling"
SUMMARY = "A share of a rail's continuous support is gathered at fasteners of a spacing."
PARAMETERS = {
    "share": "1, 0 to 1: of the stiffness that stands at fasteners",
    "spacing_m": "m, 0.45 to 0.85: of the fasteners",
    "offset": "1, -0.5 to 0.5: of the fasteners, in spacings",
}
SIGNATURE = (
    "Responses of the rail towards the pinned-pinned frequency, near 1 kHz, by place in the bay; from a train, "
    "lines at speed over spacing."
)
CONFUSED_WITH = {
    "parametric_support": "a line over speed only",
    "pad_frequency": "all places in a bay alike",
}
SOURCE = (
    "Grassie and others (1982), J. Mech. Eng. Sci. 24, 77-90; Heckl (2002), J. Sound and Vibration 252, 849-882"
)
FEWEST = 20


def hypotheses(situation: Situation) -> Iterator[Hypothesis]:
    """One for each dense layer below a rail."""
    for layer in pads(situation.campaign.model.line):
        if layer.x.size >= FEWEST and spacing(layer.x) < DENSE_M:
            yield _of(layer)


def _of(layer: Layer) -> Hypothesis:
    low, high = float(layer.x.min()), float(layer.x.max())

    def amend(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        share, step = values["share"], values["spacing_m"]
        if share == 0.0:
            return campaign
        line = campaign.model.line
        table = line.joint_table()
        total = float(table.scale[table.layer == layer.index].sum())
        first = 0.5 * (low + high) + values["offset"] * step
        numbers = np.arange(np.ceil((low - first) / step), np.floor((high - first) / step) + 1.0)
        x = first + step * numbers
        joints = list(line.joints)
        own = joints[layer.index]
        joints[layer.index] = own.model_copy(update={"scale": own.scale * (1.0 - share)})
        each = share * total / x.size
        joints.append(Joints(between=own.between, law=own.law, at=tuple(x.tolist()), scale=each))
        return with_line(campaign, joints=tuple(joints))

    return Hypothesis(
        entry=ID,
        domain=DOMAIN,
        family=FAMILY,
        free=(
            between_free("share", "1", 0.0, 1.0),
            linear_free("spacing_m", "m", 0.62, 0.04, 0.45, 0.85),
            linear_free("offset", "1", 0.0, 0.3, -0.5, 0.5),
        ),
        amend=amend,
        locate=lambda _: Where(what=layer.law, x_m=(low, high)),
        starts=((1.0, 0.0, 0.0), (1.0, 0.0, 1.2)),
        law=lambda v: f"{v['share']:.2f} of the stiffness at fasteners every {v['spacing_m']:.3f} m",
        size="share",
        none=0.0,
    )
