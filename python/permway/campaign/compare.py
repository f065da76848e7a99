"""One record and its predictions as curves, channel by channel, with intervals; decibels by line and by band."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.dataset import Dataset
from permway.campaign.kinds import kind_of
from permway.campaign.kinds.kind import NEPER_DB, POWER_DB
from permway.recordings.estimates.bands import Bands

__all__ = ["NEPER_DB", "POWERS", "POWER_DB", "UNSURE_DB", "curves", "flat", "line_frequency", "third_octaves"]

POWERS = ("psd", "decay_rate")
"""Variables whose decibels are 10 lg."""

UNSURE_DB = 1.0
"""A line of larger standard deviation states nothing of a level, and is left out of levels in bands."""


def curves(
    campaign: Campaign, dataset: Dataset, predicted: Mapping[str, xr.Dataset], scatter_dB: Reals
) -> xr.Dataset:
    """Measured and predicted side by side.

    Parameters
    ----------
    campaign : Campaign
    dataset : Dataset
    predicted : mapping of model's name to Dataset of xarray
        As :func:`permway.campaign.predict.predict` gives them.
    scatter_dB : ndarray, shape (channels, F)
        One standard deviation of each line of the record.

    Returns
    -------
    xarray.Dataset
        `measured` (channel, frequency), complex but for powers; `low`, `high`, the 95 % interval of its modulus;
        `phase_half_rad`, half that of its phase; `scatter_dB`; `predicted` (model, channel, frequency);
        `deviation_dB`, measured over predicted; coordinates `sensor` and `force` of each channel.
        Without a known uncertainty the intervals are NaN. The deviation of a line that was not measured is NaN.
    """
    kind = kind_of(dataset.record)
    variable = kind.variable
    measured = flat(dataset, dataset.data)
    models = list(predicted)
    values = np.stack([flat(dataset, predicted[name]) for name in models])
    sensor, force = kind.channels(dataset)
    labels = [f"{s} < {f}" if f else s for s, f in zip(sensor, force, strict=True)]
    low, high, half = kind.interval(dataset, measured, scatter_dB)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.log(np.abs(measured) / np.abs(values))
    deviation = np.where(np.isfinite(ratio), ratio, np.nan) * (POWER_DB if kind.power else NEPER_DB)
    dims = ("channel", "frequency")
    data = xr.Dataset(
        {
            "measured": (dims, measured, {"long_name": f"measured {dataset.data[variable].attrs['long_name']}"}),
            "low": (dims, low, {"long_name": "lower bound of the modulus, 95 %"}),
            "high": (dims, high, {"long_name": "upper bound of the modulus, 95 %"}),
            "phase_half_rad": (dims, half, {"long_name": "half the 95 % interval of the phase", "units": "rad"}),
            "scatter_dB": (dims, scatter_dB, {"long_name": "standard deviation of the level", "units": "dB"}),
            "predicted": (("model", *dims), values, {"long_name": "predicted"}),
            "deviation_dB": (("model", *dims), deviation, {"long_name": "measured over predicted", "units": "dB"}),
        },
        coords={
            "model": models,
            "channel": labels,
            "frequency": ("frequency", line_frequency(dataset), {"units": "Hz", "long_name": "frequency"}),
            "sensor": ("channel", np.array(sensor, dtype=str)),
            "force": ("channel", np.array(force, dtype=str)),
            "unit": ("channel", [kind.unit(campaign, dataset, name) for name in sensor]),
        },
        attrs={
            "record": dataset.record.name,
            "condition": dataset.condition.name,
            "statistic": dataset.record.statistic,
            "variable": variable,
            "sign": "deviations are measured over predicted: positive where the model is too low",
        },
    )
    if dataset.condition.temperature_C is not None:
        data.attrs["temperature_C"] = dataset.condition.temperature_C
    return data


def flat(dataset: Dataset, data: xr.Dataset) -> Complexes | Reals:
    """Measured or predicted values as (channel, frequency); pairs of sensor and point are channels."""
    values = data[kind_of(dataset.record).variable].values
    return np.asarray(values.reshape(-1, values.shape[-1]))


def line_frequency(dataset: Dataset) -> Reals:
    """Frequencies along the last dimension, Hz; of a material's points they may repeat."""
    name = "band" if "band" in dataset.data.dims else "frequency"
    return np.asarray(dataset.data[name].values, dtype=np.float64)


def third_octaves(record: xr.Dataset) -> xr.Dataset:
    """Deviations of levels in one-third octaves (IEC 61260-1).

    Every line counts alike in its band, and only lines that are known to `UNSURE_DB`.

    Parameters
    ----------
    record : Dataset
        From :func:`curves`.

    Returns
    -------
    xarray.Dataset
        `deviation_dB` (model, channel, band), NaN where no line states anything; `scatter_dB` (channel, band), its
        standard deviation by noise; `lines` (channel, band).
    """
    number = np.round(10.0 * np.log10(record["frequency"].values)).astype(np.int64)
    bands = Bands(number=np.arange(number.min(), number.max() + 1))
    member = (number[None, :] == bands.number[:, None]).astype(np.float64)
    stated = np.isfinite(record["deviation_dB"].values).all(axis=0) & (record["scatter_dB"].values <= UNSURE_DB)
    power = record.attrs["variable"] in POWERS

    def squares(values: np.ndarray) -> Reals:
        return np.where(stated, np.abs(values) ** (1 if power else 2), 0.0)

    measured = squares(record["measured"].values)
    scatter = measured * np.where(stated, record["scatter_dB"].values, 0.0)
    # Neighbouring lines under Hann's window say half the same.
    alike = 2.0 if record.attrs["variable"] == "psd" else 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        level = measured @ member.T
        ratio = 10.0 * np.log10(level / (squares(record["predicted"].values) @ member.T))
        noise = np.sqrt(alike * (scatter**2 @ member.T)) / level
    return xr.Dataset(
        {
            "deviation_dB": (
                ("model", "channel", "band"),
                np.where(np.isfinite(ratio), ratio, np.nan),
                {"long_name": "level, measured over predicted", "units": "dB"},
            ),
            "scatter_dB": (
                ("channel", "band"),
                noise,
                {"long_name": "standard deviation by noise", "units": "dB"},
            ),
            "lines": (
                ("channel", "band"),
                (stated @ member.T).astype(np.int64),
                {"long_name": "lines", "units": "1"},
            ),
        },
        coords={
            "model": record["model"].values,
            "channel": record["channel"].values,
            "band": ("band", bands.nominal_Hz, {"units": "Hz", "long_name": "nominal middle of the band"}),
        },
    )
