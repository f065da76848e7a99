"""What calibration errors do to residuals: the columns of a block, kept as they are cheapest to multiply by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from permway.arrays import Complexes, Reals


class Functions(Protocol):
    """What calibration errors are sums of, as :mod:`permway.diagnosis.gaussian_process` of frequency."""

    @property
    def count(self) -> int:
        """How many functions."""

    def root(self, length: float | None) -> Reals:
        """R so that R times independent unit coefficients has this length, shape (count, count)."""


@dataclass(frozen=True)
class ErrorSource:
    """One source of calibration errors.

    Attributes
    ----------
    name : str
        As "sensor rail@16" or "irregularity".
    process : Functions
    parts : int
        2 for log gain and phase, each with coefficients of its own; 1 for a level.
    chain : bool
        Whether its length is that of measuring chains; else it is the shortest of its functions.
    fixed : bool
        Whether its columns have the size of its errors already, so that none is estimated.
    """

    name: str
    process: Functions
    parts: int
    chain: bool = True
    fixed: bool = False

    @property
    def count(self) -> int:
        """Number of coefficients."""
        return self.parts * self.process.count


class Columns(Protocol):
    """Residuals per coefficient, of one block: each of unit size is an error of 1 neper or rad."""

    def transposed_times(self, values: Reals) -> Reals:
        """Transposed times values, (n, k) to (c, k)."""

    def times(self, coefficients: Reals) -> Reals:
        """Times coefficients, (c,) to (n,)."""

    def gram(self) -> Reals:
        """Transposed times itself, (c, c)."""


@dataclass(frozen=True)
class CalibrationErrors:
    """Calibration errors of a block.

    Attributes
    ----------
    sources : tuple of ErrorSource
        In the order of the columns.
    columns : Columns
    """

    sources: tuple[ErrorSource, ...]
    columns: Columns

    def of_unit_variance(self, sizes: Mapping[str, float], *, chains: bool) -> dict[str, Reals]:
        """By source, its columns for coefficients of unit variance, (n, c); with those of chains or without."""
        unit, found, stop = np.eye(sum(source.count for source in self.sources)), {}, 0
        for source in self.sources:
            start, stop = stop, stop + source.count
            if chains or not source.chain:
                columns = [self.columns.times(one) for one in unit[start:stop]]
                found[source.name] = sizes[source.name] * np.stack(columns, axis=1)
        return found


@dataclass(frozen=True)
class PlainColumns:
    """Of any block.

    Attributes
    ----------
    matrix : ndarray, shape (n, c)
    """

    matrix: Reals

    def transposed_times(self, values: Reals) -> Reals:
        """See :class:`Columns`."""
        return np.asarray(self.matrix.T @ values)

    def times(self, coefficients: Reals) -> Reals:
        """See :class:`Columns`."""
        return np.asarray(self.matrix @ coefficients)

    def gram(self) -> Reals:
        """See :class:`Columns`."""
        return np.asarray(self.matrix.T @ self.matrix)


@dataclass(frozen=True)
class PairColumns:
    """Of frequency responses: gain and phase of the sensor's chain and of the hammer's act on a pair alike.

    Rows are the real parts of all pairs and lines, then the imaginary parts; columns those of each sensor, then of
    each point, log gain first, then phase.

    Attributes
    ----------
    gains : ndarray, shape (sensors, points, F, functions)
        What a gain does, turned back by `phase`; a phase does i times as much.
    phase : ndarray of complex, shape (sensors, points, F)
        Of what is there, which errors multiply.
    """

    gains: Reals
    phase: Complexes

    def transposed_times(self, values: Reals) -> Reals:
        """See :class:`Columns`."""
        half = values.shape[0] // 2
        turned = (values[:half] + 1j * values[half:]).reshape(*self.phase.shape, values[0].size)
        turned *= self.phase.conj()[..., None]
        found = as_complex(self.gains.swapaxes(-1, -2) @ as_parts(turned))
        whole = np.concatenate([found.sum(axis=1), found.sum(axis=0)])
        both = np.stack([whole.real, whole.imag], axis=1)
        # No length is left to be guessed: there may be no columns at all.
        return np.asarray(both.reshape(2 * whole.shape[0] * whole.shape[1], *values.shape[1:]))

    def times(self, coefficients: Reals) -> Reals:
        """See :class:`Columns`."""
        sensors, points, _, count = self.gains.shape
        both = coefficients.reshape(sensors + points, 2, count)
        parts = both[:sensors, None] + both[None, sensors:]
        moved = as_complex(self.gains @ parts.swapaxes(-1, -2))[..., 0]
        moved = (moved * self.phase).reshape(-1)
        return np.concatenate([moved.real, moved.imag])

    def gram(self) -> Reals:
        """See :class:`Columns`; gains and phases do not meet."""
        sensors, points, _, count = self.gains.shape
        pairs = self.gains.swapaxes(-1, -2) @ self.gains
        whole = np.zeros((sensors + points, 2, count, sensors + points, 2, count))
        s, p = np.arange(sensors), sensors + np.arange(points)
        for part in range(2):
            whole[s, part, :, s, part] = pairs.sum(axis=1)
            whole[p, part, :, p, part] = pairs.sum(axis=0)
            whole[:sensors, part, :, sensors:, part] = pairs.transpose(0, 2, 1, 3)
            whole[sensors:, part, :, :sensors, part] = pairs.transpose(1, 2, 0, 3)
        size = 2 * (sensors + points) * count
        return whole.reshape(size, size)


def as_parts(values: Complexes) -> Reals:
    """Complex numbers as real ones, real and imaginary parts side by side along the last axis."""
    return np.ascontiguousarray(values).view(np.float64)


def as_complex(parts: Reals) -> Complexes:
    """Parts side by side along the last axis as complex numbers."""
    return np.ascontiguousarray(parts).view(np.complex128)
