"""The rail's flexibility over one span of a viaduct, from 1 to 1000 Hz, in warmth and frost."""

from __future__ import annotations

import numpy as np
import permway
import xarray as xr
from look import axes, show
from matplotlib.figure import Figure

TEMPERATURES_C = (20.0, -20.0, -30.0)
FREQUENCY_HZ = np.geomspace(1.0, 1000.0, 600)


def compute() -> xr.DataArray:
    """Receptance at midspan, m/N, over temperature and frequency."""
    line = permway.slab_track_viaduct_32m(girder="elastic_bearings")
    rail = permway.Place(body="rail", x_m=16.0)
    sweeps = [
        permway.receptance(line, FREQUENCY_HZ, forces=[rail], sensors=[rail], temperature_C=t)["receptance"]
        for t in TEMPERATURES_C
    ]
    found = xr.concat(sweeps, dim=xr.DataArray(list(TEMPERATURES_C), dims="temperature"))
    return found.isel(sensor=0, force=0)


def numbers(found: xr.DataArray) -> dict[str, float]:
    """What the page quotes."""
    size = abs(found)
    first = size.sel(temperature=20.0, frequency=slice(2.0, 10.0))
    quoted = {"girder's first resonance, Hz": float(first.idxmax("frequency"))}
    at_100 = size.interp(frequency=100.0)
    for t in TEMPERATURES_C:
        quoted[f"receptance at 100 Hz and {t:g} °C, nm/N"] = 1e9 * float(at_100.sel(temperature=t))
    return quoted


def picture(found: xr.DataArray) -> Figure:
    """Moduli."""
    figure, (left,) = axes()
    for t in TEMPERATURES_C:
        left.loglog(found["frequency"], abs(found.sel(temperature=t)), label=f"{t:g} °C")
    left.set(xlabel="frequency, Hz", ylabel="receptance of the rail, m/N")
    left.legend(frameon=False)
    return figure


if __name__ == "__main__":
    show(__file__, compute, numbers, picture)
