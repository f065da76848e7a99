"""Calibration errors over frequency: functions that span them, and what is expected of their coefficients.

The error of a measuring chain varies with the logarithm of frequency, normal with a squared-exponential
correlation. It is written in the eigenfunctions of that correlation (Karhunen and Loeve): for a length of an
octave twenty of them hold it to a thousandth over eight octaves. As many splines leave a percent,
and where hundreds of lines agree to a thousandth, a percent looks like a fault.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy import linalg

from permway.arrays import Reals

FIRST_LENGTH = 1.0
"""Octaves, where nothing is known yet."""

SHORTEST = 0.7
"""Octaves: the length whose eigenfunctions are used."""

NEGLECTED = 1e-5
"""Share of the largest variance below which an eigenfunction is left out."""

ROUGH = 0.01
"""Share of the variance that is as rough as the functions allow, whatever the length."""

MARGIN = 0.5
"""Lengths beyond the ends to which the functions reach."""

PER_LENGTH = 12
"""Points per length at which eigenfunctions are found."""


class GaussianProcess:
    """Functions of frequency that calibration errors are sums of.

    Parameters
    ----------
    low, high : float
        Ends, Hz or cycles per metre.
    shortest : float
        Octaves.
    """

    def __init__(self, low: float, high: float, *, shortest: float = SHORTEST) -> None:
        # Eigenfunctions end where they are worst; what is asked for ends before.
        margin = MARGIN * shortest
        self._shortest, self._first = shortest, float(np.log2(low)) - margin
        self._octaves = float(np.log2(high / low)) + 2.0 * margin
        self._points, self._vectors, self._values = _eigenfunctions(self._octaves, shortest)

    @property
    def count(self) -> int:
        """How many functions."""
        return int(self._values.size)

    def values(self, frequency: Reals) -> Reals:
        """Shape (F, count), for coefficients of unit variance if the length is the shortest; constant beyond."""
        x = np.clip(np.log2(frequency) - self._first, 0.0, self._octaves)
        return np.asarray(_correlation(x, self._points, self._shortest) @ self._vectors / np.sqrt(self._values))

    def root(self, length: float | None) -> Reals:
        """Lower triangle R so that R times independent unit coefficients has this length, shape (count, count).

        Parameters
        ----------
        length : float, optional
            Octaves; without, the shortest.
        """
        if length is None or length == self._shortest:
            return np.eye(self.count)
        return _root(self._octaves, self._shortest, length)


def _correlation(x: Reals, y: Reals, length: float) -> Reals:
    return np.asarray(np.exp(-0.5 * ((x[:, None] - y[None, :]) / length) ** 2))


@cache
def _eigenfunctions(octaves: float, length: float) -> tuple[Reals, Reals, Reals]:
    """Points, eigenvectors with the rule's weights in them, and eigenvalues, the largest first."""
    nodes, weights = np.polynomial.legendre.leggauss(max(8, round(PER_LENGTH * octaves / length)))
    points, weights = 0.5 * octaves * (nodes + 1.0), 0.5 * octaves * weights
    half = np.sqrt(weights)
    values, vectors = linalg.eigh(half[:, None] * _correlation(points, points, length) * half)
    kept = np.flatnonzero(values > NEGLECTED * values[-1])[::-1]
    return points, vectors[:, kept] * half[:, None], values[kept]


@cache
def _root(octaves: float, shortest: float, length: float) -> Reals:
    points, vectors, values = _eigenfunctions(octaves, shortest)
    inverse = vectors / np.sqrt(values)
    expected = (1.0 - ROUGH) * inverse.T @ _correlation(points, points, length) @ inverse
    return np.asarray(linalg.cholesky(expected + ROUGH * np.eye(values.size), lower=True))
