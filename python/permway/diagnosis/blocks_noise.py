"""Noise of the sensors of a hammer test against each other, as their coherence tells it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr
from scipy import sparse

from permway.arrays import Reals
from permway.diagnosis.blocks import Rows
from permway.diagnosis.smooth import Origin, Smooth, SparseColumns
from permway.recordings.campaign_load import Dataset

FEWEST = 5
"""Sensors that tell how much their noise differs; with fewer none is told from the others."""

SCATTER = 0.7
"""Of the logarithm of noise from sensor to sensor, in power, at least: a factor of 2."""

NORMAL = 1.4826
"""Standard deviations of a normal variable in its median absolute deviation."""

BAND_SCATTER = 0.2
"""Of that logarithm from band to band, at least."""

ANY = 20.0
"""Of what all sensors have in common, hammer and ground: unknown."""

UNKNOWN = 1e3
"""dB: no level is told by noise."""


@dataclass(frozen=True)
class Levels:
    """Independent coefficients, one for each level."""

    count: int

    def root(self, length: float | None) -> Reals:
        """No length binds them."""
        return np.eye(self.count)


class NoiseBlock:
    """Logarithms of noise by sensor and octave, in power of the response.

    What hammer and ground do, all sensors of a test have in common; what is left is each one's own, alike in all
    bands. How far these may differ is told by the middle of the sensors, so that one that is far off stands out.

    Parameters
    ----------
    dataset : Dataset
        Frequency responses with their coherence.
    """

    log_determinant = 0.0

    def __init__(self, dataset: Dataset) -> None:
        self.dataset = dataset
        data = dataset.data
        sensors = data["sensor"].values.astype(str)
        frequency = np.asarray(data["frequency"].values, dtype=np.float64)
        octave = np.floor(np.log2(frequency / frequency[0]) + 1e-9).astype(int)
        with np.errstate(divide="ignore", invalid="ignore"):
            noise = np.log(data["log_variance"].values * np.abs(data["frf"].values) ** 2)
        noise = np.where(np.isfinite(noise), noise, np.nan)
        self._octave = octave
        self.bands = np.array([np.exp(np.log(frequency[octave == o]).mean()) for o in np.unique(octave)])
        # By sensor and band.
        level = np.array([[_mean(one[:, octave == o]) for o in np.unique(octave)] for one in noise])
        common = np.nanmedian(level, axis=0)
        own = np.nanmedian(level - common, axis=1)
        self.scatter = max(SCATTER, NORMAL * float(np.median(np.abs(own - np.median(own)))))
        left = level - common - own[:, None]
        self.sigma = max(BAND_SCATTER, NORMAL * float(np.nanmedian(np.abs(left))))
        known = np.isfinite(level)
        self._sensor, self._band = np.nonzero(known)
        self._level = (level - common)[known]
        self.names = sensors
        mine = sensors[self._sensor]
        self.rows = Rows(
            np.char.add("noise of ", mine),
            mine,
            np.full(mine.size, ""),
            self.bands[self._band],
            np.full(mine.size, UNKNOWN),
        )

    def held(self, lines: np.ndarray) -> np.ndarray:
        """Rows most of whose lines are marked, (n,), from marks of (sensors, points, F)."""
        bands = np.unique(self._octave)
        share = np.array([[one[:, self._octave == o].mean() for o in bands] for one in lines])
        return np.asarray(share[self._sensor, self._band] > 0.5)

    @staticmethod
    def tells(dataset: Dataset) -> bool:
        """Whether a dataset has enough sensors, and their coherence."""
        data = dataset.data
        if dataset.record.statistic != "frf" or data.sizes["sensor"] < FEWEST:
            return False
        variance = data["log_variance"].values
        return bool((np.isfinite(variance) & (variance > 0.0)).any(axis=(1, 2)).all())

    def own(self) -> Reals:
        """How much noisier each sensor is than the middle one, logarithm of power, (sensors,)."""
        each = np.array([self._level[self._sensor == s].mean() for s in range(self.names.size)])
        return np.asarray(each - np.median(each))

    def deviations(self, predicted: xr.Dataset) -> Reals:
        """Measured less predicted over the scatter from band to band."""
        expected = np.log(predicted["noise_factor"].values)
        return np.asarray((self._level - expected[self._sensor]) / self.sigma)

    def of(self, dataset: Dataset) -> NoiseBlock:
        """See :class:`permway.diagnosis.blocks.Block`; how far sensors may differ, each test tells itself."""
        return NoiseBlock(dataset)

    @cached_property
    def smooth(self) -> Smooth:
        """One level of each sensor, in all tests the same, and what all have in common, band by band."""
        count, bands = self.names.size, self.bands.size
        row = np.arange(self._sensor.size)
        shape = (row.size, count + bands)
        each = sparse.coo_array((np.full(row.size, self.scatter / self.sigma), (row, self._sensor)), shape=shape)
        common = sparse.coo_array((np.full(row.size, ANY / self.sigma), (row, count + self._band)), shape=shape)
        origins = [Origin(f"noise {name}", Levels(1), 1, fixed=True) for name in self.names]
        origins.append(Origin(f"unrest {self.dataset.record.name}", Levels(bands), 1, fixed=True))
        return Smooth(tuple(origins), SparseColumns(sparse.csr_array(each + common)))


def _mean(values: Reals) -> float:
    there = values[np.isfinite(values)]
    return float(there.mean()) if there.size else float("nan")
