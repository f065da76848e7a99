"""Whether records are what their labels say: whose prediction each row is most like, which way phases run.

Rows may carry another sensor's label; sensors and points may have changed places in a file whose axes carry no
names; and some programs write phases for exp(-i omega t), which reverses them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from permway.arrays import Complexes, Reals
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.observations import Observations

BETTER = 0.25
"""Share of the misfit of the labels given that other labels must come below: a model that lacks physics makes rows
unlike their predictions, and seldom like another sensor's."""

LEAST_DB = 3.0
"""Root mean square deviation, with the labels given, below which labels are not doubted."""


REVERSED = 0.6
"""Share of the phases' mean square error that reversed ones must come below."""

LEAST_RAD = 0.7
"""Root mean square error of phases below which they are not doubted."""


@dataclass(frozen=True)
class Mislabelled:
    """A record that is not what its labels say.

    Attributes
    ----------
    record : str
    words : str
        What is wrong, for people.
    channels : tuple of str
        Labels of the rows that are.
    """

    record: str
    words: str
    channels: tuple[str, ...]


def mislabelled(observations: Observations) -> Mislabelled | None:
    """The first record whose labels are wrong, by the stated values: recalibrated ones would bend towards them."""
    predicted = observations.predicted(observations.campaign).datasets
    for block, prediction in zip(observations.blocks, predicted, strict=True):
        if isinstance(block, FrfBlock):
            found = _exchanged(block, prediction["frf"].values) or _reversed(block, prediction["frf"].values)
            if found is not None:
                return found
    return None


def _exchanged(block: FrfBlock, predicted: Complexes) -> Mislabelled | None:
    """Labels of rows, or sensors and points, that have changed places."""
    names = [str(s) for s in block.dataset.data["sensor"].values]
    measured, expected, used = np.log(np.abs(block.measured)), np.log(np.abs(predicted)), block.weight > 0.0
    record = block.dataset.record.name
    cost = _costs(measured, expected, used)
    given = float(np.trace(cost))
    if 8.686 * np.sqrt(given / len(names)) < LEAST_DB:
        return None
    if measured.shape[0] == measured.shape[1] > 1:
        turned = _costs(measured.swapaxes(0, 1), expected, used.swapaxes(0, 1))
        if float(np.trace(turned)) < BETTER * given:
            words = "sensors and points have changed places: write the axes in the order frequency, sensor, point"
            return Mislabelled(record, words, tuple(names))
    rows, columns = linear_sum_assignment(cost)
    if len(names) > 1 and float(cost[rows, columns].sum()) < BETTER * given:
        pairs = [(names[i], names[j]) for i, j in zip(rows, columns, strict=True) if i != j]
        words = ", ".join(f"{label} is {sensor}" for label, sensor in pairs)
        return Mislabelled(record, f"labels of channels are mixed up: {words}", tuple(label for label, _ in pairs))
    return None


def _reversed(block: FrfBlock, predicted: Complexes) -> Mislabelled | None:
    """Phases that run the other way."""
    used = (block.weight > 0.0) & np.isfinite(predicted)
    measured, expected = block.measured[used], predicted[used]
    if not measured.size:
        return None
    given, other = (float(np.mean(np.angle(m / expected) ** 2)) for m in (measured, measured.conj()))
    if np.sqrt(given) < LEAST_RAD or other > REVERSED * given:
        return None
    words = "phases run backwards: they are of exp(-i omega t); conjugate the responses"
    return Mislabelled(
        block.dataset.record.name, words, tuple(str(s) for s in block.dataset.data["sensor"].values)
    )


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
