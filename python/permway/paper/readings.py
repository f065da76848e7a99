"""What is read off a response for the paper's tables."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals

PEAK_BAND_HZ = (40.0, 130.0)
"""Where the paper's wheel-track peaks lie."""
MINIMUM_BAND_HZ = (30.0, 150.0)


@dataclass(frozen=True)
class Extremum:
    """A maximum or minimum on the grid, and between its points by a parabola."""

    value: float
    at_Hz: float
    smooth_value: float
    smooth_at_Hz: float


def extremum(frequency: Reals, values: Reals, band: tuple[float, float], *, lowest: bool = False) -> Extremum:
    """The highest (or lowest) value of a positive curve in a band.

    The parabola goes through the logarithms at the extremum and its neighbours, on an even grid.
    """
    inside = np.flatnonzero((frequency >= band[0]) & (frequency <= band[1]))
    curve = np.log(values[inside])
    at = int(np.argmin(curve) if lowest else np.argmax(curve))
    shift, top = 0.0, float(curve[at])
    if 0 < at < inside.size - 1:
        before, here, after = curve[at - 1 : at + 2]
        bend = before - 2.0 * here + after
        if bend != 0.0:
            shift = float(np.clip(0.5 * (before - after) / bend, -0.5, 0.5))
            top = float(here - 0.25 * (before - after) * shift)
    index = int(inside[at])
    step = float(frequency[1] - frequency[0])
    return Extremum(
        float(values[index]), float(frequency[index]), float(np.exp(top)), float(frequency[index] + shift * step)
    )


@dataclass(frozen=True)
class Curves:
    """Curves over frequency that the tables are read from, shape (F,) each.

    Attributes
    ----------
    force : modulus of the force under wheel 1, N
    wheelset, rail : acceleration densities at wheel 1, (m/s2)2/Hz
    total : modulus of wheel + track + contact receptance at wheel 1, m/N
    """

    frequency: Reals
    force: Reals
    wheelset: Reals
    rail: Reals
    total: Reals

    @classmethod
    def of(cls, data: xr.Dataset) -> Curves:
        """From a train's response."""
        return cls(
            frequency=data["frequency"].values,
            force=np.sqrt(data["wheel_rail_force_psd"].sel(wheel="wheel1").values),
            wheelset=data["vehicle_acceleration_psd"].sel(degree="car1.wheelset1").values,
            rail=data["line_acceleration_psd"].sel(place="wheel1").values,
            total=np.abs(data["total_receptance"].sel(wheel="wheel1", wheel_force="wheel1").values),
        )


def readings(data: xr.Dataset, at_Hz: dict[str, list[float]]) -> dict[tuple[str, float | None], float]:
    """Every quantity of the tables.

    Parameters
    ----------
    data : Dataset
        From :func:`permway.response.train.train_response` on the whole-hertz grid.
    at_Hz : dict of quantity to frequencies
        Where `body_bounce` and `body_pitch` are wanted.

    Returns
    -------
    dict
        (quantity, frequency or None) to value. Peak values are the peak's own, at its own frequency.
    """
    curves = Curves.of(data)
    f = curves.frequency
    found: dict[tuple[str, float | None], float] = {}
    for name, values in (("force", curves.force), ("wheelset", curves.wheelset), ("rail", curves.rail)):
        peak = extremum(f, values, PEAK_BAND_HZ)
        found[name, None], found[f"{name}_peak_Hz", None] = peak.value, peak.at_Hz
    found["flexibility_minimum_Hz", None] = extremum(f, curves.total, MINIMUM_BAND_HZ, lowest=True).at_Hz
    track: Complexes = data["track_receptance"].sel(wheel="wheel1", wheel_force="wheel1").values
    found["bridge_peak_Hz", None] = extremum(f, np.abs(track), (2.0, 15.0)).at_Hz
    acceleration = data["vehicle_acceleration_psd"]
    for quantity, degree in (("body_bounce", "car1.body.bounce"), ("body_pitch", "car1.body.pitch")):
        for frequency in at_Hz.get(quantity, []):
            found[quantity, frequency] = float(acceleration.sel(degree=degree, frequency=frequency))
    return found
