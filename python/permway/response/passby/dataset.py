"""What a pass gives, labelled."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from permway.arrays import Complexes, Reals
from permway.model.passby import Quantity
from permway.model.place import Place
from permway.response.passby.bands import REFERENCES, band_energy, one_third_octaves
from permway.response.passby.rough import Realisation
from permway.response.passby.window import FLAT, Window
from permway.response.receptance import frequency_coordinate

BAND_WIDTH = 10.0**0.05 - 10.0**-0.05
"""Of a one-third octave, over its centre."""

_UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}


def labelled(
    spectra: Complexes,
    history: Reals,
    window: Window,
    record: Realisation | None,
    sensors: Sequence[Place],
    quantity: Quantity,
    averaging_s: float,
) -> xr.Dataset:
    """The dataset of a pass, with names, units and one-third octaves."""
    unit = _UNITS[quantity]
    compound = unit if "/" not in unit else f"({unit})"
    energy = 2.0 * np.abs(spectra) ** 2
    middle, lower, upper = one_third_octaves(
        window.step_Hz / BAND_WIDTH * 10.0**-0.05, (window.lines - 1) * window.step_Hz * FLAT
    )
    rms = np.sqrt(np.maximum(band_energy(energy, window.step_Hz, lower, upper), 0.0) / averaging_s)
    with np.errstate(divide="ignore"):
        level = 20.0 * np.log10(rms / REFERENCES[quantity])
    data = xr.Dataset(
        coords={
            "part": ["quasi_static", "dynamic", "total"][: spectra.shape[0]],
            "sensor": [s.label for s in sensors],
            "sensor_body": ("sensor", [s.body for s in sensors]),
            "sensor_x": ("sensor", [s.x_m for s in sensors], {"units": "m"}),
            "time": ("time", window.time, {"long_name": "time from the first wheel's entry", "units": "s"}),
            "frequency": frequency_coordinate(window.frequency),
            "band": ("band", middle, {"long_name": "one-third octave, exact middle", "units": "Hz"}),
            "band_lower": ("band", lower, {"units": "Hz"}),
            "band_upper": ("band", upper, {"units": "Hz"}),
        }
    )
    for name, axis, values, units, words in (
        ("history", "time", history, unit, quantity),
        ("spectrum", "frequency", spectra, f"{compound}/Hz", f"transform of {quantity}"),
        ("energy", "frequency", energy, f"{compound}2 s/Hz", f"one-sided energy density of {quantity}"),
        ("band_rms", "band", rms, unit, f"r.m.s. {quantity} in one-third octaves"),
        (
            "band_level",
            "band",
            level,
            "dB",
            f"{quantity} level, re 1e{round(np.log10(REFERENCES[quantity]))} {unit}",
        ),
    ):
        data[name] = (("part", "sensor", axis), values, {"long_name": words, "units": units})
    if record is not None:
        force = np.stack(
            [course(np.mod(window.time + window.lead_s, record.length_s)) for course in record.courses()]
        )
        names = [f"wheel{i + 1}" for i in range(force.shape[0])]
        data.coords["wheel"] = names
        data["wheel_force"] = (("wheel", "time"), force, {"long_name": "dynamic wheel-rail force", "units": "N"})
    return data
