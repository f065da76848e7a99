"""Joints of a layer changed over a stretch whose ends may lie anywhere."""

from __future__ import annotations

import numpy as np

from permway.diagnosis.catalogue._change import with_line
from permway.model.changes import Change
from permway.model.line import Line
from permway.recordings.campaign import Campaign


def layers_of(line: Line, law: str) -> list[int]:
    """Indices of the layers that a law is the stiffness of."""
    return [i for i, layer in enumerate(line.joints) if layer.law == law]


def spacing_of(line: Line, law: str) -> float:
    """Distance of neighbouring joints of a law, m; 1 where they have none."""
    table = line.joint_table()
    x = np.unique(table.x[table.law == list(line.laws).index(law)])
    return float(np.median(np.diff(x))) if x.size > 1 else 1.0


def weakened(campaign: Campaign, law: str, centre_m: float, length_m: float, factor: float) -> Campaign:
    """All layers of a law with a factor over a stretch, its edges a joint's spacing wide.

    A joint within `length_m` of the stretch has the factor, and the change fades out linearly over one spacing on
    either side: so the model follows the ends smoothly, and a stretch that ends midway between two joints changes
    the outer one by half.
    """
    line = campaign.model.line
    step = spacing_of(line, law)
    low, high = centre_m - 0.5 * length_m, centre_m + 0.5 * length_m
    changes = [Change(from_m=low, to_m=high, factor=factor)]
    changes.append(Change(from_m=low - step, to_m=low - 1e-6 * step, factor_from=1.0, factor_to=factor))
    changes.append(Change(from_m=high + 1e-6 * step, to_m=high + step, factor_from=factor, factor_to=1.0))
    table = line.joint_table()
    joints = list(line.joints)
    for index in layers_of(line, law):
        layer, x = joints[index], table.x[table.layer == index]
        mine = tuple(c for c in changes if c.holds(x).any())
        joints[index] = layer.model_copy(update={"changes": (*layer.changes, *mine)})
    return with_line(campaign, joints=tuple(joints))
