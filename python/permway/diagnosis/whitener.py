"""Taking out of deviations what smooth errors of all blocks would explain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.smooth import Columns, Origin, Smooth


@dataclass(frozen=True)
class AllColumns:
    """The columns of all blocks: one origin met by two records is one.

    Attributes
    ----------
    origins : tuple of Origin
    parts : tuple of (slice, ndarray of int, Columns)
        Of each block: its rows, where its columns stand among all, and they themselves.
    gram : ndarray, shape (c, c)
    """

    origins: tuple[Origin, ...]
    parts: tuple[tuple[slice, np.ndarray, Columns], ...]
    gram: Reals

    @staticmethod
    def of(blocks: Sequence[Smooth], sizes: Sequence[int]) -> AllColumns:
        """From what the blocks say, and how many rows they have."""
        first: dict[str, int] = {}
        origins: list[Origin] = []
        count = 0
        for origin in (o for smooth in blocks for o in smooth.origins):
            if origin.name not in first:
                first[origin.name] = count
                origins.append(origin)
                count += origin.count
        parts, start = [], 0
        for smooth, rows in zip(blocks, sizes, strict=True):
            place = np.concatenate([first[o.name] + np.arange(o.count) for o in smooth.origins])
            parts.append((slice(start, start + rows), place, smooth.columns))
            start += rows
        return AllColumns(tuple(origins), tuple(parts), _gram(parts, count))

    def pull(self, values: Reals) -> Reals:
        """Transposed times values, (n,) or (n, k)."""
        found = np.zeros((self.gram.shape[0], *values.shape[1:]))
        for rows, place, columns in self.parts:
            found[place] += columns.pull(values[rows])
        return found

    def push(self, coefficients: Reals, size: int) -> Reals:
        """Times coefficients, to (size,)."""
        moved = np.zeros(size)
        for rows, place, columns in self.parts:
            moved[rows] = columns.push(coefficients[place])
        return moved

    def masked(self, keep: np.ndarray) -> AllColumns:
        """The same with nothing outside some rows."""
        parts = [(rows, place, columns.masked(keep[rows])) for rows, place, columns in self.parts]
        return AllColumns(self.origins, tuple(parts), _gram(parts, self.gram.shape[0]))


def _gram(parts: Sequence[tuple[slice, np.ndarray, Columns]], count: int) -> Reals:
    whole = np.zeros((count, count))
    for _, place, columns in parts:
        whole[np.ix_(place, place)] += columns.gram()
    return whole


@dataclass(frozen=True)
class Whitener:
    """Takes out of deviations what smooth errors of known sizes and length would explain.

    With columns B and coefficients of covariance D = R R' that of the deviations is I + B D B'. Its inverse is
    applied by Woodbury's identity, and quadratic forms come out as those of independent deviations less what is
    explained.
    """

    columns: AllColumns
    roots: tuple[Reals, ...]
    factor: Reals

    @staticmethod
    def of(columns: AllColumns, sizes: Mapping[str, float], length: float) -> Whitener:
        """From the columns, and the sizes and the length of their origins."""
        roots = [
            root
            for o in columns.origins
            for root in [sizes[o.name] * o.wander.root(length if o.chain else None)] * o.parts
        ]
        inner = columns.gram.copy()
        stop = 0
        for root in roots:
            start, stop = stop, stop + root.shape[0]
            inner[start:stop] = root.T @ inner[start:stop]
            inner[:, start:stop] = inner[:, start:stop] @ root
        inner[np.diag_indices_from(inner)] += 1.0
        return Whitener(columns, tuple(roots), linalg.cholesky(inner, lower=True, overwrite_a=True))

    def pull(self, values: Reals) -> Reals:
        """`R' B' v`; values (n,) or (n, k)."""
        found, stop = self.columns.pull(values), 0
        for root in self.roots:
            start, stop = stop, stop + root.shape[0]
            found[start:stop] = root.T @ found[start:stop]
        return found

    def reduce(self, values: Reals) -> Reals:
        """`L^-1 R' B' v`, of which the squares are what is explained; values (n,) or (n, k)."""
        return np.asarray(linalg.solve_triangular(self.factor, self.pull(values), lower=True, check_finite=False))

    def square(self, values: Reals) -> float:
        """Quadratic form of the deviations, smooth errors integrated out."""
        reduced = self.reduce(values)
        return float(values @ values - reduced @ reduced)

    def explained(self, values: Reals) -> Reals:
        """The coefficients that explain most, independent and of unit variance beforehand."""
        return np.asarray(linalg.cho_solve((self.factor, True), self.pull(values), check_finite=False))

    def variances(self) -> Reals:
        """Of the coefficients afterwards."""
        inverse, _ = linalg.lapack.dtrtri(self.factor, lower=1)
        return np.asarray((np.tril(inverse) ** 2).sum(axis=0))

    def smooth(self, coefficients: Reals, size: int) -> Reals:
        """What coefficients do to so many deviations."""
        moved, stop = np.empty_like(coefficients), 0
        for root in self.roots:
            start, stop = stop, stop + root.shape[0]
            moved[start:stop] = root @ coefficients[start:stop]
        return self.columns.push(moved, size)

    def of_origin(self) -> np.ndarray:
        """Index of each coefficient's origin."""
        return np.repeat(np.arange(len(self.columns.origins)), [o.count for o in self.columns.origins])

    @property
    def log_determinant(self) -> float:
        """Of I + B D B'."""
        return float(2.0 * np.log(np.diag(self.factor)).sum())
