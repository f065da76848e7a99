"""What a test of a material reads: the modulus of a law, or its stiffness."""

from __future__ import annotations

import numpy as np
import xarray as xr

from permway.campaign.campaign import Campaign
from permway.campaign.parts import Record
from permway.campaign.paths import parse_path, value_at
from permway.errors import InputError
from permway.laws.base import Law


def predicted(campaign: Campaign, record: Record, data: xr.Dataset) -> xr.Dataset:
    """The law at every point of a table, (point,), complex.

    Raises
    ------
    InputError
        For a law that the model does not have, or that needs a temperature the table does not give.
    """
    where = f"records.{record.name}.law"
    try:
        law = value_at(campaign.model, parse_path(str(record.law), where))
    except KeyError as error:
        raise InputError(f"leads to no law: {error.args[0]}", where=where, value=record.law) from error
    if not isinstance(law, Law):
        raise InputError("leads to no law", where=where, value=record.law)
    temperature = data["temperature_C"].values if "temperature_C" in data.coords else None
    frequency = np.asarray(data["frequency"].values, dtype=np.float64)
    return data["modulus"].copy(data=law.complex(frequency, temperature)).to_dataset(name="modulus")
