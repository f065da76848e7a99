"""Fits again: sizes of errors learnt anew, slopes taken anew, parameters put elsewhere."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Fit, free_parameters
from permway.diagnosis.learning import learnt
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.tangent import Problem
from permway.errors import InputError

HOPELESS = 3.0
"""Times the gain of the last learning by which a fit may lie behind a rival and yet come near."""

MOST_RELEARNT, RELEARNT = 6, 2.0
"""Times that sizes are learnt of a model that is fitted, and what the objective must then gain."""


def relearnt(fit: Fit, sharp: Evidence, *, best: float = np.inf) -> Fit:
    """On the records as they are, the sizes of smooth errors learnt anew, now that less is left to explain.

    As often as the fit gains by it: sizes that are too large hide where to go on.

    Parameters
    ----------
    fit : Fit
    sharp : Evidence
        Of the records as they are.
    best : float
        Objective of a rival: what lies behind it by more than a few times its last gain will not come near.
    """
    return learnt_on(fit, sharp, best=best)[0]


def learnt_on(fit: Fit, sharp: Evidence, *, best: float) -> tuple[Fit, list[Reals]]:
    """As :func:`relearnt`, and at which z sizes were learnt on the way."""
    value, slopes = np.inf, None
    # Learning is a fixed point and no descent: it may lead to what is worse.
    kept = settled(fit) if fit.evidence is sharp else None
    path: list[Reals] = []
    way: list[Reals] = []
    for _ in range(MOST_RELEARNT):
        evidence, _ = learnt(sharp, sharp.predicted(fit.campaign))
        way = [*way, fit.z]
        fit = recalibrate(evidence, build=fit.build, free=fit.free, start=fit.z, learn=False, slopes=slopes)
        slopes = fit.jacobian
        if kept is None or fit.objective < kept.objective:
            kept, path = fit, way
        if fit.objective > value - RELEARNT or fit.objective - best > HOPELESS * (value - fit.objective):
            break
        sharp, value = evidence, fit.objective
    assert kept is not None
    return kept, path


def weighed_anew(fit: Fit) -> Fit:
    """Fitted to records that are weighed by its own prediction: a base that lacks an effect weighs them wrongly.

    Coherences above all, where the effect makes them other than the base has them.
    """
    return relearnt(fit, fit.evidence.reweighed(fit.evidence.predicted(fit.campaign)))


def settled(fit: Fit) -> Fit:
    """The same with slopes and covariance of where it ended."""
    return recalibrate(
        fit.evidence,
        build=fit.build,
        free=fit.free,
        start=fit.z,
        slopes=fit.jacobian,
        learn=False,
        reweigh=False,
        most_steps=0,
    )


def moved(fit: Fit, about: Mapping[str, float]) -> Fit:
    """The same model with some parameters elsewhere, nothing sought: deviations, slopes and covariance of there.

    Parameters
    ----------
    fit : Fit
    about : mapping of str to float
        Coordinates z by name.
    """
    z = np.array([about.get(f.name, float(z)) for f, z in zip(fit.free, fit.z, strict=True)])
    return recalibrate(
        fit.evidence, build=fit.build, free=fit.free, start=z, learn=False, reweigh=False, most_steps=0
    )


def untouched(evidence: Evidence) -> Fit:
    """The owner's values as if the records were what they predict: slopes and covariance, and no deviation."""
    problem = Problem(evidence, evidence.campaign.with_values, free_parameters(evidence.campaign))
    state = problem.at(np.zeros(len(problem.free)))
    if state is None:
        raise InputError("the model cannot be solved", where="model")
    tangent = problem.tangent(state)
    nothing = np.zeros_like(state.deviations)
    return Fit(
        free=problem.free,
        z=state.z,
        covariance=np.asarray(linalg.inv(tangent.normal(1.0))),
        campaign=state.solved.campaign,
        evidence=evidence,
        deviations=nothing,
        clean=nothing,
        chi2=0.0,
        prior=0.0,
        log_determinant=tangent.whitener.log_determinant,
        jacobian=tangent.jacobian,
        heat=1.0,
        evaluations=problem.evaluations,
        build=problem.build,
    )
