"""Covariance of all residuals: noise, discrepancy, calibration errors, and errors that a few columns span."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.blocks import Block
from permway.diagnosis.blocks_passage import UNEVENNESS
from permway.diagnosis.observations import Observations, Solved
from permway.posterior.chains import Chains, Factor, chains_of, contiguous
from permway.posterior.hyper import IDEALISATION, LACKING, Hyper
from permway.posterior.roots import Roots, Weighted

NEPER_PER_DB = float(np.log(10.0)) / 20.0


@dataclass(frozen=True)
class Frame:
    """All of the covariance that no hyperparameter changes.

    Attributes
    ----------
    observations : Observations
        Records as residuals whitened by their noise.
    chains : list of Chains
    columns : ndarray, shape (m, b)
        Errors of unit variance that act by few columns: an irregularity's level, tables, the idealisation, what
        unevenness does.
    spanned : ndarray of int, shape (m,)
        The rows that they act on.
    sigma : ndarray, shape (n,)
        Of each row's noise, neper.
    statistic : ndarray of str, shape (n,)
        Of each row's record.
    sources : ndarray of str, shape (b,)
        Of each column.
    """

    observations: Observations
    chains: tuple[Chains, ...]
    columns: Reals
    spanned: np.ndarray
    sigma: Reals
    statistic: np.ndarray
    sources: np.ndarray

    @staticmethod
    def of(observations: Observations) -> Frame:
        """From the records."""
        blocks = tuple(block.bare() for block in observations.blocks)
        observations = observations.with_blocks(blocks)
        statistic = np.concatenate(
            [np.full(b.rows.channel.size, b.dataset.record.statistic, dtype="U16") for b in blocks]
        )
        sigma = NEPER_PER_DB * np.concatenate([b.rows.scale_dB for b in blocks])
        columns, sources = _columns(observations, blocks)
        spanned = np.flatnonzero(np.any(columns, axis=1))
        chains = tuple(chains_of(blocks))
        return Frame(observations, chains, columns[spanned], spanned, np.maximum(sigma, 1e-9), statistic, sources)

    def about(self, solved: Solved, covariance: Covariance, residuals: Reals) -> Frame:
        """The same records weighed by what a fit predicts and, if it lacks nothing, by the errors that it leaves.

        What noise hides is expected to be what the prediction is there, and spectra scatter as it has them.

        Parameters
        ----------
        solved : Solved
            Its predictions.
        covariance : Covariance
            Of its residuals.
        residuals : ndarray, shape (n,)
        """
        starts = np.cumsum([0, *(b.rows.channel.size for b in self.observations.blocks)])
        # Of a model that lacks something, errors of chains take up what it lacks.
        lacking = covariance.hyper.novel > LACKING
        errors = np.zeros_like(residuals) if lacking else covariance.errors(residuals)
        spanned = {} if lacking else covariance.coefficients(residuals)
        blocks = tuple(
            block.about(solved.of(index), errors[starts[index] : starts[index + 1]], spanned)
            for index, block in enumerate(self.observations.blocks)
        )
        return Frame.of(self.observations.with_blocks(blocks))

    @property
    def whole(self) -> Reals:
        """The columns at all rows, (n, b)."""
        found = np.zeros((self.sigma.size, self.columns.shape[1]))
        found[self.spanned] = self.columns
        return found

    def with_idealisation(self, more: Reals) -> Frame:
        """The same with what the idealisation may do to the residuals, (n, c), in place of what is there."""
        other = self.sized != IDEALISATION
        columns = np.hstack([self.whole[:, other], more])
        spanned = np.flatnonzero(np.any(columns, axis=1))
        sources = np.append(self.sources[other], [IDEALISATION] * more.shape[1])
        return replace(self, columns=columns[spanned], spanned=spanned, sources=sources)

    @cached_property
    def sized(self) -> np.ndarray:
        """Of each column the hyperparameter that multiplies it; empty where it has its size."""
        first = [str(source).split(" ", 1)[0] for source in self.sources]
        return np.array([name if name in (IDEALISATION, UNEVENNESS) else "" for name in first], dtype=str)

    @property
    def idealisation(self) -> Reals:
        """Its columns at all rows, (n, c)."""
        return self.whole[:, self.sized == IDEALISATION]

    def first(self) -> Hyper:
        """Hyperparameters at the medians of their priors."""
        kinds = dict.fromkeys(kind for chains in self.chains for kind in chains.kinds)
        return Hyper.first(tuple(kinds), tuple(self.of_statistic), uneven=UNEVENNESS in self.sized)

    @cached_property
    def of_statistic(self) -> dict[str, np.ndarray]:
        """Rows of each kind of record."""
        return {str(name): np.flatnonzero(self.statistic == name) for name in np.unique(self.statistic)}

    def covariance(self, hyper: Hyper, keep: np.ndarray | None = None) -> Covariance:
        """With these hyperparameters; of some rows only, if that is asked for: others then have no precision."""
        weights = np.empty(self.sigma.size)
        for name, mine in self.of_statistic.items():
            weights[mine] = 1.0 / (1.0 + (hyper.discrepancy(name) / self.sigma[mine]) ** 2)
        noise = -float(np.log(weights if keep is None else weights[keep]).sum())
        if keep is not None:
            weights = np.where(keep, weights, 0.0)
        factors = []
        for chains in self.chains:
            sizes = np.array([hyper[kind] for kind in chains.kinds])
            rows = chains.rows[:, 0] if chains.turn is not None else chains.rows
            factors.append(chains.factor(sizes, hyper["length"], weights[rows]))
        return Covariance(self, hyper, weights, noise, tuple(factors))


def _columns(observations: Observations, blocks: tuple[Block, ...]) -> tuple[Reals, np.ndarray]:
    """Columns of errors that are no chain's, scaled to unit variance, and the source of each.

    One source met by two records is one.
    """
    total = sum(b.rows.channel.size for b in blocks)
    found: dict[str, Reals] = {}
    start = 0
    for block in blocks:
        rows = slice(start, start + block.rows.channel.size)
        start = rows.stop
        for name, columns in block.spanned(observations.sizes).items():
            whole = found.setdefault(name, np.zeros((total, columns.shape[1])))
            whole[rows] += columns
    sources = [name for name, columns in found.items() for _ in columns.T]
    return np.hstack([np.zeros((total, 0)), *found.values()]), np.array(sources, dtype=str)


@dataclass(frozen=True)
class Covariance:
    """Of the residuals, for given hyperparameters; it applies its inverse and has its determinant."""

    frame: Frame
    hyper: Hyper
    weights: Reals
    noise: float
    factors: tuple[Factor, ...]

    @property
    def _sizes(self) -> Reals:
        """By which the frame's columns count."""
        return np.array([self.hyper[name] if name else 1.0 for name in self.frame.sized])

    @property
    def columns(self) -> Reals:
        """Errors that a few columns span, of unit variance, at all rows, (n, b)."""
        return self.frame.whole * self._sizes

    @cached_property
    def _noise(self) -> Reals:
        """Square root of each row's precision, (n, 1)."""
        return np.sqrt(self.weights)[:, None]

    @cached_property
    def _unsized(self) -> Weighted:
        """The frame's columns."""
        rows = contiguous(self.frame.spanned)
        above = self._noise[rows] * self.frame.columns
        whole = np.zeros((self.weights.size, above.shape[1]))
        whole[rows] = above
        return Weighted(above, self._pulled(whole), above.T @ above)

    @cached_property
    def _spanned(self) -> tuple[Reals, Reals]:
        """Of the columns: what chains take off them, and the factor of their part."""
        below = self._taken(self._unsized) * self._sizes
        inner = self._unsized.across * self._sizes[:, None] * self._sizes - below.T @ below
        return below, linalg.cholesky(inner + np.eye(len(inner)), lower=True)

    def weighted(self, values: Reals) -> Weighted:
        """Columns (n, k) weighed by the noise: the half of the work that sizes of errors do not change."""
        above = self._noise * values
        across = np.zeros((0, values.shape[1]))
        if self.frame.columns.shape[1]:
            across = self._unsized.above.T @ above[contiguous(self.frame.spanned)]
        return Weighted(above, self._pulled(above), across)

    def _pulled(self, above: Reals) -> tuple[Reals, ...]:
        return tuple(f.pulled(self._noise[f.chains.local] * above[f.chains.local]) for f in self.factors)

    def _taken(self, weighted: Weighted) -> Reals:
        """What errors of chains take off columns, as a root, (states, k)."""
        below = [f.half(pulled) for f, pulled in zip(self.factors, weighted.pulled, strict=True)]
        return np.concatenate([np.zeros((0, weighted.above.shape[1])), *below])

    def _across(self, weighted: Weighted, below: Reals) -> Reals:
        """Inner products of the frame's columns with others."""
        return np.asarray(self._sizes[:, None] * weighted.across - self._spanned[0].T @ below)

    def rooted(self, weighted: Weighted) -> Roots:
        """What inner products by the inverse are made of."""
        below = self._taken(weighted)
        if self.frame.columns.shape[1]:
            beside = linalg.solve_triangular(self._spanned[1], self._across(weighted, below), lower=True)
            below = np.concatenate([below, beside])
        return Roots(weighted.above, below)

    def roots(self, values: Reals) -> Roots:
        """The same of columns (n, k): half the work of applying the inverse."""
        return self.rooted(self.weighted(values))

    def resized(self, hyper: Hyper) -> Covariance:
        """With other sizes of errors beside the same noise.

        Raises
        ------
        ValueError
            If the noise is another.
        """
        new = self.frame.covariance(hyper)
        if not np.array_equal(new.weights, self.weights):
            raise ValueError("the discrepancy is another")
        if self.frame.columns.shape[1]:
            new.__dict__["_unsized"] = self._unsized
        return new

    def errors(self, residuals: Reals) -> Reals:
        """Most probable errors of chains at rows of frequency responses: log gains, then phases; else 0."""
        found = np.zeros(residuals.size)
        for factor in self.factors:
            chains = factor.chains
            if chains.turn is not None:
                states = factor.states((self.weights * residuals)[chains.local, None])
                moved = np.asarray(chains.design @ states.reshape(chains.parts, chains.size).T)
                with np.errstate(divide="ignore", invalid="ignore"):
                    each = np.where(chains.relative[:, None] > 0.0, moved / chains.relative[:, None], 0.0)
                found[chains.rows] = each
        return found

    def coefficients(self, residuals: Reals) -> dict[str, Reals]:
        """Most probable errors that columns span: by source, of its columns as the frame has them."""
        found = self._sizes * (self.columns.T @ self.apply(residuals[:, None])[:, 0])
        return {str(name): found[self.frame.sources == name] for name in np.unique(self.frame.sources)}

    def apply(self, values: Reals) -> Reals:
        """Inverse times values, shape (n, k)."""
        found = self._without_columns(values)
        if self.frame.columns.shape[1]:
            weighted = self.weighted(values)
            across = self._across(weighted, self._taken(weighted))
            taken = np.zeros_like(values)
            inner = self._sizes[:, None] * linalg.cho_solve((self._spanned[1], True), across)
            taken[self.frame.spanned] = self.frame.columns @ inner
            found -= self._without_columns(taken)
        return found

    def _without_columns(self, values: Reals) -> Reals:
        """The inverse of all but the columns' part."""
        found = values * self.weights[:, None]
        for factor in self.factors:
            at = factor.chains.local
            found[at] -= self.weights[at, None] * factor.apply(found[at])
        return found

    def square(self, values: Reals) -> float:
        """Quadratic form of one vector."""
        return float(self.roots(values[:, None]).squares()[0])

    @cached_property
    def log_determinant(self) -> float:
        """Over that of the noise."""
        found = self.noise + sum(f.log_determinant for f in self.factors)
        if self.frame.columns.shape[1]:
            found += 2.0 * float(np.log(np.diag(self._spanned[1])).sum())
        return found
