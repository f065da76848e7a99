"""A constant law made to relax: by a springpot, or by a spring and a dashpot in series, beside a spring."""

from __future__ import annotations

import numpy as np

from permway.diagnosis.catalogue._change import with_law
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import between_free, log_free
from permway.laws import Hysteretic, Maxwell, Parallel, Springpot
from permway.recordings.campaign import Campaign

REFERENCE_HZ = 60.0
"""Where the stiffness is told."""


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
    """The campaign with k (1 - s) + i k r eta + k s (i f / f0)^a / cos(a pi / 2) for a law k (1 + i eta).

    Parameters
    ----------
    name : str
        Of a hysteretic law.
    stiffness_factor : float
        Of the stiffness at 60 Hz.
    order, share : float
        Of the springpot: a, and its share s of the stiffness at 60 Hz; without a share the constant stays.
    rest : float
        r, of the constant loss, what stays constant; what goes, the springpot has.
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
        Parallel(
            first=_constant(stiffness, 1.0 - share, rest * law.eta),
            second=Springpot(coefficient=float(coefficient), order=order),
        ),
    )


def relaxing_once(
    campaign: Campaign, name: str, *, stiffness_factor: float, rise: float, relaxation_Hz: float, rest: float
) -> Campaign:
    """The campaign with a spring and a dashpot in series, r c i f / (f1 + i f), beside the spring c of a law.

    Parameters
    ----------
    name : str
        Of a hysteretic law k (1 + i eta).
    stiffness_factor : float
        Of the stiffness at 60 Hz.
    rise, relaxation_Hz : float
        r, stiffness far above the relaxation over that far below it, less 1; and f1.
    rest : float
        Of the constant loss k eta, what stays constant.
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
        Parallel(
            first=_constant(stiffness, static, rest * law.eta),
            second=Maxwell(stiffness=branch, damping=branch / (2.0 * np.pi * relaxation_Hz)),
        ),
    )


def _constant(stiffness: float, share: float, loss_factor: float) -> Hysteretic:
    """A share of a stiffness, with a loss factor of the whole."""
    return Hysteretic(stiffness=stiffness * share, loss_factor=loss_factor / share)
