"""Frequency responses on as many lines as say something new."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

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
