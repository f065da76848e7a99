"""Parts of cross spectra: what one channel has, passes on to another, and does not share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import digamma

from permway.arrays import Complexes, Reals

Channels = int | np.ndarray
"""One channel, or one for each line."""

Part = tuple[str, int, int, np.ndarray, Reals]
"""Power, transfer or rest; its channel and the other; its lines; the scatter of its logarithm there."""


@dataclass(frozen=True, eq=False)
class Joined:
    """All parts of one kind, end to end, each array of shape (n,).

    Attributes
    ----------
    c, o : ndarray of int
        Channel and the other.
    at : ndarray of int
        Lines.
    sigma : ndarray
    worth : ndarray
        Averages.
    row : ndarray of int
        Of the residuals; of transfers where the real part stands.
    imaginary : ndarray of int
        Of transfers where the imaginary part stands.
    """

    c: np.ndarray
    o: np.ndarray
    at: np.ndarray
    sigma: Reals
    worth: Reals
    row: np.ndarray
    imaginary: np.ndarray

    @cached_property
    def bias(self) -> Reals:
        """Of the logarithm of a power."""
        return mean_of_logarithm(self.worth)


def joined(parts: Sequence[Part], worth: Sequence[Reals], kind: str) -> Joined:
    """The parts of a kind, of all parts in their order and the averages that each is worth."""
    found: list[list[np.ndarray]] = [[np.zeros(0, dtype=t)] for t in (int, int, int, float, float, int, int)]
    start = 0
    for (what, c, o, at, sigma), averages in zip(parts, worth, strict=True):
        row = start + np.arange(at.size)
        if what == kind:
            one = (np.full(at.size, c), np.full(at.size, o), at, sigma, averages, row, row + at.size)
            for column, values in zip(found, one, strict=True):
                column.append(values)
        start += (2 if what == "transfer" else 1) * at.size
    return Joined(*(np.concatenate(column) for column in found))


def coherence(csd: Complexes) -> Reals:
    """Of all pairs, (channels, channels, F)."""
    power = np.einsum("ccf->cf", csd).real
    return np.asarray(np.abs(csd) ** 2 / (power[:, None] * power[None, :]))


def transfer(csd: Complexes, c: Channels, o: Channels, at: np.ndarray) -> Complexes:
    """From one channel to another."""
    return np.asarray(csd[c, o, at] / csd[o, o, at].real)


def mean_of_logarithm(averages: Reals) -> Reals:
    """Mean of the logarithm of a power by so many averages, less the logarithm of its mean."""
    return np.asarray(digamma(averages) - np.log(averages))


def remainder(csd: Complexes, c: Channels, o: Channels, at: np.ndarray, left: Reals | float = 1.0) -> Reals:
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
