"""One fit for every set of amendments: damped Gauss-Newton between bounds, and Laplace's evidence where it ends.

Source: Nocedal and Wright (2006), Numerical Optimization, section 10.3; Fletcher (1982) for the second-order
correction; Kass and Raftery (1995), Bayes factors, section 4.1, for Laplace's approximation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg, optimize

from permway.arrays import Reals
from permway.diagnosis.bounded import bounded_step
from permway.diagnosis.fit import Build, Free
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.quick import stacked
from permway.diagnosis.tangent import Problem, State
from permway.errors import InputError
from permway.posterior.covariance import Covariance, Frame
from permway.posterior.hyper import Hyper

ENOUGH = 0.1
"""Of minus two log posterior: a step that gains less is the last."""

TRUSTED = 0.9
"""Ratio of a step's gain to the predicted gain from which slopes serve once more."""

SETTLED, MOST_ESTIMATES = 1e-5, 25
"""Relative change of the objective at which hyperparameters are found, and steps at most."""

CURVED = 0.5
"""The same, below which the step is taken again with the curvature that it met."""


@dataclass(frozen=True)
class Model:
    """A set of amendments on the nominal model, as a function of standard normal parameters.

    Attributes
    ----------
    build : callable
        From values to a campaign.
    free : tuple of Free
        Nominal parameters first.
    """

    build: Build
    free: tuple[Free, ...]

    @property
    def limits(self) -> tuple[Reals, Reals]:
        """Bounds of z."""
        both = np.array([f.limits for f in self.free]).reshape(-1, 2)
        return both[:, 0], both[:, 1]

    def values(self, z: Reals) -> dict[str, float]:
        """By name."""
        return {f.name: f.value(float(v)) for f, v in zip(self.free, z, strict=True)}


@dataclass(frozen=True)
class Fit:
    """The most probable parameters of a model, given hyperparameters.

    Attributes
    ----------
    model : Model
    frame : Frame
    hyper : Hyper
    state : State
        Parameters z, predictions and residuals.
    jacobian : ndarray, shape (n, p)
        Slopes of the residuals at, or near, the state.
    """

    model: Model
    frame: Frame
    hyper: Hyper
    state: State
    jacobian: Reals

    @cached_property
    def covariance(self) -> Covariance:
        """Of the residuals."""
        return self.frame.covariance(self.hyper)

    @property
    def z(self) -> Reals:
        """Parameters, in standard deviations of their priors."""
        return self.state.z

    @cached_property
    def objective(self) -> float:
        """Minus two log posterior density of z and hyperparameters, up to a constant of the records."""
        return self.covariance.square(self.state.deviations) + float(self.z @ self.z) + self._of_hyper

    @property
    def _of_hyper(self) -> float:
        return self.covariance.log_determinant - 2.0 * self.hyper.log_prior

    @cached_property
    def normal(self) -> Reals:
        """Half the curvature of the objective by z, (p, p)."""
        return np.asarray(self.jacobian.T @ self.covariance.apply(self.jacobian) + np.eye(self.z.size))

    @cached_property
    def spread(self) -> Reals:
        """Covariance of z (Laplace)."""
        return np.asarray(linalg.inv(self.normal)) if self.z.size else np.zeros((0, 0))

    @property
    def log_evidence(self) -> float:
        """Laplace's approximation of the marginal likelihood over z, at the most probable hyperparameters."""
        curvature = float(np.linalg.slogdet(self.normal)[1]) if self.z.size else 0.0
        return -0.5 * (self.objective + curvature)

    def values(self) -> dict[str, float]:
        """By name."""
        return self.model.values(self.z)


def grown(fit: Fit, hypothesis: Hypothesis, prefix: str) -> Model:
    """A fit's model with an amendment more, whose parameters' names get a prefix."""
    campaign = fit.frame.evidence.campaign
    build, free = stacked(fit.model.build, hypothesis, prefix, campaign)
    return Model(build, (*fit.model.free, *free))


class Fitter:
    """Fits models to one campaign's records.

    Parameters
    ----------
    frame : Frame
    """

    def __init__(self, frame: Frame) -> None:
        self.frame = frame

    def begin(self, model: Model, z: Reals, hyper: Hyper, jacobian: Reals | None = None) -> Fit:
        """A model at some parameters, slopes taken there unless they are given.

        Raises
        ------
        InputError
            If the model cannot be solved there.
        """
        problem = Problem(self.frame.evidence, model.build, model.free)
        state = problem.at(np.clip(z, *model.limits))
        if state is None:
            raise InputError("the model cannot be solved there", where="start", value=z.tolist())
        return Fit(model, self.frame, hyper, state, problem.jacobian(state) if jacobian is None else jacobian)

    def fit(self, start: Fit, *, steps: int, fixed: int = 0) -> Fit:
        """Descend by at most so many steps.

        Parameters
        ----------
        start : Fit
        steps : int
        fixed : int
            The first so many parameters keep their slopes, which cost most.
        """
        problem = Problem(self.frame.evidence, start.model.build, start.model.free)
        low, high = start.model.limits
        fit, damping, fresh = start, 1e-3, True
        for _ in range(steps):
            slope = fit.jacobian.T @ fit.covariance.apply(fit.state.deviations[:, None])[:, 0] + fit.z
            moved = None
            for _ in range(6):
                shift = bounded_step(fit.normal, slope, fit.z, low, high, damping)
                predicted = -float(2.0 * slope @ shift + shift @ fit.normal @ shift)
                if predicted < ENOUGH:
                    break
                moved = self._tried(problem, fit, np.clip(fit.z + shift, low, high))
                if moved is not None and fit.objective - moved.objective < CURVED * predicted:
                    moved = self._corrected(problem, fit, moved, damping) or moved
                if moved is not None and moved.objective < fit.objective:
                    damping = max(damping / 10.0, 1e-9)
                    break
                moved, damping = None, max(10.0 * damping, 1e-4)
            if moved is None:
                if fresh or predicted < ENOUGH:
                    break
                fit, fresh, damping = self.sloped(problem, fit, fixed), True, 1e-3
                continue
            gained = fit.objective - moved.objective
            trusted = TRUSTED * predicted < gained < predicted / TRUSTED
            fit, fresh = moved, False
            if not trusted:
                fit, fresh = self.sloped(problem, fit, fixed), True
            if gained < ENOUGH:
                break
        return fit

    def settled(self, fit: Fit, *, fixed: int = 0) -> Fit:
        """With slopes taken where it is, but for the first so many parameters."""
        return self.sloped(Problem(self.frame.evidence, fit.model.build, fit.model.free), fit, fixed)

    def sloped(self, problem: Problem, fit: Fit, fixed: int) -> Fit:
        """With slopes of all parameters after the first so many taken where it is."""
        if not fixed:
            return replace(fit, jacobian=problem.jacobian(fit.state))
        columns = problem.columns(fit.state, range(fixed, len(fit.model.free)))
        return replace(fit, jacobian=np.hstack([fit.jacobian[:, :fixed], columns]))

    def _tried(self, problem: Problem, fit: Fit, z: Reals) -> Fit | None:
        state = problem.at(z, fit.state.solved)
        if state is None:
            return None
        new = replace(fit, state=state)
        new.__dict__["covariance"] = fit.covariance
        return new

    def _corrected(self, problem: Problem, fit: Fit, tried: Fit, damping: float) -> Fit | None:
        """A step again, with the part of the residuals' change that slopes did not foretell."""
        bent = tried.state.deviations - fit.jacobian @ (tried.z - fit.z)
        slope = fit.jacobian.T @ fit.covariance.apply(bent[:, None])[:, 0] + fit.z
        low, high = fit.model.limits
        shift = bounded_step(fit.normal, slope, fit.z, low, high, damping)
        other = self._tried(problem, fit, np.clip(fit.z + shift, low, high))
        return other if other is not None and other.objective < tried.objective else None


def estimated(fit: Fit) -> Fit:
    """With its most probable hyperparameters, the parameters moving along in a straight line."""
    columns = np.column_stack([fit.state.deviations, fit.jacobian])
    low, high = fit.hyper.bounds()

    def objective(log: Reals) -> float:
        hyper = fit.hyper.moved(log)
        try:
            covariance = fit.frame.covariance(hyper)
        except linalg.LinAlgError:
            return 1e300
        inner = columns.T @ covariance.apply(columns)
        normal = inner[1:, 1:] + np.eye(fit.z.size)
        slope = inner[1:, 0] + fit.z
        moved = slope @ np.linalg.solve(normal, slope) if fit.z.size else 0.0
        curvature = float(np.linalg.slogdet(normal)[1]) if fit.z.size else 0.0
        least = float(inner[0, 0]) + float(fit.z @ fit.z) - float(moved)
        return least + curvature + covariance.log_determinant - 2.0 * hyper.log_prior

    found = optimize.minimize(
        objective,
        fit.hyper.log,
        method="L-BFGS-B",
        bounds=list(zip(low, high, strict=True)),
        options={"maxiter": MOST_ESTIMATES, "ftol": SETTLED, "eps": 1e-3},
    )
    return replace(fit, hyper=fit.hyper.moved(found.x))
