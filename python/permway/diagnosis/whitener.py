"""Taking out of residuals what calibration errors of all blocks would explain."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

import numpy as np
from scipy import linalg, sparse

from permway.arrays import Reals
from permway.diagnosis.calibration_errors import CalibrationErrors, Columns, ErrorSource


@dataclass(frozen=True)
class AllColumns:
    """The columns of all blocks: one source met by two records is one.

    Attributes
    ----------
    sources : tuple of ErrorSource
    parts : tuple of (slice, ndarray of int, Columns)
        Of each block: its rows, where its columns stand among all, and they themselves.
    gram : ndarray, shape (c, c)
    """

    sources: tuple[ErrorSource, ...]
    parts: tuple[tuple[slice, np.ndarray, Columns], ...]
    gram: Reals

    @staticmethod
    def of(blocks: Sequence[CalibrationErrors], sizes: Sequence[int]) -> AllColumns:
        """From what the blocks say, and how many rows they have."""
        first: dict[str, int] = {}
        sources: list[ErrorSource] = []
        count = 0
        for source in (o for errors in blocks for o in errors.sources):
            if source.name not in first:
                first[source.name] = count
                sources.append(source)
                count += source.count
        parts, start = [], 0
        for errors, rows in zip(blocks, sizes, strict=True):
            each = [first[o.name] + np.arange(o.count) for o in errors.sources]
            # A table of modes has no calibration errors.
            place = np.concatenate(each) if each else np.zeros(0, dtype=np.int64)
            parts.append((slice(start, start + rows), place, errors.columns))
            start += rows
        return AllColumns(tuple(sources), tuple(parts), _gram(parts, count))

    def transposed_times(self, values: Reals, only: Sequence[int] | None = None) -> Reals:
        """Transposed times values, (n,) or (n, k); of some blocks only, if the values are none elsewhere."""
        found = np.zeros((self.gram.shape[0], *values.shape[1:]))
        for index in range(len(self.parts)) if only is None else only:
            rows, place, columns = self.parts[index]
            found[place] += columns.transposed_times(values[rows])
        return found

    def times(self, coefficients: Reals, size: int) -> Reals:
        """Times coefficients, to (size,)."""
        moved = np.zeros(size)
        for rows, place, columns in self.parts:
            moved[rows] = columns.times(coefficients[place])
        return moved

    @cached_property
    def apart(self) -> tuple[np.ndarray, ...]:
        """Which parts meet no others, as gains and phases of frequency responses do not."""
        if not self.counts:
            return ()
        starts = np.cumsum([0, *self.counts[:-1]])
        met = np.logical_or.reduceat(np.logical_or.reduceat(self.gram != 0.0, starts, axis=0), starts, axis=1)
        count, kind = sparse.csgraph.connected_components(sparse.csr_array(met), directed=False)
        return tuple(np.flatnonzero(kind == number) for number in range(count))

    @property
    def counts(self) -> list[int]:
        """Coefficients of every part of every source, in their order."""
        return [o.process.count for o in self.sources for _ in range(o.parts)]


def _gram(parts: Sequence[tuple[slice, np.ndarray, Columns]], count: int) -> Reals:
    whole = np.zeros((count, count))
    for _, place, columns in parts:
        at = _at(place)
        whole[(at, at) if isinstance(at, slice) else np.ix_(place, place)] += columns.gram()
    return whole


def _at(place: np.ndarray) -> slice | np.ndarray:
    """Indices as a slice, where they follow each other: several times faster."""
    follow = place.size and place[-1] - place[0] == place.size - 1 and bool((np.diff(place) == 1).all())
    return slice(int(place[0]), int(place[-1]) + 1) if follow else place


@dataclass(frozen=True)
class Whitener:
    """Takes out of residuals what calibration errors of known sizes and length would explain.

    With columns B and coefficients of covariance D = R R' that of the residuals is I + B D B'. Its inverse is
    applied by Woodbury's identity, and quadratic forms come out as those of independent residuals less what is
    explained.

    Attributes
    ----------
    columns : AllColumns
    roots : tuple of ndarray, shape (parts, count, count) each
        R, part by part, neighbours of as many coefficients together.
    factors : tuple of (ndarray of int, ndarray)
        Of coefficients that meet no others: where they stand, and L of L L' = I + R' B' B R.
    """

    columns: AllColumns
    roots: tuple[Reals, ...]
    factors: tuple[tuple[np.ndarray, Reals], ...]

    @staticmethod
    def of(columns: AllColumns, sizes: Mapping[str, float], length: float) -> Whitener:
        """From the columns, and the sizes and the length of their sources."""
        roots = [
            root
            for o in columns.sources
            for root in [sizes[o.name] * o.process.root(length if o.chain else None)] * o.parts
        ]
        of, factors = np.repeat(np.arange(len(roots)), columns.counts), []
        for parts in columns.apart:
            mine, stacked = np.flatnonzero(np.isin(of, parts)), _stacked([roots[part] for part in parts])
            inner = _rooted(_rooted(columns.gram[np.ix_(mine, mine)], stacked, _across).T, stacked, _across)
            inner[np.diag_indices_from(inner)] += 1.0
            factors.append((mine, linalg.cholesky(inner, lower=True, overwrite_a=True)))
        return Whitener(columns, _stacked(roots), tuple(factors))

    @property
    def count(self) -> int:
        """Number of coefficients."""
        return int(self.columns.gram.shape[0])

    def transposed_times(self, values: Reals, only: Sequence[int] | None = None) -> Reals:
        """`R' B' v`; values (n,) or (n, k), of some blocks only, if they are none elsewhere."""
        return _rooted(self.columns.transposed_times(values, only), self.roots, _across)

    def reduce(self, values: Reals, only: Sequence[int] | None = None) -> Reals:
        """`L^-1 R' B' v`, of which the squares are what is explained; values as of :meth:`transposed_times`."""
        return self._each(_forward, self.transposed_times(values, only))

    def square(self, values: Reals) -> float:
        """Quadratic form of the residuals, calibration errors integrated out."""
        reduced = self.reduce(values)
        return float(values @ values - reduced @ reduced)

    def explained(self, values: Reals) -> Reals:
        """The coefficients that explain most, independent and of unit variance beforehand."""
        return self._each(
            lambda factor, mine: linalg.cho_solve((factor, True), mine, check_finite=False),
            self.transposed_times(values),
        )

    def _each(self, solve: Callable[[Reals, Reals], Reals], pulled: Reals) -> Reals:
        """Of coefficients apart from others each by its own factor."""
        for place, factor in self.factors:
            mine = pulled[place]
            if mine.any():
                pulled[place] = solve(factor, mine)
        return pulled

    def calibration(self, coefficients: Reals, size: int) -> Reals:
        """What coefficients do to so many residuals."""
        return self.columns.times(_rooted(coefficients, self.roots), size)

    @property
    def log_determinant(self) -> float:
        """Of I + B D B'."""
        return sum(float(2.0 * np.log(np.diag(factor)).sum()) for _, factor in self.factors)


def _stacked(roots: Sequence[Reals]) -> tuple[Reals, ...]:
    """Neighbours of one shape together."""
    return tuple(np.stack(list(alike)) for _, alike in groupby(roots, key=lambda root: root.shape[0]))


def _rooted(values: Reals, stacked: Sequence[Reals], of: Callable[[Reals], Reals] = lambda roots: roots) -> Reals:
    """Rows part by part times what is made of the roots; values (c,) or (c, k)."""
    moved, stop = np.empty(values.shape), 0
    for roots in stacked:
        parts, count, _ = roots.shape
        start, stop = stop, stop + parts * count
        mine = values[start:stop].reshape(parts, count, values[0].size)
        moved[start:stop] = (of(roots) @ mine).reshape(stop - start, *values.shape[1:])
    return moved


def _across(roots: Reals) -> Reals:
    return roots.swapaxes(1, 2)


def _forward(factor: Reals, values: Reals) -> Reals:
    """`L^-1 v`; of one column without what it takes to have many."""
    if values.ndim == 1:
        return np.asarray(linalg.blas.dtrsv(factor, values, lower=1))
    return np.asarray(linalg.solve_triangular(factor, values, lower=True, check_finite=False))
