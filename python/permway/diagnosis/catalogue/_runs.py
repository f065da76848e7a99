"""What the runs of a campaign hold beyond the base: lines, and the sensors that fit worst."""

from __future__ import annotations

import warnings
import weakref
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from permway.arrays import Reals
from permway.campaign.dataset import level_averages
from permway.campaign.parts import Condition
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.diagnosis.fit import Fit
from permway.diagnosis.hypothesis import Situation
from permway.model.irregularity_spectra import RangeWarning
from permway.recordings.channel import Sensor

AROUND_LINES = 8
"""Lines on either side that are a line's surroundings."""

LARGEST_SCORE = 10.0
"""Standard deviations above which a line counts no more: one line is no series."""

LINE_WIDTH = 1.5
"""Noise bandwidth of Hann's window, in lines."""


@dataclass(frozen=True)
class Excess:
    """Power of one run beyond the base's.

    Attributes
    ----------
    condition : Condition
        Of a train, as the base has it.
    frequency_Hz : ndarray, shape (F,)
    by_channel : dict of str to ndarray, shape (F,)
        Logarithm of the power measured over that predicted.
    excess : dict of str to ndarray, shape (F,)
        What stands out of its surroundings, in standard deviations.
    line_Hz : float
        Noise bandwidth of a line.
    profile : ndarray, shape (F,)
        Density of the model's irregularity, m2/Hz.
    """

    condition: Condition
    frequency_Hz: Reals
    by_channel: dict[str, Reals]
    excess: dict[str, Reals]
    line_Hz: float
    profile: Reals

    @property
    def speed(self) -> float:
        """m/s."""
        assert self.condition.speed_m_per_s is not None
        return self.condition.speed_m_per_s

    def score_at(self, frequency_Hz: Reals, channel: str = "") -> Reals:
        """What stands out about frequencies, by default in the mean over channels; NaN outside the record.

        And NaN of a channel that this run was not read by, or whose record of it is bad.
        """
        if channel and channel not in self.excess:
            return np.full(np.shape(frequency_Hz), np.nan)
        values = self.excess[channel] if channel else np.mean(list(self.excess.values()), axis=0)
        near = np.interp(frequency_Hz, self.frequency_Hz, values, left=np.nan, right=np.nan)
        return np.asarray(np.clip(near, -LARGEST_SCORE, LARGEST_SCORE))

    @property
    def neper(self) -> Reals:
        """Of the channel that shows most, line by line."""
        return np.asarray(np.max(list(self.by_channel.values()), axis=0))

    def neper_at(self, frequency_Hz: Reals, channel: str = "") -> Reals:
        """Excess about frequencies, by default of the channel that shows most; NaN as of :meth:`score_at`."""
        if channel and channel not in self.by_channel:
            return np.full(np.shape(frequency_Hz), np.nan)
        values = self.by_channel[channel] if channel else self.neper
        return np.asarray(np.interp(frequency_Hz, self.frequency_Hz, values, left=np.nan, right=np.nan))

    def amplitude_at(self, frequency_Hz: Reals, channel: str = "") -> Reals:
        """Amplitudes of lines in the profile that would leave the excess there, m; NaN outside the record."""
        neper = self.neper_at(frequency_Hz, channel)
        power = np.clip(np.expm1(neper), 0.05, None) * self.profile_at(frequency_Hz) * self.line_Hz
        return np.asarray(np.sqrt(2.0 * power))

    def profile_at(self, frequency_Hz: Reals) -> Reals:
        """Density of the model's irregularity, m2/Hz."""
        return np.exp(np.interp(frequency_Hz, self.frequency_Hz, np.log(self.profile)))


def excesses(situation: Situation) -> list[Excess]:
    """Of every run on board; none if the model has no irregularity.

    Entries ask one after the other: what was found of a fit is kept until another is asked about.
    """
    fit, model = situation.fit, situation.campaign.model
    if model.train is None or model.irregularity is None:
        return []
    for known, found in _LAST:
        if known() is fit:
            return found
    found = _found(situation)
    _LAST[:] = [(weakref.ref(fit), found)]
    return found


_LAST: list[tuple[weakref.ref[Fit], list[Excess]]] = []


def _found(situation: Situation) -> list[Excess]:
    fit = situation.fit
    found = []
    # With what a set of amendments explains already.
    predicted = fit.observations.predicted(fit.build(fit.values())).datasets
    for block, expected in zip(fit.observations.blocks, predicted, strict=True):
        condition = situation.campaign.condition(block.dataset.condition.name)
        if not isinstance(block, SpectraBlock) or condition.speed_m_per_s is None:
            continue
        frequency = block.dataset.data["frequency"].values
        ratio = np.log(block.dataset.data["psd"].values / expected["psd"].values)
        excess = ratio - median_filter(ratio, size=(1, 2 * AROUND_LINES + 1), mode="nearest")
        names = [str(name) for name in block.dataset.data["channel"].values]
        found.append(
            Excess(
                condition,
                frequency,
                dict(zip(names, ratio, strict=True)),
                dict(zip(names, np.sqrt(level_averages(block.dataset.data))[:, None] * excess, strict=True)),
                LINE_WIDTH / block.dataset.record.segment_s,
                _profile(situation, frequency, condition.speed_m_per_s),
            )
        )
    return found


def _profile(situation: Situation, frequency_Hz: Reals, speed: float) -> Reals:
    model, known = situation.campaign.model, situation.campaign.stated.irregularity
    assert model.irregularity is not None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RangeWarning)
        values = model.irregularity.density(frequency_Hz, speed, model.conversion)
    return np.asarray(values * 10.0 ** (0.1 * known.level_dB))


@dataclass(frozen=True)
class Comb:
    """A harmonic series that stands out in the runs.

    Attributes
    ----------
    per_speed : float
        Frequency of the first line over the speed, 1/m.
    amplitude_m : float
        Of the first line, if the n-th is `decay` powers of n lower: by the median of the lines.
    """

    per_speed: float
    amplitude_m: float


def combs(
    runs: Sequence[Excess],
    per_speed: Iterable[float],
    *,
    harmonics: int | None,
    decay: float,
    most: int,
    channel: str = "",
) -> list[Comb]:
    """The series of lines that stand out most, none within a hundredth of a better one.

    Parameters
    ----------
    runs : sequence of Excess
    per_speed : iterable of float
        Candidates: frequency of the first line over the speed.
    harmonics : int, optional
        By default as many as the records hold.
    decay : float
    most : int
    channel : str
        Whose lines are looked at; by default the mean over channels, and for the amplitude, line by line, the
        channel that shows most.
    """
    ranked: list[tuple[float, float]] = []
    for value in per_speed:
        scores = []
        for run in runs:
            if channel and channel not in run.excess:
                continue
            number = _numbers(run, value, harmonics)
            lines = number * value * run.speed
            seen = run.score_at(lines, channel)
            # A line shows by its power over the profile's.
            weight = number ** (-2.0 * decay) / run.profile_at(lines)
            scores.append(float(weight @ seen / max(float(np.linalg.norm(weight)), 1e-300)))
        # What is tied to length shows at every speed.
        ranked.append((min(scores) + 0.1 * sum(scores) if scores else 0.0, value))
    ranked.sort(reverse=True)
    taken: list[Comb] = []
    for _, value in ranked:
        if len(taken) == most:
            break
        if all(abs(np.log(value / other.per_speed)) > 0.01 for other in taken):
            taken.append(Comb(value, _amplitude(runs, value, harmonics, decay, channel)))
    return taken


def _numbers(run: Excess, per_speed: float, harmonics: int | None) -> Reals:
    """Harmonics within the record."""
    first = per_speed * run.speed
    low, high = int(np.ceil(run.frequency_Hz[0] / first)), int(run.frequency_Hz[-1] / first)
    return np.arange(max(low, 1), min(high, harmonics or high) + 1, dtype=np.float64)


def _amplitude(
    runs: Sequence[Excess], per_speed: float, harmonics: int | None, decay: float, channel: str
) -> float:
    found = [np.zeros(0)]
    for run in runs:
        number = _numbers(run, per_speed, harmonics)
        # The strongest lines; of the weak ones the excess says nothing.
        each = run.amplitude_at(number * per_speed * run.speed, channel) * number**decay
        found.append(np.sort(each[np.isfinite(each)])[-max(1, each.size // 2) :])
    every = np.concatenate(found)
    return float(np.median(every)) if every.size else 1e-6


def on_board(situation: Situation) -> list[Sensor]:
    """Sensors on the vehicle that a run was read by."""
    campaign = situation.campaign
    used = [n for b in situation.fit.observations.blocks for n in b.dataset.record.channels.values()]
    return [sensor for sensor in campaign.stated.sensors if sensor.degree is not None and sensor.name in used]


def suspects(situation: Situation, names: Iterable[str], most: int) -> list[str]:
    """Sensors by how badly the base fits what they read, calibration errors left in."""
    rows = situation.fit.observations.rows
    square = {}
    for name in names:
        mine = rows.sensor == name
        square[name] = float(np.mean(situation.fit.residuals[mine] ** 2)) if mine.any() else -1.0
    ranked = sorted(square, key=lambda name: -square[name])
    return [name for name in ranked if square[name] >= 0.0][:most]


def likely(situation: Situation, most: int = 12) -> list[str]:
    """Sensors that may be at fault: the worst on the line, and the worst on the vehicle."""
    sensors = situation.campaign.stated.sensors
    line = suspects(situation, [s.name for s in sensors if s.body is not None], most)
    return line + suspects(situation, [s.name for s in sensors if s.degree is not None], most)


def measured_psd(situation: Situation, sensor: str) -> list[tuple[Reals, Reals]]:
    """Frequencies and power of a channel in every run, SI squared per hertz."""
    found = []
    for block in situation.fit.observations.blocks:
        data = block.dataset.data
        if "psd" in data and sensor in data["channel"].values:
            found.append((data["frequency"].values, data["psd"].sel(channel=sensor).values))
    return found
