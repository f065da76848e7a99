"""How the pictures of the examples look, and where they go."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

COLOURS = ("#c8553d", "#2a7bb0", "#26293b", "#6a994e", "#b08a2a")
DPI = 110


def axes(columns: int = 1, *, width: float = 7.2, height: float = 3.6) -> tuple[Figure, list[Axes]]:
    """A figure with axes side by side."""
    figure = Figure(figsize=(width, height), layout="constrained")
    found = list(np.atleast_1d(figure.subplots(1, columns)))
    for one in found:
        one.spines[["top", "right"]].set_visible(False)
        one.grid(color="0.91", linewidth=0.6)
        one.set_axisbelow(True)
        one.set_prop_cycle(color=COLOURS)
    return figure, found


def show(
    file: str,
    compute: Callable[[], Any],
    numbers: Callable[[Any], Mapping[str, float]],
    picture: Callable[[Any], Figure],
) -> None:
    """Print an example's numbers and draw its picture into the current folder."""
    found = compute()
    for name, value in numbers(found).items():
        print(f"{value:12.5g}  {name}")
    path = Path(f"{Path(file).stem}.png")
    picture(found).savefig(path, dpi=DPI, metadata={"Software": None})
    print(path)
