"""Figures 11 to 14: flexibility of wheel, track and bridge, contact, and their sum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from permway.arrays import Complexes
from permway.paper.figures.style import (
    PART,
    TEMPERATURE,
    both_conventions,
    celsius,
    hertz,
    line,
    logarithmic,
    mark_frequency,
    panels,
)
from permway.paper.printed import PRINTED, TEMPERATURES_C
from permway.paper.tables import ONE_LAW

Runs = Mapping[tuple[str, str], Mapping[int, xr.Dataset]]
MINIMUM_HZ = {r.temperature_C: r.value for r in PRINTED if r.quantity == "flexibility_minimum_Hz"}


def figure_11(runs: Runs) -> Any:
    """Amplitude and phase at 20 degC."""
    return _parts(runs, 20)


def figure_12(runs: Runs) -> Any:
    """Amplitude and phase at -20 degC."""
    return _parts(runs, -20)


def figure_13(runs: Runs) -> Any:
    """Amplitude and phase at -30 degC."""
    return _parts(runs, -30)


def figure_14(runs: Runs) -> Any:
    """Total flexibility at the three temperatures."""
    figure = panels(2, height=600)

    def draw(convention: str) -> Sequence[tuple[Any, int]]:
        traces = []
        for t in TEMPERATURES_C:
            data = runs[convention, ONE_LAW][t]
            traces += _pair(data, _at_wheel_1(data, "total"), celsius(t), TEMPERATURE[t])
        return traces

    both_conventions(figure, draw)
    for t, at in MINIMUM_HZ.items():
        mark_frequency(figure, at, f"{at:g}", TEMPERATURE[t], row=2, rows=2)
    return _axes(figure)


def _parts(runs: Runs, temperature_C: int) -> Any:
    figure = panels(2, height=600)

    def draw(convention: str) -> Sequence[tuple[Any, int]]:
        data = runs[convention, ONE_LAW][temperature_C]
        contact = np.full(data.sizes["frequency"], complex(data["contact_receptance"]))
        return [
            *_pair(data, _at_wheel_1(data, "wheel"), "wheel", PART["wheel"]),
            *_pair(data, _at_wheel_1(data, "track"), "track and bridge", PART["track and bridge"]),
            *_pair(data, contact, "contact", PART["contact"], dash="dash"),
            *_pair(data, _at_wheel_1(data, "total"), "total", TEMPERATURE[temperature_C], width=3),
        ]

    both_conventions(figure, draw)
    at = MINIMUM_HZ[temperature_C]
    mark_frequency(figure, at, f"printed minimum {at:g} Hz", "#6b717c", row=1, rows=2)
    return _axes(figure)


def _at_wheel_1(data: xr.Dataset, part: str) -> Complexes:
    return np.asarray(data[f"{part}_receptance"].sel(wheel="wheel1", wheel_force="wheel1").values)


def _pair(data: xr.Dataset, value: Complexes, name: str, colour: str, **more: Any) -> list[tuple[Any, int]]:
    f = data["frequency"].values
    degrees = np.degrees(np.angle(value))
    # At a driving point the phase lies in -180 to 0; rounding must not make it +180.
    degrees = np.where(degrees > 90.0, degrees - 360.0, degrees)
    shown = {"legendgroup": name, **more}
    return [
        (line(f, np.abs(value), name, colour, **shown), 1),
        (line(f, degrees, name, colour, **{**shown, "showlegend": False}), 2),
    ]


def _axes(figure: Any) -> Any:
    logarithmic(figure, 1, "flexibility, m/N")
    figure.update_yaxes(title_text="phase, degrees", range=[-190, 10], dtick=45, row=2, col=1)
    hertz(figure, 2)
    return figure
