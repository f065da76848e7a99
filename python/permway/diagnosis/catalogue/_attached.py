"""Masses spread along a beam, on springs or fixed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import fresh, with_joints
from permway.diagnosis.catalogue._roles import reaches
from permway.laws.base import Law
from permway.model.joints import GROUND, Joints

STEP_M = 1.0
"""Between the joints that stand for a spread mass, at most."""


def spread_over(campaign: Campaign, body: str, per_metre: Mapping[str, Law]) -> Campaign:
    """Hang laws on all beams of a row.

    Parameters
    ----------
    body : str
        The row.
    per_metre : mapping of name to law
        Of a metre, N/m2.
    """
    line = campaign.model.line
    joints, laws = [], {}
    for name, law in per_metre.items():
        made = fresh(name, line.laws)
        laws[made] = law
        for segment in reaches(line, body):
            length = segment.stop - segment.start
            count = max(2, int(np.ceil(length / STEP_M)))
            # The middles of equal parts, so each stands for one of them.
            x = segment.start + length / count * (np.arange(count) + 0.5)
            joints.append(
                Joints(
                    between=(segment.name, GROUND),
                    law=made,
                    at=tuple(x.tolist()),
                    stiffness_is="per_metre",
                    layer_m=(segment.start, segment.stop),
                )
            )
    return with_joints(campaign, *joints, laws=laws)
