"""What a hammer test reads: frequency responses from force points to sensors on the line."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.parts import Condition
from permway.campaign.predictions.sweeps import Request
from permway.recordings.channel import Point, Sensor, transfers


def request(
    campaign: Campaign, condition: Condition, sensors: list[str], points: list[str], frequency_Hz: Reals
) -> Request:
    """The receptances behind the frequency responses from points to sensors, by name."""
    rows = [campaign.sensor(name) for name in sensors]
    columns = [campaign.point(name) for name in points]
    return Request(
        needed_temperature(campaign, condition),
        frequency_Hz,
        tuple((str(sensor.body), float(sensor.x_m or 0.0)) for sensor in rows),
        tuple((point.body, point.x_m) for point in columns),
    )


def read(sensors: Sequence[Sensor], points: Sequence[Point], frequency_Hz: Reals) -> Complexes:
    """What is read per receptance: sensors' chains over force cells' chains.

    Returns
    -------
    ndarray of complex128, shape (F, sensors, points)
        SI unit of the quantity per N, over m/N; not to be written to.
    """
    return _read(tuple(sensors), tuple(points), frequency_Hz.tobytes())


@lru_cache(maxsize=4)
def _read(sensors: tuple[Sensor, ...], points: tuple[Point, ...], frequency: bytes) -> Complexes:
    top, bottom = (transfers(chains, np.frombuffer(frequency)) for chains in (sensors, points))
    found = np.asarray(top[:, :, None] * (1.0 / bottom)[:, None, :])
    found.flags.writeable = False
    return found


def temperature(campaign: Campaign, condition: Condition) -> float | None:
    """Temperature of a condition, or else the model's, degrees Celsius."""
    return campaign.model.temperature_C if condition.temperature_C is None else condition.temperature_C


def needed_temperature(campaign: Campaign, condition: Condition) -> float | None:
    """The same; None where no law depends on it, for then one solve serves conditions of all temperatures."""
    return temperature(campaign, condition) if campaign.model.line.needs_temperature else None
