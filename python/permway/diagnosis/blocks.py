"""What a prediction is held against: standardised deviations, dataset by dataset.

A block turns one dataset of a campaign into deviations of unit variance if the model is right: of the complex
frequency response by its noise, of power by its Gamma distribution, of what two channels share by their coherence.
Beside them it says how the smooth errors of measuring chains and of the irregularity would move them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
import xarray as xr
from scipy import sparse

from permway.arrays import Complexes, Reals
from permway.recordings.campaign_load import Dataset

FLOOR = 0.003
"""Relative error that no record is free of: rounding, discretisation, the last decimals (0.026 dB)."""


@dataclass(frozen=True)
class Smooth:
    """How smooth errors move the deviations of a block.

    Attributes
    ----------
    origins : tuple of str
        Of every column, as "sensor rail@16" or "irregularity".
    columns : sparse matrix, shape (rows, coefficients)
        Deviations per coefficient, each of unit size a smooth error of 1 neper (amplitude) or rad.
    """

    origins: tuple[str, ...]
    columns: sparse.csr_array


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


class Block(Protocol):
    """A dataset that deviations are taken of."""

    dataset: Dataset
    rows: Rows

    @property
    def log_determinant(self) -> float:
        """Of the covariance that the deviations were whitened by, over that of their noise."""

    def deviations(self, predicted: xr.Dataset) -> Reals:
        """Standardised, shape (n,)."""

    @property
    def smooth(self) -> list[Smooth]:
        """What smooth errors would do."""


@dataclass
class Basis:
    """Cubic splines over the logarithm of frequency: a value at each knot, smooth between (Keys 1981).

    A smooth error that wanders over an octave is followed to half a percent of its size by two knots per octave;
    by straight lines to five.

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
        octaves = max(np.log2(self.high / self.low), 1e-6)
        count = max(2, round(octaves * self.per_octave) + 1)
        self.knots = np.linspace(np.log(self.low), np.log(self.high), count)

    def values(self, frequency_Hz: Reals) -> Reals:
        """Shape (F, knots)."""
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


SURE = 0.25
"""Relative error of a response or a transfer below which it counts by its logarithm."""


class FrfBlock:
    """Frequency responses: complex deviations by the noise of each line, from coherence, and a floor.

    Errors of chains multiply: a deviation is the logarithm of measured over predicted, in units of the measured
    response. Where noise is large the logarithm is biased, and the difference stands for it.

    Beside the noise, which is new on every line, each pair of sensor and point has a smooth error of its own: of
    the model's idealisation, of where exactly the hammer fell. It is integrated out pair by pair, once, with the
    measured response for the true one.

    Parameters
    ----------
    dataset : Dataset
    floor : float
        Relative error that adds to the noise of each line.
    pair : float
        Size of a pair's smooth error, neper and rad.
    reference : Dataset of xarray
        A prediction, which stands for what is there where noise hides it.
    """

    KNOTS_PER_OCTAVE = 3.0

    def __init__(
        self,
        dataset: Dataset,
        *,
        floor: float = FLOOR,
        pair: float = FLOOR,
        reference: xr.Dataset,
    ) -> None:
        self.dataset, self.floor, self.pair, self._reference = dataset, floor, pair, reference
        data = dataset.data
        self.measured: Complexes = data["frf"].values
        self.frequency: Reals = data["frequency"].values
        size = np.abs(self.measured)
        # The coherence comes from the same blows: its scatter widens what it says of them.
        averages = float(data.attrs.get("averages", np.inf))
        widened = averages / (averages - 2.0) if np.isfinite(averages) and averages > 2.5 else 1.0
        noise = _noise_variance(widened * data["log_variance"].values * size**2, reach=2)
        self.sigma = np.sqrt(noise + (floor * size) ** 2)
        used = np.isfinite(self.measured) & np.isfinite(self.sigma) & (self.sigma > 0.0)
        # What is not used weighs nothing, and stays in its place.
        with np.errstate(divide="ignore", invalid="ignore"):
            self.weight = np.where(used, 1.0 / self.sigma, 0.0)
            decibels = np.where(used, 8.686 * self.sigma / size, np.inf)
        self._measured = np.where(used, self.measured, 0.0)
        own = np.nan_to_num(np.sqrt(data["log_variance"].values), nan=np.inf)
        expected = np.where(used, reference["frf"].values, 0.0)
        # Noise alone looks large, and sure of itself, where it happens to be both.
        seen = np.minimum(size, np.abs(expected))
        self._logarithmic = used & (np.maximum(own * size, self.sigma) < SURE * seen)
        # Of what is mostly noise, smooth errors act on what is there.
        self._there: Complexes = np.where(self._logarithmic, self._measured, expected)
        self._basis = Basis(float(self.frequency[0]), float(self.frequency[-1]))
        fine = Basis(float(self.frequency[0]), float(self.frequency[-1]), self.KNOTS_PER_OCTAVE)
        errors = (self._there * self.weight)[..., None] * fine.values(self.frequency)
        self._directions, singular, _ = np.linalg.svd(errors, full_matrices=False)
        self._across = np.ascontiguousarray(self._directions.conj().swapaxes(-1, -2))
        self._singular = singular
        self._last: tuple[xr.Dataset, Reals] | None = None
        self._shrink = 1.0 - 1.0 / np.sqrt(1.0 + (pair * singular) ** 2)
        names = [data["sensor"].values.astype(str), data["force"].values.astype(str)]
        sensor, force, frequency = (
            np.broadcast_to(v, self.measured.shape).reshape(-1)
            for v in (names[0][:, None, None], names[1][None, :, None], self.frequency)
        )
        label = np.char.add(np.char.add(sensor, " < "), force)
        columns = (label, sensor, force, frequency, decibels.reshape(-1))
        self.rows = Rows(*(np.tile(v, 2) for v in columns))

    def with_pair(self, pair: float) -> FrfBlock:
        """The same with another size of the pairs' errors."""
        return self._other(pair=pair)

    def with_floor(self, floor: float) -> FrfBlock:
        """The same with another relative error."""
        return self._other(floor=floor)

    def with_reference(self, reference: xr.Dataset) -> FrfBlock:
        """The same with another prediction where noise hides what is there."""
        return self._other(reference=reference)

    def _other(
        self, *, floor: float | None = None, pair: float | None = None, reference: xr.Dataset | None = None
    ) -> FrfBlock:
        return FrfBlock(
            self.dataset,
            floor=self.floor if floor is None else floor,
            pair=self.pair if pair is None else pair,
            reference=self._reference if reference is None else reference,
        )

    @property
    def log_determinant(self) -> float:
        """Of the covariance of the pairs' errors and the noise, by that of the noise."""
        return float(2.0 * np.log1p((self.pair * self._singular) ** 2).sum())

    def white(self, values: Complexes) -> Complexes:
        """Takes out of weighted values (sensor, force, frequency) what the pairs' smooth errors would explain."""
        within = self._across @ values[..., None]
        return np.asarray(values - (self._directions @ (self._shrink[..., None] * within))[..., 0])

    def deviations(self, predicted: xr.Dataset) -> Reals:
        """Real parts, then imaginary parts."""
        if self._last is None or self._last[0] is not predicted:
            d = self.white(self.off(predicted) * self.weight).reshape(-1)
            self._last = predicted, np.concatenate([d.real, d.imag])
        return self._last[1]

    def off(self, predicted: xr.Dataset) -> Complexes:
        """Measured less predicted, in the response's unit, as errors that multiply have it."""
        model = predicted["frf"].values
        with np.errstate(divide="ignore", invalid="ignore"):
            multiplied = self._measured * np.log(self._measured / model)
        return np.asarray(np.where(self._logarithmic, multiplied, self._measured - model))

    def slope(self, predicted: xr.Dataset) -> Complexes:
        """By what a change of the predicted response changes it, reversed: 1 where they agree."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.where(self._logarithmic, self._measured / predicted["frf"].values, 1.0))

    def learnt_pair(self, predicted: xr.Dataset) -> float:
        """The size of the pairs' errors after one step of expectation maximisation."""
        d = self.off(predicted) * self.weight
        within = (self._across @ d[..., None])[..., 0]
        variance = (self.pair * self._singular) ** 2
        share = variance / (1.0 + variance)
        # Coefficients along the directions, in units of their size: posterior mean and variance.
        mean = share * within / np.maximum(self.pair * self._singular, 1e-300)
        power = 0.5 * np.abs(mean) ** 2 + 1.0 / (1.0 + variance)
        return float(self.pair * np.sqrt(power[variance > 0.0].mean()))

    @cached_property
    def smooth(self) -> list[Smooth]:
        """Of each sensor's chain and of the hammer's at each point: log gain and phase."""
        basis = self._basis.values(self.frequency)
        sensors, points = (self.dataset.data[kind].values.astype(str) for kind in ("sensor", "force"))
        spread = self._there * self.weight
        white = np.stack([self.white(spread * column) for column in basis.T], axis=-1)
        # A smooth gain moves a response along itself, a smooth phase across.
        gain = np.concatenate([white.real, white.imag]).reshape(-1, basis.shape[1])
        phase = np.concatenate([-white.imag, white.real]).reshape(-1, basis.shape[1])
        # Measured is what is there times the error: deviations grow by it.
        values = np.hstack([gain, phase])
        width, rows = values.shape[1], np.arange(values.shape[0])
        pair = (rows // self.frequency.size) % (sensors.size * points.size)
        first = np.stack([pair // points.size, sensors.size + pair % points.size], axis=1) * width
        where = (first[:, :, None] + np.arange(width)).reshape(-1)
        whole = sparse.csr_array(
            (np.hstack([values, values]).reshape(-1), where, np.arange(0, where.size + 1, 2 * width)),
            shape=(rows.size, width * (sensors.size + points.size)),
        )
        origins = [f"sensor {name}" for name in sensors] + [f"force {name}" for name in points]
        return [Smooth(tuple(np.repeat(origins, width)), whole)]


def _noise_variance(raw: Reals, reach: int = 4) -> Reals:
    """Smoothed over neighbouring lines, so that a line's weight does not follow its own error.

    Parameters
    ----------
    raw : ndarray, shape (..., F)
        Variance of real and of imaginary part, line by line; NaN where it is not known.
    """
    kernel = np.ones(2 * reach + 1)

    def line(values: Reals) -> Reals:
        there = np.isfinite(values)
        total = np.convolve(np.where(there, values, 0.0), kernel, "same")
        count = np.convolve(there.astype(float), kernel, "same")
        with np.errstate(invalid="ignore"):
            return np.asarray(np.where(there, total / count, np.nan))

    return np.apply_along_axis(line, -1, raw)


LEAST_LINES = 20
"""Of a part, from which its scatter is learnt."""


class SpectraBlock:
    """Cross spectra of a run: power of one channel, and every other channel by what it shares with another.

    The complex Wishart density of all channels falls into factors (Goodman 1963): one channel's power is Gamma,
    the transfer from it to a second is normal given that power, and what remains of the second's power is Gamma
    again. Each channel hangs on the one that it is most coherent with: a tree, which leaves out what a channel
    shares with more than one other.

    Parameters
    ----------
    dataset : Dataset
    expected : Dataset of xarray
        The prediction by which the tree is chosen and transfers are weighed.
    floor : float
        Relative error of transfers that adds to their scatter.
    scatter : sequence of float, optional
        Of each part, by how much its lines scatter more than so many averages of a stationary record would: the
        level of a track changes from place to place.
    """

    LEAST_COHERENCE = 0.1
    MOST_COHERENCE = 0.98

    def __init__(
        self, dataset: Dataset, expected: xr.Dataset, *, floor: float = 0.01, scatter: Sequence[float] = ()
    ) -> None:
        self.dataset, self._expected, self._floor = dataset, expected, floor
        data = dataset.data
        # Neighbouring lines under Hann's window say half the same.
        self._lines = np.arange(0, data.sizes["frequency"], 2)
        self.frequency: Reals = data["frequency"].values[self._lines]
        self.measured: Complexes = data["csd"].values[:, :, self._lines]
        self.averages = float(data.attrs["averages"])
        names = data["channel"].values.astype(str)
        coherence = _coherence(expected["csd"].values[:, :, self._lines])
        self.root, self.tree = _tree(np.nanmean(coherence, axis=-1))
        labels, frequency, scale, kind = [], [], [], []
        self._parts: list[tuple[str, int, int, np.ndarray, Reals]] = []
        self.log_determinant = 0.0
        single = 1.0 / np.sqrt(self.averages)
        everywhere = np.arange(self.frequency.size)

        def add(what: str, channel: int, other: int, at: np.ndarray, sigma: Reals) -> None:
            copies = 2 if what == "transfer" else 1
            more = scatter[len(self._parts)] if scatter else 1.0
            sigma = more * sigma
            self._parts.append((what, channel, other, at, sigma))
            self.log_determinant += 2.0 * copies * at.size * float(np.log(more))
            text = names[channel] if what == "power" else f"{names[channel]} {what} {names[other]}"
            for _ in range(copies):
                labels.extend([text] * at.size)
                kind.extend([names[channel]] * at.size)
                frequency.append(self.frequency[at])
                scale.append((8.686 if what == "transfer" else 4.343) * sigma)

        add("power", self.root, self.root, everywhere, np.full(everywhere.size, single))
        for child, parent in self.tree:
            g2 = np.clip(coherence[child, parent], 1e-6, 1.0 - 1e-9)
            at = np.flatnonzero(g2 >= self.LEAST_COHERENCE)
            relative = np.sqrt((1.0 - g2[at]) / (2.0 * self.averages * g2[at]) + floor**2)
            add("transfer", child, parent, at, relative)
            at = np.flatnonzero(g2 <= self.MOST_COHERENCE)
            add("rest", child, parent, at, np.full(at.size, single))
        text = np.array(labels, dtype=str)
        self.rows = Rows(
            text,
            np.array(kind, dtype=str),
            np.full(text.size, ""),
            np.concatenate(frequency),
            np.concatenate(scale),
        )
        self._basis = Basis(float(self.frequency[0]), float(self.frequency[-1]))

    def deviations(self, predicted: xr.Dataset) -> Reals:
        """Part by part, transfers as real then imaginary."""
        model = predicted["csd"].values[:, :, self._lines]
        found = []
        for what, c, o, at, sigma in self._parts:
            if what == "power":
                power = (self.measured[c, c, at] / model[c, c, at]).real
                found.append(np.log(np.maximum(power, 1e-12)) / sigma)
            elif what == "transfer":
                measured = self.measured[c, o, at] / self.measured[o, o, at].real
                expected = model[c, o, at] / model[o, o, at].real
                ratio = measured / expected
                # Gains multiply; where noise is large, their logarithm is biased, and smooth errors are nothing.
                off = np.where(sigma < SURE, np.log(ratio), ratio - 1.0)
                found.extend([off.real / sigma, off.imag / sigma])
            else:
                rest = _remainder(self.measured, c, o, at) / _remainder(model, c, o, at)
                found.append(np.log(np.maximum(rest, 1e-12)) / sigma)
        return np.concatenate(found)

    def scattered(self, predicted: xr.Dataset) -> SpectraBlock:
        """The same with the scatter of each part learnt from how its lines differ from their neighbours."""
        plain = SpectraBlock(self.dataset, self._expected, floor=self._floor)
        deviations, scatter, start = plain.deviations(predicted), [], 0
        for what, _, _, at, _ in plain._parts:
            size = (2 if what == "transfer" else 1) * at.size
            # The second half of a transfer is its imaginary part: one difference of all is none of neighbours.
            steps = np.diff(deviations[start : start + size])
            typical = 1.4826 / np.sqrt(2.0) * float(np.median(np.abs(steps))) if size > LEAST_LINES else 1.0
            scatter.append(max(1.0, typical))
            start += size
        return SpectraBlock(self.dataset, self._expected, floor=self._floor, scatter=scatter)

    @cached_property
    def smooth(self) -> list[Smooth]:
        """Of each channel's chain, log gain and phase, and of the irregularity's level."""
        names = self.dataset.data["channel"].values.astype(str)
        speed = self.dataset.condition.speed_m_per_s
        found = []
        for channel, name in enumerate(names):
            gains, phases = [], []
            for what, c, o, at, sigma in self._parts:
                basis = self._basis.values(self.frequency[at]) / sigma[:, None]
                sign = float(c == channel) - float(o == channel and what == "transfer")
                zero = np.zeros_like(basis)
                if what == "transfer":
                    gains.extend([-sign * basis, zero])
                    phases.extend([zero, -sign * basis])
                else:
                    gains.append(-2.0 * float(c == channel) * basis)
                    phases.append(zero)
            columns = sparse.csr_array(np.hstack([np.vstack(gains), np.vstack(phases)]))
            found.append(Smooth((f"channel {name}",) * columns.shape[1], columns))
        if speed is not None:
            # The same track under every speed: knots over wavenumber, two per octave.
            wavenumber = IRREGULARITY_KNOTS
            level = []
            for what, _, _, at, sigma in self._parts:
                basis = wavenumber.values(self.frequency[at] / speed) / sigma[:, None]
                level.extend([-basis] if what != "transfer" else [np.zeros_like(basis)] * 2)
            found.append(Smooth(("irregularity",) * wavenumber.knots.size, sparse.csr_array(np.vstack(level))))
        return found


IRREGULARITY_KNOTS = Basis(0.005, 20.0, per_octave=1.0)
"""Over cycles per metre."""


def _coherence(csd: Complexes) -> Reals:
    power = np.einsum("ccf->cf", csd).real
    return np.asarray(np.abs(csd) ** 2 / (power[:, None] * power[None, :]))


def _remainder(csd: Complexes, c: int, o: int, at: np.ndarray) -> Reals:
    """Power of c that o does not share, and a thousandth of all of it: no record is clean below."""
    own = csd[c, c, at].real
    return np.asarray(own - np.abs(csd[c, o, at]) ** 2 / csd[o, o, at].real + 1e-3 * own)


def _tree(coherence: Reals) -> tuple[int, list[tuple[int, int]]]:
    """A root and (child, parent) pairs, most coherent first (Prim); the root is the first channel."""
    inside, tree = [0], []
    while len(inside) < coherence.shape[0]:
        outside = [c for c in range(coherence.shape[0]) if c not in inside]
        child, parent = max(((c, p) for c in outside for p in inside), key=lambda pair: coherence[pair])
        tree.append((child, parent))
        inside.append(child)
    return 0, tree
