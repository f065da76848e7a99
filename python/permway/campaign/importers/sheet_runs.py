"""The runs of a sheet's folder: channels, noise floors, and how the records came about."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from permway.arrays import Reals
from permway.campaign.importers.sheet_form import Sheet
from permway.campaign.importers.sheet_position import position
from permway.errors import InputError
from permway.recordings.estimates.welch import cross_spectra
from permway.recordings.readers import read_time

DEGREES = {"carbody": "car1.body.bounce", "bogie1": "car1.bogie1.bounce", "bogie2": "car1.bogie2.bounce"} | {
    f"axlebox{i}": f"car1.wheelset{i}" for i in range(1, 5)
}

UNITS = {"m/s^2": "m/s2", "m/s2": "m/s2", "g": "g"}

BAND_HZ = (3.0, 400.0)
"""Used of the runs: below lies detrending, above the lines for which such records were computed."""

QUIET_HZ = (470.0, 505.0)
"""Where the runs hold nothing but noise."""

ALIKE = 4.0
"""Times the median of all channels: one whose floor is higher is noisier than a recorder's channels are."""

LINES_HZ = ((0.0, 0.5), (30.0, 1.0))
"""Where the transfer functions behind computed runs are exact, and between which they are interpolated.

The sheets do not say so; the records do. Wheelset 3 over wheelset 1, which meets the same profile 17.44 m earlier,
falls halfway between whole hertz to 0.54 at 200 km/h and to 0.77 at 300 km/h, as linear interpolation over that
lag must; below 30 Hz it falls, twice in a hertz, to 0.88 and 0.94.
"""

SHOWS_HZ = (60.0, 350.0)
"""Where a record is asked whether it was interpolated between whole hertz."""


@dataclass(frozen=True)
class Runs:
    """The runs of a folder, read.

    Attributes
    ----------
    sheet : Sheet
    sources : list of Path
        One for each speed.
    noise : dict of channel to float
        Floor, unit squared per hertz: the least over the runs of the median in the quiet band; of a channel that
        is noisier than `ALIKE` times the median of all that median, for so much the user would expect.
    interpolated : list of bool
        Whether each record was computed by interpolation between `LINES_HZ`.
    """

    sheet: Sheet
    sources: list[Path]
    noise: dict[str, float]
    interpolated: list[bool]

    def sensors(self) -> list[dict[str, Any]]:
        """The channels on board."""
        assert self.sheet.runs is not None
        unit = UNITS[self.sheet.runs.unit]
        return [
            {
                "name": channel,
                "degree": DEGREES[channel],
                "quantity": "acceleration",
                "unit": unit,
                "chain": {"noise_floor": self.noise[channel]},
            }
            for channel in self.sheet.runs.channels
        ]

    def conditions(self, names: Sequence[str]) -> list[dict[str, Any]]:
        """One for each speed."""
        assert self.sheet.runs is not None
        common: dict[str, Any] = {"kind": "train", "temperature_C": self.sheet.temperature_C[0]}
        if len(self.sheet.temperature_C) > 1:
            common["note"] = "the sheet does not say at which of its temperatures: the first is taken"
        wheels = list(position(self.sheet).wheels_m)
        return [
            {"name": name, **common, "speed_m_per_s": speed / 3.6, "wheels_m": wheels}
            for name, speed in zip(names, self.sheet.runs.speeds_kmh, strict=True)
        ]

    def records(self, names: Sequence[str]) -> list[dict[str, Any]]:
        """One for each speed."""
        runs = self.sheet.runs
        assert runs is not None
        common = {
            "statistic": "csd",
            "band_Hz": [BAND_HZ[0], min(BAND_HZ[1], 0.4 * runs.sampling_Hz)],
            "segment_s": 1.0,
            "sampling_Hz": runs.sampling_Hz,
            "channels": {channel: channel for channel in runs.channels},
        }
        lines = {"interpolated_Hz": [list(pair) for pair in LINES_HZ]}
        return [
            {"name": name, "file": source.name, "condition": name, **common, **(lines if computed else {})}
            for name, source, computed in zip(names, self.sources, self.interpolated, strict=True)
        ]


def read_runs(sheet: Sheet, sources: list[Path]) -> Runs:
    """Read what the campaign file needs to know of the runs.

    Raises
    ------
    InputError
        For a unit or a channel that is not known here, and for files that do not hold what the sheet states.
    """
    assert sheet.runs is not None
    if sheet.runs.unit not in UNITS:
        raise InputError("is no unit of acceleration here", where="sheet.json: runs.unit", value=sheet.runs.unit)
    for index, channel in enumerate(sheet.runs.channels):
        if channel not in DEGREES:
            where = f"sheet.json: runs.channels[{index}]"
            raise InputError(
                "is no channel here", where=where, value=channel, remedy=f"use one of {list(DEGREES)}"
            )
    least = np.full(len(sheet.runs.channels), np.inf)
    interpolated = []
    for source, speed in zip(sources, sheet.runs.speeds_kmh, strict=True):
        file = read_time(source, channels=sheet.runs.channels, sampling_Hz=sheet.runs.sampling_Hz)
        values, rate = file.values, sheet.runs.sampling_Hz
        quiet = (
            cross_spectra(values, sampling_Hz=rate, segment_s=1.0)["psd"].sel(frequency=slice(*QUIET_HZ)).values
        )
        if quiet.shape[1]:
            least = np.minimum(least, np.median(quiet, axis=1))
        interpolated.append(_is_interpolated(sheet, values, rate, speed / 3.6))
    known = np.where(np.isfinite(least) & (least > 0.0), least, 1e-12)
    usual = float(np.median(known))
    for channel, value in zip(sheet.runs.channels, known, strict=True):
        if value > ALIKE * usual:
            warnings.warn(
                f"{channel}: {value / usual:.3g} times the noise of the other channels, in power; the campaign "
                "states theirs, so that a diagnosis states the difference",
                stacklevel=2,
            )
    known = np.where(known > ALIKE * usual, usual, known)
    noise = {channel: float(f"{value:.4g}") for channel, value in zip(sheet.runs.channels, known, strict=True)}
    return Runs(sheet, sources, noise, interpolated)


def _is_interpolated(sheet: Sheet, values: Reals, sampling_Hz: float, speed_m_per_s: float) -> bool:
    """Whether the ratio of two wheelsets far apart dips halfway between whole hertz as interpolation makes it.

    Linear interpolation over a lag tau between lines 1 Hz apart leaves |cos(pi tau)| halfway; a measured ratio,
    and one computed line by line, knows no whole hertz. Of all pairs the median counts: one odd wheel is outvoted.
    """
    assert sheet.runs is not None
    wheels = position(sheet).wheels_m
    spectrum = np.fft.rfft(values, axis=1)
    frequency = np.fft.rfftfreq(values.shape[1], 1.0 / sampling_Hz)
    shown = (frequency >= SHOWS_HZ[0]) & (frequency <= SHOWS_HZ[1])
    off = np.abs(frequency - np.round(frequency))
    near, far = shown & (off < 0.08), shown & (off > 0.42)
    if not (near.any() and far.any()):
        return False
    rows = {channel: row for row, channel in enumerate(sheet.runs.channels)}
    votes = []
    for first in ("axlebox1", "axlebox2"):
        for second in ("axlebox3", "axlebox4"):
            if first not in rows or second not in rows:
                continue
            lag = (wheels[int(first[-1]) - 1] - wheels[int(second[-1]) - 1]) / speed_m_per_s
            # Of the sum over a line's neighbourhood, for a ratio of two random numbers has no mean.
            power = np.abs(spectrum[[rows[first], rows[second]]]) ** 2
            ratio = [np.sqrt(power[1, kept].sum() / power[0, kept].sum()) for kept in (near, far)]
            votes.append(ratio[1] / ratio[0] - 0.5 * (1.0 + abs(np.cos(np.pi * lag))))
    return bool(votes) and float(np.median(votes)) < 0.0
