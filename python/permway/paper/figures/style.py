"""What all figures share: colours, axes, and the choice between the paper's convention and the right one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import plotly.graph_objects as go
from plotly.subplots import make_subplots

from permway.paper.conventions import PAPER, RIGHT

TEMPERATURE = {20: "#c8431a", -20: "#0a6fb4", -30: "#1d2433"}
"""Warm to cold; distinguished with any colour vision, and by lightness in grey."""
PART = {"wheel": "#0b8f6b", "track and bridge": "#c77800", "contact": "#8a8f98"}
# Plotly enlarges powers of ten by a quarter.
POWERS: dict[str, Any] = {"type": "log", "dtick": 1, "exponentformat": "power", "tickfont": {"size": 10}}
INK, GRID = "#20242c", "#e3e6ea"
_FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, 'Liberation Sans', sans-serif"

SHOWN = ((PAPER.name, "as the paper computed"), (RIGHT.name, "right convention"))
"""Conventions that a figure can show, and what their buttons say."""


def celsius(temperature_C: float) -> str:
    """Temperature in words, with a true minus."""
    return f"{temperature_C:g} °C".replace("-", "−")


def panels(rows: int, *, height: int, shared: bool = True) -> Any:
    """Empty panels below each other over one horizontal axis."""
    figure = make_subplots(rows=rows, cols=1, shared_xaxes=shared, vertical_spacing=0.07 if shared else 0.13)
    return dress(figure, height=height)


def dress(figure: Any, *, height: int) -> Any:
    """Paper-like looks: white, thin grid, legend below."""
    figure.update_layout(
        template="none",
        height=height,
        font={"family": _FONT, "size": 13, "color": INK},
        paper_bgcolor="white",
        plot_bgcolor="white",
        margin={"l": 62, "r": 14, "t": 34, "b": 78},
        legend={
            "orientation": "h",
            "x": 0.0,
            "y": 0.0,
            "yref": "container",
            "yanchor": "bottom",
            "font": {"size": 12},
        },
        hoverlabel={"font": {"size": 12}, "namelength": -1},
    )
    axis = {
        "gridcolor": GRID,
        "linecolor": INK,
        "linewidth": 1,
        "mirror": True,
        "showline": True,
        "ticks": "outside",
        "ticklen": 4,
        "zeroline": False,
        "tickfont": {"size": 12},
        "title": {"standoff": 8},
        "automargin": True,
    }
    figure.update_xaxes(**axis)
    figure.update_yaxes(**axis)
    return figure


def hertz(figure: Any, row: int, *, to: float = 200.0) -> None:
    """Give the lowest panel its frequency axis, linear as in the paper; the others follow it."""
    figure.update_xaxes(range=[0, to])
    figure.update_xaxes(title_text="frequency, Hz", row=row, col=1)


def logarithmic(
    figure: Any, row: int, title: str, *, decades: tuple[float, float] | None = None, step: int = 1
) -> None:
    """A logarithmic vertical axis with its powers of ten written out."""
    figure.update_yaxes(title_text=title, range=decades, row=row, col=1, **{**POWERS, "dtick": step})


def both_conventions(
    figure: Any,
    draw: Callable[[str], Sequence[tuple[Any, int]]],
    layouts: dict[str, dict[str, Any]] | None = None,
) -> Any:
    """Draw a figure under the paper's convention and under the right one, with buttons to choose.

    Parameters
    ----------
    figure : plotly Figure
    draw : callable
        Convention's name to traces with their rows.
    layouts : dict, optional
        Convention's name to what else of the layout changes with it.
    """
    figure_of: list[str] = []
    for name, _ in SHOWN:
        for trace, row in draw(name):
            trace.visible = name == SHOWN[0][0]
            figure.add_trace(trace, row=row, col=1)
            figure_of.append(name)
    figure.update_layout(
        margin={"t": 46},
        updatemenus=[
            {
                "type": "buttons",
                "direction": "right",
                "showactive": True,
                "active": 0,
                "x": 0.0,
                "xanchor": "left",
                "y": 1.0,
                "yanchor": "bottom",
                "pad": {"b": 8, "l": 0},
                "bgcolor": "white",
                "bordercolor": "#b7bcc4",
                "font": {"size": 12},
                "buttons": [
                    {
                        "label": label,
                        "method": "update",
                        "args": [{"visible": [o == name for o in figure_of]}, (layouts or {}).get(name, {})],
                    }
                    for name, label in SHOWN
                ],
            }
        ],
    )
    return figure


def line(x: Any, y: Any, name: str, colour: str, **more: Any) -> Any:
    """A curve. `dash`, `width`, and whatever a trace takes."""
    look = {"color": colour, "width": more.pop("width", 2), "dash": more.pop("dash", "solid"), "simplify": False}
    return go.Scatter(x=x, y=y, name=name, mode="lines", line=look, **more)


def points(x: Any, y: Any, name: str, colour: Any, **more: Any) -> Any:
    """Printed values: open diamonds."""
    mark = {"symbol": "diamond-open", "size": 11, "color": colour, "line": {"width": 2.2}}
    return go.Scatter(x=x, y=y, name=name, mode="markers", marker=mark, **more)


def mark_frequency(figure: Any, at: float, text: str, colour: str, *, row: int = 1, rows: int = 1) -> None:
    """A thin vertical line through all panels, with its words in one of them."""
    for panel in range(1, rows + 1):
        words: dict[str, Any] = {}
        if panel == row:
            words = {
                "annotation_text": text,
                "annotation_position": "top right",
                "annotation_font": {"size": 12, "color": colour},
            }
        figure.add_vline(x=at, line={"color": colour, "width": 1, "dash": "dot"}, row=panel, col=1, **words)
