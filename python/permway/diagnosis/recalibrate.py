"""Recalibration: what the stated tolerances allow the parameters to take up, and how surely.

Gauss-Newton with Levenberg's damping on the standardised deviations of all records together, each parameter in
standard deviations of its owner's prior, smooth errors integrated out. The sizes of the smooth errors are learnt
on the way (MacKay's fixed point, 1992), and so is the length over which those of chains correlate.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.bounded import bounded_step
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Build, Fit, Free, free_parameters, limits_of
from permway.diagnosis.journal import Arrays, current
from permway.diagnosis.learning import learnt
from permway.diagnosis.speeds import begin
from permway.diagnosis.tangent import Problem, State, Tangent
from permway.errors import InputError

UNFIT, COARSE = 1.5, 1e-3
"""Mean square of the deviations from which a model does not fit, and share of them that a step must then gain."""

FORETOLD = 0.95
"""Ratio of a step's gain to what the slopes foretold, or the other way round, from which they serve once more."""

CURVED, BENDS = 0.5, 3
"""Ratio of a step's gain to what the slopes foretold below which the step is taken again with the curvature
that it met: a second-order correction, as Fletcher's (1982) of constrained steps; and how often."""

AT_REST = 0.1
"""Share of the least gain of a step below which slopes that are exact foretell none worth taking."""

MOST_LEARNT = 2
"""Times that the sizes of smooth errors are learnt on the way."""

Progress = Callable[[str], object]

Changes = list[tuple[bool, bool, Reals]]
"""Where the evidence was changed: whether spectra were weighed anew, whether sizes were learnt, and at which z."""


def recalibrate(
    evidence: Evidence,
    *,
    build: Build | None = None,
    free: tuple[Free, ...] | None = None,
    start: Reals | None = None,
    learn: bool = True,
    reweigh: bool | None = None,
    slopes: Reals | None = None,
    most_steps: int = 30,
    settle: bool = True,
    progress: Progress | None = None,
) -> Fit:
    """Find the most probable values of the free parameters.

    Parameters
    ----------
    evidence : Evidence
    build : callable, optional
        From values to a campaign; by default the campaign's own parameters.
    free : tuple of Free, optional
        By default the campaign's own parameters.
    start : ndarray, shape (p,), optional
        Where to begin, in z; by default at the priors' centres, and at the speeds that fit best.
    learn : bool
        Whether to learn the sizes of smooth errors.
    reweigh : bool, optional
        Whether to weigh spectra anew by what the fit predicts; by default if `build` is not given. Objectives
        compare only between fits that weigh alike.
    slopes : ndarray, shape (n, p), optional
        Derivatives of the deviations near the start, to begin with.
    most_steps : int
    settle : bool
        Whether slopes are taken anew where it ends; else they, and the covariance, may be of a place near by.
    progress : callable, optional
        Told in words how far it is.

    Raises
    ------
    InputError
        If the model cannot be predicted at the start.
    """
    reweigh = build is None if reweigh is None else reweigh
    build = evidence.campaign.with_values if build is None else build
    free = free_parameters(evidence.campaign) if free is None else free
    problem = Problem(evidence, build, free)
    own = start is None and build == evidence.campaign.with_values
    journal = current()
    names = [f.name for f in free]
    given = (
        names,
        start,
        slopes is None,
        learn,
        reweigh,
        most_steps,
        settle,
        evidence.length,
        sorted(evidence.sizes.items()),
    )
    kept = None if journal is None else journal.recall("recalibrate", *given)
    if kept is None:
        z = begin(evidence, problem) if own else np.zeros(len(free)) if start is None else start.copy()
        state, tangent, changes = _descended(problem, z, learn, reweigh, slopes, most_steps, settle, progress)
        if journal is not None:
            journal.keep(_noted(state, changes, problem.evaluations))
    else:
        state = _recalled(problem, kept)
        tangent = problem.tangent(state)
    chi2 = tangent.chi2(state)
    heat = max(1.0, chi2 / max(1, state.deviations.size))
    whitener = tangent.whitener
    smooth = whitener.smooth(whitener.explained(state.deviations), state.deviations.size)
    return Fit(
        free=free,
        z=state.z,
        covariance=np.asarray(linalg.inv(tangent.normal(heat))),
        campaign=state.solved.campaign,
        evidence=problem.evidence,
        deviations=state.deviations,
        clean=state.deviations - smooth,
        chi2=chi2,
        prior=float(state.z @ state.z),
        log_determinant=tangent.whitener.log_determinant,
        jacobian=tangent.jacobian,
        heat=heat,
        evaluations=problem.evaluations,
        build=build,
    )


def _descended(
    problem: Problem,
    z: Reals,
    learn: bool,
    reweigh: bool,
    slopes: Reals | None,
    most_steps: int,
    settle: bool,
    progress: Progress | None,
) -> tuple[State, Tangent, Changes]:
    """The most probable state, its tangent, and where on the way to it the evidence was changed."""
    free, changes = problem.free, []
    state = _solvable(problem, z)
    tangent = problem.tangent(state, slopes)
    exact = slopes is None
    damping, rounds = 1e-3, 0
    low, high = limits_of(free)
    for step in range(most_steps):
        # Far from the records the priors lead: the deviations count as if each were no better than all are.
        heat = max(1.0, tangent.chi2(state) / max(1, state.deviations.size))
        # A base that does not fit is no more than where a search begins.
        enough = 0.5 if heat < UNFIT else COARSE * state.deviations.size
        normal, slope = tangent.normal(heat), tangent.slope(state, heat)
        fresh = tangent.at is state and exact
        moved, gained, foretold = None, 0.0, 0.0
        for _ in range(8 if fresh else 2):
            shift = bounded_step(normal, slope, state.z, low, high, damping)
            foretold = -float(2.0 * slope @ shift + shift @ normal @ shift)
            if fresh and foretold < AT_REST * enough:
                break
            tried = problem.at(np.clip(state.z + shift, low, high))
            if tried is not None:
                tried, gained = _to_the_floor(problem, tangent, state, tried, heat, damping, foretold)
                if gained > 0.0:
                    moved, damping = tried, max(damping / 10.0, 1e-9)
                    break
            damping = max(damping * 10.0, 1e-6)
        state = state if moved is None else moved
        if progress is not None:
            progress(f"step {step + 1}, {tangent.heated(state, 1.0):.1f}, heat {heat:.3g}")
        if gained >= enough:
            # Where the step did what the slopes foretold, they do for the next.
            if not FORETOLD * foretold < gained < foretold / FORETOLD:
                tangent, exact = problem.tangent(state), True
        elif moved is None and not fresh:
            tangent, exact = problem.tangent(state), True
        elif (learn and rounds < MOST_LEARNT) or reweigh:
            changes.append((reweigh, learn, state.z))
            change, reweigh = _changed(problem, state, reweigh, learn), False
            if learn:
                rounds = rounds + 1 if change >= 0.1 else MOST_LEARNT
            state = problem.again(state)
            tangent, exact = problem.tangent(state), True
            damping = 1e-3
        elif settle and not fresh:
            tangent, exact = problem.tangent(state), True
        else:
            break
    if settle and (tangent.at is not state or not exact):
        tangent = problem.tangent(state)
    return state, tangent, changes


def _to_the_floor(
    problem: Problem, tangent: Tangent, state: State, tried: State, heat: float, damping: float, foretold: float
) -> tuple[State, float]:
    """A step that gained less than foretold, taken as far along a bent valley, and back to its floor; its gain."""
    low, high = limits_of(problem.free)
    before, normal = tangent.heated(state, heat), tangent.normal(heat)
    gained = before - tangent.heated(tried, heat)
    for _ in range(BENDS):
        if gained > CURVED * foretold:
            break
        bent = tangent.slope(tangent.bent(state, tried), heat)
        shift = bounded_step(normal, bent, state.z, low, high, damping)
        other = problem.at(np.clip(state.z + shift, low, high))
        if other is None:
            break
        more = before - tangent.heated(other, heat)
        if more <= gained:
            break
        tried, gained = other, more
    return tried, gained


def _changed(problem: Problem, state: State, reweigh: bool, learn: bool) -> float:
    """Weigh spectra anew, learn the sizes of smooth errors: the largest change of a size's logarithm."""
    change = 0.0
    if reweigh:
        problem.evidence = problem.evidence.reweighed(state.solved)
    if learn:
        problem.evidence, change = learnt(problem.evidence, state.solved)
    return change


def _noted(state: State, changes: Changes, evaluations: int) -> dict[str, np.ndarray]:
    """What it takes to come to a state again."""
    return {
        "z": state.z,
        "changed": np.array([(reweigh, learn) for reweigh, learn, _ in changes], dtype=bool).reshape(
            len(changes), 2
        ),
        "changed_at": np.array([z for _, _, z in changes]).reshape(len(changes), state.z.size),
        "evaluations": np.array(evaluations),
    }


def _recalled(problem: Problem, kept: Arrays) -> State:
    """The state that an earlier run came to, the evidence changed on the way as it was then."""
    for (reweigh, learn), z in zip(kept["changed"], kept["changed_at"], strict=True):
        _changed(problem, _solvable(problem, z), bool(reweigh), bool(learn))
    problem.evaluations = int(kept["evaluations"])
    return _solvable(problem, kept["z"])


def _solvable(problem: Problem, z: Reals) -> State:
    state = problem.at(np.clip(z, *limits_of(problem.free)))
    if state is None:
        raise InputError("the model cannot be solved there", where="start", value=z.tolist())
    return state
