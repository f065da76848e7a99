"""The most probable hyperparameters of a fit, its parameters moving along in a straight line.

A quasi-Newton descent between bounds (Nocedal and Wright 2006, Numerical Optimization, chapter 6 and section
18.3). Fits of one search differ little in their curvature, so each begins with that of the fit that it came from.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.posterior.fit import Fit
from permway.posterior.hyper import Hyper
from permway.posterior.hyper_slope import hyper_slope

SETTLED = 0.1
"""Of minus two log posterior, that a step is predicted to gain if it is taken: a twentieth of a nat."""

MOST_STEPS, HALVED = 25, 5
"""Steps at most, and how often each is halved until it descends."""

CURVING = 0.2
"""Of a logarithm, by which the objective is differenced for curvatures where none is known."""

LEAST_BEND, LONGEST = 0.2, 1.5
"""Curvature at least, that of a prior with a factor of 9 for a standard deviation; longest step of a logarithm."""


def estimated(fit: Fit) -> Fit:
    """With its most probable hyperparameters."""
    objective = least_objective(fit)
    low, high = fit.hyper.bounds()
    x = np.clip(fit.hyper.log, low, high)
    value = objective(x)
    slope = _slope(fit, x)
    bend = _curvature(objective, x, value, low, high) if fit.bend is None else fit.bend
    for _ in range(MOST_STEPS):
        shift = _step(slope, bend, x, low, high)
        # Newton's step gains half of what its slope predicts.
        if -0.5 * float(slope @ shift) < SETTLED:
            break
        for _ in range(HALVED):
            new = objective(x + shift)
            if new < value:
                break
            shift = 0.5 * shift
        else:
            break
        gained, x, value = value - new, x + shift, new
        after = _slope(fit, x)
        bend = _updated(bend, shift, after - slope)
        slope = after
        if gained < 0.5 * SETTLED:
            break
    return replace(fit, hyper=fit.hyper.moved(x), bend=bend)


def least_objective(fit: Fit) -> Callable[[Reals], float]:
    """Minus two log posterior of logarithms of hyperparameters, the parameters where it is least for them."""
    columns = np.column_stack([fit.state.residuals, fit.jacobian])

    def objective(log: Reals) -> float:
        hyper: Hyper = fit.hyper.moved(log)
        try:
            covariance = fit.frame.covariance(hyper)
        except linalg.LinAlgError:
            return 1e300
        roots = covariance.roots(columns)
        inner = roots.times(roots)
        normal = inner[1:, 1:] + np.eye(fit.z.size)
        slope = inner[1:, 0] + fit.z
        moved = slope @ np.linalg.solve(normal, slope) if fit.z.size else 0.0
        curvature = float(np.linalg.slogdet(normal)[1]) if fit.z.size else 0.0
        least = float(inner[0, 0]) + float(fit.z @ fit.z) - float(moved)
        return least + curvature + covariance.log_determinant - 2.0 * hyper.log_prior

    return objective


def _slope(fit: Fit, x: Reals) -> Reals:
    return hyper_slope(fit, fit.frame.covariance(fit.hyper.moved(x)))


def _curvature(objective: Callable[[Reals], float], x: Reals, value: float, low: Reals, high: Reals) -> Reals:
    """Of each logarithm alone."""
    found = np.empty(x.size)
    for index in range(x.size):
        middle = min(max(x[index], low[index] + CURVING), high[index] - CURVING)
        ends = []
        for step in (-CURVING, 0.0, CURVING):
            moved = x.copy()
            moved[index] = middle + step
            ends.append(value if moved[index] == x[index] else objective(moved))
        found[index] = (ends[0] - 2.0 * ends[1] + ends[2]) / CURVING**2
    return np.diag(np.maximum(found, LEAST_BEND))


def _step(slope: Reals, bend: Reals, x: Reals, low: Reals, high: Reals) -> Reals:
    """Newton's step of what is free to move, kept between the bounds; downhill in any case."""
    free = np.flatnonzero(~(((x <= low) & (slope > 0.0)) | ((x >= high) & (slope < 0.0))))
    shift = np.zeros(x.size)
    if not free.size:
        return shift
    shift[free] = -np.linalg.solve(bend[np.ix_(free, free)], slope[free])
    # What no record constrains stands where its prior has it, without a slope.
    shift *= min(1.0, LONGEST / max(float(np.abs(shift).max()), LONGEST))
    kept = np.clip(x + shift, low, high) - x
    if float(slope @ kept) < 0.5 * float(slope @ shift):
        return kept
    # What the bounds leave of it may lead uphill: each alone does not.
    shift[free] = np.clip(-slope[free] / np.diag(bend)[free], -LONGEST, LONGEST)
    return np.clip(x + shift, low, high) - x


def _updated(bend: Reals, shift: Reals, change: Reals) -> Reals:
    """Damped BFGS, which stays positive definite (Powell 1978)."""
    pushed = bend @ shift
    expected, met = float(shift @ pushed), float(shift @ change)
    if expected <= 0.0:
        return bend
    if met < 0.2 * expected:
        share = 0.8 * expected / (expected - met)
        change = share * change + (1.0 - share) * pushed
        met = float(shift @ change)
    return np.asarray(bend - np.outer(pushed, pushed) / expected + np.outer(change, change) / met)
