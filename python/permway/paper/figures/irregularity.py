"""Figure 10: the irregularity's spectra over wavenumber and wavelength."""

from __future__ import annotations

from typing import Any

import numpy as np

from permway.arrays import Reals
from permway.model.irregularity import GermanLow, GermanSato, Sato
from permway.paper.figures.style import INK, PART, POWERS, TEMPERATURE, line, logarithmic, panels

WAVELENGTHS_M = (100.0, 30.0, 10.0, 3.0, 1.0, 0.3)


def figure_10() -> Any:
    """German low disturbance, as printed and right, Sato's, and what the paper's tables were computed with."""
    figure = panels(1, height=460)
    long, short = np.geomspace(2.0 * np.pi / 100.0, 2.0 * np.pi, 120), np.geomspace(2.0 * np.pi, 20.0 * np.pi, 60)
    whole = np.concatenate([long, short * (1.0 + 1e-6)])
    used = GermanSato(form="paper_eq28").wavenumber_density(whole)
    curves: tuple[tuple[Reals, Reals, str, str, dict[str, Any]], ...] = (
        (whole, used, "used by the paper", "#c9ced6", {"width": 8}),
        (
            long,
            GermanLow(form="paper_eq28").wavenumber_density(long),
            "German, (28) as printed",
            TEMPERATURE[20],
            {},
        ),
        (long, GermanLow().wavenumber_density(long), "German, right", TEMPERATURE[-20], {"dash": "dash"}),
        (short, Sato().wavenumber_density(short), "Sato, A in mm²", PART["wheel"], {}),
    )
    for x, y, name, colour, more in curves:
        figure.add_trace(
            line(
                x,
                y,
                name,
                colour,
                customdata=2.0 * np.pi / x,
                hovertemplate="%{x:.3g} rad/m (%{customdata:.3g} m): %{y:.3g}",
                **more,
            ),
            row=1,
            col=1,
        )
    ends = np.log10([2.0 * np.pi / 110.0, 20.0 * np.pi]).tolist()
    logarithmic(figure, 1, "density, m²/(rad/m)", step=2)
    figure.update_xaxes(range=ends, title_text="wavenumber, rad/m", **POWERS)
    # A second axis is drawn only for a curve on it; this one has no points.
    figure.add_scatter(x=[None], y=[None], xaxis="x2", showlegend=False)
    figure.update_layout(
        margin={"t": 62},
        xaxis2={
            "overlaying": "x",
            "side": "top",
            "type": "log",
            "range": ends,
            "tickvals": [2.0 * np.pi / w for w in WAVELENGTHS_M],
            "ticktext": [f"{w:g}" for w in WAVELENGTHS_M],
            "ticks": "outside",
            "ticklen": 4,
            "tickcolor": INK,
            "showgrid": False,
            "title": {"text": "wavelength, m", "standoff": 6},
        },
    )
    return figure
