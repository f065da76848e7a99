"""Noise of the sensors of a hammer test against each other, as their coherence states it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign.load import Dataset
from permway.diagnosis.blocks import Block, Rows
from permway.diagnosis.calibration_errors import CalibrationErrors, ErrorSource, PlainColumns

FEWEST = 5
"""Sensors that show how much their noise differs; with fewer none stands out from the others."""

SCATTER = 0.7
"""Of the logarithm of noise from sensor to sensor, in power, at least: a factor of 2."""

NORMAL = 1.4826
"""Standard deviations of a normal variable in its median absolute deviation."""

QUIETEST = 0.1
"""Quantile over pairs and lines that shows a sensor's noise: where little reaches it. Elsewhere the force cell's
noise, or the decimals that coherence is written with, come to more."""

ANY = 20.0
"""Of what all sensors have in common, hammer and ground: unknown."""

UNKNOWN = 1e3
"""dB: noise constrains no level."""


@dataclass(frozen=True)
class Level:
    """One coefficient, over no frequency."""

    count: int = 1

    def root(self, length: float | None) -> Reals:
        """No length binds it."""
        return np.eye(1)


class NoiseBlock(Block):
    """Logarithms of noise by sensor, in power of the response.

    What hammer and ground do, all sensors of a test have in common; what is left is each one's own. How far these
    may differ is given by the middle of the sensors, so that one that is far off stands out.

    Parameters
    ----------
    dataset : Dataset
        Frequency responses with their coherence.
    student : bool
        Whether distances are Student's, with a degree of freedom less than there are sensors, by which the scale
        is known: of five that do not differ in kind, one in sixty lies four scales off. Else they are normal.
    """

    log_determinant = 0.0
    is_record = False

    def __init__(self, dataset: Dataset, *, student: bool = False) -> None:
        self.dataset, self._student = dataset, student
        data = dataset.data
        self.names = data["sensor"].values.astype(str)
        frequency = np.asarray(data["frequency"].values, dtype=np.float64)
        level = np.array([np.quantile(one[np.isfinite(one)], QUIETEST) for one in _noise(data)])
        self.own: Reals = level - np.median(level)
        self.scatter = max(SCATTER, NORMAL * float(np.median(np.abs(self.own))))
        count = self.names.size
        self.rows = Rows(
            np.char.add("noise of ", self.names),
            self.names,
            np.full(count, ""),
            np.full(count, np.exp(np.log(frequency).mean())),
            np.full(count, UNKNOWN),
        )

    @staticmethod
    def is_constrained(dataset: Dataset) -> bool:
        """Whether a dataset has enough sensors, and their coherence."""
        if dataset.record.statistic != "frf" or dataset.data.sizes["sensor"] < FEWEST:
            return False
        return bool(np.isfinite(_noise(dataset.data)).any(axis=(1, 2)).all())

    def residuals(self, predicted: xr.Dataset) -> Reals:
        """Measured less predicted over how far sensors differ, as a normal variable of the same density has it."""
        off = np.asarray((self.own - np.log(predicted["noise_factor"].values)) / self.scatter)
        if not self._student:
            return off
        freedom = self.own.size - 1.0
        return np.asarray(np.sign(off) * np.sqrt((freedom + 1.0) * np.log1p(off**2 / freedom)))

    def changed(self, predicted: xr.Dataset, change: Complexes) -> Reals:
        """The same: receptances do not change the noise."""
        return self.residuals(predicted)

    def levels_dB(self, predicted: xr.Dataset) -> Reals:
        """None: noise constrains no level."""
        return np.full(self.own.size, np.nan)

    def scatter_dB(self) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`; noise has no level that is compared."""
        return np.zeros((0, 0))

    def of(self, dataset: Dataset) -> NoiseBlock:
        """See :class:`permway.diagnosis.blocks.Block`; how far sensors may differ, each test states itself."""
        return NoiseBlock(dataset, student=self._student)

    def bare(self) -> NoiseBlock:
        """The same, with distances that are Student's."""
        return NoiseBlock(self.dataset, student=True)

    @cached_property
    def calibration(self) -> CalibrationErrors:
        """What all sensors of the test have in common."""
        column = np.full((self.names.size, 1), ANY / self.scatter)
        source = ErrorSource(f"unrest {self.dataset.record.name}", Level(), 1, fixed=True)
        return CalibrationErrors((source,), PlainColumns(column))


def _noise(data: xr.Dataset) -> Reals:
    """Logarithm of the noise's power, (sensors, points, F); not finite where there is none, or nothing is read."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.log(data["log_variance"].values * np.abs(data["frf"].values) ** 2))
