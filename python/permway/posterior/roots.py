"""Inner products of columns by the inverse of a covariance, each a difference of two sums of squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.arrays import Reals


@dataclass(frozen=True)
class Roots:
    """Columns X as A and B of which A' A - B' B is the inner product of X by the inverse of a covariance."""

    above: Reals
    below: Reals

    def beside(self, more: Roots) -> Roots:
        """With further columns."""
        return Roots(np.hstack([self.above, more.above]), np.hstack([self.below, more.below]))

    def first(self, count: int) -> Roots:
        """Of the first so many columns."""
        return Roots(self.above[:, :count], self.below[:, :count])

    def times(self, other: Roots) -> Reals:
        """Inner products with other columns, shape (k, other's k)."""
        return np.asarray(self.above.T @ other.above - self.below.T @ other.below)

    def squares(self) -> Reals:
        """Inner product of each column with itself, shape (k,)."""
        return np.asarray(
            np.einsum("nk,nk->k", self.above, self.above) - np.einsum("nk,nk->k", self.below, self.below)
        )


@dataclass(frozen=True)
class Weighted:
    """Columns X weighed by the noise, whose precision is W.

    Attributes
    ----------
    above : ndarray, shape (n, k)
        Root of W times X.
    pulled : tuple of ndarray
        C' W X of each list of chains, as its factor solves for it.
    across : ndarray, shape (b, k)
        B' W X, of errors that a few columns B span, of unit size.
    """

    above: Reals
    pulled: tuple[Reals, ...]
    across: Reals
