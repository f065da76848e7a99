"""How much an effect shows beside all that a recalibration can take up: its deviance.

The deviance of a change of the responses is d = min over z, c of |r - J z - B c|^2 + |z|^2 + |c|^2. Here r is the
noise-free difference with and without the effect, in standard deviations of noise and rounding; z are parameters
in standard deviations of their priors, J the slopes of the responses by them; c are coefficients of the smooth
errors of all chains, B what these do. It is linear in z and c, so that no fit is needed: with V = 1 + B B',
b = J' V^-1 r and M = J' V^-1 J it is d = r' V^-1 r - b' (1 + M)^-1 b. The logarithm of responses is taken where
noise is below `SURE` of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import linalg

from permway.challenge.beams import Complexes, Reals

SURE = 0.25
"""Noise over response below which the logarithm of the response counts; else its difference."""


class Part(Protocol):
    """A record: from responses to standardised differences, and their inner product by V^-1."""

    def difference(self, responses: Complexes) -> Reals:
        """Standardised difference to the base, shape (n,)."""

    def reduced(self, values: Reals) -> Reals:
        """Of columns (n, k), what calibration errors explain, shape (c, k): squares are taken off."""

    def wrapped(self, values: Reals) -> Reals:
        """A difference of differences, its phases within half a turn."""


@dataclass(frozen=True)
class Blows:
    """Hammer tests of the same chains, at one temperature or several.

    Attributes
    ----------
    base : ndarray of complex128, shape (tests, sensors, points, F)
        With nothing concealed.
    sigma : ndarray, same shape
        Standard deviation of real part and of imaginary part.
    functions : ndarray, shape (F, k)
        Of calibration errors.
    sizes : (float, float)
        Of sensors and of points.
    """

    base: Complexes
    sigma: Reals
    functions: Reals
    sizes: tuple[float, float]

    @cached_property
    def weight(self) -> Reals:
        """Inverse of the relative error."""
        return np.asarray(np.abs(self.base) / self.sigma)

    def difference(self, responses: Complexes) -> Reals:
        """See :class:`Part`; real parts, then imaginary parts."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = responses / self.base
            off = np.where(self.weight * SURE > 1.0, np.log(ratio), ratio - 1.0)
        parts = (self.weight * off).reshape(-1)
        return np.concatenate([parts.real, parts.imag])

    def wrapped(self, values: Reals) -> Reals:
        """See :class:`Part`."""
        half = values.size // 2
        weight = self.weight.reshape(-1)
        turns = values[half:] / (2.0 * np.pi * weight)
        whole = np.where(weight * SURE > 1.0, np.round(turns), 0.0)
        return np.concatenate([values[:half], values[half:] - 2.0 * np.pi * weight * whole])

    @cached_property
    def _factor(self) -> Reals:
        """Of 1 + B' B, which is the same of gains and of phases."""
        _, sensors, points, _ = self.base.shape
        count = self.functions.shape[1]
        square = (self.weight**2).sum(axis=0)
        each = np.einsum("fa,spf,fb->spab", self.functions, square, self.functions, optimize=True)
        whole = np.zeros((sensors + points, count, sensors + points, count))
        s, p = np.arange(sensors), sensors + np.arange(points)
        one, two = self.sizes
        whole[s, :, s] = one**2 * each.sum(axis=1)
        whole[p, :, p] = two**2 * each.sum(axis=0)
        whole[:sensors, :, sensors:] = one * two * each.transpose(0, 2, 1, 3)
        whole[sensors:, :, :sensors] = one * two * each.transpose(1, 2, 0, 3)
        size = (sensors + points) * count
        matrix = whole.reshape(size, size)
        matrix[np.diag_indices(size)] += 1.0
        return np.asarray(linalg.cholesky(matrix, lower=True))

    def reduced(self, values: Reals) -> Reals:
        """See :class:`Part`."""
        parts = values.reshape(2, *self.base.shape, -1) * self.weight[None, ..., None]
        pulled = np.einsum("htspfk,fa->hspak", parts, self.functions, optimize=True)
        one, two = self.sizes
        each = np.concatenate([one * pulled.sum(axis=2), two * pulled.sum(axis=1)], axis=1)
        each = each.reshape(2, -1, values.shape[1])
        both = [linalg.solve_triangular(self._factor, half, lower=True) for half in each]
        return np.concatenate(both)


@dataclass(frozen=True)
class Ride:
    """A run: cross-spectral densities of some channels.

    Attributes
    ----------
    base : ndarray of complex128, shape (F, channels, channels)
    averages : float
        Independent segments.
    functions : ndarray, shape (F, k)
    size : float
        Of each channel's calibration errors.
    """

    base: Complexes
    averages: float
    functions: Reals
    size: float

    @cached_property
    def _roots(self) -> tuple[Complexes, Complexes]:
        """S^1/2 and S^-1/2."""
        values, vectors = np.linalg.eigh(self.base)
        size = np.sqrt(values)[:, None, :]
        adjoint = vectors.conj().swapaxes(1, 2)
        return np.asarray(vectors * size @ adjoint), np.asarray(vectors / size @ adjoint)

    def _rows(self, matrices: Complexes) -> Reals:
        """Independent numbers of Hermitian matrices (..., m, m), standardised, shape (..., m^2)."""
        upper = np.triu_indices(self.base.shape[1], 1)
        own = np.einsum("...ii->...i", matrices).real
        beside = np.sqrt(2.0) * matrices[..., upper[0], upper[1]]
        rows = np.concatenate([own, beside.real, beside.imag], axis=-1)
        return np.asarray(np.sqrt(self.averages) * rows)

    def difference(self, responses: Complexes) -> Reals:
        """See :class:`Part`: gains of the channels, and the matrix logarithm of what is left over the base's.

        Where channels are coherent a gain is far from the matrix that it acts on, and bends its logarithm.
        """
        gains, (half, inverse) = self._gains(responses), self._roots
        undone = np.exp(-gains)
        left = undone[:, :, None] * responses * undone.conj()[:, None, :]
        values, vectors = np.linalg.eigh(inverse @ left @ inverse)
        logs = np.log(np.maximum(values, 1e-12))[:, None, :]
        by_gains = inverse @ (gains[:, :, None] * half)
        found = vectors * logs @ vectors.conj().swapaxes(1, 2) + by_gains + by_gains.conj().swapaxes(1, 2)
        return self._rows(np.asarray(found)).reshape(-1)

    def _gains(self, responses: Complexes) -> Complexes:
        """Logarithms of gains (F, m) that give channels their powers, and their phases to the first channel."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = responses / self.base
            levels = 0.5 * np.log(np.einsum("fcc->fc", ratio).real)
            return np.asarray(levels + 1j * np.angle(ratio[:, :, 0]))

    def wrapped(self, values: Reals) -> Reals:
        """See :class:`Part`; a matrix' logarithm has no turns."""
        return values

    @cached_property
    def _columns(self) -> Reals:
        """What gains and phases of the channels do, shape (n, 2 m k)."""
        half, inverse = self._roots
        channels, found = self.base.shape[1], []
        for index in range(channels):
            one = np.zeros((channels, channels))
            one[index, index] = 1.0
            displaced = inverse @ one @ half
            for turn in (1.0, 1j):
                each = self._rows(turn * displaced + np.conj(turn) * displaced.conj().swapaxes(1, 2))
                columns = each[:, :, None] * self.functions[:, None, :] * self.size
                found.append(columns.reshape(-1, self.functions.shape[1]))
        return np.concatenate(found, axis=1)

    @cached_property
    def _factor(self) -> Reals:
        gram = self._columns.T @ self._columns
        gram[np.diag_indices(gram.shape[0])] += 1.0
        return np.asarray(linalg.cholesky(gram, lower=True))

    def reduced(self, values: Reals) -> Reals:
        """See :class:`Part`."""
        return np.asarray(linalg.solve_triangular(self._factor, self._columns.T @ values, lower=True))


class Scale:
    """Weighs changes of responses against what parameters and calibration errors may take up.

    Parameters
    ----------
    parts : sequence of Part
    slopes : sequence of sequence of ndarray
        For each parameter the responses of all parts, one step away.
    step : float
        In standard deviations of the prior.
    """

    def __init__(self, parts: Sequence[Part], slopes: Sequence[Sequence[Complexes]], step: float) -> None:
        self.parts = parts
        columns = [[p.difference(r) / step for p, r in zip(parts, one, strict=True)] for one in slopes]
        self._slopes = [np.column_stack([c[i] for c in columns]) if columns else None for i in range(len(parts))]
        self._reduced = [None if s is None else p.reduced(s) for p, s in zip(parts, self._slopes, strict=True)]
        inner = np.eye(len(columns))
        for slope, reduced in zip(self._slopes, self._reduced, strict=True):
            if slope is not None and reduced is not None:
                inner += slope.T @ slope - reduced.T @ reduced
        self._inner = linalg.cholesky(inner, lower=True) if columns else inner

    def deviance(self, responses: Sequence[Complexes]) -> float:
        """Of responses with an effect, against the base recalibrated."""
        total, along = 0.0, np.zeros(self._inner.shape[0])
        for part, slope, reduced, values in zip(self.parts, self._slopes, self._reduced, responses, strict=True):
            off = part.difference(values)
            explained = part.reduced(off[:, None])[:, 0]
            total += float(off @ off - explained @ explained)
            if slope is not None and reduced is not None:
                along += slope.T @ off - reduced.T @ explained
        if along.size:
            displaced = linalg.solve_triangular(self._inner, along, lower=True)
            total -= float(displaced @ displaced)
        return total
