"""Pictures of mode shapes: a panel for each mode, a curve for each body."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from permway.arrays import Complexes, Reals
from permway.errors import must_be
from permway.files import prepare_folder, write_bytes

_WIDTH_IN, _ROW_IN, _TOP_IN = 6.3, 1.25, 0.55
_FONT = 8
_COLUMNS, _ROWS = 2, 6
"""Panels of a picture: more modes go into further ones."""

_COLOURS = ("#0a6fb4", "#c8431a", "#0b8f6b", "#c77800", "#7b4ea3", "#1d2433", "#8a8f98", "#c2558f")
_STYLES = ("-", "--", ":")
_THICK, _THINNER = 2.6, 0.72
"""Points, and the factor from body to body."""

_OUT_OF_PHASE = 0.05
"""Largest imaginary part that is not drawn."""


def draw_modes(data: xr.Dataset, folder: str | Path, *, dpi: int = 150) -> list[Path]:
    """Draw mode shapes, twelve a picture: `modes.png`, `modes-2.png` and so on.

    Down is down. A mode whose places do not move in phase has its part a quarter of a period later as a thin line.

    Parameters
    ----------
    data : Dataset
        From :func:`permway.modes`.
    folder : path
        Made if its parent exists.
    dpi : int
        Dots per inch; 300 for print.

    Returns
    -------
    list of Path
        None without modes.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    must_be(data, xr.Dataset, "data", remedy="as in draw_modes(permway.modes(line, 1.0, 60.0), folder)")
    many = _COLUMNS * _ROWS
    parts = [data.isel(mode=slice(i, i + many)) for i in range(0, data.sizes["mode"], many)]
    names = ["modes.png" if i == 0 else f"modes-{i + 1}.png" for i in range(len(parts))]
    prepare_folder(Path(folder), names)
    paths = []
    for name, part in zip(names, parts, strict=True):
        buffer = io.BytesIO()
        _figure(part).savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
        paths.append(write_bytes(Path(folder) / name, buffer.getvalue()))
    return paths


def _figure(data: xr.Dataset) -> Figure:
    count = data.sizes["mode"]
    columns = min(count, _COLUMNS)
    rows = -(-count // columns)
    figure = Figure(figsize=(_WIDTH_IN, _TOP_IN + _ROW_IN * rows), layout="constrained")
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    rows_of = [str(name).partition("[") for name in data["place_body"].values]
    bodies = list(dict.fromkeys(name for name, _, _ in rows_of))
    looks: dict[str, dict[str, Any]] = {
        # Later ones are thinner, so that curves which lie on each other are all seen.
        body: {
            "color": _COLOURS[i % len(_COLOURS)],
            "linestyle": _STYLES[i // len(_COLOURS) % len(_STYLES)],
            "linewidth": _THICK * _THINNER ** min(i, len(_COLOURS)),
        }
        for i, body in enumerate(bodies)
    }
    for index, axes in enumerate(panels.flat):
        if index >= count:
            axes.set_axis_off()
            # The one above has the axis then.
            panels.flat[index - columns].tick_params(labelbottom=True)
            panels.flat[index - columns].set_xlabel("x, m", fontsize=_FONT)
            continue
        _mode(axes, data.isel(mode=index), looks)
    for axes in panels[-1]:
        axes.set_xlabel("x, m", fontsize=_FONT)
    for axes in panels[:, 0]:
        axes.set_ylabel("shape, down", fontsize=_FONT)
    panels[0, 0].set_ylim(1.15, -1.15)
    handles = [Line2D([], [], label=body, **look) for body, look in looks.items()]
    figure.legend(
        handles=handles, loc="outside upper left", ncols=min(len(bodies), 6), frameon=False, fontsize=_FONT
    )
    return figure


def _mode(axes: Axes, mode: xr.Dataset, looks: dict[str, dict[str, Any]]) -> None:
    names = mode["place_body"].values.astype(str)
    x, shape = mode["place_x"].values, mode["shape"].values
    axes.axhline(0.0, color="0.8", linewidth=0.6, zorder=0)
    for name in dict.fromkeys(names):
        at = names == name
        look = looks[name.partition("[")[0]]
        _curve(axes, x[at], shape[at], look)
    frequency, damping = mode["natural_frequency"].item(), 100.0 * mode["damping_ratio"].item()
    axes.set_title(
        f"{mode['mode'].item()}:  {frequency:.5g} Hz,  ζ = {_percent(damping)}", fontsize=_FONT, loc="left", pad=3
    )
    axes.tick_params(labelsize=_FONT - 1)
    axes.set_yticks([-1, 0, 1], ["−1", "0", "1"])
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(x=0.02)


def _curve(axes: Axes, x: Reals, shape: Complexes, look: dict[str, Any]) -> None:
    if x.size == 1:
        axes.plot(x, shape.real, marker="o", markersize=2.5, color=look["color"])
        return
    axes.plot(x, shape.real, **look)
    if np.abs(shape.imag).max() > _OUT_OF_PHASE:
        axes.plot(x, shape.imag, **{**look, "linewidth": 0.6}, alpha=0.7)


def _percent(value: float) -> str:
    return f"{value:.1f} %" if value >= 1.0 else f"{value:.2g} %"
