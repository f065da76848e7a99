"""A constant law made to relax: a springpot beside a spring takes its place."""

from __future__ import annotations

import numpy as np

from permway.diagnosis.catalogue._change import with_law
from permway.laws import FractionalKelvinVoigt, Hysteretic
from permway.recordings.campaign import Campaign

REFERENCE_HZ = 60.0
"""Where the stiffness is told."""


def relaxing(campaign: Campaign, name: str, *, stiffness_factor: float, order: float, share: float) -> Campaign:
    """The campaign with k (1 - s) + k s (i f / f0)^a / cos(a pi / 2) for a constant law k (1 + i eta).

    All loss is then the springpot's: that of the constant was fitted to it.

    Parameters
    ----------
    name : str
        Of a hysteretic law.
    stiffness_factor : float
        Of the stiffness at 60 Hz.
    order, share : float
        Of the springpot: a, and its share s of the stiffness at 60 Hz; without a share the constant stays.
    """
    law = campaign.model.line.laws[name]
    if share == 0.0:
        return campaign
    assert isinstance(law, Hysteretic)
    stiffness = law.stiffness * stiffness_factor
    # At f0 the real parts add up to the stiffness.
    coefficient = stiffness * share / np.cos(0.5 * np.pi * order) * (2.0 * np.pi * REFERENCE_HZ) ** -order
    return with_law(
        campaign,
        name,
        FractionalKelvinVoigt(stiffness=stiffness * (1.0 - share), coefficient=float(coefficient), order=order),
    )
