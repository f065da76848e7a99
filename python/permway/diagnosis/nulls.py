"""Gains of BIC that a campaign of this layout would show with nothing missing: the threshold against false alarms.

Records of the recalibrated model are simulated: noise of every line, smooth errors of every chain, parameters
drawn from their priors. What the hypotheses gain of them is taken to first order about the start from which each
was screened, so that thousands of campaigns cost no solve. The best of all hypotheses counts, as in a search.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.choose import penalty
from permway.diagnosis.compete import Ring
from permway.diagnosis.quick import Quick

DRAWS = 2000
LEVEL = 0.95
"""Share of campaigns with nothing missing that stay below the threshold."""

LEAST = 10.0
"""Threshold below which none is set: a search over starts is not quite linear, and 10 is "very strong" evidence
(Kass and Raftery 1995)."""


def null_gains(ring: Ring, screened: Sequence[Quick], *, seed: int = 0, draws: int = DRAWS) -> Reals:
    """The best gain of BIC of each simulated campaign, shape (draws,).

    Parameters
    ----------
    ring : Ring
        Of the recalibrated base.
    screened : sequence of Quick
        With their columns.
    """
    known = [(q, c) for q in screened if (c := _columns(q)) is not None]
    if not known:
        return np.full(draws, -np.inf)
    columns = np.concatenate([c for _, c in known], axis=1)
    # Heat lessens what each record says; with nothing missing there is none.
    information = ring.projected(columns, columns) * ring.fit.heat
    information = 0.5 * (information + information.T)
    values, vectors = linalg.eigh(information)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    random = np.random.default_rng(seed)
    slopes = root @ random.standard_normal((root.shape[1], draws))
    best = np.full(draws, -np.inf)
    start = 0
    for quick, own in known:
        stop = start + own.shape[1]
        inner = information[start:stop, start:stop] + np.eye(stop - start)
        pull = slopes[start:stop]
        gain = np.einsum("pd,pd->d", pull, linalg.solve(inner, pull, assume_a="pos"))
        best = np.maximum(best, gain - penalty(quick, ring))
        start = stop
    return best


def _columns(quick: Quick) -> Reals | None:
    """Slopes by its parameters, or where they were not taken what its start changes."""
    if quick.columns is not None:
        return np.asarray(quick.columns, dtype=np.float64)
    return None if quick.direction is None else np.asarray(quick.direction[:, None], dtype=np.float64)


def threshold(ring: Ring, screened: Sequence[Quick], *, seed: int = 0) -> float:
    """Gain of BIC that 95 of 100 campaigns of this layout stay below if nothing is missing."""
    return max(LEAST, float(np.quantile(null_gains(ring, screened, seed=seed), LEVEL)))
