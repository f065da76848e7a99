"""What an effect may leave for how it was idealised: a share of its gain in each record and octave."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Fit

SLIP = 0.03
"""Share of an effect's gain that its idealisation may leave for another to take up."""

MOST = 0.8
"""Share of another's gain from which it is no more than that."""

EXACT = frozenset({"sensor_delay", "sensor_gain", "sensor_polarity", "speed_error"})
"""Effects that are numbers of the recording, of which nothing is idealised."""

LOWEST_HZ = 0.5


def gain_by_cell(before: Fit, after: Fit, channels: Collection[str] = ()) -> Reals:
    """By how much the quadratic form is lower after, by record and octave, both with the sizes of errors of after.

    Parameters
    ----------
    before, after : Fit
        Of the same records.
    channels : collection of str
        Only what these read; by default all.

    Returns
    -------
    ndarray, shape (blocks, octaves)
    """
    evidence = after.evidence
    kept = np.ones(evidence.block_of.size)
    if channels:
        kept[~np.isin(evidence.rows.sensor, list(channels))] = 0.0
    less, more = (_by_cell(evidence, _deviations(evidence, fit), kept) for fit in (after, before))
    return more - less


def mended(first: Reals, further: Reals, *, one_place: bool = False) -> float:
    """Share of a further effect's gain that may be how the first was idealised, 0 to 1.

    Held against what the first gained in the records and octaves that tell of the further one: a large effect in
    hammer tests says nothing of a small one in the runs, and a stiffness at low frequencies nothing of a resonance
    at high ones. At one place octaves do not tell them apart: a law that is not quite right is so in all of them.

    Parameters
    ----------
    first, further : ndarray, shape (blocks, octaves)
        Gains.
    one_place : bool
        Whether both are at one joint, body or channel.
    """
    if one_place:
        first, further = (gain.sum(axis=1) for gain in (first, further))
    told = np.clip(further, 0.0, None)
    if not told.any():
        return 1.0
    return float(np.minimum(told, SLIP * np.clip(first, 0.0, None)).sum() / told.sum())


def _deviations(evidence: Evidence, fit: Fit) -> Reals:
    return evidence.deviations(evidence.predicted(fit.campaign).datasets)


def _by_cell(evidence: Evidence, deviations: Reals, kept: Reals) -> Reals:
    """The quadratic form's parts: deviations times what smooth errors leave of them."""
    whitener = evidence.whitener
    left = deviations - whitener.smooth(whitener.explained(deviations), deviations.size)
    octave = np.round(np.log2(np.maximum(evidence.rows.frequency_Hz, LOWEST_HZ) / LOWEST_HZ)).astype(int)
    octaves = int(octave.max(initial=0)) + 1
    cells = evidence.block_of * octaves + octave
    found = np.bincount(cells, weights=kept * deviations * left, minlength=len(evidence.blocks) * octaves)
    return np.asarray(found, dtype=np.float64).reshape(-1, octaves)
