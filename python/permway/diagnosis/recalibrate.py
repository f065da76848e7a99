"""Which values the tolerances allow the parameters to take up, the sizes of calibration errors being known.

Gauss-Newton with Levenberg's damping on the standardised residuals, each parameter in standard deviations of its
nominal prior, calibration errors integrated out.
"""

from __future__ import annotations

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.bounded import bounded_step
from permway.diagnosis.fit import Build, Fit, Free, free_parameters, limits_of
from permway.diagnosis.observations import Observations
from permway.diagnosis.speeds import begin
from permway.diagnosis.tangent import Problem, State, Tangent
from permway.errors import InputError

UNFIT, COARSE = 1.5, 1e-3
"""Mean square of the residuals from which a model does not fit, and share of them that a step must then gain."""

AS_PREDICTED = 0.95
"""Ratio of a step's gain to what the slopes predicted, or the other way round, from which they serve once more."""

CURVED, BENDS = 0.5, 3
"""Ratio of a step's gain to what the slopes predicted below which the step is taken again with the curvature
that it met: a second-order correction, as Fletcher's (1982) of constrained steps; and how often."""

AT_REST = 0.1
"""Share of the least gain of a step below which slopes that are exact predict none worth taking."""


def recalibrate(
    observations: Observations,
    *,
    build: Build | None = None,
    free: tuple[Free, ...] | None = None,
    start: Reals | None = None,
    most_steps: int = 30,
) -> Fit:
    """Find the most probable values of the free parameters.

    Parameters
    ----------
    observations : Observations
    build : callable, optional
        From values to a campaign; by default the campaign's own parameters.
    free : tuple of Free, optional
        By default the campaign's own parameters.
    start : ndarray, shape (p,), optional
        Where to begin, in z; by default at the priors' centres, and at the speeds that fit best.
    most_steps : int
        0 to stay at the start.

    Raises
    ------
    InputError
        If the model cannot be predicted at the start.
    """
    build = observations.campaign.with_values if build is None else build
    free = free_parameters(observations.campaign) if free is None else free
    problem = Problem(observations, build, free)
    if start is not None:
        z = start.copy()
    else:
        z = begin(observations, problem) if build == observations.campaign.with_values else np.zeros(len(free))
    state, tangent = _descended(problem, z, most_steps)
    chi2 = tangent.chi2(state)
    inflation = max(1.0, chi2 / max(1, state.residuals.size))
    whitener = tangent.whitener
    explained = whitener.calibration(whitener.explained(state.residuals), state.residuals.size)
    return Fit(
        free=free,
        z=state.z,
        covariance=np.asarray(linalg.inv(tangent.normal(inflation))),
        campaign=state.solved.campaign,
        observations=observations,
        residuals=state.residuals,
        clean=state.residuals - explained,
        chi2=chi2,
        prior=float(state.z @ state.z),
        log_determinant=whitener.log_determinant,
        jacobian=tangent.jacobian,
        inflation=inflation,
        evaluations=problem.evaluations,
        build=build,
    )


def _descended(problem: Problem, z: Reals, most_steps: int) -> tuple[State, Tangent]:
    """The most probable state, and its tangent."""
    low, high = limits_of(problem.free)
    state = problem.at(np.clip(z, low, high))
    if state is None:
        raise InputError("the model cannot be solved there", where="start", value=z.tolist())
    tangent, damping = problem.tangent(state), 1e-3
    for _ in range(most_steps):
        # Far from the records the priors lead: the residuals count as if each were no better than all are.
        inflation = max(1.0, tangent.chi2(state) / max(1, state.residuals.size))
        enough = 0.5 if inflation < UNFIT else COARSE * state.residuals.size
        normal, slope = tangent.normal(inflation), tangent.slope(state, inflation)
        fresh = tangent.at is state
        moved, gained, predicted = None, 0.0, 0.0
        for _ in range(8 if fresh else 2):
            shift = bounded_step(normal, slope, state.z, low, high, damping)
            predicted = -float(2.0 * slope @ shift + shift @ normal @ shift)
            if fresh and predicted < AT_REST * enough:
                break
            tried = problem.at(np.clip(state.z + shift, low, high))
            if tried is not None:
                tried, gained = _to_the_floor(problem, tangent, state, tried, inflation, damping, predicted)
                if gained > 0.0:
                    moved, damping = tried, max(damping / 10.0, 1e-9)
                    break
            damping = max(damping * 10.0, 1e-6)
        state = state if moved is None else moved
        if gained >= enough:
            # Where the step did what the slopes predicted, they do for the next.
            if not AS_PREDICTED * predicted < gained < predicted / AS_PREDICTED:
                tangent = problem.tangent(state)
        elif fresh and moved is None:
            break
        else:
            tangent = problem.tangent(state)
    return state, tangent if tangent.at is state else problem.tangent(state)


def _to_the_floor(
    problem: Problem,
    tangent: Tangent,
    state: State,
    tried: State,
    inflation: float,
    damping: float,
    predicted: float,
) -> tuple[State, float]:
    """A step that gained less than predicted, as far along a curved valley, and back to its floor; its gain."""
    low, high = limits_of(problem.free)
    before, normal = tangent.inflated(state, inflation), tangent.normal(inflation)
    gained = before - tangent.inflated(tried, inflation)
    for _ in range(BENDS):
        if gained > CURVED * predicted:
            break
        curved = tangent.slope(tangent.curved(state, tried), inflation)
        shift = bounded_step(normal, curved, state.z, low, high, damping)
        other = problem.at(np.clip(state.z + shift, low, high))
        if other is None:
            break
        more = before - tangent.inflated(other, inflation)
        if more <= gained:
            break
        tried, gained = other, more
    return tried, gained
