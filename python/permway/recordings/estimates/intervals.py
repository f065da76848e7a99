"""Confidence intervals of power spectra and of frequency response functions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from permway.arrays import Reals, real_numbers
from permway.errors import InputError
from permway.recordings.estimates.checks import as_complexes, as_reals, check_finite, check_level


class Interval(NamedTuple):
    """Lower and upper bound, of the shape of the estimate."""

    low: Reals
    high: Reals

    def covers(self, truth: ArrayLike) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        """Where the truth lies within."""
        value = np.asarray(truth)
        return np.asarray((self.low <= value) & (value <= self.high))


class FrfInterval(NamedTuple):
    """Intervals of one frequency response function; each holds for itself at the level, not together."""

    magnitude: Interval
    phase_rad: Interval
    radius: Reals
    """Of the circle about the estimate that holds the complex value."""


def power_interval(power: ArrayLike, degrees_of_freedom: ArrayLike, *, level: float = 0.95) -> Interval:
    """Interval of a power that is chi-square distributed about its mean.

    nu P / chi2(nu; 1 - a/2) to nu P / chi2(nu; a/2) (Bendat and Piersol 2010, chapter 8); a Gamma law for
    nu = 2 K that is no whole number.

    Parameters
    ----------
    power, degrees_of_freedom : array_like, broadcastable
        Spectral density or band power, and nu.
    level : float

    Raises
    ------
    InputError
        For a negative power, or degrees of freedom that are not positive.
    """
    tail = 0.5 * (1.0 - check_level(level))
    value = as_reals(power, "power")
    if np.any(value < 0.0):
        raise InputError("must not be negative", where="power", value=float(value.min()))
    freedom = _freedom(degrees_of_freedom)
    # chi2.ppf(q, nu) = 2 gammaincinv(nu / 2, q), without the cost of a distribution object.
    return Interval(
        0.5 * freedom * value / special.gammaincinv(0.5 * freedom, 1.0 - tail),
        0.5 * freedom * value / special.gammaincinv(0.5 * freedom, tail),
    )


def log_power_moments(degrees_of_freedom: ArrayLike) -> tuple[Reals, Reals]:
    """Mean and variance of ln(estimate / truth) of such a power: psi(nu/2) - ln(nu/2) and psi'(nu/2)."""
    half = 0.5 * _freedom(degrees_of_freedom)
    return np.asarray(special.digamma(half) - np.log(half)), np.asarray(special.polygamma(1, half))


def log_frf_variance(coherence: ArrayLike, averages: ArrayLike) -> Reals:
    """Variance of ln|H| and of the phase in rad, each: (1 - g2) / (2 K g2) (Bendat and Piersol 2010, chapter 9).

    Parameters
    ----------
    coherence, averages : array_like, broadcastable
        g2 in (0, 1], and K.
    """
    coherence, averages = as_reals(coherence, "coherence"), as_reals(averages, "averages")
    if np.any((coherence <= 0.0) | (coherence > 1.0)):
        raise InputError("must lie in (0, 1]", where="coherence", value=float(coherence.min()))
    if np.any(averages <= 0.0):
        raise InputError("must be above zero", where="averages", value=float(averages.min()))
    return np.asarray((1.0 - coherence) / (2.0 * averages * coherence))


def frf_interval(
    frf: ArrayLike, variance: ArrayLike, degrees_of_freedom: ArrayLike, *, level: float = 0.95
) -> FrfInterval:
    """Intervals of magnitude and phase, and the circle that holds both.

    The error's part along any fixed direction, over its estimated deviation s |H|, is Student's t; its squared
    modulus, over 2 s^2 |H|^2, is F(2, nu) (Goodman 1965; Bendat and Piersol 2010, chapter 9). The part across the
    true direction gives |sin(phase error)| <= t s, exactly; where t s >= 1 the phase is not known at all. The
    part along gives the magnitude, |H| (sqrt(1 - s^2) -+ t s): the root takes off what noise across adds to the
    modulus.

    Parameters
    ----------
    frf : array_like, complex
    variance : array_like
        s^2: variance of ln|H| (and of the phase), estimated with nu degrees of freedom.
    degrees_of_freedom : array_like
        nu = 2 (K - references).
    level : float
    """
    tail = 0.5 * (1.0 - check_level(level))
    value = as_complexes(frf, "frf")
    square = as_reals(variance, "variance")
    if np.any(square < 0.0):
        raise InputError("must not be negative", where="variance", value=float(square.min()))
    freedom = _freedom(degrees_of_freedom)
    modulus, deviation = np.abs(value), np.sqrt(square)
    reach = special.stdtrit(freedom, 1.0 - tail) * deviation
    middle = np.sqrt(np.maximum(1.0 - square, 0.0))
    magnitude = Interval(modulus * np.maximum(middle - reach, 0.0), modulus * (middle + reach))
    half = np.where(reach < 1.0, np.arcsin(np.minimum(reach, 1.0)), np.pi)
    phase = np.angle(value)
    # F(2, nu) has the quantile nu/2 ((2 tail)^(-2/nu) - 1) in closed form.
    quantile = 0.5 * freedom * ((2.0 * tail) ** (-2.0 / freedom) - 1.0)
    radius = np.asarray(modulus * deviation * np.sqrt(2.0 * quantile))
    return FrfInterval(magnitude, Interval(phase - half, phase + half), radius)


def _freedom(degrees_of_freedom: ArrayLike) -> Reals:
    freedom = real_numbers(degrees_of_freedom, "degrees_of_freedom")
    check_finite(freedom, "degrees_of_freedom")
    if np.any(freedom <= 0.0):
        raise InputError(
            "must be above zero",
            where="degrees_of_freedom",
            value=float(freedom.min()),
            remedy="take more averages than references",
        )
    return freedom
