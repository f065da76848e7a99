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
from permway.diagnosis.clock import Progress
from permway.diagnosis.compete import Ring
from permway.diagnosis.journal import current
from permway.diagnosis.quick import Quick

DRAWS, BATCH = 2000, 250
"""Simulated campaigns, and how many at once."""

LEVEL = 0.95
"""Share of campaigns with nothing missing that stay below the threshold."""

LEAST = 10.0
"""Threshold below which none is set: a search over starts is not quite linear, and 10 is "very strong" evidence
(Kass and Raftery 1995)."""


def null_gains(
    ring: Ring,
    screened: Sequence[Quick],
    *,
    seed: int = 0,
    draws: int = DRAWS,
    progress: Progress | None = None,
) -> Reals:
    """The best gain of BIC of each simulated campaign, shape (draws,).

    Parameters
    ----------
    ring : Ring
        Of the recalibrated base.
    screened : sequence of Quick
        With their columns.
    progress : callable, optional
        Told how many campaigns are simulated.
    """
    known = [(q, c) for q in screened if (c := _columns(q)) is not None]
    best = np.full(draws, -np.inf)
    if not known:
        return best
    columns = np.concatenate([c for _, c in known], axis=1)
    # Heat lessens what each record says; with nothing missing there is none.
    information = ring.projected(columns, columns) * ring.fit.heat
    information = 0.5 * (information + information.T)
    values, vectors = linalg.eigh(information)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    noise = np.random.default_rng(seed).standard_normal((root.shape[1], draws))
    stops = np.cumsum([c.shape[1] for _, c in known])
    own = [(stop - c.shape[1], stop, penalty(q, ring)) for (q, c), stop in zip(known, stops, strict=True)]
    inverses = [linalg.inv(information[a:b, a:b] + np.eye(b - a)) for a, b, _ in own]
    for begun in range(0, draws, BATCH):
        if progress is not None:
            progress("nulls", begun, draws)
        slopes = root @ noise[:, begun : begun + BATCH]
        for (start, stop, asked), inverse in zip(own, inverses, strict=True):
            pull = slopes[start:stop]
            gain = np.einsum("pd,pd->d", pull, inverse @ pull) - asked
            best[begun : begun + BATCH] = np.maximum(best[begun : begun + BATCH], gain)
    return best


def _columns(quick: Quick) -> Reals | None:
    """Slopes by its parameters, or where they were not taken what its start changes."""
    if quick.columns is not None:
        return np.asarray(quick.columns, dtype=np.float64)
    return None if quick.direction is None else np.asarray(quick.direction[:, None], dtype=np.float64)


def threshold(ring: Ring, screened: Sequence[Quick], *, seed: int = 0, progress: Progress | None = None) -> float:
    """Gain of BIC that 95 of 100 campaigns of this layout stay below if nothing is missing.

    It is a step of the journal: a diagnosis that goes on where it was does not simulate them again.
    """
    journal = current()
    kept = None if journal is None else journal.recall("nulls", seed, DRAWS)
    if kept is not None:
        return float(kept["threshold"])
    found = max(LEAST, float(np.quantile(null_gains(ring, screened, seed=seed, progress=progress), LEVEL)))
    if journal is not None:
        journal.keep({"threshold": np.array(found)})
    return found
