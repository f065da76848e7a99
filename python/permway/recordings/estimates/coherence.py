"""The sample coherence: its exact distribution, intervals and bias."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy import special
from scipy.interpolate import PchipInterpolator

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.estimates.checks import as_reals, check_level, check_positive
from permway.recordings.estimates.intervals import Interval

_SERIES = 600.0
"""Mean of the mixing number above which a fitted Gamma law stands for the series (error of the CDF below 6e-4)."""

_GRID = 64
_HIGHEST = 8.0
"""Fisher's z of the table's last coherence, 1 - 4.5e-7; beyond it the distribution of z only shifts."""


def coherence_cdf(sample: ArrayLike, truth: ArrayLike, averages: float) -> Reals:
    """Probability that the sample coherence stays below a value (Goodman 1957; Carter et al. 1973).

    Its density (K - 1) (1 - g2)^K (1 - x)^(K-2) 2F1(K, K; 1; g2 x) is a mixture of Beta(j + 1, K - 1) with
    negative binomial weights of K and g2, which holds for any real K above 1.

    Parameters
    ----------
    sample, truth : array_like, broadcastable
        Sample coherence x and true coherence g2, both in [0, 1).
    averages : float
        K.
    """
    number = _averages(averages)
    x, g2 = np.broadcast_arrays(as_reals(sample, "sample"), as_reals(truth, "truth"))
    if x.size and not (min(x.min(), g2.min()) >= 0.0 and max(x.max(), g2.max()) <= 1.0):
        raise InputError("a coherence must lie in [0, 1]", where="sample, truth")
    flat = [_cdf(a, b, number) for a, b in zip(x.ravel(), g2.ravel(), strict=True)]
    return np.array(flat).reshape(x.shape)


def _cdf(x: float, g2: float, number: float) -> float:
    if x >= 1.0:
        return 1.0
    if g2 >= 1.0 or x <= 0.0:
        return 0.0
    ratio = g2 / (1.0 - g2)
    mean = number * ratio
    if mean <= _SERIES:
        last = int(mean + 12.0 * np.sqrt(mean * (1.0 + ratio)) + 40.0)
        j = np.arange(last + 1.0)
        log_weight = special.gammaln(number + j) - special.gammaln(number) - special.gammaln(j + 1.0)
        weight = np.exp(log_weight + special.xlogy(j, g2) + number * np.log1p(-g2))
        return float(np.dot(weight, special.betainc(j + 1.0, number - 1.0, x)))
    # Explained power: Gamma(j + 1) mixed, of mean m + 1 and variance 1 + 2 m + m ratio; unexplained: Gamma(K - 1).
    shape = (mean + 1.0) ** 2 / (1.0 + 2.0 * mean + mean * ratio)
    odds = x / (1.0 - x) * shape / (mean + 1.0)
    return float(special.betainc(shape, number - 1.0, odds / (1.0 + odds)))


def coherence_interval(coherence: ArrayLike, averages: float, *, level: float = 0.95) -> Interval:
    """Interval of the true coherence, by inverting the exact distribution of the sample's.

    Parameters
    ----------
    coherence : array_like
        Sample coherence in [0, 1].
    averages : float
        K, above 1; need not be whole.
    level : float

    Raises
    ------
    InputError
        For a coherence outside [0, 1], or not more than one average (any sample coherence is then 1).
    """
    tail = 0.5 * (1.0 - check_level(level))
    number = _averages(averages)
    z = _transformed(coherence)
    return Interval(_invert(z, number, 1.0 - tail), _invert(z, number, tail))


def unbiased_coherence(coherence: ArrayLike, averages: float) -> Reals:
    """Coherence that a sample would exceed as often as not: the sample's, less its bias (1 - g2)^2 / K and so on.

    Parameters
    ----------
    coherence : array_like
        Sample coherence in [0, 1].
    averages : float
        K, above 1.
    """
    return _invert(_transformed(coherence), _averages(averages), 0.5)


def _transformed(coherence: ArrayLike) -> Reals:
    value = as_reals(coherence, "coherence")
    if np.any((value < -1e-12) | (value > 1.0 + 1e-12)):
        raise InputError("must lie in [0, 1]", where="coherence", value=[float(value.min()), float(value.max())])
    return np.asarray(np.arctanh(np.sqrt(np.clip(value, 0.0, 1.0 - 1e-15))))


def _invert(z: Reals, averages: float, probability: float) -> Reals:
    """True coherence whose quantile of the sample's z is the z met; 0 where even no coherence gives more."""
    truth, quantile = _quantiles(round(averages, 6), round(probability, 12))
    inverse = PchipInterpolator(quantile, truth, extrapolate=False)
    inside = inverse(np.clip(z, quantile[0], quantile[-1]))
    beyond = truth[-1] + z - quantile[-1]
    found = np.where(z > quantile[-1], beyond, np.where(z <= quantile[0], 0.0, inside))
    return np.asarray(np.tanh(found) ** 2)


@lru_cache(maxsize=64)
def _quantiles(averages: float, probability: float) -> tuple[Reals, Reals]:
    """Table of true z and the quantile of the sample's z there."""
    truth = _HIGHEST * np.linspace(0.0, 1.0, _GRID) ** 2
    g2 = np.tanh(truth) ** 2
    low, high = np.zeros(_GRID), np.full(_GRID, _HIGHEST + 12.0)
    for _ in range(34):
        middle = 0.5 * (low + high)
        below = coherence_cdf(np.tanh(middle) ** 2, g2, averages) < probability
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return truth, 0.5 * (low + high)


def _averages(averages: float) -> float:
    number = check_positive(averages, "averages")
    if number <= 1.0:
        raise InputError(
            "one average has a sample coherence of 1, whatever the truth",
            where="averages",
            value=averages,
            remedy="shorten the segments, or pool records",
        )
    return number
