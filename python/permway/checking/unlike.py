"""A model that does not resemble what was measured: asked back, for no single change explains it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from permway.campaign.load import Dataset
from permway.checking.blunder import Blunder
from permway.checking.compared import Compared
from permway.checking.deviations import levels_dB

RATIOS = ("frf", "transmissibility")
"""Statistics whose level the model states."""

UNLIKE_dB = 10.0
"""Scatter of measured over predicted levels of a record, and median of those of a response, dB, from which it is
asked back. Campaigns by finite elements, honest, with physics missing or with pads 30 % softer than is stated,
scatter by 6.4 dB at most, beside a lost fastener the median is 9 dB: at half of it these are asked. Records of
another line scatter by 12 to 16 dB, and at twice of it pass. On ballasted track with pads 30 % softer one record
of five scattered by 10.6 dB, and is asked in vain."""

FAR_dB = 10.0
"""Median size of measured over predicted levels in a third of an octave, dB, from which it is reported: what
tolerances move is mostly narrower. Of 30 honest campaigns by finite elements 2 have such a band, at half of it 8,
at twice none; of 18 with pads 30 % softer that are not asked back 4, at half 7, at twice 1."""


def far_off(records: Sequence[tuple[Dataset, Compared]]) -> str | None:
    """The third octaves about the worst in which levels are far off, in words; None if there are none.

    Parameters
    ----------
    records : sequence of (Dataset, Compared)
        Put right; those of which it is asked whether they are of this model are left aside.
    """
    sizes, lines = [np.zeros(0)], [np.zeros(0)]
    for dataset, right in records:
        if dataset.record.statistic in RATIOS and not is_unlike(dataset, right):
            levels = np.abs(levels_dB(right))
            known = np.isfinite(levels)
            sizes.append(levels[known])
            lines.append(np.broadcast_to(right.frequency_Hz, levels.shape)[known])
    size, frequency = np.concatenate(sizes), np.concatenate(lines)
    band = np.floor(3.0 * np.log2(frequency)).astype(np.int64)
    # A single line may be that of a zero.
    several = [one for one in np.unique(band).tolist() if np.ptp(frequency[band == one]) > 0.0]
    medians = {one: float(np.median(size[band == one])) for one in several}
    worst = max(medians, key=lambda one: medians[one], default=0)
    if medians.get(worst, 0.0) < FAR_dB:
        return None
    low = high = worst
    while medians.get(low - 1, 0.0) >= FAR_dB:
        low -= 1
    while medians.get(high + 1, 0.0) >= FAR_dB:
        high += 1
    own = (band >= low) & (band <= high)
    off, ends = size[own], (frequency[own].min(), frequency[own].max())
    return (
        f"levels differ from the model's by {np.median(off):.0f} dB in the median, up to {off.max():.0f} dB, "
        f"between {ends[0]:.3g} and {ends[1]:.3g} Hz: something large is missing, or a value far off; diagnose"
    )


def unlike(records: Sequence[tuple[Dataset, Compared]]) -> Iterator[Blunder]:
    """One question of all records that the model does not resemble, once what blunders explain is put right.

    Parameters
    ----------
    records : sequence of (Dataset, Compared)
    """
    off = {dataset.record.name: off_dB(right) for dataset, right in records if is_unlike(dataset, right)}
    if not off:
        return
    middles, scatters = ([pair[at] for pair in off.values()] for at in (0, 1))
    what = (
        f"measured over predicted levels are {_range(middles)} dB in the median and scatter by "
        f"{_range(scatters)} dB: the model does not resemble what was measured"
    )
    remedy = "check the unit of frequency (Hz, or rad/s?), of stiffnesses, the places, and which model this is"
    yield Blunder("model", f"records.{', '.join(off)}", what, remedy, asked=True)


def is_unlike(dataset: Dataset, right: Compared) -> bool:
    """Whether the model does not resemble a record, once what blunders explain is put right."""
    middle, scatter = off_dB(right)
    # A run's level may be free, as its irregularity is.
    return max(scatter, abs(middle) if dataset.record.statistic in RATIOS else 0.0) >= UNLIKE_dB


def questioned(blunder: Blunder) -> Blunder:
    """A blunder of a record that the model does not resemble: odds against such a model prove nothing."""
    return replace(blunder, what=f"if the model is right, {blunder.what}", log_odds=None, asked=True)


def off_dB(one: Compared) -> tuple[float, float]:
    """Median of the deviations of levels, and half of what holds 68 % of them, dB; 0 where no line states any."""
    levels = levels_dB(one)
    levels = levels[np.isfinite(levels)]
    if not levels.size:
        return 0.0, 0.0
    low, middle, high = np.percentile(levels, [16.0, 50.0, 84.0])
    return float(middle), float(0.5 * (high - low))


def _range(sizes: Sequence[float]) -> str:
    low, high = round(min(sizes)), round(max(sizes))
    return str(low) if low == high else f"{low} to {high}"
