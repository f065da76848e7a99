"""What an effect may leave for how it was idealised: a share of its gain in the records that tell of another."""

from __future__ import annotations

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Fit

SLIP = 0.03
"""Share of an effect's gain that its idealisation may leave for another to take up."""


def gain_by_record(before: Fit, after: Fit) -> Reals:
    """By how much each record's part of the quadratic form is lower after, both with the sizes of errors of after.

    Parameters
    ----------
    before, after : Fit
        Of the same records.

    Returns
    -------
    ndarray, shape (blocks,)
    """
    evidence = after.evidence
    return _by_record(evidence, _deviations(evidence, before)) - _by_record(evidence, _deviations(evidence, after))


def slip(first: Reals, further: Reals) -> float:
    """Gain that a further effect must exceed to be no mending of the first.

    Held against what the first gained in the records that tell of the further one: a large effect in hammer tests
    says nothing of a small one in the runs.

    Parameters
    ----------
    first, further : ndarray, shape (blocks,)
        Gains by record.
    """
    told = np.clip(further, 0.0, None)
    if not told.any():
        return SLIP * float(np.clip(first, 0.0, None).sum())
    return SLIP * float(told @ np.clip(first, 0.0, None) / told.sum())


def _deviations(evidence: Evidence, fit: Fit) -> Reals:
    return evidence.deviations(evidence.predicted(fit.campaign).datasets)


def _by_record(evidence: Evidence, deviations: Reals) -> Reals:
    """The quadratic form's parts: deviations times what smooth errors leave of them."""
    whitener = evidence.whitener
    left = deviations - whitener.smooth(whitener.explained(deviations), deviations.size)
    found = np.bincount(evidence.block_of, weights=deviations * left, minlength=len(evidence.blocks))
    return np.asarray(found, dtype=np.float64)
