"""Frequency responses compared with a prediction."""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from functools import cached_property

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign.compare import flat
from permway.campaign.load import Dataset
from permway.diagnosis.blocks import DECIMALS, FLOOR, SURE, Basis, Block, Prediction, Rows
from permway.diagnosis.calibration_errors import CalibrationErrors, ErrorSource, PairColumns, as_complex, as_parts
from permway.diagnosis.frf_lines import noise_variance, widened
from permway.diagnosis.gaussian_process import GaussianProcess

REACH = 2
"""Lines to either side over which the variance of noise is taken together."""


class FrfBlock(Block):
    """Frequency responses: complex residuals by the noise of each line, from coherence, and a floor.

    Errors of chains multiply: a residual is the logarithm of measured over predicted, in units of the measured
    response. Where noise is large the logarithm is biased, and the difference stands for it, taken about the
    errors that the other lines show: of exp(e) it is linear in e.

    Beside the noise, which is new on every line, each pair of sensor and point has a calibration error of its own:
    of the model's idealisation, of where exactly the hammer fell. It is integrated out pair by pair, once, with
    the measured response for the true one.

    Parameters
    ----------
    dataset : Dataset
    floor : float or ndarray, shape (sensors, points, 1)
        Relative error that adds to the noise of each line.
    pair : float
        Size of a pair's calibration error, neper and rad; 0 where a discrepancy stands for it.
    reference : Dataset of xarray
        A prediction, which stands for what is there where noise hides it.
    errors : ndarray of complex128, shape (sensors, points, F), optional
        Log gain and phase by which chains are expected to be off, that prediction being so; by default none.
    span : (float, float), optional
        Hz, over which chains' errors vary, where other records of the same chains reach further.
    """

    KNOTS_PER_OCTAVE = 3.0
    is_thinned = True
    chained = "responses"

    def __init__(
        self,
        dataset: Dataset,
        *,
        floor: float | Reals = FLOOR,
        pair: float = FLOOR,
        reference: xr.Dataset,
        errors: Complexes | None = None,
        span: tuple[float, float] | None = None,
    ) -> None:
        self.dataset, self.floor, self._reference = dataset, floor, reference
        self._errors = errors
        data = dataset.data
        self.measured: Complexes = data["frf"].values
        self.frequency: Reals = data["frequency"].values
        size = np.abs(self.measured)
        noise = noise_variance(data["log_variance"].values * size**2, reach=REACH)
        noise *= widened(float(data.attrs.get("averages", np.inf)), lines=2 * REACH + 1)
        self.sigma = np.sqrt(noise + (floor * size) ** 2)
        used = np.isfinite(self.measured) & np.isfinite(self.sigma) & (self.sigma > 0.0)
        # What is not used weighs nothing, and stays in its place.
        with np.errstate(divide="ignore", invalid="ignore"):
            self.weight = np.where(used, 1.0 / self.sigma, 0.0)
            decibels = np.where(used, 8.686 * self.sigma / size, np.inf)
        self._measured = np.where(used, self.measured, 0.0)
        own = np.nan_to_num(np.sqrt(data["log_variance"].values), nan=np.inf)
        off = np.zeros(1, dtype=np.complex128) if errors is None else errors
        expected = np.where(used, reference["frf"].values * np.exp(off), 0.0)
        self._gain: Complexes = np.exp(off)
        # Noise alone looks large, and sure of itself, where it happens to be both.
        seen = np.minimum(size, np.abs(expected))
        self._logarithmic = used & (np.maximum(own * size, np.sqrt(noise)) < SURE * seen)
        self._seen: Complexes = self._measured[self._logarithmic]
        self._hidden = used & ~self._logarithmic
        gains, offs = (np.broadcast_to(v, used.shape)[self._hidden] for v in (self._gain, off))
        # exp(e) is, about errors E, exp(E) (1 - E) + exp(E) e.
        self._hidden_measured = gains, self._measured[self._hidden] + expected[self._hidden] * offs
        self._chain: Complexes = reference["chain"].values[self._hidden]
        # A response that noise has made larger weighs more: so much is the weighed logarithm above zero.
        self._lifted: Reals = 2.0 * (noise[self._logarithmic] / np.abs(self._seen) ** 2)
        # Of what is mostly noise, calibration errors act on what is there.
        self._there: Complexes = np.where(self._logarithmic, self._measured, expected)
        self._span = span or (float(self.frequency[0]), float(self.frequency[-1]))
        # Errors multiply: turned by the phase of what is there they are real.
        there = np.abs(self._there)
        with np.errstate(divide="ignore", invalid="ignore"):
            self._phase: Complexes = np.where(there > 0.0, self._there / there, 1.0)
        self._relative: Reals = there * self.weight
        self._sized(pair)
        self.rows = self._labelled(decibels)

    @property
    def relative(self) -> Reals:
        """Modulus of what is there, in standard deviations of the noise, shape (sensors, points, F)."""
        return self._relative

    @property
    def phase(self) -> Complexes:
        """Of what is there, as a factor of modulus 1, shape (sensors, points, F)."""
        return self._phase

    @property
    def processes(self) -> list[tuple[list[str], int]]:
        """Names of the chains that act on the measured responses, each list with the axis that it is along."""
        data = self.dataset.data
        return [
            ([f"{kind} {name}" for name in data[kind].values.astype(str)], axis)
            for axis, kind in enumerate(("sensor", "force"))
        ]

    @property
    def is_usable(self) -> bool:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return bool((self.weight > 0.0).any())

    def _labelled(self, decibels: Reals) -> Rows:
        """Labels of the rows: all real parts, then all imaginary parts."""
        names = [self.dataset.data[key].values.astype(str) for key in ("sensor", "force")]
        sensor, force, frequency = (
            np.broadcast_to(v, self.measured.shape).reshape(-1)
            for v in (names[0][:, None, None], names[1][None, :, None], self.frequency)
        )
        label = np.char.add(np.char.add(sensor, " < "), force)
        columns = (label, sensor, force, frequency, decibels.reshape(-1))
        return Rows(*(np.tile(v, 2) for v in columns))

    def _sized(self, pair: float) -> None:
        """Take a size of the pairs' errors, and let go of what came of another."""
        self.pair = pair
        self._last: tuple[xr.Dataset, Reals] | None = None
        self._near: tuple[xr.Dataset, Complexes, Complexes, Complexes] | None = None
        for known in ("calibration", "_shrink"):
            self.__dict__.pop(known, None)

    @cached_property
    def _own_errors(self) -> tuple[Reals, Reals]:
        """Directions of the pairs' errors, orthonormal for each pair, and what one of unit size does there."""
        fine = Basis(float(self.frequency[0]), float(self.frequency[-1]), self.KNOTS_PER_OCTAVE)
        own_errors = self._relative[..., None] * fine.values(self.frequency)
        directions, singular, _ = np.linalg.svd(own_errors, full_matrices=False)
        return directions, singular

    @cached_property
    def _shrink(self) -> Reals:
        """Share of each direction that these errors explain."""
        return np.asarray(1.0 - 1.0 / np.sqrt(1.0 + (self.pair * self._own_errors[1]) ** 2))

    def with_pair(self, pair: float) -> FrfBlock:
        """The same with another size of the pairs' errors."""
        other = copy(self)
        other._sized(pair)
        return other

    def with_floor(self, floor: float | Reals) -> FrfBlock:
        """The same with another relative error, of all lines or pair by pair."""
        return self._other(floor=floor)

    def bare(self) -> FrfBlock:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return self.with_floor(DECIMALS).with_pair(0.0)

    def about(self, prediction: Prediction, errors: Reals, spanned: Mapping[str, Reals]) -> FrfBlock:
        """See :class:`permway.diagnosis.blocks.Block`."""
        count = self.measured.size
        both = errors[:count] + 1j * errors[count:]
        return self.with_reference(prediction.data, both.reshape(self.measured.shape))

    def spanned(self, sizes: Mapping[str, float]) -> dict[str, Reals]:
        """None: all are those of chains."""
        return {}

    def with_reference(self, reference: xr.Dataset, errors: Complexes) -> FrfBlock:
        """The same with another prediction, and errors of chains, where noise hides what is there."""
        return self._other(reference=reference, errors=errors)

    def scatter_dB(self) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`."""
        scale = self.rows.scale_dB
        return np.asarray(scale[: scale.size // 2].reshape(flat(self.dataset, self.dataset.data).shape))

    def of(self, dataset: Dataset) -> FrfBlock:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return FrfBlock(
            dataset,
            floor=self.floor,
            pair=self.pair,
            reference=self._reference,
            errors=self._errors,
            span=self._span,
        )

    def _other(
        self,
        *,
        floor: float | Reals | None = None,
        reference: xr.Dataset | None = None,
        errors: Complexes | None = None,
    ) -> FrfBlock:
        return FrfBlock(
            self.dataset,
            floor=self.floor if floor is None else floor,
            pair=self.pair,
            reference=self._reference if reference is None else reference,
            errors=self._errors if errors is None else errors,
            span=self._span,
        )

    @property
    def log_determinant(self) -> float:
        """Of the covariance of the pairs' errors and the noise, by that of the noise."""
        return float(2.0 * np.log1p((self.pair * self._own_errors[1]) ** 2).sum()) if self.pair else 0.0

    def white(self, values: Complexes) -> Complexes:
        """Takes out of weighted values (sensor, force, frequency) what calibration errors of pairs explain."""
        if not self.pair:
            return values
        parts = as_parts((values * self._phase.conj())[..., None])
        self._take_out(parts)
        return np.asarray(as_complex(parts)[..., 0] * self._phase)

    def _take_out(self, parts: Reals) -> None:
        """Take what errors of pairs explain out of real columns (sensor, force, frequency, k), in place."""
        if self.pair:
            directions = self._own_errors[0]
            parts -= directions @ (self._shrink[..., None] * (directions.swapaxes(-1, -2) @ parts))

    def residuals(self, predicted: xr.Dataset) -> Reals:
        """Real parts, then imaginary parts."""
        last = self._last
        if last is None or last[0] is not predicted:
            d = self.white(self.off(predicted) * self.weight).reshape(-1)
            # Another thread may keep its own meanwhile.
            self._last = last = predicted, np.concatenate([d.real, d.imag])
        return last[1]

    def changed(self, predicted: xr.Dataset, change: Complexes) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`."""
        if self._near is None or self._near[0] is not predicted:
            chain = predicted["chain"].values
            self._near = predicted, predicted["frf"].values, chain, self._undone(chain)
        _, model, chain, undone = self._near
        model = model + chain * np.moveaxis(change, 0, -1)
        d = self.white(self._off(model, undone) * self.weight).reshape(-1)
        return np.concatenate([d.real, d.imag])

    def levels_dB(self, predicted: xr.Dataset) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`; imaginary parts are phases."""
        with np.errstate(divide="ignore", invalid="ignore"):
            levels = 20.0 * np.log10(np.abs(self._measured / predicted["frf"].values)).reshape(-1)
        return np.concatenate([levels, np.full(levels.size, np.nan)])

    def off(self, predicted: xr.Dataset) -> Complexes:
        """Measured less predicted, in the response's unit, as errors that multiply have it."""
        return self._off(predicted["frf"].values, self._undone(predicted["chain"].values))

    def _undone(self, chain: Complexes) -> Complexes:
        """What hidden predictions of a chain are multiplied by."""
        return np.asarray(self._hidden_measured[0] * _straight(chain[self._hidden] / self._chain))

    def _off(self, model: Complexes, undone: Complexes) -> Complexes:
        found = np.zeros_like(self._measured)
        found[self._logarithmic] = self._seen * (self._logarithms(model) - self._lifted)
        found[self._hidden] = self._hidden_measured[1] - model[self._hidden] * undone
        return found

    def _logarithms(self, model: Complexes) -> Complexes:
        """Of measured over predicted, of the lines that count by it."""
        # A model that predicts nothing there has no logarithm: what is not finite is refused where it is used.
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = self._seen / model[self._logarithmic]
            # The logarithm by its parts: several times faster than that of complex numbers.
            return np.asarray(0.5 * np.log(_square(ratio)) + 1j * np.angle(ratio))

    def along(self, predicted: xr.Dataset) -> Complexes:
        """Direction in which a gain moves a residual; a phase moves it across."""
        there = np.where(self._logarithmic, self._measured, predicted["frf"].values * self._gain)
        return np.asarray(np.exp(1j * np.angle(there)))

    def slope(self, predicted: xr.Dataset) -> Complexes:
        """By what a change of the predicted response changes it, reversed: 1 where they agree."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.where(self._logarithmic, self._measured / predicted["frf"].values, self._gain))

    @cached_property
    def calibration(self) -> CalibrationErrors:
        """Of each sensor's chain and of the hammer's at each point: log gain and phase."""
        process = GaussianProcess(*self._span)
        # Measured is what is there times the error: residuals grow by it.
        gains = self._relative[..., None] * process.values(self.frequency)
        self._take_out(gains)
        sources = tuple(ErrorSource(name, process, 2) for names, _ in self.processes for name in names)
        return CalibrationErrors(sources, PairColumns(gains, self._phase))


def _square(values: Complexes) -> Reals:
    return np.asarray(values.real**2 + values.imag**2)


def _straight(chain: Complexes) -> Complexes:
    """By what a hidden prediction is multiplied, so that calibration errors may undo what its chain is off by.

    It is off from the reference's by exp(r), and errors by -r undo that where logarithms count. So does 1 + r
    here, and exp(r) would leave r^2 / 2: a delay whose phase calibration errors take back would be louder. What is
    farther off than errors go stays as predicted.
    """
    if np.all(chain == 1.0):
        return np.ones_like(chain)
    size = np.abs(chain)
    grown = np.log(size)
    return np.asarray(np.exp(-0.5 * (grown * np.exp(-0.5 * grown**2) + 1j * chain.imag / size) ** 2))
