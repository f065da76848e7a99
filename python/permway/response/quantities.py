"""The same response as mobility or accelerance."""

from __future__ import annotations

import numpy as np
import xarray as xr


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
    factor = (2j * np.pi * receptance["frequency"]) ** order
    result = (factor * receptance).transpose(*receptance.dims).rename(name)
    result.attrs = {"long_name": name, "units": units}
    return result
