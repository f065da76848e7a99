"""The cross-spectral matrix as a complex Wishart variable: likelihood, and a statistic of known distribution."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.recordings.estimates.checks import as_complexes, check_positive


class Deviance(NamedTuple):
    """Distance of a sample matrix from a supposed one, and what chance alone would give."""

    value: Reals
    probability: Reals
    """Of a value at least as large, if the supposed matrix is true."""
    standardised: Reals
    """The value as a standard normal number."""


def wishart_log_density(sample: ArrayLike, truth: ArrayLike, averages: float) -> Reals:
    """Log density of the sample cross-spectral matrix (Goodman 1963; Yuen, Katafygiotis and Beck 2002).

    K p ln K - ln Gamma_p(K) + (K - p) ln det S - K ln det T - K tr(T^-1 S), with the complex multivariate
    ln Gamma_p(K) = p (p - 1)/2 ln pi + sum ln Gamma(K - i); K need not be whole.

    Parameters
    ----------
    sample, truth : array_like, shape (..., p, p), broadcastable
        S and T, Hermitian and positive definite.
    averages : float
        K, at least p.

    Returns
    -------
    ndarray, shape (...)
    """
    log_truth, log_sample, trace, size, number = _compare(sample, truth, averages)
    gamma = 0.5 * size * (size - 1) * np.log(np.pi) + special.gammaln(number - np.arange(size)).sum()
    constant = number * size * np.log(number) - gamma
    return np.asarray(constant + (number - size) * log_sample - number * (log_truth + trace))


def wishart_deviance(sample: ArrayLike, truth: ArrayLike, averages: float) -> Deviance:
    """Twice the log likelihood lost by supposing `truth`, 2 K (tr(T^-1 S) - ln det(T^-1 S) - p).

    Its cumulants are exact, mean 2 K (p ln K - sum psi(K - i)) and variance 4 K^2 sum psi'(K - i) - 4 p K, from
    the generating function Gamma_p(K (1 - 2 t)) (1 - 2 t)^(-p K (1 - 2 t)); a Gamma law of these two stands for
    the distribution (for large K chi-square with p^2 degrees of freedom; Anderson 2003, section 10.8).

    Parameters
    ----------
    sample, truth : array_like, shape (..., p, p)
    averages : float
        K, at least p.
    """
    log_truth, log_sample, trace, size, number = _compare(sample, truth, averages)
    value = np.asarray(2.0 * number * (trace - (log_sample - log_truth) - size))
    steps = number - np.arange(size)
    mean = 2.0 * number * float(size * np.log(number) - special.digamma(steps).sum())
    variance = 4.0 * number**2 * float(special.polygamma(1, steps).sum()) - 4.0 * size * number
    shape, size_of_one = mean**2 / variance, variance / mean
    above = special.gammaincc(shape, np.maximum(value, 0.0) / size_of_one)
    normal = np.asarray(-special.ndtri(np.clip(above, 1e-300, 1.0 - 1e-16)), dtype=np.float64)
    return Deviance(value, np.asarray(above, dtype=np.float64), normal)


def _compare(sample: ArrayLike, truth: ArrayLike, averages: float) -> tuple[Reals, Reals, Reals, int, float]:
    number = check_positive(averages, "averages")
    matrices = [_hermitian(values, where) for values, where in ((sample, "sample"), (truth, "truth"))]
    size = matrices[0].shape[-1]
    if matrices[1].shape[-1] != size:
        raise InputError(f"has {matrices[1].shape[-1]} channels, the sample {size}", where="truth")
    if number < size:
        raise InputError(
            f"a matrix of {size} channels needs at least {size} averages to be regular",
            where="averages",
            value=averages,
            remedy="shorten the segments, or compare fewer channels at a time",
        )
    factors = [_factor(matrix, where) for matrix, where in zip(matrices, ("sample", "truth"), strict=True)]
    logs = [2.0 * np.log(np.einsum("...ii->...i", factor).real).sum(axis=-1) for factor in factors]
    whitened = np.linalg.solve(*np.broadcast_arrays(factors[1], factors[0]))
    return logs[1], logs[0], np.sum(np.abs(whitened) ** 2, axis=(-2, -1)), size, number


def _hermitian(values: ArrayLike, where: str) -> Complexes:
    matrix = as_complexes(values, where)
    if matrix.ndim < 2 or matrix.shape[-1] != matrix.shape[-2]:
        raise InputError(
            "must be square matrices (..., channel, channel)",
            where=where,
            value=f"shape {matrix.shape}",
            remedy='transpose: data.csd.transpose("frequency", "channel", "channel2")',
        )
    off = np.abs(matrix - matrix.conj().swapaxes(-1, -2)).max(initial=0.0)
    if off > 1e-9 * np.abs(matrix).max(initial=0.0):
        raise InputError("not Hermitian", where=where, value=float(off))
    return matrix


def _factor(matrix: Complexes, where: str) -> Complexes:
    # Channels may differ by many powers of ten; scaled to unit diagonals the test for rank is fair.
    size = np.sqrt(np.einsum("...ii->...i", matrix).real)
    if not np.all(size > 0.0):
        raise InputError("a channel without power", where=where, remedy="leave dead channels out")
    try:
        unit = np.linalg.cholesky(matrix / (size[..., :, None] * size[..., None, :]))
    except np.linalg.LinAlgError as error:
        raise InputError(
            "not positive definite", where=where, remedy="leave out a channel that others determine"
        ) from error
    return np.asarray(size[..., :, None] * unit)
