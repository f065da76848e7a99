"""A constant law made to relax: by a springpot, or by a spring and a dashpot in series, beside a spring."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import constant_law, with_law
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Hypothesis, Where, between_free, log_free
from permway.laws import Hysteretic, Maxwell, Parallel, Scaled, Springpot
from permway.laws.base import Law

REFERENCE_HZ = 60.0
"""Where the stiffness is stated."""

WHOLE = 0.1
"""Share, or rise, from which the constant loss may go entirely; below, in proportion: what hardly relaxes keeps
its loss. At twice or half of it only what relaxes by less than a tenth has another form."""


FORMS = (
    "A springpot beside a spring, k (1 - s) + k s (i f / f0)^a, f0 = 60 Hz, or a spring and a dashpot in series "
    "beside a spring, c + c r i f / (f1 + i f), for the constant stiffness k; of its constant loss a part stays."
)

PARAMETERS = {
    "stiffness_factor": "1, 0.33 to 3.05: stiffness at 60 Hz over the constant one",
    "order": "1, 0.02 to 0.8: order a of the springpot",
    "share": "1, 0 to 0.98: share s of the springpot",
    "rise": "1, 0.02 to 10: r, what the stiffness rises by through the relaxation, over that below it",
    "relaxation_Hz": "Hz, 4 to 1000: f1, where the loss of the relaxing branch is largest",
    "rest": "1, 0 to 1: part of the constant loss that stays; of s or r below 0.1 more stays",
}


def relaxations(entry: str, family: str, name: str) -> Iterator[Hypothesis]:
    """Both forms of a hysteretic law that relaxes.

    Parameters
    ----------
    entry, family : str
    name : str
        Of the law.
    """

    def springpot(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return relaxing(campaign, name, **values)

    def once(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
        return relaxing_once(campaign, name, **values)

    yield Hypothesis(
        entry=entry,
        domain="path",
        family=family,
        free=springpot_free(),
        amend=springpot,
        locate=lambda _: Where(what=name),
        # Weak ones of which the constant loss goes, in part, and of which it stays: these lose more than before.
        starts=(
            (0.0, -0.6, 0.5, -1.0),
            (0.0, -1.2, 1.2, -1.0),
            (0.0, 0.2, -0.7, 0.0),
            *((0.0, z, -1.0, 2.0) for z in (-1.2, -0.2, 0.8)),
        ),
        law=lambda v: (
            f"spring ({1 - v['share']:.2f} of the stiffness) beside a springpot of order {v['order']:.2f}"
        ),
        size="share",
        none=0.0,
    )
    yield Hypothesis(
        entry=entry,
        domain="path",
        family=family,
        free=(
            log_free("stiffness_factor", "1", 1.0, 1.25),
            log_free("rise", "1", 0.4, 2.0),
            log_free("relaxation_Hz", "Hz", 70.0, 2.0),
            between_free("rest", "1", 0.0, 1.0),
        ),
        amend=once,
        locate=lambda _: Where(what=name),
        # Sharp responses lead astray from what is far too strong: weak ones below, at and above the middle, too.
        starts=(
            (0.0, 0.0, 0.0, 1.0),
            (0.0, 0.0, 1.0, 1.0),
            (0.0, -1.5, 0.0, 1.0),
            *((0.0, -3.0, z, 2.0) for z in (-1.0, 0.0, 1.0)),
        ),
        law=lambda v: (
            f"relaxes about {v['relaxation_Hz']:.3g} Hz, where the stiffness rises by {100.0 * v['rise']:.0f} %"
        ),
        size="rise",
        none=0.0,
    )


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
        r, of the constant loss, what stays, of all that relaxes too; what goes, the springpot has. Of a share
        below :data:`WHOLE` so much less goes.
    """
    if share == 0.0:
        return campaign
    law = constant_law(campaign, name)
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
            _left(rest, share) * law.eta,
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
    if rise == 0.0:
        return campaign
    law = constant_law(campaign, name)
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
            _left(rest, rise) * law.eta,
        ),
    )


def _left(rest: float, size: float) -> float:
    """What stays of the constant loss: all of it beside a relaxation of no size."""
    return 1.0 - (1.0 - rest) * min(size / WHOLE, 1.0)


def _lossy(law: Law, loss_factor: float) -> Law:
    """A law with a constant loss of all of it."""
    return Scaled(law=law, factor=1.0, loss_factor=loss_factor)
