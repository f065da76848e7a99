"""Which of a campaign's data a held-out group holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from permway.campaign.checks import SAME_SPEED
from permway.campaign.kinds import kind_of
from permway.campaign.parts import HeldOut

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign
    from permway.campaign.load import Dataset


def held_out(campaign: Campaign, group: HeldOut, dataset: Dataset) -> xr.DataArray:
    """Mark what a group holds of a dataset.

    A place holds what is struck there or read there; a channel what it reads.

    Parameters
    ----------
    campaign : Campaign
    group : HeldOut
    dataset : Dataset

    Returns
    -------
    xarray.DataArray of bool
        (sensor, force, frequency) of an FRF, (channel, frequency) of spectra, (band,) of decay rates, (point,) of
        a material's table, (quantity, frequency) of modes.
    """
    data, condition = dataset.data, dataset.condition
    dimensions = kind_of(dataset.record).dimensions
    whole = xr.DataArray(
        np.zeros([data.sizes[d] for d in dimensions], dtype=np.bool_),
        dims=dimensions,
        coords={d: data.coords[d] for d in dimensions if d in data.coords},
        name="held_out",
    )
    match group.axis:
        case "record":
            return whole | (dataset.record.name in group.members)
        case "speed":
            v = condition.speed_m_per_s
            return whole | any(v is not None and abs(v - float(m)) <= SAME_SPEED * float(m) for m in group.members)
        case "temperature":
            return whole | (condition.temperature_C in group.members)
        case "band":
            assert group.band_Hz is not None
            frequency = data["band"] if "band" in dimensions else data["frequency"]
            return whole | ((frequency >= group.band_Hz[0]) & (frequency <= group.band_Hz[1]))
        case "channel":
            dimension = "sensor" if "sensor" in dimensions else "channel"
            return whole | data[dimension].isin(group.members) if dimension in dimensions else whole
    assert group.from_to_m is not None
    for dimension in ("sensor", "force", "channel"):
        if dimension in dimensions:
            places = [_place(campaign, dimension, str(name)) for name in data[dimension].values]
            inside = [x is not None and group.from_to_m[0] <= x <= group.from_to_m[1] for x in places]
            whole = whole | xr.DataArray(np.array(inside), dims=dimension, coords={dimension: data[dimension]})
    return whole


def _place(campaign: Campaign, dimension: str, name: str) -> float | None:
    return campaign.point(name).x_m if dimension == "force" else campaign.sensor(name).x_m
