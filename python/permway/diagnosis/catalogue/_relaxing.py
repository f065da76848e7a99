"""A constant law made to relax: by a springpot, or by a spring and a dashpot in series, beside a spring."""

from __future__ import annotations

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_law
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import between_free, log_free
from permway.laws import Hysteretic, Maxwell, Parallel, Scaled, Springpot
from permway.laws.base import Law

REFERENCE_HZ = 60.0
"""Where the stiffness is constrained."""


def springpot_free() -> tuple[Free, ...]:
    """What :func:`relaxing` is made of, as parameters of a hypothesis."""
    return (
        log_free("stiffness_factor", "1", 1.0, 1.25),
        between_free("order", "1", 0.02, 0.8),
        between_free("share", "1", 0.0, 0.98),
        between_free("rest", "1", 0.0, 1.0),
    )


def relaxing(
    campaign: Campaign, name: str, *, stiffness_factor: float, order: float, share: float, rest: float = 0.0
) -> Campaign:
    """The campaign with k (1 + i r eta) (1 - s + s (i f / f0)^a / cos(a pi / 2)) for a law k (1 + i eta).

    Parameters
    ----------
    name : str
        Of a hysteretic law.
    stiffness_factor : float
        Of the stiffness at 60 Hz.
    order, share : float
        Of the springpot: a, and its share s of the stiffness at 60 Hz; without a share the constant stays.
    rest : float
        r, of the constant loss, what stays, of all that relaxes too; what goes, the springpot has.
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
        _lossy(
            Parallel(
                first=Hysteretic(stiffness=stiffness * (1.0 - share)),
                second=Springpot(coefficient=float(coefficient), order=order),
            ),
            rest * law.eta,
        ),
    )


def relaxing_once(
    campaign: Campaign, name: str, *, stiffness_factor: float, rise: float, relaxation_Hz: float, rest: float
) -> Campaign:
    """The campaign with a spring and a dashpot in series beside the spring of a law, c (1 + r i f / (f1 + i f)).

    Parameters
    ----------
    name : str
        Of a hysteretic law k (1 + i eta).
    stiffness_factor : float
        Of the stiffness at 60 Hz.
    rise, relaxation_Hz : float
        r, stiffness far above the relaxation over that far below it, less 1; and f1.
    rest : float
        Of the constant loss eta, what stays, of all that relaxes too.
    """
    law = campaign.model.line.laws[name]
    if rise == 0.0:
        return campaign
    assert isinstance(law, Hysteretic)
    stiffness = law.stiffness * stiffness_factor
    static = 1.0 / (1.0 + rise * REFERENCE_HZ**2 / (REFERENCE_HZ**2 + relaxation_Hz**2))
    branch = rise * static * stiffness
    return with_law(
        campaign,
        name,
        _lossy(
            Parallel(
                first=Hysteretic(stiffness=stiffness * static),
                second=Maxwell(stiffness=branch, damping=branch / (2.0 * np.pi * relaxation_Hz)),
            ),
            rest * law.eta,
        ),
    )


def _lossy(law: Law, loss_factor: float) -> Law:
    """A law with a constant loss of all of it."""
    return Scaled(law=law, factor=1.0, loss_factor=loss_factor)
