"""The same response as mobility or accelerance."""

from __future__ import annotations

import numpy as np
import xarray as xr

from permway.errors import InputError


def mobility(receptance: xr.DataArray) -> xr.DataArray:
    """Velocity per force, i omega times receptance, m/s/N.

    Parameters
    ----------
    receptance : DataArray
        m/N, with a coordinate `frequency` in Hz.
    """
    return _derived(receptance, 1, "mobility", "m/s/N")


def accelerance(receptance: xr.DataArray) -> xr.DataArray:
    """Acceleration per force, -omega^2 times receptance, m/s2/N.

    Parameters
    ----------
    receptance : DataArray
        m/N, with a coordinate `frequency` in Hz.
    """
    return _derived(receptance, 2, "accelerance", "m/s2/N")


def _derived(receptance: xr.DataArray, order: int, name: str, units: str) -> xr.DataArray:
    if not isinstance(receptance, xr.DataArray):
        remedy = f'as in {name}(data["receptance"])'
        raise InputError(
            f"must be one variable, not a {type(receptance).__name__}", where="receptance", remedy=remedy
        )
    if "frequency" not in receptance.coords:
        remedy = "take it from an answer of permway.receptance or permway.solve"
        raise InputError("has no coordinate 'frequency'", where="receptance", value=receptance.dims, remedy=remedy)
    factor = (2j * np.pi * receptance["frequency"]) ** order
    result = (factor * receptance).transpose(*receptance.dims).rename(name)
    result.attrs = {"long_name": name, "units": units}
    return result
