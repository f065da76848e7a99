"""What a decay-rate test reads: EN 15461's rate in one-third octaves."""

from __future__ import annotations

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.parts import Record
from permway.campaign.predictions.sweeps import Request
from permway.recordings.estimates.decay_rate import grid_positions, rate_on_grid

LINES = 12
"""Lines in a one-third octave, whose powers are averaged: enough for the peak where the rail is pinned."""


def request(campaign: Campaign, record: Record, temperature_C: float | None, data: xr.Dataset) -> Request:
    """The receptances from the blows of EN 15461's grid to the accelerometer, at the first of them."""
    sensor = campaign.sensor(next(iter(record.channels.values())))
    assert record.spacing_m is not None
    start = float(sensor.x_m or 0.0)
    blows = tuple((str(sensor.body), float(start + x)) for x in grid_positions(record.spacing_m))
    return Request(temperature_C, lines(data), blows[:1], blows)


def lines(data: xr.Dataset) -> Reals:
    """Frequencies within the bands, `LINES` in each at equal ratios, Hz."""
    return lines_of(1000.0 * 10.0 ** (np.round(10.0 * np.log10(data["band"].values / 1000.0)) / 10.0))


def lines_of(middle_Hz: Reals) -> Reals:
    """The same, from exact mid-band frequencies."""
    share = (np.arange(LINES) + 0.5) / LINES - 0.5
    return np.asarray((middle_Hz[:, None] * 10.0 ** (share / 10.0)[None, :]).reshape(-1), dtype=np.float64)


def band_moduli(receptance: Complexes, frequency_Hz: Reals) -> Reals:
    """Root of the mean power in every band, (blows, bands), of receptances (F, 1, blows) at those lines."""
    bands = frequency_Hz.size // LINES
    power = np.abs(receptance[:, 0, :]).reshape(bands, LINES, -1) ** 2
    # The same blow strikes all lines of a band; accelerance weighs them by the fourth power of their frequency.
    weight = frequency_Hz.reshape(bands, LINES, 1) ** 4
    return np.asarray(np.sqrt((power * weight).sum(axis=1) / weight.sum(axis=1)).T)


def predicted(record: Record, data: xr.Dataset, need: Request, receptance: Complexes) -> xr.Dataset:
    """The decay rate in every band, from receptances (F, 1, blows) of what was requested."""
    assert record.spacing_m is not None
    rate = rate_on_grid(band_moduli(receptance, need.frequency_Hz), record.spacing_m)
    return data["decay_rate"].copy(data=rate).to_dataset(name="decay_rate")
