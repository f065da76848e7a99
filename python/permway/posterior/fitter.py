"""One fit for every set of amendments: damped Gauss-Newton between bounds.

Source: Nocedal and Wright (2006), Numerical Optimization, section 10.3; Fletcher (1982) for the second-order
correction.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.bounded import bounded_step
from permway.diagnosis.tangent import Problem
from permway.errors import InputError
from permway.posterior.covariance import Frame
from permway.posterior.fit import Fit, Model
from permway.posterior.hyper import Hyper

ENOUGH = 0.1
"""Of minus two log posterior: a step that gains less is the last."""

TRUSTED = 0.9
"""Ratio of a step's gain to the predicted gain from which slopes serve once more."""

CURVED = 0.5
"""The same, below which the step is taken again with the curvature that it met."""


class Fitter:
    """Fits models to one campaign's records.

    Parameters
    ----------
    frame : Frame
    """

    def __init__(self, frame: Frame) -> None:
        self.frame = frame

    def grown(self, fit: Fit, model: Model, z: Reals, bend: Reals | None) -> Fit:
        """A model with further parameters at some values, with slopes of a smaller one's and of the new ones.

        Parameters
        ----------
        fit : Fit
            Of the smaller model, with the hyperparameters that are wanted.
        model : Model
        z : ndarray
        bend : ndarray, optional

        Raises
        ------
        InputError
            If the model cannot be solved there.
        """
        blank = np.zeros((fit.jacobian.shape[0], z.size - fit.z.size))
        new = self.begin(model, z, fit.hyper, np.hstack([fit.jacobian, blank]), bend)
        new.__dict__["covariance"], new.__dict__["roots"] = fit.covariance, fit.roots
        return self.settled(new, fixed=fit.z.size)

    def begin(
        self, model: Model, z: Reals, hyper: Hyper, jacobian: Reals | None = None, bend: Reals | None = None
    ) -> Fit:
        """A model at some parameters, slopes taken there unless they are given.

        Raises
        ------
        InputError
            If the model cannot be solved there.
        """
        problem = Problem(self.frame.observations, model.build, model.free)
        state = problem.at(np.clip(z, *model.limits))
        if state is None:
            raise InputError("the model cannot be solved there", where="start", value=z.tolist())
        slopes = problem.jacobian(state) if jacobian is None else jacobian
        return Fit(model, self.frame, hyper, state, slopes, bend, jacobian is None)

    def fit(self, start: Fit, *, steps: int, fixed: int = 0) -> Fit:
        """Descend by at most so many steps.

        Parameters
        ----------
        start : Fit
        steps : int
        fixed : int
            The first so many parameters keep their slopes, which cost most.
        """
        problem = Problem(self.frame.observations, start.model.build, start.model.free)
        low, high = start.model.limits
        ends = [index for centre, length, _ in start.model.stretches for index in (centre, length)]
        fit, damping, fresh, exact = start, 1e-3, start.exact or fixed > 0, not fixed
        for _ in range(steps):
            slope = fit.slope(fit.state.residuals) + fit.z
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
                if predicted < ENOUGH or (fresh and exact and not ends):
                    break
                if fresh and exact:
                    # Ends of stretches change nothing up to the next joint, and then much: they keep the rest from
                    # moving, which does so without them.
                    low[ends] = high[ends] = fit.z[ends]
                    ends, damping = [], 1e-3
                    continue
                # Where slopes that were kept lead nowhere, all are taken anew.
                exact = exact or fresh
                fit, fresh, damping = self.sloped(problem, fit, 0 if exact else fixed), True, 1e-3
                continue
            gained = fit.objective - moved.objective
            trusted = TRUSTED * predicted < gained < predicted / TRUSTED
            fit, fresh, exact = moved, False, not fixed
            if not trusted:
                fit, fresh = self.sloped(problem, fit, fixed), True
            if gained < ENOUGH:
                break
        return fit

    def settled(self, fit: Fit, *, fixed: int = 0) -> Fit:
        """With slopes taken where it is, but for the first so many parameters."""
        if fit.exact:
            return fit
        return self.sloped(Problem(self.frame.observations, fit.model.build, fit.model.free), fit, fixed)

    def sloped(self, problem: Problem, fit: Fit, fixed: int) -> Fit:
        """With slopes of all parameters after the first so many taken where it is."""
        if not fixed:
            new = replace(fit, jacobian=problem.jacobian(fit.state), exact=True)
            new.__dict__["covariance"] = fit.covariance
            return new
        columns = problem.columns(fit.state, range(fixed, len(fit.model.free)))
        new = replace(fit, jacobian=np.hstack([fit.jacobian[:, :fixed], columns]), exact=False)
        new.__dict__["covariance"] = fit.covariance
        if "roots" in fit.__dict__:
            # What the slopes that are kept make of the covariance is known.
            new.__dict__["roots"] = fit.roots.first(fixed).beside(fit.covariance.roots(columns))
        return new

    def _tried(self, problem: Problem, fit: Fit, z: Reals) -> Fit | None:
        state = problem.at(z, fit.state.solved)
        if state is None:
            return None
        new = replace(fit, state=state, exact=False)
        for known in ("covariance", "roots", "normal"):
            new.__dict__[known] = getattr(fit, known)
        return new

    def _corrected(self, problem: Problem, fit: Fit, tried: Fit, damping: float) -> Fit | None:
        """A step again, with the part of the residuals' change that slopes did not predict."""
        bent = tried.state.residuals - fit.jacobian @ (tried.z - fit.z)
        slope = fit.slope(bent) + fit.z
        low, high = fit.model.limits
        shift = bounded_step(fit.normal, slope, fit.z, low, high, damping)
        other = self._tried(problem, fit, np.clip(fit.z + shift, low, high))
        return other if other is not None and other.objective < tried.objective else None
