"""A record beside its prediction: levels and phases of what was read, line by line, and how surely known."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from permway.arrays import Complexes, Reals
from permway.campaign.dataset import level_averages
from permway.campaign.load import Dataset
from permway.checking.change import Change, Ratio

SUREST, LEAST_SURE = 1e-4, 0.25
"""Variance of a line's logarithm that is taken at least, and beyond which the line is left out: noise of a quarter
lifts its level by more than 1 dB."""

PER_OCTAVE = 1.0
"""Independent lines in an octave, at most: a model that lacks something is wrong over whole resonances. Half of it
halves all odds."""


@dataclass(frozen=True)
class Compared:
    """One record as rows of numbers: pairs of a frequency response; of spectra channels, and pairs of channels.

    A row belongs to one or two members: channels, and after them force points. Its level is the sum of its
    members' levels, its phase the sum or difference of theirs, and so a change of a member acts on it.

    Attributes
    ----------
    channels, points : tuple of str
        Names of sensors and of force points.
    frequency_Hz : ndarray, shape (F,)
    first, second : ndarray of int, shape (rows,)
        Members; `second` is -1 where there is one only.
    side : ndarray, shape (rows,)
        What a phase of the second member counts: 1 for a response, -1 for a cross spectrum.
    measured, predicted : ndarray of complex128, shape (rows, F)
    variance : ndarray, shape (rows, F)
        Of the logarithm and of the phase, by noise; infinite where a line states nothing.
    levelled, phased : ndarray of bool, shape (rows,)
        Whether a row has a level, and a phase, of its own.
    share : float
        What a row counts: rows that share members say little new.
    common : float
        Standard deviation of a level common to all rows that nobody knows, neper.
    slope : float
        The same of its change over an octave.
    """

    channels: tuple[str, ...]
    points: tuple[str, ...]
    frequency_Hz: Reals
    first: NDArray[np.int64]
    second: NDArray[np.int64]
    side: Reals
    measured: Complexes
    predicted: Complexes
    variance: Reals
    levelled: NDArray[np.bool_]
    phased: NDArray[np.bool_]
    share: float
    common: float
    slope: float

    @property
    def weight(self) -> Reals:
        """What each line counts, shape (F,): its part of an octave, and never more than one."""
        return line_weight(self.frequency_Hz) * PER_OCTAVE * self.share

    @property
    def used(self) -> NDArray[np.bool_]:
        """Lines that say something, shape (rows, F)."""
        return np.isfinite(self.variance)

    def touched(self, change: Change) -> NDArray[np.bool_]:
        """Rows that a change acts on."""
        if change.whole or change.conjugate or change.reading:
            return np.ones(self.first.size, dtype=bool)
        members = [*change.ratios, *(change.swapped or ()), *change.exchanged]
        return np.asarray(np.isin(self.first, members) | np.isin(self.second, members))

    def changed(self, change: Change) -> Compared:
        """What was read, put right if the change was made."""
        measured = self.measured
        if change.reading == "decibels":
            measured = _from_levels(np.abs(measured), change.reference) * np.exp(1j * np.angle(measured))
        if change.reading == "radians":
            measured = np.abs(measured) * np.exp(1j * np.angle(measured) * 180.0 / np.pi)
        if change.conjugate:
            measured = measured.conj()
        if change.exchanged:
            # im + i re is i times the conjugate.
            rows = np.isin(self.first, change.exchanged)
            measured = np.where(rows[:, None], 1j * measured.conj(), measured)
        found = replace(self, measured=measured)
        if change.swapped is not None:
            found = found._swapped(*change.swapped)
        if change.ratios:
            factor = np.ones_like(self.measured)
            for member, ratio in change.ratios.items():
                of = _factor(ratio, self.frequency_Hz)
                factor[self.first == member] *= of
                mine = self.second == member
                factor[mine] *= np.where(self.side[mine, None] > 0.0, of, of.conj())
            found = replace(found, measured=found.measured * factor)
        return found

    def log_jacobian(self, change: Change) -> float:
        """Of the changed logarithms and phases by those read: only what bends them has one."""
        if change.reading == "radians":
            return float(np.sum(self.weight * self.used[self.phased])) * float(np.log(180.0 / np.pi))
        if change.reading == "decibels":
            with np.errstate(divide="ignore"):
                each = np.log(np.abs(self.measured) * np.log(10.0) / 20.0)
            return float(np.sum((self.weight * each)[self.used]))
        return 0.0

    def _swapped(self, one: int, other: int) -> Compared:
        """Two members in each other's place."""
        swap = {one: other, other: one}
        at = {
            (int(a), int(b)): (row, False) for row, (a, b) in enumerate(zip(self.first, self.second, strict=True))
        }
        at |= {(b, a): (row, True) for (a, b), (row, _) in list(at.items()) if b >= 0 and (b, a) not in at}
        measured, variance = self.measured.copy(), self.variance.copy()
        for row, (a, b) in enumerate(zip(self.first.tolist(), self.second.tolist(), strict=True)):
            source, turned = at[(swap.get(a, a), swap.get(b, b))]
            measured[row] = self.measured[source].conj() if turned else self.measured[source]
            variance[row] = self.variance[source]
        return replace(self, measured=measured, variance=variance)


def line_weight(frequency_Hz: Reals) -> Reals:
    """Octaves that each line stands for, at most one, shape (F,)."""
    if frequency_Hz.size < 2:
        return np.ones(frequency_Hz.size)
    at = np.log2(frequency_Hz)
    edges = np.concatenate([[at[0]], 0.5 * (at[1:] + at[:-1]), [at[-1]]])
    return np.minimum(np.diff(edges), 1.0)


def compared(dataset: Dataset, predicted: xr.Dataset, common: tuple[float, float]) -> Compared:
    """A record as rows beside its prediction.

    Parameters
    ----------
    dataset : Dataset
        Of statistic "frf", "csd", "psd" or "transmissibility".
    predicted : xarray.Dataset
        As :func:`permway.campaign.predict.predict` gives it.
    common : (float, float)
        Standard deviations of a level that nobody knows, neper, and of its slope, neper an octave.
    """
    match dataset.record.statistic:
        case "frf":
            return _of_responses(dataset, predicted, common)
        case "csd" | "psd":
            return _of_spectra(dataset, predicted, common)
    names = tuple(dataset.names("channel"))
    values, model = dataset.data["transmissibility"].values, predicted["transmissibility"].values
    rows = np.arange(len(names))
    return _made(names, (), dataset.frequency_Hz, rows, np.full(rows.size, -1), values, model, 0.0, common)


def _of_responses(dataset: Dataset, predicted: xr.Dataset, common: tuple[float, float]) -> Compared:
    sensors, points = tuple(dataset.names("sensor")), tuple(dataset.names("force"))
    first = np.repeat(np.arange(len(sensors)), len(points))
    second = len(sensors) + np.tile(np.arange(len(points)), len(sensors))
    shape = (first.size, dataset.frequency_Hz.size)
    values, model = (data["frf"].values.reshape(shape) for data in (dataset.data, predicted))
    variance = dataset.data["log_variance"].values.reshape(shape)
    return _made(sensors, points, dataset.frequency_Hz, first, second, values, model, variance, common)


def _of_spectra(dataset: Dataset, predicted: xr.Dataset, common: tuple[float, float]) -> Compared:
    names = tuple(dataset.names("channel"))
    count = len(names)
    alone, (one, other) = np.arange(count), np.triu_indices(count, 1)
    worth = level_averages(dataset.data)
    csd, model = (np.asarray(data["csd"].values, dtype=np.complex128) for data in (dataset.data, predicted))
    first, second = np.concatenate([alone, one]), np.concatenate([np.full(count, -1), other])
    at = np.concatenate([alone, other])
    averages = np.minimum(worth[first], worth[at])[:, None]
    # A level is of an amplitude, and a power is the square of one.
    power = np.sqrt(np.abs(np.einsum("ccf->cf", csd))), np.sqrt(np.abs(np.einsum("ccf->cf", model)))
    values, expected = csd[first, at], model[first, at]
    values[:count], expected[:count] = power
    reported = np.minimum(_coherence(csd), _coherence(model))[first, at]
    with np.errstate(divide="ignore"):
        variance = (1.0 - reported) / (2.0 * averages * reported)
    variance[:count] = 0.25 / worth[:, None]
    # Below what no coherence gives by chance a phase states nothing.
    variance[reported < 4.0 / averages] = np.inf
    made = _made(names, (), dataset.frequency_Hz, first, second, values, expected, variance, common)
    alone_rows = np.arange(first.size) < count
    return replace(made, levelled=alone_rows, phased=~alone_rows, side=-np.ones(first.size))


def _coherence(csd: Complexes) -> Reals:
    power = np.einsum("ccf->cf", csd).real
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.abs(csd) ** 2 / (power[:, None] * power[None, :])
    return np.asarray(np.clip(np.nan_to_num(found), 0.0, 1.0 - 1e-9))


def _made(
    channels: tuple[str, ...],
    points: tuple[str, ...],
    frequency_Hz: Reals,
    first: NDArray[np.int64],
    second: NDArray[np.int64],
    measured: Complexes,
    predicted: Complexes,
    variance: Reals | float,
    common: tuple[float, float],
) -> Compared:
    known = np.maximum(np.broadcast_to(variance, measured.shape), SUREST)
    reported = (
        np.isfinite(measured) & np.isfinite(predicted) & (np.abs(measured) > 0.0) & (np.abs(predicted) > 0.0)
    )
    rows = first.size
    return Compared(
        channels,
        points,
        frequency_Hz,
        first,
        second,
        np.ones(rows),
        np.where(reported, measured, 1.0),
        np.where(reported, predicted, 1.0),
        np.where(reported & (known <= LEAST_SURE), known, np.inf),
        np.ones(rows, dtype=bool),
        np.ones(rows, dtype=bool),
        share=(len(channels) + max(len(points), 1) - 1) / rows,
        common=common[0],
        slope=common[1],
    )


def _factor(ratio: Ratio, frequency_Hz: Reals) -> Complexes:
    omega: Complexes = 2j * np.pi * np.asarray(frequency_Hz, dtype=np.complex128)
    return np.asarray(ratio.size * omega**ratio.order)


def _from_levels(levels_dB: Reals, reference: float) -> Reals:
    return np.asarray(reference * 10.0 ** (np.minimum(levels_dB, 600.0) / 20.0))
