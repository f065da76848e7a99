"""Lines of a frequency response: as many as say something new, and the noise that their coherence states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.campaign.load import Dataset

LINES_PER_FREQUENCY = 40.0
"""Lines of a frequency response within its own frequency, at most."""


def thinned(dataset: Dataset, lines: float = LINES_PER_FREQUENCY) -> Dataset:
    """Frequency responses on lines no closer than 1/lines of their frequency.

    What lies closer says nothing new of a structure with loss factors above that; of others the record says how
    many lines it takes (`lines_per_frequency`).
    """
    if dataset.record.statistic != "frf":
        return dataset
    frequency = dataset.data["frequency"].values
    many = (dataset.record.lines_per_frequency or LINES_PER_FREQUENCY) * lines / LINES_PER_FREQUENCY
    kept, last = [], -np.inf
    for index, value in enumerate(frequency):
        if value - last >= value / many * (1.0 - 1e-9):
            kept.append(index)
            last = value
    return replace(dataset, data=dataset.data.isel(frequency=kept))


def widened(averages: float, lines: int) -> float:
    """By what a variance of noise is too small that comes from the coherence of the same blows.

    One blow of K goes into the response itself; and few blows scatter, of which `lines` are taken together.
    """
    if not np.isfinite(averages) or averages <= 1.0:
        return 1.0
    freedom = lines * (averages - 1.0)
    return averages / (averages - 1.0) * (freedom / (freedom - 1.0) if freedom > 1.0 else 1.0)


def noise_variance(raw: Reals, reach: int) -> Reals:
    """Smoothed over neighbouring lines, so that a line's weight does not follow its own error.

    Parameters
    ----------
    raw : ndarray, shape (..., F)
        Variance of real and of imaginary part, line by line; NaN where it is not known.
    """
    kernel = np.ones(2 * reach + 1)

    def line(values: Reals) -> Reals:
        there = np.isfinite(values)
        # By hand what "same" would give: that is as long as the kernel where there are fewer lines.
        middle = slice(reach, reach + values.size)
        total = np.convolve(np.where(there, values, 0.0), kernel)[middle]
        count = np.convolve(there.astype(float), kernel)[middle]
        with np.errstate(invalid="ignore"):
            return np.asarray(np.where(there, total / count, np.nan))

    return np.apply_along_axis(line, -1, raw)
