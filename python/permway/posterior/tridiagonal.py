"""Cholesky factor of a symmetric block tridiagonal matrix: what a chain of Markov states has for its precision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from permway.arrays import Reals


@dataclass(frozen=True)
class Tridiagonal:
    """The factor L of a positive definite matrix of K by K blocks, each of w rows, applied block by block.

    Attributes
    ----------
    inverse : ndarray, shape (K, w, w)
        Of the blocks of L on its diagonal.
    below : ndarray, shape (K - 1, w, w)
        Its blocks below them.
    log_determinant : float
        Of the matrix.
    """

    inverse: Reals
    below: Reals
    log_determinant: float

    @staticmethod
    def of(diagonal: Reals, below: Reals) -> Tridiagonal:
        """Factor a matrix of which these are the blocks on the diagonal and below it.

        Raises
        ------
        numpy.linalg.LinAlgError
            If it is not positive definite.
        """
        inverse, found, log_root = np.empty_like(diagonal), np.empty_like(below), 0.0
        for k in range(len(diagonal)):
            block = diagonal[k]
            if k:
                found[k - 1] = below[k - 1] @ inverse[k - 1].T
                block = block - found[k - 1] @ found[k - 1].T
            root = np.linalg.cholesky(block)
            log_root += float(np.log(np.diag(root)).sum())
            inverse[k] = lapack.dtrtri(root, lower=1)[0]
        return Tridiagonal(inverse, found, 2.0 * log_root)

    def forward(self, values: Reals) -> Reals:
        """L^-1 times values, shape (K w, k)."""
        count, width, _ = self.inverse.shape
        each = values.reshape(count, width, values.shape[1])
        solved = np.empty_like(each)
        for k in range(count):
            left = each[k] - self.below[k - 1] @ solved[k - 1] if k else each[k]
            np.matmul(self.inverse[k], left, out=solved[k])
        return solved.reshape(values.shape)

    def backward(self, values: Reals) -> Reals:
        """L'^-1 times values, shape (K w, k)."""
        count, width, _ = self.inverse.shape
        each = values.reshape(count, width, values.shape[1])
        solved = np.empty_like(each)
        for k in reversed(range(count)):
            left = each[k] - self.below[k].T @ solved[k + 1] if k + 1 < count else each[k]
            np.matmul(self.inverse[k].T, left, out=solved[k])
        return solved.reshape(values.shape)

    def inverse_blocks(self) -> tuple[Reals, Reals]:
        """Of the inverse of the matrix, the blocks on the diagonal and below it, (K, w, w) and (K - 1, w, w)."""
        at, beside = np.empty_like(self.inverse), np.empty_like(self.below)
        for k in reversed(range(len(at))):
            at[k] = self.inverse[k].T @ self.inverse[k]
            if k + 1 < len(at):
                over = self.below[k] @ self.inverse[k]
                beside[k] = -at[k + 1] @ over
                at[k] -= over.T @ beside[k]
        return at, beside
