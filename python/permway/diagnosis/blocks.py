"""What a prediction is compared with: standardised residuals, dataset by dataset.

A block turns one dataset of a campaign into residuals of unit variance if the model is right: of the complex
frequency response by its noise, of power by its Gamma distribution, of what two channels share by their coherence.
Beside them it says how the calibration errors of measuring chains and of the irregularity would move them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.load import Dataset
from permway.campaign.predict import Request, Result
from permway.diagnosis.calibration_errors import CalibrationErrors

SURE = 0.25
"""Relative error of a response or a transfer below which it counts by its logarithm."""

FLOOR, DECIMALS = 0.003, 0.0005
"""Relative error that no record is free of: rounding, discretisation, the last decimals (0.026 dB); and that of
the last decimals alone, where a discrepancy stands for the rest."""


@dataclass(frozen=True)
class Rows:
    """Labels of a block's rows, for maps and for what is held out.

    Attributes
    ----------
    channel : ndarray of str, shape (n,)
        As "rail@16 < slab@8" or "axlebox1".
    sensor, force : ndarray of str, shape (n,)
        Of a frequency response; force is empty elsewhere.
    frequency_Hz : ndarray, shape (n,)
    scale_dB : ndarray, shape (n,)
        One standard deviation of the row, in dB of what was measured.
    """

    channel: np.ndarray
    sensor: np.ndarray
    force: np.ndarray
    frequency_Hz: Reals
    scale_dB: Reals


@dataclass(frozen=True)
class Prediction:
    """What a model predicts of one dataset, and what it was made from.

    Attributes
    ----------
    campaign : Campaign
    data : Dataset of xarray
    solved : (Request, Result), optional
        Receptances; of some kinds there are none.
    """

    campaign: Campaign
    data: xr.Dataset
    solved: tuple[Request, Result] | None


class Block(Protocol):
    """A dataset that residuals are taken of.

    Attributes
    ----------
    dataset : Dataset
    rows : Rows
    is_record : bool
        Whether it is a record itself, and not the noise of one.
    is_thinned : bool
        Whether it is taken at fewer lines where there are many.
    chained : "responses", "spectra", "passages" or None
        With which others its chains' errors, processes over frequency, are estimated; with none if all errors
        act by columns.
    pair : float
        Size of an error that each pair of sensor and point has of its own, neper; 0 without pairs.
    """

    dataset: Dataset
    rows: Rows
    is_record: ClassVar[bool] = True
    is_thinned: ClassVar[bool] = False
    chained: ClassVar[str | None] = None
    pair: float = 0.0

    @property
    def log_determinant(self) -> float:
        """Of the covariance that the residuals were whitened by, over that of their noise."""

    def residuals(self, predicted: xr.Dataset) -> Reals:
        """Standardised, shape (n,)."""

    def changed(self, predicted: xr.Dataset, change: Complexes) -> Reals | None:
        """Residuals where receptances differ from those behind a prediction; None if that takes another one.

        Parameters
        ----------
        predicted : Dataset of xarray
        change : ndarray of complex128, shape (F, rows, columns)
            Of the receptances that its request asks for, m/N.
        """
        return None

    def levels_dB(self, predicted: xr.Dataset) -> Reals:
        """Measured over predicted, no error taken out, shape (n,); NaN where a row is no level, but a phase."""

    def scatter_dB(self) -> Reals:
        """One standard deviation of every line's level, (channel, frequency)."""

    def of(self, dataset: Dataset) -> Block:
        """Another record of the same channels and lines, with the same errors."""

    @property
    def calibration(self) -> CalibrationErrors:
        """What calibration errors would do."""

    @property
    def is_usable(self) -> bool:
        """Whether any of its rows counts."""
        return True

    def bare(self) -> Block:
        """The same without errors that a discrepancy stands for, and without tails that are too light."""
        return self

    def about(self, prediction: Prediction, errors: Reals, spanned: Mapping[str, Reals]) -> Block:
        """The same weighed by what a fit predicts, and by the errors that it leaves.

        Parameters
        ----------
        prediction : Prediction
        errors : ndarray, shape (n,)
            Of chains.
        spanned : mapping of source to ndarray, shape (c,)
            Coefficients of what :meth:`spanned` has; of some sources only, where a fit is relied on.
        """
        return self

    def spanned(self, sizes: Mapping[str, float]) -> dict[str, Reals]:
        """By source, errors that no process over frequency stands for: columns of unit variance, (n, c)."""
        return self.calibration.of_unit_variance(sizes, chains=self.chained is None)


@dataclass
class Basis:
    """Cubic splines over the logarithm of frequency: a value at each knot, smooth between (Keys 1981).

    Parameters
    ----------
    low, high : float
        Ends, Hz.
    per_octave : float
        Knots per octave.
    """

    low: float
    high: float
    per_octave: float = 2.0
    knots: Reals = field(init=False)

    def __post_init__(self) -> None:
        # At a single frequency all smooth functions are one constant.
        octaves = float(np.log2(self.high / self.low))
        count = max(2, round(octaves * self.per_octave) + 1) if octaves > 0.0 else 1
        self.knots = np.linspace(np.log(self.low), np.log(self.high), count)

    def values(self, frequency_Hz: Reals) -> Reals:
        """Shape (F, knots)."""
        if self.knots.size == 1:
            return np.ones((np.size(frequency_Hz), 1))
        x = np.clip(np.log(frequency_Hz), self.knots[0], self.knots[-1])
        step, count = self.knots[1] - self.knots[0], self.knots.size
        away = np.abs((x[:, None] - self.knots[0]) / step - np.arange(-1.0, count + 1.0)[None, :])
        near = (1.5 * away - 2.5) * away**2 + 1.0
        far = ((-0.5 * away + 2.5) * away - 4.0) * away + 2.0
        whole = np.where(away < 1.0, near, np.where(away < 2.0, far, 0.0))
        values = whole[:, 1:-1].copy()
        # Beyond the ends it goes on straight.
        for end, beside, out in ((0, 1, 0), (-1, -2, -1)):
            values[:, end] += 2.0 * whole[:, out]
            values[:, beside] -= whole[:, out]
        return np.asarray(values)
