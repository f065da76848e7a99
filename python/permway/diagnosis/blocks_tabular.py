"""Residuals of records that are tables: decay rates, swept sines, moduli."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.campaign.compare import flat
from permway.campaign.load import Dataset
from permway.diagnosis.blocks import Block, Rows
from permway.diagnosis.calibration_errors import CalibrationErrors, ErrorSource, PlainColumns
from permway.diagnosis.gaussian_process import GaussianProcess

SCATTER_DB = {"decay_rate": 1.0, "transmissibility": 0.3, "modulus": 0.5}
"""One standard deviation of a value, where the record says none: 10 lg of a decay rate, 20 lg of the others."""


class TableBlock(Block):
    """Values of a table, each with the same scatter in its logarithm.

    Parameters
    ----------
    dataset : Dataset
        Of "decay", "transmissibility" or "material".
    scatter_dB : float, optional
        By default :data:`SCATTER_DB`.
    span : (float, float), optional
        Hz, over which errors vary, where other records reach further.
    """

    log_determinant = 0.0

    def __init__(
        self, dataset: Dataset, *, scatter_dB: float | None = None, span: tuple[float, float] | None = None
    ) -> None:
        self.dataset, self._scatter, self._span = dataset, scatter_dB, span
        data = dataset.data
        self.name = next(name for name in SCATTER_DB if name in data)
        self.measured = data[self.name].values
        scatter = SCATTER_DB[self.name] if scatter_dB is None else scatter_dB
        self.complex = np.iscomplexobj(self.measured)
        self.sigma = scatter / (8.686 if self.complex else 4.343)
        frequency = np.asarray(data["band" if "band" in data.dims else "frequency"].values, dtype=np.float64)
        channels = (
            data["channel"].values.astype(str) if "channel" in data.dims else np.array([dataset.record.name])
        )
        count = 2 if self.complex else 1
        self.frequency = np.broadcast_to(frequency, (channels.size, frequency.size)).reshape(-1)
        label = np.repeat(channels, frequency.size)
        text = np.tile(label, count)
        self.rows = Rows(
            text, text, np.full(text.size, ""), np.tile(self.frequency, count), np.full(text.size, scatter)
        )

    def residuals(self, predicted: xr.Dataset) -> Reals:
        """Logarithms of measured over predicted; of complex values modulus, then phase."""
        ratio = np.log((self.measured / predicted[self.name].values).reshape(-1)) / self.sigma
        return np.concatenate([ratio.real, ratio.imag]) if self.complex else np.asarray(ratio)

    def levels_dB(self, predicted: xr.Dataset) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`."""
        found = self.residuals(predicted) * self.rows.scale_dB
        if self.complex:
            found[found.size // 2 :] = np.nan
        return np.asarray(found)

    def scatter_dB(self) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return np.full(flat(self.dataset, self.dataset.data).shape, float(self.rows.scale_dB[0]))

    def of(self, dataset: Dataset) -> TableBlock:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return TableBlock(dataset, scatter_dB=self._scatter, span=self._span)

    @cached_property
    def calibration(self) -> CalibrationErrors:
        """Of the rig, or of the method: a calibration error of the logarithm.

        What a model misses of the decay along one section, it misses at every visit.
        """
        process = GaussianProcess(*(self._span or (float(self.frequency.min()), float(self.frequency.max()))))
        values = process.values(self.frequency) / self.sigma
        zero = np.zeros_like(values)
        matrix = np.block([[values, zero], [zero, values]]) if self.complex else values
        source = ErrorSource(f"record {self.dataset.record.name}", process, 2 if self.complex else 1)
        if self.name != "decay_rate":
            return CalibrationErrors((source,), PlainColumns(matrix))
        section = ErrorSource("decay of the section", process, 1)
        return CalibrationErrors((source, section), PlainColumns(np.hstack([matrix, matrix])))
