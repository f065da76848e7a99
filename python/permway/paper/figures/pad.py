"""Figures 7 to 9: the pad's law over temperature and frequency."""

from __future__ import annotations

from typing import Any

import numpy as np
import plotly.graph_objects as go

from permway.arrays import Reals
from permway.laws import AnyLaw
from permway.paper.figures.style import (
    INK,
    POWERS,
    TEMPERATURE,
    dress,
    line,
    logarithmic,
    mark_frequency,
    panels,
    points,
)
from permway.paper.printed import GLASS_TRANSITION_C, LOSS_FACTOR_PEAK, LOSS_MODULUS_PEAK_C
from permway.paper.reproduce import table_1_pair

TEST_HZ = 2.0
"""Frequency of the paper's DMA test."""
IDENTIFIED_C = (-30.0, 20.0)
"""Between these temperatures the law is held by the tables."""
SCALED_AT_HZ = 55.0
"""Where the law is made equal to Table 1: the tables hold it there at 20 degC."""


def figure_7(law: AnyLaw) -> Any:
    """Stiffness and loss factor at 2 Hz over temperature, with the facts that the paper prints of its test."""
    figure = panels(2, height=560)
    t = np.arange(-60.0, 40.5, 0.5)
    value = np.array([law.complex(TEST_HZ, float(x))[()] for x in t])
    inside = (t >= IDENTIFIED_C[0]) & (t <= IDENTIFIED_C[1])
    curves = (
        (value.real / 1e6, "storage", TEMPERATURE[-20], 1),
        (value.imag / 1e6, "loss", TEMPERATURE[20], 1),
        (value.imag / value.real, "loss factor", INK, 2),
    )
    for y, name, colour, row in curves:
        figure.add_trace(line(t[inside], y[inside], f"{name}, identified", colour), row=row, col=1)
        for part in (t <= IDENTIFIED_C[0], t >= IDENTIFIED_C[1]):
            figure.add_trace(
                line(t[part], y[part], f"{name}, extrapolated", colour, dash="dot", showlegend=False),
                row=row,
                col=1,
            )
    figure.add_trace(
        points([GLASS_TRANSITION_C], [LOSS_FACTOR_PEAK], "loss factor's peak, printed", TEMPERATURE[20]),
        row=2,
        col=1,
    )
    mark_frequency(figure, LOSS_MODULUS_PEAK_C, "loss modulus peaks, printed", "#6b717c", row=1, rows=1)
    logarithmic(figure, 1, "stiffness, MN/m")
    figure.update_yaxes(title_text="loss factor", rangemode="tozero", row=2, col=1)
    figure.update_xaxes(range=[-60, 40])
    figure.update_xaxes(title_text="temperature, °C", row=2, col=1)
    return figure


def figure_8(law: AnyLaw) -> Any:
    """Table 1's curves at 20 degC beside the identified law, scaled to them at one frequency."""
    figure = panels(2, height=560)
    f = np.geomspace(1.0, 1e4, 161)
    printed = table_1_pair().complex(f)
    scale = float(table_1_pair().complex(SCALED_AT_HZ)[()].real / law.complex(SCALED_AT_HZ, 20.0)[()].real)
    own = scale * law.complex(f, 20.0)
    colours = {"storage": TEMPERATURE[-20], "loss": TEMPERATURE[20], "loss factor": INK}
    for kind, value, dash in (("Table 1", printed, "dash"), ("identified", own, "solid")):
        for name, y, row in (
            ("storage", value.real, 1),
            ("loss", value.imag, 1),
            ("loss factor", value.imag / value.real, 2),
        ):
            figure.add_trace(line(f, y, f"{name}, {kind}", colours[name], dash=dash), row=row, col=1)
    logarithmic(figure, 1, "modulus, MPa")
    logarithmic(figure, 2, "loss factor")
    figure.update_xaxes(**POWERS)
    figure.update_xaxes(title_text="frequency, Hz", row=2, col=1)
    return figure


def figure_9_storage(law: AnyLaw) -> Any:
    """Storage stiffness over temperature and frequency."""
    f, t, value = _grid(law)
    return _map(f, t, value.real / 1e6, "MN/m")


def figure_9_loss_factor(law: AnyLaw) -> Any:
    """Loss factor over temperature and frequency."""
    f, t, value = _grid(law)
    return _map(f, t, value.imag / value.real, "")


def _grid(law: AnyLaw) -> tuple[Reals, Reals, Any]:
    f, t = np.linspace(1.0, 200.0, 50), np.linspace(*IDENTIFIED_C, 41)
    return f, t, law.complex(f[None, :], t[:, None])


def _map(f: Reals, t: Reals, z: Reals, unit: str) -> Any:
    """Lines of equal value, labelled; a surface in space would need WebGL, which not every browser has."""
    figure = dress(
        go.Figure(
            go.Contour(
                x=f,
                y=t,
                z=z,
                colorscale="Viridis",
                ncontours=14,
                contours={"showlabels": True, "labelfont": {"size": 11, "color": "white"}},
                line={"width": 0.7, "color": "rgba(255,255,255,0.6)"},
                colorbar={"title": {"text": unit}, "thickness": 12, "outlinewidth": 0, "tickfont": {"size": 11}},
                hovertemplate="%{x:.0f} Hz, %{y:.0f} °C: %{z:.3g}<extra></extra>",
            )
        ),
        height=400,
    )
    figure.update_layout(margin={"b": 52})
    figure.update_xaxes(title_text="frequency, Hz")
    figure.update_yaxes(title_text="temperature, °C")
    return figure
