"""Random numbers of a small campaign: by tier, seed, index and purpose, and by nothing else."""

from __future__ import annotations

import hashlib

import numpy as np

TIER = "small"


def generator(seed: int, index: int, purpose: str, *, tier: str = TIER) -> np.random.Generator:
    """A generator of its own for each purpose, so that one more draw for one purpose changes no other.

    The tier's name and the purpose go in by a hash, never by a place in a list.

    Parameters
    ----------
    seed, index : int
        Of the suite, and of the campaign in it.
    purpose : str
    tier : str
    """
    words = [int.from_bytes(hashlib.sha256(name.encode()).digest()[:8], "big") for name in (tier, purpose)]
    return np.random.default_rng([*words, seed, index])


def log_between(random: np.random.Generator, low: float, high: float) -> float:
    """A value between two, equally likely in its logarithm, to four digits."""
    return rounded(float(np.exp(random.uniform(np.log(low), np.log(high)))))


def rounded(value: float) -> float:
    """Four significant digits, as an engineer writes a number down."""
    return float(f"{value:.4g}")
