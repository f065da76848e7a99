"""What smooth errors do to deviations: the columns of a block, kept as they are cheapest to multiply by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from permway.arrays import Complexes, Reals


class Functions(Protocol):
    """What smooth errors are sums of; :class:`permway.diagnosis.wander.Wander` of frequency."""

    @property
    def count(self) -> int:
        """How many functions."""

    def root(self, length: float | None) -> Reals:
        """R so that R times independent unit coefficients has this length, shape (count, count)."""


@dataclass(frozen=True)
class Origin:
    """One source of smooth errors.

    Attributes
    ----------
    name : str
        As "sensor rail@16" or "irregularity".
    wander : Functions
    parts : int
        2 for log gain and phase, each with coefficients of its own; 1 for a level.
    chain : bool
        Whether its length is that of measuring chains; else it is the shortest of its functions.
    fixed : bool
        Whether its columns have the size of its errors already, so that none is learnt.
    """

    name: str
    wander: Functions
    parts: int
    chain: bool = True
    fixed: bool = False

    @property
    def count(self) -> int:
        """Number of coefficients."""
        return self.parts * self.wander.count


class Columns(Protocol):
    """Deviations per coefficient, of one block: each of unit size is an error of 1 neper or rad."""

    def pull(self, values: Reals) -> Reals:
        """Transposed times values, (n, k) to (c, k)."""

    def push(self, coefficients: Reals) -> Reals:
        """Times coefficients, (c,) to (n,)."""

    def gram(self) -> Reals:
        """Transposed times itself, (c, c)."""

    def masked(self, rows: np.ndarray) -> Columns:
        """The same with nothing outside some rows."""


@dataclass(frozen=True)
class Smooth:
    """Smooth errors of a block.

    Attributes
    ----------
    origins : tuple of Origin
        In the order of the columns.
    columns : Columns
    """

    origins: tuple[Origin, ...]
    columns: Columns


@dataclass(frozen=True)
class PlainColumns:
    """Of any block.

    Attributes
    ----------
    matrix : ndarray, shape (n, c)
    """

    matrix: Reals

    def pull(self, values: Reals) -> Reals:
        """See :class:`Columns`."""
        return np.asarray(self.matrix.T @ values)

    def push(self, coefficients: Reals) -> Reals:
        """See :class:`Columns`."""
        return np.asarray(self.matrix @ coefficients)

    def gram(self) -> Reals:
        """See :class:`Columns`."""
        return np.asarray(self.matrix.T @ self.matrix)

    def masked(self, rows: np.ndarray) -> PlainColumns:
        """See :class:`Columns`."""
        return PlainColumns(self.matrix * rows[:, None])


@dataclass(frozen=True)
class PairColumns:
    """Of frequency responses: gain and phase of the sensor's chain and of the hammer's act on a pair alike.

    Rows are the real parts of all pairs and lines, then the imaginary parts; columns those of each sensor, then of
    each point, log gain first, then phase.

    Attributes
    ----------
    gains : ndarray of complex, shape (sensors, points, F, functions)
        What a gain does; a phase does i times as much.
    """

    gains: Complexes

    def _complex(self, values: Reals) -> Complexes:
        half = values.shape[0] // 2
        sensors, points, lines, _ = self.gains.shape
        return np.asarray((values[:half] + 1j * values[half:]).reshape(sensors, points, lines, -1))

    @cached_property
    def _adjoint(self) -> Complexes:
        return np.ascontiguousarray(self.gains.conj().swapaxes(-1, -2))

    def pull(self, values: Reals) -> Reals:
        """See :class:`Columns`."""
        found = self._adjoint @ self._complex(values.reshape(values.shape[0], -1))
        whole = np.concatenate([found.sum(axis=1), found.sum(axis=0)])
        both = np.stack([whole.real, whole.imag], axis=1)
        return np.asarray(both.reshape(-1, *values.shape[1:]))

    def push(self, coefficients: Reals) -> Reals:
        """See :class:`Columns`."""
        sensors, points, _, count = self.gains.shape
        both = coefficients.reshape(sensors + points, 2, count)
        each = both[:, 0] + 1j * both[:, 1]
        moved = (self.gains @ (each[:sensors, None] + each[None, sensors:])[..., None])[..., 0].reshape(-1)
        return np.concatenate([moved.real, moved.imag])

    def gram(self) -> Reals:
        """See :class:`Columns`."""
        sensors, points, _, count = self.gains.shape
        pairs = self._adjoint @ self.gains
        whole = np.zeros((sensors + points, count, sensors + points, count), dtype=np.complex128)
        s, p = np.arange(sensors), sensors + np.arange(points)
        whole[s, :, s, :] = pairs.sum(axis=1)
        whole[p, :, p, :] = pairs.sum(axis=0)
        whole[:sensors, :, sensors:] = pairs.transpose(0, 2, 1, 3)
        whole[sensors:, :, :sensors] = pairs.transpose(1, 2, 0, 3)
        real = np.empty((sensors + points, 2, count, sensors + points, 2, count))
        real[:, 0, :, :, 0], real[:, 1, :, :, 1] = whole.real, whole.real
        real[:, 0, :, :, 1], real[:, 1, :, :, 0] = -whole.imag, whole.imag
        size = 2 * (sensors + points) * count
        return real.reshape(size, size)

    def masked(self, rows: np.ndarray) -> PairColumns:
        """See :class:`Columns`; a line is left out with both its parts."""
        half = rows[: rows.size // 2]
        return PairColumns(self.gains * half.reshape(self.gains.shape[:3])[..., None])
