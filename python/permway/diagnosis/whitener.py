"""Taking out of deviations what smooth errors of all blocks would explain."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import linalg, sparse

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

    @cached_property
    def apart(self) -> tuple[np.ndarray, ...]:
        """Where coefficients stand that meet no others, as gains and phases of frequency responses do not."""
        of = np.repeat(np.arange(len(self.counts)), self.counts)
        rows, columns = np.nonzero(self.gram)
        meet = sparse.coo_array((np.ones(rows.size), (of[rows], of[columns])), shape=2 * (len(self.counts),))
        count, kind = sparse.csgraph.connected_components(meet, directed=False)
        return tuple(np.flatnonzero(kind[of] == number) for number in range(count))

    @property
    def counts(self) -> list[int]:
        """Coefficients of every part of every origin, in their order."""
        return [o.wander.count for o in self.origins for _ in range(o.parts)]

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

    Attributes
    ----------
    columns : AllColumns
    roots : tuple of ndarray
        R, block by block.
    factors : tuple of (ndarray of int, ndarray)
        Of coefficients that meet no others: where they stand, and L of L L' = I + R' B' B R.
    """

    columns: AllColumns
    roots: tuple[Reals, ...]
    factors: tuple[tuple[np.ndarray, Reals], ...]

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
        factors = [
            (mine, linalg.cholesky(inner[np.ix_(mine, mine)], lower=True, overwrite_a=True))
            for mine in columns.apart
        ]
        return Whitener(columns, tuple(roots), tuple(factors))

    @property
    def count(self) -> int:
        """Number of coefficients."""
        return int(self.columns.gram.shape[0])

    def pull(self, values: Reals) -> Reals:
        """`R' B' v`; values (n,) or (n, k)."""
        found, stop = self.columns.pull(values), 0
        for root in self.roots:
            start, stop = stop, stop + root.shape[0]
            found[start:stop] = root.T @ found[start:stop]
        return found

    def reduce(self, values: Reals) -> Reals:
        """`L^-1 R' B' v`, of which the squares are what is explained; values (n,) or (n, k)."""
        return self._each(
            lambda factor, mine: linalg.solve_triangular(factor, mine, lower=True, check_finite=False),
            self.pull(values),
        )

    def square(self, values: Reals) -> float:
        """Quadratic form of the deviations, smooth errors integrated out."""
        reduced = self.reduce(values)
        return float(values @ values - reduced @ reduced)

    def explained(self, values: Reals) -> Reals:
        """The coefficients that explain most, independent and of unit variance beforehand."""
        return self._each(
            lambda factor, mine: linalg.cho_solve((factor, True), mine, check_finite=False), self.pull(values)
        )

    def _each(self, solve: Callable[[Reals, Reals], Reals], pulled: Reals) -> Reals:
        """Of coefficients apart from others each by its own factor."""
        for place, factor in self.factors:
            pulled[place] = solve(factor, pulled[place])
        return pulled

    def variances(self) -> Reals:
        """Of the coefficients afterwards."""
        found = np.empty(self.count)
        for place, factor in self.factors:
            inverse, _ = linalg.lapack.dtrtri(factor, lower=1)
            found[place] = (np.tril(inverse) ** 2).sum(axis=0)
        return found

    def smooth(self, coefficients: Reals, size: int) -> Reals:
        """What coefficients do to so many deviations."""
        return self.columns.push(self._moved(coefficients), size)

    def of_part(self, coefficients: Reals, index: int) -> Reals:
        """Coefficients of one block's columns, nepers and rad of them, in the order of its origins."""
        return np.asarray(self._moved(coefficients)[self.columns.parts[index][1]])

    def _moved(self, coefficients: Reals) -> Reals:
        moved, stop = np.empty_like(coefficients), 0
        for root in self.roots:
            start, stop = stop, stop + root.shape[0]
            moved[start:stop] = root @ coefficients[start:stop]
        return moved

    def of_origin(self) -> np.ndarray:
        """Index of each coefficient's origin."""
        return np.repeat(np.arange(len(self.columns.origins)), [o.count for o in self.columns.origins])

    @property
    def log_determinant(self) -> float:
        """Of I + B D B'."""
        return sum(float(2.0 * np.log(np.diag(factor)).sum()) for _, factor in self.factors)
