"""Poles and residues of many responses at once, by the Loewner pencil.

Lines are "left" and "right" ones in turn, mu and lambda, each with a few directions l and r. Of the left data
v = l H and the right data w = H r the matrices L = (v r - l w) / (mu - lambda) and Ls = (mu v r - lambda l w) /
(mu - lambda) are such that H(s) = W (Ls - s L)^-1 V. Source: Mayo and Antoulas (2007), Linear Algebra Appl. 425,
634-662. Nine equal spans have poles within 1e-4 of each other under damping of 5e-2: no single mixture of
responses, as in :mod:`permway.response.poles`, distinguishes them, but their directions do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from permway.arrays import Complexes, Reals

TOLERANCE = 1e-12
"""Singular values below it, relative to the largest, are rounding."""

Integers = np.ndarray[tuple[int], np.dtype[np.int64]]


@dataclass(frozen=True)
class Pencil:
    """A rational matrix function of frequency through its data.

    Attributes
    ----------
    poles : ndarray of complex128, shape (R,)
        rad/s.
    full : bool
        Whether the data have no more rank than poles were found: more lines, or a narrower band, are needed.
    right : ndarray of int, shape (K,)
        Right lines.
    directions : ndarray, shape (K, columns, T)
        Theirs.
    motion : ndarray of complex128, shape (K T, R)
        What makes the data H[right] @ directions the residues' left factors.
    force : ndarray of complex128, shape (R, columns)
        The residues' right factors.
    """

    poles: Complexes
    full: bool
    right: Integers
    directions: Reals
    motion: Complexes
    force: Complexes

    def displaced(self, responses: Complexes) -> Complexes:
        """Left factors of the residues, (rows, R), of responses (K, rows, columns) at the right lines."""
        data = np.moveaxis(responses @ self.directions, 0, 1)
        return np.asarray(data.reshape(data.shape[0], -1) @ self.motion)


def pencil(omega: Reals, responses: Complexes, directions: int, seed: int) -> Pencil:
    """The rational function through responses of about one size.

    Parameters
    ----------
    omega : ndarray, shape (N,)
        rad/s, ascending; every second is a right line.
    responses : ndarray of complex128, shape (N, columns, columns)
    directions : int
        A line's.
    seed : int
        Of the directions.
    """
    draw = np.random.default_rng(seed)
    columns = responses.shape[-1]
    left, right = np.arange(0, omega.size, 2), np.arange(1, omega.size, 2)
    ahead = np.linalg.qr(draw.standard_normal((left.size, columns, directions)))[0].transpose(0, 2, 1)
    behind = np.linalg.qr(draw.standard_normal((right.size, columns, directions)))[0]
    v, w = ahead @ responses[left], responses[right] @ behind
    vr = np.tensordot(v, behind, axes=(2, 1))
    lw = np.tensordot(ahead, w, axes=(2, 1))
    mu, by = omega[left][:, None, None, None], omega[right][None, None, :, None]
    size = left.size * directions, right.size * directions
    loewner = ((vr - lw) / (mu - by)).reshape(size)
    shifted = ((mu * vr - by * lw) / (mu - by)).reshape(size)
    # Below the real axis there are no poles.
    beside = complex(0.5, -0.5) * np.sqrt(omega[0] * omega[-1])
    u, s, vh = np.linalg.svd(beside * loewner - shifted, full_matrices=False)
    rank = int((s > TOLERANCE * s[0]).sum())
    up, across = u[:, :rank].conj().T, vh[:rank].conj().T
    # With S the singular values, L x = S x / (beside - pole): an eigenvalue problem of one matrix.
    root = np.sqrt(s[:rank])
    values, y, x = linalg.eig((up @ loewner @ across) / np.outer(root, root), left=True, right=True)
    x, y = x / root[:, None], y / root[:, None]
    force = y.conj().T @ up @ v.reshape(size[0], columns)
    with np.errstate(divide="ignore", invalid="ignore"):
        poles = beside - 1.0 / values
        # Near a pole the inverse of Ls - s L is -x y / (y L x) / (s - pole), and y S x = (beside - pole) y L x.
        weight = (y.conj() * s[:rank, None] * x).sum(axis=0) * values
        force = -force / weight[:, None]
    known = np.isfinite(poles) & np.isfinite(force).all(axis=1)
    return Pencil(poles[known], rank > 0.9 * min(size), right, behind, (across @ x)[:, known], force[known])
