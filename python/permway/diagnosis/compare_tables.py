"""Parameters and sizes of calibration errors of a comparison, as labelled tables."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from permway.campaign.campaign import Campaign
from permway.campaign.compare import NEPER_DB, POWER_DB
from permway.campaign.kinds import kind_of
from permway.diagnosis.fit import WIDTH, Fit
from permway.diagnosis.observations import Observations
from permway.diagnosis.recalibrated_values import recalibrated_of

SAYS_NOTHING = 0.9
"""A posterior that is wider than this share of the prior: the records say nothing of the parameter."""

LEFT = 2.0
"""Standard deviations of the prior beyond which a value has left its tolerance."""


def parameters_of(campaign: Campaign, fit: Fit | None) -> xr.Dataset:
    """Nominal value and tolerance of every parameter; recalibrated, beside them, what was found."""
    known = list(campaign.parameters.known.values())
    nominal = np.array([k.nominal for k in known])
    columns: dict[str, Any] = {
        "nominal": nominal,
        "low_2sigma": np.array([k.value(-2.0) for k in known]),
        "high_2sigma": np.array([k.value(2.0) for k in known]),
    }
    if fit is not None:
        moved = recalibrated_of(fit)
        found = [moved[k.name] for k in known]
        low, high = (np.array([getattr(one, end) for one in found]) for end in ("low", "high"))
        reach = [abs(k.z(b) - k.z(a)) for k, a, b in zip(known, low, high, strict=True)]
        columns |= {
            "value": np.array([one.value for one in found]),
            "low": low,
            "high": high,
            "z": np.array([one.z for one in found]),
            "sigma_over_prior": 0.5 * np.array(reach) / WIDTH,
        }
        columns["left"] = np.abs(columns["z"]) > LEFT
        columns["not_informed"] = columns["sigma_over_prior"] > SAYS_NOTHING
    return xr.Dataset(
        {name: ("parameter", values) for name, values in columns.items()},
        coords={
            "parameter": np.array([k.name for k in known], dtype=str),
            "unit": ("parameter", np.array([k.parameter.unit for k in known], dtype=str)),
        },
        attrs={"interval": "low to high hold 90 %", "z": "standard deviations of the prior"},
    )


def calibration_of(observations: Observations) -> xr.Dataset:
    """Sizes of the calibration errors that were allowed, dB of the level they act on."""
    decay = {f"record {d.record.name}" for d in observations.datasets if kind_of(d.record).power}
    sizes = {
        source: size * (POWER_DB if source.startswith(("irregularity", "decay")) or source in decay else NEPER_DB)
        for source, size in observations.sizes.items()
        if source in {o.name for o in observations.columns.sources}
    }
    for block in observations.blocks:
        if block.pair:
            sizes[f"pairs of {block.dataset.record.name}"] = block.pair * NEPER_DB
    return xr.Dataset(
        {
            "size_dB": (
                "source",
                np.array(list(sizes.values())),
                {"long_name": "standard deviation", "units": "dB"},
            )
        },
        coords={"source": np.array(list(sizes), dtype=str)},
    )
