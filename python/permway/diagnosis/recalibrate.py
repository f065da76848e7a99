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
from permway.diagnosis.evidence import LARGEST_SMOOTH, SMALLEST_SMOOTH, Evidence, Solved
from permway.diagnosis.fit import Build, Fit, Free, free_parameters
from permway.diagnosis.journal import Arrays, current
from permway.diagnosis.speeds import begin
from permway.diagnosis.tangent import Problem, State, Tangent
from permway.diagnosis.wander import LENGTHS
from permway.errors import InputError

USUAL, SEEN = 0.02, 4.0
"""Size of smooth errors that is expected beforehand, neper or rad, and how many coefficients it counts for."""

APART, FEWEST_ALIKE = 3.0, 4
"""Times the median of its kind that the size of an origin may be, and of how many that is told."""

LARGEST = {"irregularity": 1.5, "decay": 0.5}
"""Of origins by their first word, nepers of a power, where it is not that of a chain."""

UNFIT, COARSE = 1.5, 1e-3
"""Mean square of the deviations from which a model does not fit, and share of them that a step must then gain."""

FORETOLD = 0.95
"""Ratio of a step's gain to what the slopes foretold, or the other way round, from which they serve once more."""

MOST_LEARNT, LEARNING_STEPS = 2, 5
"""Times that the sizes of smooth errors are learnt, and steps each time."""

HOPELESS = 3.0
"""Times the gain of the last learning by which a fit may lie behind a rival and yet come near."""

MOST_RELEARNT, RELEARNT = 6, 2.0
"""Times that sizes are learnt of a model that is fitted, and what the objective must then gain."""

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
    low, high = _limits(free)
    for step in range(most_steps):
        # Far from the records the priors lead: the deviations count as if each were no better than all are.
        heat = max(1.0, tangent.chi2(state) / max(1, state.deviations.size))
        normal, slope = tangent.normal(heat), tangent.slope(state, heat)
        fresh = tangent.at is state and exact
        moved, gained, foretold = None, 0.0, 0.0
        for _ in range(8 if fresh else 2):
            shift = bounded_step(normal, slope, state.z, low, high, damping)
            tried = problem.at(np.clip(state.z + shift, low, high))
            gained = 0.0 if tried is None else tangent.heated(state, heat) - tangent.heated(tried, heat)
            if tried is not None and gained > 0.0:
                foretold = -float(2.0 * slope @ shift + shift @ normal @ shift)
                moved, damping = tried, max(damping / 10.0, 1e-9)
                break
            damping = max(damping * 10.0, 1e-6)
        state = state if moved is None else moved
        if progress is not None:
            progress(f"step {step + 1}, {tangent.heated(state, 1.0):.1f}, heat {heat:.3g}")
        # A base that does not fit is no more than where a search begins.
        enough = 0.5 if heat < UNFIT else COARSE * state.deviations.size / heat
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
        else:
            break
    if settle and (tangent.at is not state or not exact):
        tangent = problem.tangent(state)
    return state, tangent, changes


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
        "changed": np.array([(reweigh, learn) for reweigh, learn, _ in changes], dtype=bool).reshape(-1, 2),
        "changed_at": np.array([z for _, _, z in changes]).reshape(-1, state.z.size),
        "evaluations": np.array(evaluations),
    }


def _recalled(problem: Problem, kept: Arrays) -> State:
    """The state that an earlier run came to, the evidence changed on the way as it was then."""
    for (reweigh, learn), z in zip(kept["changed"], kept["changed_at"], strict=True):
        _changed(problem, _solvable(problem, z), bool(reweigh), bool(learn))
    problem.evaluations = int(kept["evaluations"])
    return _solvable(problem, kept["z"])


def _solvable(problem: Problem, z: Reals) -> State:
    state = problem.at(np.clip(z, *_limits(problem.free)))
    if state is None:
        raise InputError("the model cannot be solved there", where="start", value=z.tolist())
    return state


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
    value, slopes = np.inf, None
    for _ in range(MOST_RELEARNT):
        evidence, _ = learnt(sharp, sharp.predicted(fit.campaign))
        fit = recalibrate(evidence, build=fit.build, free=fit.free, start=fit.z, learn=False, slopes=slopes)
        slopes = fit.jacobian
        if fit.objective > value - RELEARNT or fit.objective - best > HOPELESS * (value - fit.objective):
            break
        sharp, value = evidence, fit.objective
    return fit


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


def _limits(free: tuple[Free, ...]) -> tuple[Reals, Reals]:
    if not free:
        return np.zeros(0), np.zeros(0)
    low, high = np.array([f.limits for f in free]).T
    return low, high


def learnt(evidence: Evidence, solved: Solved) -> tuple[Evidence, float]:
    """Learn the sizes of smooth errors, and the length of those of chains, about a prediction.

    Sizes by MacKay's fixed point (1992): a coefficient counts by as much as the records tell of it.

    Returns
    -------
    (Evidence, float)
        And the largest change of a size's logarithm.
    """
    before = evidence.sizes
    for step in range(LEARNING_STEPS):
        deviations = evidence.deviations(solved.datasets)
        if step == 0:
            evidence = _of_best_length(evidence, deviations)
        whitener = evidence.whitener
        coefficients, told = whitener.explained(deviations), 1.0 - whitener.variances()
        origin_of = whitener.of_origin()
        sizes, change = dict(evidence.sizes), 0.0
        for index, origin in enumerate(whitener.columns.origins):
            if origin.fixed:
                continue
            mine, old = origin_of == index, evidence.sizes[origin.name]
            # As if so many more of the usual size had been seen: what does not fit is not all chain.
            power = float(np.sum(coefficients[mine] ** 2)) * old**2
            new = float(np.sqrt((power + SEEN * USUAL**2) / (told[mine].sum() + SEEN)))
            highest = LARGEST.get(origin.name.split()[0], LARGEST_SMOOTH)
            sizes[origin.name] = float(np.clip(new, SMALLEST_SMOOTH, highest))
        sizes = _alike(sizes)
        for origin in whitener.columns.origins:
            old = evidence.sizes[origin.name]
            change = max(change, abs(np.log(sizes[origin.name] / old)))
        clean = deviations - whitener.smooth(coefficients, deviations.size)
        evidence = evidence.with_sizes(sizes).learnt_scatter(solved.datasets, clean)
        if change < 0.1:
            break
    return evidence, max((abs(np.log(evidence.sizes[o] / size)) for o, size in before.items()), default=0.0)


def _alike(sizes: dict[str, float]) -> dict[str, float]:
    """Without one that is far larger than most of its kind: chains of a kind wander alike.

    What one channel is missed by beyond that is a fault of its own, or physics, and is sought.
    """
    kinds: dict[str, list[float]] = {}
    for name, size in sizes.items():
        kinds.setdefault(name.split()[0], []).append(size)
    most = {
        kind: max(APART * float(np.median(found)), USUAL) if len(found) >= FEWEST_ALIKE else np.inf
        for kind, found in kinds.items()
    }
    return {name: min(size, most[name.split()[0]]) for name, size in sizes.items()}


def _of_best_length(evidence: Evidence, deviations: Reals) -> Evidence:
    """Of the present length and its neighbours, the one under which the deviations are likeliest."""
    at = int(np.argmin(np.abs(np.log(np.array(LENGTHS) / evidence.length))))
    tried = [evidence.with_sizes(evidence.sizes, length) for length in LENGTHS[max(0, at - 1) : at + 2]]
    return min(tried, key=lambda e: e.whitener.square(deviations) + e.whitener.log_determinant)
