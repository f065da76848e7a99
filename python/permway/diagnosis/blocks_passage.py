"""Residuals of passages: complex spectra over their noise and a floor, with errors of chains and drifts beside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import xarray as xr
from scipy.ndimage import uniform_filter1d

from permway.arrays import Complexes, Reals
from permway.campaign.compare import NEPER_DB
from permway.campaign.load import Dataset
from permway.campaign.passage import spectrum_of
from permway.campaign.predict import by_unevenness
from permway.campaign.predictions.passage import PROFILE, Scatter, with_profile
from permway.diagnosis.blocks import DECIMALS, FLOOR, Block, Prediction, Rows
from permway.diagnosis.calibration_errors import CalibrationErrors, ErrorSource, PlainColumns
from permway.diagnosis.gaussian_process import GaussianProcess

ABOUT = 9
"""Lines whose mean square is the size about a line: axles make lobes, and between them nothing is exact either."""

LOW = 0.3
"""Share of that size below which a line says no level."""

DRIFT = 10.0
"""Standard deviation of offset and drift over a record, in its root mean square: any."""

UNEVENNESS = "unevenness"
"""First word of the source of what unevenness does, whose level a posterior estimates."""


@dataclass(frozen=True)
class Apart:
    """So many coefficients that nothing binds: a gain; offset, slope and bend of a record over time."""

    count: int

    def root(self, length: float | None) -> Reals:
        """No length binds them."""
        return np.eye(self.count)


class PassageBlock(Block):
    """Measured less predicted spectra, real parts, then imaginary parts.

    Errors of chains multiply: a log gain that is the same at all frequencies, and log gain and phase that are
    smooth over them, whose size a diagnosis estimates. They act on what is predicted, for of what was measured
    noise is a part, and a gain would explain it. A drift is no physics: three polynomials of time, of any size,
    are integrated out. So is what unevenness does, by the sum of some profiles with normal coefficients: the
    record's lines have that covariance. It depends on where axles are, and so on parameters. So the profile that a
    fit finds most probable is a part of predictions, and what it did where the covariance was taken is given back.
    Each record counts as of an unevenness of its own.

    Parameters
    ----------
    dataset : Dataset
        Of statistic "passage".
    reference : Dataset of xarray
        A prediction, which errors of chains act on.
    scatter : Scatter, optional
        By unevenness; by default none.
    floor : float
        Relative error beside the noise of each line.
    span : (float, float), optional
        Hz, over which chains' errors vary, where other passages reach further.
    """

    log_determinant = 0.0
    chained = "passages"

    def __init__(
        self,
        dataset: Dataset,
        *,
        reference: xr.Dataset,
        scatter: Scatter | None = None,
        floor: float = FLOOR,
        span: tuple[float, float] | None = None,
    ) -> None:
        self.dataset, self.floor, self._span = dataset, floor, span
        self._reference: Complexes = reference["spectrum"].values
        data = dataset.data
        self.measured: Complexes = data["spectrum"].values
        self._scatter = scatter
        known = None if scatter is None or PROFILE not in data else scatter.known
        self._known: Complexes = np.zeros_like(self.measured) if known is None else known
        self.frequency: Reals = data["frequency"].values
        self.names = data["channel"].values.astype(str)
        power = np.abs(self.measured) ** 2
        self.size: Reals = np.sqrt(uniform_filter1d(power, ABOUT, axis=-1, mode="nearest"))
        self.sigma: Reals = np.sqrt(data["noise_sd"].values ** 2 + (floor * self.size) ** 2)
        label, at = np.broadcast_arrays(self.names[:, None], self.frequency)
        scale = NEPER_DB * self.sigma / self.size
        columns = (label, label, np.full(label.shape, ""), at, scale)
        self.rows = Rows(*(np.tile(v.reshape(-1), 2) for v in columns))

    @property
    def relative(self) -> Reals:
        """What an error of 1 neper does to each line, in standard deviations, (channel, frequency)."""
        return np.asarray(np.abs(self._reference) / self.sigma)

    @property
    def phase(self) -> Complexes:
        """Of the reference, as a number of modulus 1, (channel, frequency)."""
        return np.asarray(np.exp(1j * np.angle(self._reference)))

    @property
    def processes(self) -> list[tuple[list[str], int]]:
        """Names of the chains that act on the spectra, with the axis that they are along."""
        return [([f"channel {name}" for name in self.names], 0)]

    def residuals(self, predicted: xr.Dataset) -> Reals:
        """Measured less predicted but for a profile's part as it was known, in standard deviations."""
        return _parts((self.measured + self._known - predicted["spectrum"].values) / self.sigma)

    def levels_dB(self, predicted: xr.Dataset) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`; between lobes of the spectrum there is no level."""
        with np.errstate(divide="ignore"):
            levels = NEPER_DB * np.log(np.abs(self.measured) / np.abs(predicted["spectrum"].values))
        levels = np.where(np.abs(self.measured) > LOW * self.size, levels, np.nan).reshape(-1)
        return np.concatenate([levels, np.full(levels.size, np.nan)])

    def scatter_dB(self) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`; with what unevenness does."""
        by_unevenness = 0.5 * np.sum(np.abs(self._spectra) ** 2, axis=-1)
        return np.asarray(NEPER_DB * np.sqrt(self.sigma**2 + by_unevenness) / self.size)

    def of(self, dataset: Dataset) -> PassageBlock:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return self._as(dataset, self._reference)

    def about(self, prediction: Prediction, errors: Reals, spanned: Mapping[str, Reals]) -> PassageBlock:
        """The same with a fit's prediction, which errors of chains then act on, and its profile of unevenness."""
        dataset, scatter, spectrum = self.dataset, self._scatter, prediction.data["spectrum"].values
        if scatter is None or prediction.solved is None:
            return self._as(dataset, spectrum)
        if self._uneven in spanned:
            data = with_profile(dataset.data, scatter.waves, spanned[self._uneven])
            dataset = replace(dataset, data=data)
        return self._as(dataset, spectrum, scatter=by_unevenness(prediction.campaign, dataset, *prediction.solved))

    @property
    def _uneven(self) -> str:
        """The source of what unevenness does."""
        return f"{UNEVENNESS} of {self.dataset.record.name}"

    @property
    def _spectra(self) -> Complexes:
        """By each profile of the unevenness, (channel, frequency, profiles)."""
        return np.zeros((*self.measured.shape, 0)) if self._scatter is None else self._scatter.spectra

    def bare(self) -> PassageBlock:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return self._as(self.dataset, self._reference, floor=DECIMALS)

    def _as(
        self,
        dataset: Dataset,
        spectrum: Complexes,
        *,
        floor: float | None = None,
        scatter: Scatter | None = None,
    ) -> PassageBlock:
        reference = dataset.data[["spectrum"]].copy(data={"spectrum": spectrum})
        floor, scatter = self.floor if floor is None else floor, scatter or self._scatter
        return PassageBlock(dataset, reference=reference, scatter=scatter, floor=floor, span=self._span)

    @cached_property
    def calibration(self) -> CalibrationErrors:
        """Of every channel its chain, and its drift in this record; and unevenness."""
        process = GaussianProcess(*(self._span or (float(self.frequency[0]), float(self.frequency[-1]))))
        values = process.values(self.frequency)
        drift = _drifts(self.dataset.data)
        sources: list[ErrorSource] = []
        columns: list[Reals] = []
        for index, name in enumerate(self.names):
            read = (self._reference[index] / self.sigma[index])[:, None]
            gain = read * values
            size = DRIFT * float(np.sqrt(np.mean(np.abs(self.measured[index]) ** 2)))
            moved = size * drift / self.sigma[index][:, None]
            sources += [
                ErrorSource(f"gain {name}", Apart(1), 1, chain=False),
                ErrorSource(f"channel {name}", process, 2),
                ErrorSource(f"drift of {self.dataset.record.name}: {name}", Apart(3), 1, chain=False, fixed=True),
            ]
            for column in np.hstack([read, gain, 1j * gain, moved]).T:
                whole = np.zeros(self.measured.shape, dtype=np.complex128)
                whole[index] = column
                columns.append(_parts(whole))
        if count := self._spectra.shape[-1]:
            sources.append(ErrorSource(self._uneven, Apart(count), 1, chain=False, fixed=True))
            columns.extend(_parts(one / self.sigma) for one in np.moveaxis(self._spectra, -1, 0))
        return CalibrationErrors(tuple(sources), PlainColumns(np.stack(columns, axis=1)))


def _parts(values: Complexes) -> Reals:
    flat = values.reshape(-1)
    return np.concatenate([flat.real, flat.imag])


def _drifts(data: xr.Dataset) -> Complexes:
    """Spectra of offset, slope and bend as the record shows them, each of root mean square 1, (frequency, 3)."""
    samples, rate = int(data.attrs["samples"]), float(data.attrs["sampling_Hz"])
    time = np.linspace(-1.0, 1.0, samples)
    lines = spectrum_of(np.stack([np.ones(samples), time, time**2]), rate)
    number = np.round(data["frequency"].values * samples / rate).astype(np.int64)
    found = lines[:, number].T
    return np.asarray(found / np.sqrt(np.mean(np.abs(found) ** 2, axis=0)))
