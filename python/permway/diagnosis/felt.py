"""How much an amendment changes what is predicted, beside how finely models of one kind agree with each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.campaign.compare import POWERS, VARIABLE
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Fit
from permway.diagnosis.hypothesis import Domain

FELT = 0.01
"""Change of a sensor's prediction, neper (0.09 dB), below which nothing is called missing: two discretisations of
one structure differ by a third of it, and thousands of lines make sure of much less."""

MOST_LINES = 0.9
"""Share of the lines that one stands out from."""


def moved(base: Fit, amended: Fit, domain: Domain) -> float:
    """Largest change of what a sensor is predicted to read, of all records, neper.

    Root mean square over lines, which is what discretisations differ by. None of them brings a line that turns
    with a wheel: of what excites, what the line that changes most does beyond nine tenths of all counts, too.

    Parameters
    ----------
    base, amended : Fit
    domain : str
        Of what the amended model has more.
    """
    predicted = [fit.evidence.predicted(fit.campaign).datasets for fit in (base, amended)]
    return changed(amended.evidence, predicted[0], predicted[1], domain)


def changed(
    evidence: Evidence, before: Sequence[xr.Dataset], after: Sequence[xr.Dataset], domain: Domain
) -> float:
    """The same between two predictions of all blocks."""
    size = _standing_out if domain == "irregularity" else _mean
    return max(
        (
            size(one)
            for index in evidence.records
            for one in _by_sensor(evidence.blocks[index].dataset.record.statistic, before[index], after[index])
        ),
        default=0.0,
    )


def _mean(change: Reals) -> float:
    return float(np.sqrt(np.nanmean(change**2)))


def _standing_out(change: Reals) -> float:
    change = np.abs(change)
    return max(_mean(change), float(np.nanmax(change) - np.nanquantile(change, MOST_LINES)))


def _by_sensor(statistic: str, before: xr.Dataset, after: xr.Dataset) -> list[Reals]:
    """Changes of the logarithm of every sensor's amplitudes; where nothing is predicted, none."""
    name = VARIABLE[statistic]
    with np.errstate(divide="ignore", invalid="ignore"):
        change = np.abs(np.log(after[name].values / before[name].values))
    change = np.where(np.isfinite(change), change, np.nan) * (0.5 if name in POWERS else 1.0)
    return [one for one in change.reshape(change.shape[0] if change.ndim > 1 else 1, -1) if np.isfinite(one).any()]
