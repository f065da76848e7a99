"""Figures 16 to 18: wheel-rail force and accelerations, with the printed peaks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from permway.arrays import Reals
from permway.paper.conventions import PAPER, RIGHT
from permway.paper.figures.flexibility import Runs
from permway.paper.figures.style import (
    TEMPERATURE,
    both_conventions,
    celsius,
    hertz,
    line,
    logarithmic,
    panels,
    points,
)
from permway.paper.printed import PRINTED, TEMPERATURES_C
from permway.paper.readings import Curves
from permway.paper.tables import ONE_LAW

Reader = Callable[[xr.Dataset], Reals]


def figure_16(runs: Runs) -> Any:
    """Amplitude of the wheel-rail force under wheel 1, with the peaks of Table 5."""
    figure = _figure(runs, [(lambda data: Curves.of(data).force, "force", "Table 5")], height=460)
    logarithmic(figure, 1, "force, N")
    # The paper's force is the root of a density over wavenumber, called N; the right one is per root hertz.
    buttons = figure.layout.updatemenus[0].buttons
    for button, title in zip(buttons, ("force, N", "force, N/√Hz"), strict=True):
        button.args = [button.args[0], {"yaxis.title.text": title}]
    return figure


def figure_17(runs: Runs) -> Any:
    """Densities of the car body's bounce and pitch acceleration, with the peaks of Table 6."""
    figure = _figure(
        runs,
        [(_body("bounce"), "body_bounce", "Table 6"), (_body("pitch"), "body_pitch", "Table 6")],
        height=620,
    )
    # Where the wheels' lags cancel, nothing is left but rounding; the axis does not follow it there.
    logarithmic(figure, 1, "bounce, (m/s²)²/Hz", decades=(-12.0, 0.5), step=2)
    logarithmic(figure, 2, "pitch, (rad/s²)²/Hz", decades=(-12.0, -1.0), step=2)
    return figure


def figure_18(runs: Runs) -> Any:
    """Densities of wheelset's and rail's acceleration at wheel 1, with the peaks of Tables 7 and 8."""
    figure = _figure(
        runs,
        [
            (lambda data: Curves.of(data).wheelset, "wheelset", "Tables 7 and 8"),
            (lambda data: Curves.of(data).rail, "rail", "Tables 7 and 8"),
        ],
        height=620,
    )
    logarithmic(figure, 1, "wheelset, (m/s²)²/Hz")
    logarithmic(figure, 2, "rail, (m/s²)²/Hz", step=2)
    return figure


def _figure(runs: Runs, readers: Sequence[tuple[Reader, str, str]], *, height: int) -> Any:
    figure = panels(len(readers), height=height)

    def draw(convention: str) -> Sequence[tuple[Any, int]]:
        traces = []
        for row, (read, quantity, table) in enumerate(readers, start=1):
            for t in TEMPERATURES_C:
                data = runs[convention, ONE_LAW][t]
                curve = line(
                    data["frequency"].values,
                    read(data),
                    celsius(t),
                    TEMPERATURE[t],
                    legendgroup=str(t),
                    showlegend=row == 1,
                )
                traces.append((curve, row))
            # The printed values are of the paper's convention and have no place beside the right one.
            if convention == PAPER.name:
                traces.append((_printed(quantity, f"printed, {table}", first=row == 1), row))
        return traces

    both_conventions(figure, draw, {PAPER.name: {}, RIGHT.name: {}})
    hertz(figure, len(readers))
    return figure


def _printed(quantity: str, name: str, *, first: bool) -> Any:
    rows = [r for r in PRINTED if r.quantity == quantity]
    return points(
        [r.at_Hz for r in rows],
        [r.value for r in rows],
        name,
        [TEMPERATURE[r.temperature_C] for r in rows],
        legendgroup="printed",
        showlegend=first,
        customdata=[celsius(r.temperature_C) for r in rows],
        hovertemplate="%{customdata}: %{y:.4g} at %{x:g} Hz",
    )


def _body(motion: str) -> Reader:
    def read(data: xr.Dataset) -> Reals:
        return np.asarray(data["vehicle_acceleration_psd"].sel(degree=f"car1.body.{motion}").values)

    return read
