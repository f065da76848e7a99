"""Changes of a model that several effects share: laws, joints, bodies, sensors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from permway.laws.base import Law
from permway.model.bodies import AnyBody
from permway.model.joints import Joints
from permway.model.line import Line
from permway.recordings.campaign import Campaign
from permway.recordings.channel import Chain


def with_line(campaign: Campaign, **parts: Any) -> Campaign:
    """The campaign with other `bodies`, `joints` or `laws` of its line, checked again."""
    model = campaign.model
    line = Line(**{"bodies": model.line.bodies, "joints": model.line.joints, "laws": model.line.laws, **parts})
    return campaign.with_model(model.model_copy(update={"line": line}))


def with_law(campaign: Campaign, name: str, law: Law) -> Campaign:
    """The campaign with another law of that name."""
    return with_line(campaign, laws={**campaign.model.line.laws, name: law})


def with_joints(campaign: Campaign, *joints: Joints, laws: Mapping[str, Law] | None = None) -> Campaign:
    """The campaign with further joints, and their laws."""
    line = campaign.model.line
    return with_line(campaign, joints=(*line.joints, *joints), laws={**line.laws, **(laws or {})})


def with_body(campaign: Campaign, name: str, body: AnyBody, *joints: Joints, laws: Mapping[str, Law]) -> Campaign:
    """The campaign with a further body and the joints that hold it."""
    line = campaign.model.line
    return with_line(
        campaign,
        bodies={**line.bodies, name: body},
        joints=(*line.joints, *joints),
        laws={**line.laws, **laws},
    )


def with_chain(campaign: Campaign, sensor: str, chain: Chain) -> Campaign:
    """The campaign with another measuring chain of a sensor."""
    said = campaign.said
    sensors = tuple(s.model_copy(update={"chain": chain}) if s.name == sensor else s for s in said.sensors)
    changed = said.model_copy(update={"sensors": sensors})
    return Campaign(changed, campaign.model, campaign.folder, campaign.parameters)
