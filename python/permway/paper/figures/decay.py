"""Figure 15: the track's decay rate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from permway.paper.figures.flexibility import Runs
from permway.paper.figures.style import TEMPERATURE, both_conventions, celsius, hertz, line, panels
from permway.paper.printed import TEMPERATURES_C
from permway.paper.statements import track_decay
from permway.paper.tables import ONE_LAW


def figure_15(runs: Runs) -> Any:
    """Decay rate between contact points 1 and 3 (paper, equation (30))."""
    figure = panels(1, height=440)

    def draw(convention: str) -> Sequence[tuple[Any, int]]:
        data = runs[convention, ONE_LAW]
        return [
            (line(data[t]["frequency"].values, track_decay(data[t]), celsius(t), TEMPERATURE[t]), 1)
            for t in TEMPERATURES_C
        ]

    both_conventions(figure, draw)
    for low, high in ((0.0, 122.0), (181.0, 200.0)):
        figure.add_vrect(x0=low, x1=high, fillcolor="#8a8f98", opacity=0.09, line_width=0, layer="below")
    figure.update_yaxes(title_text="decay rate, dB/m")
    hertz(figure, 1)
    return figure
