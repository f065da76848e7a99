"""Intervals of identified parameters from the Jacobian at the optimum, and what the data do not constrain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import stats

from permway.arrays import Reals
from permway.laws.limits import limit_words
from permway.laws.search import Problem

_CONFIDENCE = 0.90
_AT_BOUND = 1e-4
_WIDE_DECADES = 1.0
_WIDE_RANGE = 0.5
_WIDE_K = 20.0
"""Of a transition: half is what few isotherms allow, twice states nothing of where the glass begins."""
_STEP = 1e-6


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One identified parameter with its 90 % interval and, if there is one, what is wrong with it."""

    name: str
    value: float
    low: float
    high: float
    note: str = ""


def parameter_table(problem: Problem, x: Reals, jacobian: Reals, square: float) -> tuple[Parameter, ...]:
    """Values and 90 % intervals of the parameters of law and shift.

    Parameters
    ----------
    problem : Problem
        What was solved.
    x : ndarray, shape (d,)
        Coordinates of the optimum.
    jacobian : ndarray, shape (2 n, d)
        Of the weighted residuals there.
    square : float
        Sum of squares there.
    """
    width = problem.bounds[:, 1] - problem.bounds[:, 0]
    low_end = x - problem.bounds[:, 0] < _AT_BOUND * width
    bound = low_end | (problem.bounds[:, 1] - x < _AT_BOUND * width)
    kinds = problem.law.kinds + problem.shift.kinds
    covariance, quantile = _covariance(jacobian, square)
    own = len(x) - len(problem.shift.bounds)

    def named(coordinates: Reals) -> dict[str, float]:
        return problem.law.parameters(problem.at_reference(coordinates)) | {
            f"shift.{name}": value for name, value in problem.shift.parameters(coordinates[own:]).items()
        }

    found = []
    values = named(x)
    for name, value in values.items():
        # Scales are judged in decades, orders and logarithms as they are.
        scale = value > 0.0 and not _is_plain(name)
        gradient = _gradient(_Viewed(named, name, scale), x, width)
        variance = float(gradient @ covariance @ gradient)
        spread = quantile * max(variance, 0.0) ** 0.5
        middle = _view(value, scale)
        low, high = middle - spread, middle + spread
        touched = np.nonzero(bound & (np.abs(gradient) * width > 1e-3))[0]
        note = ""
        if len(touched):
            stated = dict.fromkeys(limit_words(kinds[index], not low_end[index]) for index in touched)
            note = "not identifiable: " + "; also, ".join(stated)
        elif spread > _widest(name, scale)[0]:
            note = f"not identifiable: the interval is wider than {_widest(name, scale)[1]}"
            note += " on either side; measure over more temperatures and frequencies, or use a law with fewer "
            note += "parameters"
        low, high = (_power(low), _power(high)) if scale else (low, high)
        found.append(Parameter(name=name, value=value, low=low, high=high, note=note))
    return tuple(found)


@dataclass(frozen=True)
class _Viewed:
    """One named parameter as a function of the coordinates."""

    named: Callable[[Reals], dict[str, float]]
    name: str
    scale: bool

    def __call__(self, x: Reals) -> float:
        return _view(self.named(x)[self.name], self.scale)


def _covariance(jacobian: Reals, square: float) -> tuple[Reals, float]:
    rows, columns = jacobian.shape
    freedom = max(rows - columns, 1)
    _, singular, right = np.linalg.svd(jacobian, full_matrices=False)
    # A direction the data do not see gets a very large variance, not a missing one.
    singular = np.maximum(singular, 1e-10 * singular.max(initial=1e-300))
    covariance = (right.T / singular**2) @ right * (square / freedom)
    return np.asarray(covariance), float(stats.t.ppf(0.5 + 0.5 * _CONFIDENCE, freedom))


def _gradient(function: Callable[[Reals], float], x: Reals, width: Reals) -> Reals:
    gradient = np.zeros_like(x)
    for index in range(len(x)):
        step = np.zeros_like(x)
        step[index] = _STEP * width[index]
        gradient[index] = (function(x + step) - function(x - step)) / (2.0 * step[index])
    return gradient


def _is_plain(name: str) -> bool:
    return name.rsplit(".", 1)[-1] in ("order", "alpha", "beta", "gamma", "transition_C") or "log10" in name


def _widest(name: str, scale: bool) -> tuple[float, str]:
    if name.endswith("_C"):
        return _WIDE_K, f"{_WIDE_K:g} K"
    return (_WIDE_DECADES, "a decade") if scale else (_WIDE_RANGE, f"{_WIDE_RANGE}")


def _view(value: float, scale: bool) -> float:
    return float(np.log10(value)) if scale else value


def _power(exponent: float) -> float:
    return float(10.0 ** np.clip(exponent, -300.0, 300.0))
