"""Residuals of tables of modes: logarithms of frequency and damping over their standard deviations."""

from __future__ import annotations

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.campaign.compare import NEPER_DB
from permway.campaign.load import Dataset
from permway.campaign.predictions.modes import FARTHEST, LIGHTEST
from permway.diagnosis.blocks import Block, Rows
from permway.diagnosis.calibration_errors import CalibrationErrors, PlainColumns
from permway.errors import InputError

MISSED = (float(np.log(FARTHEST)), 0.0)
"""Neper, of frequency and of damping: what a mode counts as that the model does not have, whatever its sign."""


class ModesBlock(Block):
    """Natural frequencies, then the damping ratios that are stated.

    A mode that the model lacks counts as off by as much as the farthest that would be matched to it: finite, so
    that an amendment which brings the mode gains by it.

    Parameters
    ----------
    dataset : Dataset
        Of statistic "modes".
    predicted : Dataset of xarray
        By the nominal model.

    Raises
    ------
    InputError
        If the model has no damping where the record states it.
    """

    log_determinant = 0.0

    def __init__(self, dataset: Dataset, predicted: xr.Dataset | None = None) -> None:
        self.dataset = dataset
        data = dataset.data
        self.measured: Reals = data["modes"].values
        self._stated = np.isfinite(self.measured)
        sigma = np.where(self._stated, data["relative_sd"].values, np.nan)
        self.sigma: Reals = sigma[self._stated]
        if predicted is not None:
            self._check_damped(predicted["modes"].values)
        quantity = data["quantity"].values.astype(str)[:, None]
        frequency = np.asarray(data["frequency"].values, dtype=np.float64)
        label, at = (np.broadcast_to(v, self._stated.shape)[self._stated] for v in (quantity, frequency))
        self.rows = Rows(label, label, np.full(label.size, ""), at, NEPER_DB * self.sigma)

    def _check_damped(self, predicted: Reals) -> None:
        undamped = self._stated[1] & (predicted[1] < LIGHTEST)
        if undamped.any():
            hertz = float(self.measured[0][undamped][0])
            raise InputError(
                f"the model's mode near {hertz:g} Hz has no damping, and the record states it",
                where=f"records.{self.dataset.record.name}",
                value=float(self.measured[1][undamped][0]),
                remedy="give bodies or laws of the model a loss_factor, or leave the damping of the mode empty",
            )

    def residuals(self, predicted: xr.Dataset) -> Reals:
        """Logarithms of measured over predicted, in standard deviations."""
        return np.asarray(self._logarithms(predicted) / self.sigma)

    def levels_dB(self, predicted: xr.Dataset) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return np.asarray(NEPER_DB * self._logarithms(predicted))

    def _logarithms(self, predicted: xr.Dataset) -> Reals:
        values = predicted["modes"].values
        floor = np.array([[0.0], [LIGHTEST]])
        off = np.log(self.measured / np.maximum(values, floor))
        missed = np.isnan(values[0])
        for row, size in enumerate(MISSED):
            off[row, missed] = size
        return np.asarray(off[self._stated])

    def scatter_dB(self) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return np.asarray(NEPER_DB * self.dataset.data["relative_sd"].values)

    def of(self, dataset: Dataset) -> ModesBlock:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return ModesBlock(dataset)

    @property
    def calibration(self) -> CalibrationErrors:
        """None: what is listed has its own standard deviation."""
        return CalibrationErrors((), PlainColumns(np.zeros((self.sigma.size, 0))))


def missed_modes(record: xr.Dataset) -> list[str]:
    """Of a record's curves, in words, the modes that a model has not; none of other records.

    Parameters
    ----------
    record : Dataset of xarray
        From :func:`permway.campaign.compare.curves`.
    """
    if record.attrs["statistic"] != "modes":
        return []
    return [
        f"{record.attrs['record']}: the {model} model has no mode within a factor of {FARTHEST:g} of "
        f"{float(hertz):g} Hz that these sensors see and no other listed mode is"
        for model in record["model"].values.astype(str)
        for hertz, value in zip(
            record["frequency"].values, record["predicted"].sel(model=model).values[0], strict=True
        )
        if np.isnan(value)
    ]
