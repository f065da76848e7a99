"""Whether channels are what their labels say: which sensor's prediction each measured row is most like."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from permway.arrays import Reals
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.fit import Fit

BETTER = 0.25
"""Share of the misfit of the labels given that other labels must come below: a model that lacks physics makes rows
unlike their predictions, and seldom like another sensor's."""

LEAST_DB = 3.0
"""Root mean square deviation, with the labels given, below which labels are not doubted."""


@dataclass(frozen=True)
class Mislabelled:
    """Rows that carry another sensor's label.

    Attributes
    ----------
    record : str
    pairs : tuple of (label, sensor)
        The label of a row, and the sensor that it is like.
    error_dB, relabelled_dB : float
        Root mean square deviation with the labels given, and with the better ones.
    """

    record: str
    pairs: tuple[tuple[str, str], ...]
    error_dB: float
    relabelled_dB: float

    @property
    def words(self) -> str:
        """For people."""
        said = ", ".join(f"{label} is {sensor}" for label, sensor in self.pairs)
        return f"labels of channels are mixed up: {said}"


def mislabelled(fit: Fit) -> Mislabelled | None:
    """The first record whose labels are wrong.

    Parameters
    ----------
    fit : Fit
        With the owner's values: a recalibration would bend them towards wrong labels.
    """
    predicted = fit.evidence.predicted(fit.evidence.campaign).datasets
    for block, prediction in zip(fit.evidence.blocks, predicted, strict=True):
        if not isinstance(block, FrfBlock) or block.measured.shape[0] < 2:
            continue
        names = [str(s) for s in block.dataset.data["sensor"].values]
        cost = _costs(np.log(np.abs(block.measured)), np.log(np.abs(prediction["frf"].values)), block.weight > 0.0)
        rows, columns = linear_sum_assignment(cost)
        given, best = float(np.trace(cost)), float(cost[rows, columns].sum())
        decibels = 8.686 * np.sqrt(np.array([given, best]) / len(names))
        if best < BETTER * given and decibels[0] > LEAST_DB:
            pairs = tuple((names[i], names[j]) for i, j in zip(rows, columns, strict=True) if i != j)
            return Mislabelled(block.dataset.record.name, pairs, float(decibels[0]), float(decibels[1]))
    return None


def _costs(measured: Reals, predicted: Reals, used: np.ndarray) -> Reals:
    """Mean square difference of logarithms between every measured and every predicted row."""
    count = measured.shape[0]
    found = np.empty((count, count))
    for i in range(count):
        mine = used[i] & np.isfinite(measured[i])
        for j in range(count):
            there = mine & np.isfinite(predicted[j])
            found[i, j] = float(np.mean((measured[i] - predicted[j])[there] ** 2)) if there.any() else 0.0
    return found
