"""Parts of cross spectra: what one channel has, passes on to another, and does not share."""

from __future__ import annotations

import numpy as np
from scipy.special import digamma

from permway.arrays import Complexes, Reals


def coherence(csd: Complexes) -> Reals:
    """Of all pairs, (channels, channels, F)."""
    power = np.einsum("ccf->cf", csd).real
    return np.asarray(np.abs(csd) ** 2 / (power[:, None] * power[None, :]))


def transfer(csd: Complexes, c: int, o: int, at: np.ndarray) -> Complexes:
    """From one channel to another."""
    return np.asarray(csd[c, o, at] / csd[o, o, at].real)


def mean_of_logarithm(averages: Reals) -> Reals:
    """Mean of the logarithm of a power by so many averages, less the logarithm of its mean."""
    return np.asarray(digamma(averages) - np.log(averages))


def remainder(csd: Complexes, c: int, o: int, at: np.ndarray, left: Reals | float = 1.0) -> Reals:
    """Power of c that o does not share, as much as is left of it, and a thousandth of all: none is clean below."""
    own = csd[c, c, at].real
    return np.asarray(left * (own - np.abs(csd[c, o, at]) ** 2 / csd[o, o, at].real) + 1e-3 * own)


def tree_of(coherence: Reals) -> tuple[int, list[tuple[int, int]]]:
    """A root and (child, parent) pairs, most coherent first (Prim); the root is the first channel."""
    inside, tree = [0], []
    while len(inside) < coherence.shape[0]:
        outside = [c for c in range(coherence.shape[0]) if c not in inside]
        child, parent = max(((c, p) for c in outside for p in inside), key=lambda pair: coherence[pair])
        tree.append((child, parent))
        inside.append(child)
    return 0, tree
