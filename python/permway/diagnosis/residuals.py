"""Standardised residuals as maps, channel against frequency, and whether they look like noise."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.diagnosis.blocks import Block
from permway.diagnosis.blocks_frf import FrfBlock

PARTS = ("level", "phase")
LAGS = 12


def standardised(block: Block, residuals: Mapping[str, Reals], predicted: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Residuals of a block, row by row of its map.

    Complex residuals are turned by the predicted phase, so that their real part is one of level and their
    imaginary part one of phase; noise is as large either way. (What was measured holds the noise itself: turned by
    its phase, noise alone would seem to raise the level.)

    Parameters
    ----------
    block : Block
    residuals : mapping of model's name to ndarray, shape (n,)
        Standardised, of the block's rows.
    predicted : mapping of model's name to Dataset
        What the residuals are from.

    Returns
    -------
    xarray.Dataset
        `z` (model, part, row, frequency), of unit variance if the model is right, NaN where there is none; rows
        are channels, or what two channels share; coordinate `sensor` of each row.
    """
    if isinstance(block, FrfBlock):
        z, labels, sensors, frequency = _frf(block, residuals, predicted)
    else:
        z, labels, sensors, frequency = _by_label(block, residuals)
    return xr.Dataset(
        {
            "z": (
                ("model", "part", "row", "frequency"),
                z,
                {"long_name": "residual over its standard deviation", "units": "1"},
            )
        },
        coords={
            "model": list(residuals),
            "part": list(PARTS),
            "row": labels,
            "sensor": ("row", sensors),
            "frequency": ("frequency", frequency, {"units": "Hz"}),
        },
        attrs={"record": block.dataset.record.name, "statistic": block.dataset.record.statistic},
    )


def _frf(
    block: FrfBlock, residuals: Mapping[str, Reals], predicted: Mapping[str, xr.Dataset]
) -> tuple[Reals, list[str], list[str], Reals]:
    shape = block.measured.shape
    half = block.measured.size
    found = []
    for model, values in residuals.items():
        turn = np.where(block.weight > 0.0, block.along(predicted[model]).conj(), np.nan)
        turned = (values[:half] + 1j * values[half:]).reshape(shape) * turn
        found.append(np.stack([turned.real, turned.imag]).reshape(2, -1, shape[-1]))
    first = np.arange(0, half, shape[-1])
    rows = block.rows
    labels, sensors = [str(v) for v in rows.channel[first]], [str(v) for v in rows.sensor[first]]
    return np.stack(found), labels, sensors, block.frequency


def _by_label(block: Block, residuals: Mapping[str, Reals]) -> tuple[Reals, list[str], list[str], Reals]:
    rows = block.rows
    labels = list(dict.fromkeys(str(label) for label in rows.channel))
    places = {}
    for label in labels:
        where = np.flatnonzero(rows.channel == label)
        half = where.size // 2
        # Of complex values the same frequencies come twice.
        twice = where.size % 2 == 0 and np.array_equal(
            rows.frequency_Hz[where[:half]], rows.frequency_Hz[where[half:]]
        )
        places[label] = (where[:half], where[half:]) if twice else (where,)
    repeated = any(np.unique(rows.frequency_Hz[parts[0]]).size < parts[0].size for parts in places.values())
    # A material's points repeat frequencies; then lines go by number.
    frequency = rows.frequency_Hz[places[labels[0]][0]] if repeated else np.unique(rows.frequency_Hz)
    z = np.full((len(residuals), len(PARTS), len(labels), frequency.size), np.nan)
    for model, values in enumerate(residuals.values()):
        for row, label in enumerate(labels):
            for part, where in enumerate(places[label]):
                at = np.arange(where.size) if repeated else np.searchsorted(frequency, rows.frequency_Hz[where])
                z[model, part, row, at] = values[where]
    sensors = [str(rows.sensor[places[label][0][0]]) for label in labels]
    return z, labels, sensors, frequency


def lag_correlation(z: xr.DataArray, *, lags: int = LAGS) -> xr.Dataset:
    """How alike residuals are to those so many lines further, sensor by sensor.

    Parameters
    ----------
    z : DataArray (part, row, frequency)
        Of one model.
    lags : int
        At most.

    Returns
    -------
    xarray.Dataset
        `correlation` (part, sensor, lag), 1 to `lags`, of products over the mean square, not of residuals from a
        mean, for the mean is known to be zero; `chance`, half the width of what 95 % of independent noise shows.
    """
    sensors = list(dict.fromkeys(str(s) for s in z["sensor"].values))
    count = min(lags, max(1, z.sizes["frequency"] // 4))
    found = np.full((z.sizes["part"], len(sensors), count), np.nan)
    chance = np.full(found.shape, np.nan)
    for index, sensor in enumerate(sensors):
        mine = z.values[:, z["sensor"].values.astype(str) == sensor]
        for part, values in enumerate(mine):
            power = np.nanmean(values**2) if np.isfinite(values).any() else np.nan
            for lag in range(1, count + 1):
                product = values[:, :-lag] * values[:, lag:]
                there = int(np.isfinite(product).sum())
                if there and power > 0.0:
                    found[part, index, lag - 1] = np.nansum(product) / there / power
                    chance[part, index, lag - 1] = 1.96 / np.sqrt(there)
    dims = ("part", "sensor", "lag")
    return xr.Dataset(
        {
            "correlation": (dims, found, {"long_name": "lag correlation", "units": "1"}),
            "chance": (dims, chance, {"long_name": "95 % of independent noise", "units": "1"}),
        },
        coords={"part": z["part"].values, "sensor": sensors, "lag": np.arange(1, count + 1)},
    )


def channel_rms(residuals: xr.Dataset) -> xr.DataArray:
    """Root mean square of standardised residuals by model and sensor: 1 for noise alone."""
    z = residuals["z"]
    sensors = list(dict.fromkeys(str(s) for s in z["sensor"].values))
    values = np.array(
        [
            [
                float(np.sqrt(np.nanmean(model.values[:, z["sensor"].values.astype(str) == sensor] ** 2)))
                for sensor in sensors
            ]
            for model in z
        ]
    )
    return xr.DataArray(
        values, dims=("model", "sensor"), coords={"model": z["model"].values, "sensor": sensors}, name="rms"
    )
