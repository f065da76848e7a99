"""What a table of modes reads: poles of the line, each matched to the mode of the table that it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from scipy.optimize import linear_sum_assignment

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.predictions.sweeps import Request
from permway.recordings.channel import Sensor
from permway.response.poles import Poles, lines_for, poles_of

FARTHEST = 1.5
"""Factor between a listed and a predicted frequency beyond which the two are no one mode."""

USUAL = 0.1
"""Of the logarithm of frequency, by how much a model is off as a rule; what a match costs counts from it."""

USUAL_DAMPING, MOST_DAMPING = 1.0, 2.0
"""The same of the logarithm of damping, which models hardly know, and the most that counts of it."""

USUAL_SHAPE = 0.2
"""The same of 1 less the modal assurance criterion (Allemang 2003, Sound and Vibration 37, 14-21)."""

LIGHTEST = 1e-6
"""Damping ratio below which a mode of the model has none."""


def request(campaign: Campaign, names: Sequence[str], temperature_C: float | None, data: xr.Dataset) -> Request:
    """The receptances between all sensors, over a band that holds what may be one of the modes."""
    sensors = [campaign.sensor(name) for name in names]
    # Two sensors at one place see the same.
    locations = tuple(dict.fromkeys((str(s.body), float(s.x_m or 0.0)) for s in sensors))
    frequency = data["frequency"].values
    return Request(
        temperature_C, lines_for(frequency.min() / FARTHEST, frequency.max() * FARTHEST), locations, locations
    )


def predicted(data: xr.Dataset, sensors: Sequence[Sensor], request: Request, receptance: Complexes) -> Reals:
    """Natural frequency and damping ratio of every listed mode, (2, modes); NaN where the model has no such mode.

    Raises
    ------
    SolveError
        If the response is not one of modes.
    """
    found = poles_of(request.frequency_Hz, receptance)
    values = np.full((2, data.sizes["frequency"]), np.nan)
    cost = _costs(data, found, _mac(data, sensors, request, found))
    count, many = cost.shape
    # Each mode may be left out, for what the farthest match costs.
    missed = np.full((count, count), (np.log(FARTHEST) / USUAL) ** 2)
    for row, column in zip(*linear_sum_assignment(np.concatenate([cost, missed], axis=1)), strict=True):
        if column < many:
            values[:, row] = found.frequency_Hz[column], max(float(found.damping[column]), 0.0)
    return values


def _costs(data: xr.Dataset, found: Poles, mac: Reals) -> Reals:
    """How unlike every listed mode and every pole are, (modes, poles); infinite beyond :data:`FARTHEST`."""
    frequency, damping = data["modes"].values
    off = np.log(found.frequency_Hz / frequency[:, None])
    more = np.log(np.maximum(found.damping, LIGHTEST) / damping[:, None])
    more = np.nan_to_num(np.clip(more, -MOST_DAMPING, MOST_DAMPING))
    cost = (off / USUAL) ** 2 + (more / USUAL_DAMPING) ** 2 + ((1.0 - mac) / USUAL_SHAPE) ** 2
    return np.where(np.abs(off) <= np.log(FARTHEST), cost, np.inf)


def _mac(data: xr.Dataset, sensors: Sequence[Sensor], request: Request, found: Poles) -> Reals:
    """Modal assurance of listed and predicted shapes, (modes, poles); 1 where no shape is listed."""
    if "shape" not in data:
        return np.ones((data.sizes["frequency"], found.omega.size))
    at = [request.rows.index((str(s.body), float(s.x_m or 0.0))) for s in sensors]
    read = np.stack([s.transfer(found.frequency_Hz) for s in sensors], axis=-1)
    # What is listed is in the sensors' units.
    shape = found.shape[:, at] * read / np.array([s.to_SI for s in sensors])
    listed = data["shape"].values.T
    across = np.abs(listed @ shape.T.conj()) ** 2
    return np.asarray(across / np.outer((listed**2).sum(axis=1), (np.abs(shape) ** 2).sum(axis=1)))
