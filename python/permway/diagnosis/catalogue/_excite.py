"""Changes of a campaign that effects of excitation and measurement share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from permway.campaign.campaign import Campaign
from permway.campaign.parts import IrregularityKnown
from permway.diagnosis.hypothesis import Where
from permway.model.line import Line
from permway.recordings.channel import Chain

END_M = 0.01
"""Within which a bearing stands at a beam's end, as a share of the beam's length."""


def with_irregularity(campaign: Campaign, **parts: Any) -> Campaign:
    """The campaign with other numbers of what it says of the irregularity, checked again."""
    known = campaign.stated.irregularity
    changed = IrregularityKnown(**{**dict(known), **parts})
    stated = campaign.stated.model_copy(update={"irregularity": changed})
    return replace(campaign, stated=stated)


def with_speed(campaign: Campaign, factor: float, condition: str | None = None) -> Campaign:
    """The campaign with the speed of one train, or of all, times a factor."""
    stated = campaign.stated
    conditions = tuple(
        c.model_copy(update={"speed_m_per_s": c.speed_m_per_s * factor})
        if c.speed_m_per_s is not None and condition in (None, c.name)
        else c
        for c in stated.conditions
    )
    changed = stated.model_copy(update={"conditions": conditions})
    return replace(campaign, stated=changed)


def stays(
    what: str = "", x_m: tuple[float, float] | None = None, channels: tuple[str, ...] = ()
) -> Callable[[Mapping[str, float]], Where]:
    """The place of an effect that no value moves."""
    where = Where(what=what, x_m=x_m, channels=channels)
    return lambda _: where


def chain_with(chain: Chain, **parts: Any) -> Chain:
    """A measuring chain with other numbers, checked again."""
    return Chain(**{**dict(chain), **parts})


def rail_laws(line: Line, rail: str) -> list[str]:
    """Laws that hold the rail."""
    return list(dict.fromkeys(j.law for j in line.joints if rail in [b.split("[")[0] for b in j.between]))


def spans(line: Line, rail: str) -> list[tuple[str, float, float]]:
    """Beams on bearings at their ends, by name, from and to."""
    segments, table = line.segments(), line.joint_table()
    found = []
    for index, segment in enumerate(segments):
        length = segment.stop - segment.start
        if segment.body == rail or not np.isfinite(length) or length <= 0.0:
            continue
        stations = table.x[(table.upper == index) & (table.lower == -1)]
        ends = [np.any(np.abs(stations - end) <= END_M * length) for end in (segment.start, segment.stop)]
        if all(ends) and stations.size <= 4:
            found.append((segment.name, segment.start, segment.stop))
    return found
