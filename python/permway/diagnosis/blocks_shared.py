"""What the lines of one run's spectra say together: all its channels meet one profile.

Where wheels lag by a good part of a segment, what one does not share with another at a line is the same profile
still, a segment earlier or later. So the factors of the Wishart density, each of which is right, are not as
independent as where incoherence is noise: track that happens to be rough at a wavelength raises powers and
remainders of all channels alike, and a lag turns all transfers.
"""

from __future__ import annotations

import numpy as np
from scipy import linalg, sparse

from permway.arrays import Reals

FARTHEST = 2.5
"""Standard deviations at which differences of neighbours are cut off: a narrow effect is no correlation."""

BELIEVED = 0.8
"""Share of a correlation between kinds of rows that is believed: it is learnt from some hundred lines."""

FEWEST_LINES = 30
"""That two kinds of rows must have both, or they count as independent."""


def covariance(kinds: Reals) -> Reals:
    """Of kinds of rows, by how they differ from their neighbours in frequency.

    What kinds have in common scatters more than each does. What sets them apart is taken to scatter as much as
    each. It would be less by correlations that were the same at all lines; only their mean is learnt.

    Parameters
    ----------
    kinds : ndarray, shape (kinds, lines)
        Deviations of each kind; NaN at lines that it has not.

    Returns
    -------
    ndarray, shape (kinds, kinds)
        Of standardised deviations; no combination scatters less than if all were independent.
    """
    steps = np.array([_cut(np.diff(values)) for values in kinds])
    known = np.isfinite(steps)
    found = np.eye(len(kinds))
    for i in range(len(kinds)):
        for j in range(i):
            both = known[i] & known[j]
            if both.sum() >= FEWEST_LINES:
                size = np.sqrt(np.sum(steps[i, both] ** 2) * np.sum(steps[j, both] ** 2))
                found[i, j] = found[j, i] = BELIEVED * float(np.sum(steps[i, both] * steps[j, both]) / size)
    values, vectors = np.linalg.eigh(found)
    return np.asarray((vectors * np.maximum(values, 1.0)) @ vectors.T)


def apart(present: np.ndarray, rows: np.ndarray, shared: Reals) -> tuple[sparse.csr_array, float]:
    """What makes rows of a line independent: each less what those before it say of it.

    Parameters
    ----------
    present : ndarray of bool, shape (kinds, lines)
    rows : ndarray of int, shape (kinds, lines)
        Number of each row, where it is present.
    shared : ndarray, shape (kinds, kinds)
        From :func:`covariance`.

    Returns
    -------
    (sparse matrix, float)
        Shape (rows, rows); and the logarithm of the determinant of the covariance that it takes out.
    """
    which, of_line = np.unique(present.T, axis=0, return_inverse=True)
    parts, log_determinant = [], 0.0
    for index, kinds in enumerate(which):
        lines = np.flatnonzero(of_line.reshape(-1) == index)
        mine = np.flatnonzero(kinds)
        if mine.size == 0:
            continue
        root = np.linalg.cholesky(shared[np.ix_(mine, mine)])
        inverse = linalg.solve_triangular(root, np.eye(mine.size), lower=True)
        log_determinant += 2.0 * lines.size * float(np.log(np.diag(root)).sum())
        i, j = np.tril_indices(mine.size)
        at = rows[np.ix_(mine, lines)]
        parts.append((np.repeat(inverse[i, j], lines.size), at[i].ravel(), at[j].ravel()))
    values, down, across = (np.concatenate(part) for part in zip(*parts, strict=True))
    size = int(present.sum())
    return sparse.csr_array((values, (down, across)), shape=(size, size)), log_determinant


def _cut(steps: Reals) -> Reals:
    """Differences in standard deviations of their own, none farther than some."""
    known = steps[np.isfinite(steps)]
    size = 1.4826 * float(np.median(np.abs(known))) if known.size else 1.0
    return np.asarray(np.clip(steps / max(size, 1e-9), -FARTHEST, FARTHEST))
