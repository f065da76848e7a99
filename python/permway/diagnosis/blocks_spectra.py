"""Cross spectra of a run compared with a prediction."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np
import xarray as xr
from scipy.special import polygamma

from permway.arrays import Complexes, Reals
from permway.campaign.compare import POWER_DB, flat
from permway.campaign.dataset import level_averages
from permway.campaign.load import Dataset
from permway.campaign.predict import added_to, away_from_lines
from permway.diagnosis.blocks import SURE, Block, Prediction, Rows
from permway.diagnosis.calibration_errors import CalibrationErrors, ErrorSource, PlainColumns
from permway.diagnosis.gaussian_process import GaussianProcess
from permway.diagnosis.spectra_errors import Moved, at_most
from permway.diagnosis.spectra_parts import Joined, Part, coherence, joined, remainder, transfer, tree_of
from permway.errors import InputError

FIRST_LINE = 4
"""From zero, from which lines are used: Hann's window reaches over four: nearer ones hold what is beyond zero."""

TORN = 0.08
"""Of a channel's power, at the first line from zero, what calibration errors of 1.5 dB and as many neper of phase
tear from what it shares with another: they differ within the window. At further lines less by their square."""

FEWEST = 3.0
"""Averages of a run."""


UNSHARED = 0.05
"""Neper: what channels of a run do not share is more or less than predicted, on all lines alike. What the window
and uneven transfers tear apart comes to that: in six runs with nothing missing it was 0.05 more."""


class SpectraBlock(Block):
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
    added : ndarray, shape (channels, channels, F)
        Expected cross spectra of noise and hum, which gains do not act on.
    away : ndarray of complex128, shape (channels, channels, F), optional
        Expected cross spectra times the distance from the line, which errors that grow from line to line act on;
        see :func:`permway.campaign.predict.away_from_lines`. By default they act on nothing.
    floor : float
        Relative error of transfers that adds to their scatter.
    span : (float, float), optional
        Hz, over which chains' errors vary, where other records of the same channels reach further.
    """

    log_determinant = 0.0
    chained = "spectra"
    LEAST_COHERENCE = 0.1
    MOST_COHERENCE = 0.98

    def __init__(
        self,
        dataset: Dataset,
        expected: xr.Dataset,
        *,
        floor: float = 0.01,
        added: Reals,
        away: Complexes | None = None,
        span: tuple[float, float] | None = None,
    ) -> None:
        self.dataset, self._expected, self._floor, self._added = dataset, expected, floor, added
        self._away: Complexes = np.zeros(added.shape, dtype=np.complex128) if away is None else away
        data = dataset.data
        self._lines = _used_lines(dataset)
        self.frequency: Reals = data["frequency"].values[self._lines]
        self.measured: Complexes = data["csd"].values[:, :, self._lines]
        self.averages = _averages(dataset)
        # Of a level that leaps no channel is worth less than the least that a record is taken with.
        self._varied = np.maximum(level_averages(dataset.data), FEWEST)
        whole = expected["csd"].values[:, :, self._lines]
        coherent = coherence(whole)
        self.root, self.tree = tree_of(np.nanmean(coherent, axis=-1))
        self._parts: list[Part] = list(self._factors(coherent, whole))
        self.rows = self._rows()
        self._span = span or (float(self.frequency[0]), float(self.frequency[-1]))

    def _factors(self, coherent: Reals, whole: Complexes) -> Iterator[Part]:
        """The factors of the density: the root's power, then transfer and remainder of every other channel."""
        everywhere, segment_s = np.arange(self.frequency.size), self.dataset.record.segment_s
        self._worth: list[Reals] = [self._worth_of(self.root, whole[self.root, self.root].real)]
        yield "power", self.root, self.root, everywhere, np.sqrt(polygamma(1, self._worth[0]))
        for child, parent in self.tree:
            g2 = np.clip(coherent[child, parent], 1e-6, 1.0 - 1e-9)
            remaining = whole[child, child].real * (1.0 - g2)
            # One average less when another's share is taken off.
            worth = self._worth_of(child, remaining) - 1.0
            at = np.flatnonzero(g2 >= self.LEAST_COHERENCE)
            relative = np.sqrt((1.0 - g2[at]) / (2.0 * worth[at] * g2[at]) + self._floor**2)
            self._worth.append(worth[at])
            yield "transfer", child, parent, at, relative
            at = np.flatnonzero(g2 <= self.MOST_COHERENCE)
            torn = TORN / (self.frequency[at] * segment_s) ** 2 / (1.0 - g2[at])
            self._worth.append(worth[at])
            yield "rest", child, parent, at, np.hypot(np.sqrt(polygamma(1, worth[at])), torn)

    def _worth_of(self, channel: int, power: Reals) -> Reals:
        """Averages that a channel's power, or part of it, is worth at each line.

        Its level varies along the track, but for noise; variances of the parts add.
        """
        quiet = np.clip(self._added[channel, channel, self._lines].real / np.maximum(power, 1e-300), 0.0, 1.0)
        steady = 1.0 / self.averages
        return np.asarray(1.0 / (steady + (1.0 - quiet) ** 2 * (1.0 / self._varied[channel] - steady)))

    def _rows(self) -> Rows:
        """What the residuals are of; transfers have two for each line."""
        names = self.dataset.data["channel"].values.astype(str)
        labels, kind, frequency, scale = [], [], [], []
        for what, channel, other, at, sigma in self._parts:
            text = names[channel] if what == "power" else f"{names[channel]} {what} {names[other]}"
            for _ in range(2 if what == "transfer" else 1):
                labels.extend([text] * at.size)
                kind.extend([names[channel]] * at.size)
                frequency.append(self.frequency[at])
                scale.append((8.686 if what == "transfer" else 4.343) * sigma)
        return Rows(
            np.array(labels, dtype=str),
            np.array(kind, dtype=str),
            np.full(len(labels), ""),
            np.concatenate(frequency),
            np.concatenate(scale),
        )

    def residuals(self, predicted: xr.Dataset) -> Reals:
        """Part by part, transfers as real then imaginary."""
        model, lines, found = predicted.variables["csd"].values, self._lines, np.empty(self.rows.channel.size)
        own, on, off = (self._joined[kind] for kind in ("power", "transfer", "rest"))
        power = (self.measured[own.c, own.c, own.at] / model[own.c, own.c, lines[own.at]]).real
        found[own.row] = (np.log(np.maximum(power, 1e-12)) - own.bias) / own.sigma
        measured, predicted_so = self._measured_transfers, transfer(model, on.c, on.o, lines[on.at])
        # Gains multiply; where noise is large, their logarithm is biased, and it scatters as was expected:
        # a model that says more does not scatter more.
        away = (measured - predicted_so) / self._expected_transfers
        np.log(measured / predicted_so, out=away, where=on.sigma < SURE)
        found[on.row], found[on.imaginary] = away.real / on.sigma, away.imag / on.sigma
        left = off.worth / (off.worth + 1.0)
        rest = self._measured_rest / remainder(model, off.c, off.o, lines[off.at], left)
        found[off.row] = (np.log(np.maximum(rest, 1e-12)) - off.bias) / off.sigma
        return found

    @cached_property
    def _joined(self) -> dict[str, Joined]:
        return {kind: joined(self._parts, self._worth, kind) for kind in ("power", "transfer", "rest")}

    @cached_property
    def _measured_transfers(self) -> Complexes:
        on = self._joined["transfer"]
        return transfer(self.measured, on.c, on.o, on.at)

    @cached_property
    def _expected_transfers(self) -> Complexes:
        """By which those are weighed that are not sure."""
        on = self._joined["transfer"]
        return transfer(self._expected["csd"].values, on.c, on.o, self._lines[on.at])

    @cached_property
    def _measured_rest(self) -> Reals:
        off = self._joined["rest"]
        return remainder(self.measured, off.c, off.o, off.at)

    @property
    def unshared(self) -> Reals:
        """What a neper more of all that channels do not share does to the residuals, (n,)."""
        found = []
        for what, _, _, at, sigma in self._parts:
            found.extend([np.zeros(at.size)] * (1 + (what == "transfer")))
            if what == "rest":
                found[-1] = 1.0 / sigma
        return np.concatenate(found)

    def levels_dB(self, predicted: xr.Dataset) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`; imaginary parts of transfers are phases."""
        parts = []
        for what, _, _, at, _ in self._parts:
            parts.append(np.ones(at.size))
            if what == "transfer":
                parts.append(np.full(at.size, np.nan))
        return np.asarray(self.residuals(predicted) * self.rows.scale_dB * np.concatenate(parts))

    def about(self, prediction: Prediction, errors: Reals, spanned: Mapping[str, Reals]) -> SpectraBlock:
        """See :class:`permway.diagnosis.blocks.Block`."""
        if prediction.solved is None:
            return self
        added = added_to(prediction.campaign, self.dataset)
        away = away_from_lines(prediction.campaign, self.dataset, *prediction.solved)
        expected = prediction.data
        return SpectraBlock(self.dataset, expected, added=added, away=away, floor=self._floor, span=self._span)

    def spanned(self, sizes: Mapping[str, float]) -> dict[str, Reals]:
        """See :class:`permway.diagnosis.blocks.Block`; what channels do not share has an error of its own."""
        apart = {f"unshared {self.dataset.record.name}": UNSHARED * self.unshared[:, None]}
        if self.dataset.condition.speed_m_per_s is None:
            return apart
        return {"irregularity": sizes["irregularity"] * self._level(), **apart}

    def _level(self) -> Reals:
        """Of the irregularity, under every speed of the same track: of a power, half as much in every channel."""
        speed = self.dataset.condition.speed_m_per_s
        assert speed is not None
        half = np.full(self.dataset.data["channel"].size, 0.5, dtype=np.complex128)
        step = 1.0 / (self.dataset.record.segment_s * speed)
        return self.moved.columns(half, LEVEL, self.frequency / speed, step)

    def scatter_dB(self) -> Reals:
        """See :class:`permway.diagnosis.blocks.Block`; that of a power's estimate."""
        scatter = POWER_DB / np.sqrt(self._varied)
        return np.broadcast_to(scatter[:, None], flat(self.dataset, self.dataset.data).shape)

    def of(self, dataset: Dataset) -> SpectraBlock:
        """See :class:`permway.diagnosis.blocks.Block`."""
        return SpectraBlock(
            dataset,
            self._expected,
            added=self._added,
            away=self._away,
            floor=self._floor,
            span=self._span,
        )

    @property
    def moved(self) -> Moved:
        """What errors of chains and of the level act on."""
        model = self._expected["csd"].values[:, :, self._lines]
        added = at_most(self._added[:, :, self._lines], model)
        return Moved(tuple(self._parts), model, added, self._away[:, :, self._lines])

    @cached_property
    def calibration(self) -> CalibrationErrors:
        """Of each channel's chain, log gain and phase, and of the irregularity's level."""
        names = self.dataset.data["channel"].values.astype(str)
        step_Hz = 1.0 / self.dataset.record.segment_s
        moved, process, each = self.moved, GaussianProcess(*self._span), np.eye(names.size, dtype=np.complex128)
        sources = [ErrorSource(f"channel {name}", process, 2) for name in names]
        columns = [
            moved.columns(part * one, process, self.frequency, step_Hz) for one in each for part in (1.0, 1j)
        ]
        if self.dataset.condition.speed_m_per_s is not None:
            sources.append(ErrorSource("irregularity", LEVEL, 1, chain=False))
            columns.append(self._level())
        return CalibrationErrors(tuple(sources), PlainColumns(np.hstack(columns)))


LEVEL = GaussianProcess(0.005, 20.0, shortest=0.7)
"""Of the irregularity, over cycles per metre."""


def _used_lines(dataset: Dataset) -> np.ndarray:
    """Every second line from `FIRST_LINE` on: under Hann's window neighbours share half of their information."""
    known_Hz, segment_s = dataset.data["frequency"].values, dataset.record.segment_s
    lines = np.flatnonzero(known_Hz * segment_s >= FIRST_LINE - 1e-9)
    if lines.size == 0:
        raise InputError(
            f"has no line that is {FIRST_LINE} lines from zero: nearer ones hold what is beyond zero",
            where=dataset.record.name,
            value=f"up to {known_Hz.max():g} Hz, segments of {segment_s:g} s",
            remedy="give a longer segment_s, or a wider band_Hz",
        )
    return lines[::2]


def _averages(dataset: Dataset) -> float:
    """Those of the record, refused if they are fewer than `FEWEST`."""
    averages = float(dataset.data.attrs["averages"])
    if averages < FEWEST:
        raise InputError(
            f"has fewer than {FEWEST:g} averages, by which no spectrum is known",
            where=dataset.record.name,
            value=round(averages, 2),
            remedy="give a longer record, or a shorter segment_s",
        )
    return averages
