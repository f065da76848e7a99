"""Recalibration: what the stated tolerances allow the parameters to take up, and how surely.

Gauss-Newton with Levenberg's damping on the standardised deviations of all records together, each parameter in
standard deviations of its owner's prior, smooth errors integrated out. The sizes of the smooth errors are learnt
on the way (expectation maximisation; Dempster, Laird and Rubin 1977).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.evidence import LARGEST_SMOOTH, SMALLEST_SMOOTH, Evidence, Solved, Whitener
from permway.errors import InputError, SolveError
from permway.recordings.campaign import Campaign

STEP = 1e-3
"""Of finite differences, in standard deviations of the prior."""

USUAL, SEEN = 0.02, 4.0
"""Size of smooth errors that is expected beforehand, neper or rad, and how many coefficients it counts for."""

Z_LIMIT = 8.0
"""Beyond which no parameter is sought, in standard deviations of the prior."""

Progress = Callable[[str], object]
Build = Callable[[Mapping[str, float]], Campaign]
"""From values of the free parameters to a campaign."""


@dataclass(frozen=True)
class Free:
    """A number that is free: its centre and standard deviation in a coordinate z, 0 at the centre.

    Attributes
    ----------
    name, unit : str
    value : callable
        From z to the value.
    limits : (float, float)
        Of z.
    """

    name: str
    unit: str
    value: Callable[[float], float]
    limits: tuple[float, float] = (-Z_LIMIT, Z_LIMIT)


@dataclass(frozen=True)
class Fit:
    """The most probable values and what is left.

    Attributes
    ----------
    free : tuple of Free
    z : ndarray, shape (p,)
        In standard deviations of the priors.
    covariance : ndarray, shape (p, p)
        Of z (Laplace).
    campaign : Campaign
        With these values.
    evidence : Evidence
        With the sizes of smooth errors learnt.
    deviations : ndarray, shape (n,)
        Standardised, smooth errors not taken out.
    clean : ndarray, shape (n,)
        With the most probable smooth errors taken out.
    chi2 : float
        Quadratic form of the deviations, smooth errors integrated out.
    prior : float
        Sum of squares of z.
    log_determinant : float
        Of the covariance of smooth errors and noise, over that of noise.
    jacobian : ndarray, shape (n, p)
        Derivative of the deviations by z.
    heat : float
        Mean square of the deviations, at least 1: the records count so much less while no model fits.
    evaluations : int
    """

    free: tuple[Free, ...]
    z: Reals
    covariance: Reals
    campaign: Campaign
    evidence: Evidence
    deviations: Reals
    clean: Reals
    chi2: float
    prior: float
    log_determinant: float
    jacobian: Reals
    heat: float
    evaluations: int

    @property
    def objective(self) -> float:
        """Minus twice the log posterior density, up to a constant."""
        return self.chi2 + self.prior + self.log_determinant

    @property
    def log_evidence(self) -> float:
        """Laplace's approximation of the marginal likelihood, up to a constant of the records."""
        sign, value = np.linalg.slogdet(self.covariance)
        return -0.5 * self.objective + 0.5 * float(value if sign > 0 else -np.inf)

    def values(self) -> dict[str, float]:
        """Values by name."""
        return {f.name: f.value(float(z)) for f, z in zip(self.free, self.z, strict=True)}

    def intervals(self, width: float = 1.6449) -> dict[str, tuple[float, float]]:
        """90 % intervals by name, by default."""
        sigma = np.sqrt(np.diag(self.covariance))
        return {
            f.name: (f.value(float(z - width * s)), f.value(float(z + width * s)))
            for f, z, s in zip(self.free, self.z, sigma, strict=True)
        }


def free_parameters(campaign: Campaign) -> tuple[Free, ...]:
    """The campaign's parameters, each about its owner's belief."""
    found = []
    for known in campaign.parameters.known.values():
        low, high = known.bounds
        limits = [-Z_LIMIT, Z_LIMIT]
        if np.isfinite(low) and (low > 0.0 or not known.log):
            limits[0] = max(limits[0], known.z(low))
        if np.isfinite(high):
            limits[1] = min(limits[1], known.z(high))
        found.append(Free(known.name, known.parameter.unit, known.value, (limits[0], limits[1])))
    return tuple(found)


def recalibrate(
    evidence: Evidence,
    *,
    build: Build | None = None,
    free: tuple[Free, ...] | None = None,
    start: Reals | None = None,
    learn: bool = True,
    most_steps: int = 25,
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
        Where to begin, in z; by default at the priors' centres.
    learn : bool
        Whether to learn the sizes of smooth errors.
    most_steps : int
    progress : callable, optional
        Told in words how far it is.

    Raises
    ------
    InputError
        If the model cannot be predicted at the start.
    """
    build = evidence.campaign.with_values if build is None else build
    free = free_parameters(evidence.campaign) if free is None else free
    problem = _Problem(evidence, build, free)
    z = np.zeros(len(free)) if start is None else np.asarray(start, dtype=np.float64).copy()
    state = problem.at(z)
    if state is None:
        raise InputError("the model cannot be solved there", where="start", value=z.tolist())
    damping, learnt = 1e-3, 0
    for step in range(most_steps):
        # Far from the records the priors lead: the deviations count as if each were no better than all are.
        heat = max(1.0, state.chi2 / max(1, state.deviations.size))
        jacobian = problem.jacobian(state)
        reduced = state.whitener.reduce(np.column_stack([state.deviations, jacobian]))
        normal = (jacobian.T @ jacobian - reduced[:, 1:].T @ reduced[:, 1:]) / heat + np.eye(z.size)
        slope = (jacobian.T @ state.deviations - reduced[:, 1:].T @ reduced[:, 0]) / heat + state.z
        moved, gained = None, 0.0
        for _ in range(8):
            shift = -linalg.solve(normal + damping * np.diag(np.diag(normal)), slope, assume_a="pos")
            tried = problem.at(_inside(state.z + shift, free))
            gained = 0.0 if tried is None else state.heated(heat) - tried.heated(heat)
            if tried is not None and gained > 0.0:
                moved, damping = tried, max(damping / 5.0, 1e-9)
                break
            damping = max(damping * 6.0, 1e-6)
        if progress is not None:
            progress(f"step {step + 1}, {state.objective:.1f}, heat {heat:.3g}")
        state = state if moved is None else moved
        if gained < 0.5:
            if not learn or learnt >= 4:
                break
            change = problem.learn(state)
            learnt += 1
            state = problem.again(state)
            if change < 0.1:
                break
            damping = 1e-3
    jacobian = problem.jacobian(state)
    reduced = state.whitener.reduce(jacobian)
    heat = max(1.0, state.chi2 / max(1, state.deviations.size))
    normal = (jacobian.T @ jacobian - reduced.T @ reduced) / heat + np.eye(z.size)
    coefficients, _ = state.whitener.explained(state.deviations)
    return Fit(
        free=free,
        z=state.z,
        covariance=np.asarray(linalg.inv(normal)),
        campaign=state.solved.campaign,
        evidence=problem.evidence,
        deviations=state.deviations,
        clean=state.deviations - state.whitener.columns @ coefficients,
        chi2=state.chi2,
        prior=float(state.z @ state.z),
        log_determinant=state.whitener.log_determinant,
        jacobian=jacobian,
        heat=heat,
        evaluations=problem.evaluations,
    )


def _inside(z: Reals, free: tuple[Free, ...]) -> Reals:
    low, high = np.array([f.limits for f in free]).T if free else (np.zeros(0), np.zeros(0))
    return np.clip(z, low, high)


@dataclass(frozen=True)
class _State:
    z: Reals
    solved: Solved
    deviations: Reals
    whitener: Whitener
    origins: list[str]
    chi2: float

    @property
    def objective(self) -> float:
        return self.heated(1.0)

    def heated(self, heat: float) -> float:
        return self.chi2 / heat + float(self.z @ self.z) + self.whitener.log_determinant


class _Problem:
    """Deviations as a function of z."""

    def __init__(self, evidence: Evidence, build: Build, free: tuple[Free, ...]) -> None:
        self.evidence, self.build, self.free = evidence, build, free
        self.evaluations = 0

    def deviations(self, z: Reals, near: Solved | None = None) -> tuple[Campaign, Reals, Solved]:
        self.evaluations += 1
        campaign = self.build({f.name: f.value(float(v)) for f, v in zip(self.free, z, strict=True)})
        predicted = self.evidence.predicted(campaign, near)
        return campaign, self.evidence.deviations(predicted.datasets), predicted

    def at(self, z: Reals) -> _State | None:
        try:
            _, deviations, predicted = self.deviations(z)
        except (SolveError, InputError):
            return None
        if not np.isfinite(deviations).all():
            return None
        return self._state(z, predicted, deviations)

    def again(self, state: _State) -> _State:
        """The same with the sizes that were learnt."""
        return self._state(state.z, state.solved, self.evidence.deviations(state.solved.datasets))

    def _state(self, z: Reals, solved: Solved, deviations: Reals) -> _State:
        columns, origins = self.evidence.smooth(solved.datasets)
        whitener = Whitener.of(columns, origins, self.evidence.sizes)
        reduced = whitener.reduce(deviations)
        chi2 = float(deviations @ deviations - reduced @ reduced)
        return _State(z, solved, deviations, whitener, origins, chi2 + self.evidence.log_determinant)

    def jacobian(self, state: _State) -> Reals:
        """Derivative of the deviations by z, by forward differences."""
        columns = []
        for index, f in enumerate(self.free):
            step = STEP if state.z[index] + STEP <= f.limits[1] else -STEP
            moved = state.z.copy()
            moved[index] += step
            columns.append((self.deviations(moved, state.solved)[1] - state.deviations) / step)
        return np.column_stack(columns) if columns else np.zeros((state.deviations.size, 0))

    def learn(self, state: _State) -> float:
        """Learn the sizes of smooth errors; returns the largest change of a logarithm."""
        coefficients, variances = state.whitener.explained(state.deviations)
        origins = np.array(state.origins)
        sizes, change = dict(self.evidence.sizes), 0.0
        for origin, old in self.evidence.sizes.items():
            mine = origins == origin
            # As if so many more coefficients of the usual size had been seen: what does not fit is not all chain.
            power = float(np.sum(coefficients[mine] ** 2 + variances[mine])) * old**2
            new = float(np.sqrt((power + SEEN * USUAL**2) / (mine.sum() + SEEN)))
            highest = 1.5 if origin == "irregularity" else LARGEST_SMOOTH
            sizes[origin] = float(np.clip(new, SMALLEST_SMOOTH, highest))
            change = max(change, abs(np.log(sizes[origin] / old)))
        self.evidence = self.evidence.with_sizes(sizes).learnt_pairs(state.solved.datasets)
        return change
