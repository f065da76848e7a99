"""A train on the viaduct at 350 km/h: what a cold pad does to the wheel-rail force, by one-third octaves."""

from __future__ import annotations

import numpy as np
import permway
import xarray as xr
from look import axes, show
from matplotlib.figure import Figure
from permway.model.irregularity import GermanSato
from permway.recordings.estimates.bands import bands_between

FREQUENCY_HZ = np.arange(1.0, 400.0, 0.25)
BANDS = bands_between(4.0, 315.0)


def compute() -> xr.Dataset:
    """Spectra of train and line at 20 and at -30 degrees."""
    line = permway.slab_track_viaduct_32m()
    train = permway.Train(vehicle=permway.crh380a(share=0.5), centre_m=16.0, speed_m_per_s=350 / 3.6)
    both = [
        permway.train_response(line, train, GermanSato(), FREQUENCY_HZ, temperature_C=t)[
            ["wheel_rail_force_psd", "vehicle_acceleration_psd"]
        ]
        for t in (20.0, -30.0)
    ]
    return xr.concat(both, dim=xr.DataArray([20.0, -30.0], dims="temperature"))


def in_bands(density: xr.DataArray) -> np.ndarray:
    """Root mean square in each one-third octave, (temperature, band)."""
    step = FREQUENCY_HZ[1] - FREQUENCY_HZ[0]
    edges = BANDS.low_Hz[:, None], BANDS.high_Hz[:, None]
    inside = (edges[0] <= FREQUENCY_HZ) & (edges[1] > FREQUENCY_HZ)
    return np.sqrt(density.transpose("temperature", "frequency").values @ inside.T * step)


def numbers(found: xr.Dataset) -> dict[str, float]:
    """What the page quotes."""
    force = in_bands(found["wheel_rail_force_psd"].sel(wheel="wheel1"))
    middle = np.round(BANDS.nominal_Hz, 1)
    body = found["vehicle_acceleration_psd"].sel(degree="car1.body.bounce")
    comfort = np.sqrt(body.sel(frequency=slice(1.0, 20.0)).sum("frequency") * 0.25)
    return {
        "loudest band at 20 °C, Hz": float(middle[force[0].argmax()]),
        "force in it, kN": float(force[0].max() / 1e3),
        "loudest band at -30 °C, Hz": float(middle[force[1].argmax()]),
        "force in it at -30 °C, kN": float(force[1].max() / 1e3),
        "car body from 1 to 20 Hz at 20 °C, m/s2": float(comfort.sel(temperature=20.0)),
        "car body from 1 to 20 Hz at -30 °C, m/s2": float(comfort.sel(temperature=-30.0)),
    }


def picture(found: xr.Dataset) -> Figure:
    """One-third octaves of the force."""
    figure, (one,) = axes()
    force = in_bands(found["wheel_rail_force_psd"].sel(wheel="wheel1")) / 1e3
    for values, t in zip(force, found["temperature"].values, strict=True):
        one.step(BANDS.nominal_Hz, values, where="mid", label=f"{t:g} °C")
    one.set(
        xscale="log",
        xlabel="one-third octave, Hz",
        ylabel="wheel-rail force, kN rms",
        xticks=[4, 10, 31.5, 100, 315],
    )
    one.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    one.legend(frameon=False)
    return figure


if __name__ == "__main__":
    show(__file__, compute, numbers, picture)
