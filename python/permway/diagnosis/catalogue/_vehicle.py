"""What the effects of the vehicle share: additions to it, who reads what, and where residuals are largest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._runs import on_board
from permway.diagnosis.hypothesis import Situation
from permway.model.vehicle import Vehicle
from permway.model.vehicle_additions import AnyAddition

FITS = 2.0
"""Mean square of the residuals below which a base nearly fits."""

WIDTH_OCTAVES = 0.1
"""Over which residuals are added up to find where an effect is strongest."""

APART_OCTAVES = 0.7
"""At least, between the frequencies where it may be."""


def vehicle_of(campaign: Campaign) -> Vehicle | None:
    """The vehicle that passes in some record, if any does."""
    kinds = {c.name: c.kind for c in campaign.stated.conditions}
    runs = any(kinds[record.condition] == "train" for record in campaign.stated.records)
    return campaign.model.train.vehicle if campaign.model.train is not None and runs else None


def with_addition(campaign: Campaign, addition: AnyAddition) -> Campaign:
    """The campaign with one more addition to its vehicle, checked again."""
    model = campaign.model
    assert model.train is not None
    vehicle = model.train.vehicle
    table = {name: getattr(vehicle, name) for name in type(vehicle).model_fields}
    changed = Vehicle(**{**table, "additions": (*vehicle.additions, addition)})
    return campaign.with_model(
        model.model_copy(update={"train": model.train.model_copy(update={"vehicle": changed})})
    )


def sensors_on(situation: Situation, part: str) -> list[str]:
    """Sensors of runs that read the vertical motion of a part: "wheelset", "wheelset2", "bogie", "body"."""
    found = []
    for sensor in on_board(situation):
        if sensor.degree is None or not sensor.predicted or sensor.degree.endswith("pitch"):
            continue
        if sensor.degree.split(".")[1].startswith(part):
            found.append(sensor.name)
    return found


def rows_of(situation: Situation, sensors: Sequence[str]) -> np.ndarray:
    """Which residuals under a train are of sensors: of their power, and of what others share with them."""
    rows = situation.fit.observations.rows
    mine = np.isin(rows.sensor, list(sensors))
    for name in sensors:
        mine |= np.char.endswith(rows.channel, f" {name}")
    return np.asarray(mine & (rows.force == ""))


def loudest_Hz(
    situation: Situation, sensors: Sequence[str], low_Hz: float, high_Hz: float, most: int
) -> list[float]:
    """Where the residuals of sensors under a train exceed chance most, Hz."""
    fit = situation.fit
    rows = fit.observations.rows
    left = fit.clean if fit.inflation < FITS else fit.residuals
    mine = rows_of(situation, sensors) & (rows.frequency_Hz >= low_Hz) & (rows.frequency_Hz <= high_Hz)
    if not mine.any():
        return []
    frequency, at = np.unique(rows.frequency_Hz[mine], return_inverse=True)
    excess = np.bincount(at, left[mine] ** 2 - 1.0)
    octaves = np.log2(frequency)
    near = np.exp(-0.5 * ((octaves[:, None] - octaves[None, :]) / WIDTH_OCTAVES) ** 2)
    found: list[int] = []
    for index in np.argsort(-(near @ excess), kind="stable"):
        if len(found) < most and all(abs(octaves[index] - octaves[other]) >= APART_OCTAVES for other in found):
            found.append(int(index))
    return [float(frequency[index]) for index in found]
