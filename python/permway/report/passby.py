"""Picture of a passage at one sensor: time history above, one-third octaves below."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

_FONT = 8
_LOOKS = {
    "total": ("#1d2433", 0.7, 1.0),
    "dynamic": ("#0a6fb4", 1.4, 1.0),
    "quasi_static": ("#c8431a", 1.2, 1.0),
}
"""Colour, width and opacity of each part; drawn in this order."""
_WORDS = {"total": "total", "dynamic": "irregularity", "quasi_static": "static loads"}
_UNITS = {"m": (1e3, "mm"), "m/s": (1e3, "mm/s"), "m/s2": (1.0, "m/s²")}
_QUIET_DB = 60.0
"""Bands this far below the loudest are not drawn."""


def passage(data: xr.Dataset, sensor: str) -> Figure:
    """Draw history and one-third octaves of one sensor.

    Parameters
    ----------
    data : Dataset
        From :func:`permway.problem.solve.solve` of a model with a passage, or, its names without `passby_`, from
        :func:`permway.response.passby.run.passby`.
    sensor : str
        Its label.
    """
    prefix = "passby_" if "passby_history" in data else ""
    chosen = data.sel(sensor=sensor)
    history, level = chosen[f"{prefix}history"], chosen[f"{prefix}band_level"]
    factor, unit = _UNITS[str(history.attrs["units"])]
    figure = Figure(figsize=(6.3, 5.0), layout="constrained")
    upper, lower = figure.subplots(2, 1, height_ratios=(1, 1))
    parts = [str(p) for p in data["part"].values]
    for part in (p for p in _LOOKS if p in parts):
        colour, width, opacity = _LOOKS[part]
        label = _WORDS[part]
        if part != "dynamic":
            curve = factor * history.sel(part=part)
            upper.plot(data["time"], curve, color=colour, linewidth=0.8, alpha=opacity, label=label)
        _bands(lower, data, level.sel(part=part).values, colour, width, label)
    upper.set(xlabel="time from the first wheel's entry, s", ylabel=f"{history.attrs['long_name']}, {unit}")
    upper.set_xlim(*_shown(data["time"].values, history.sel(part=parts[-1]).values))
    upper.set_title(sensor, fontsize=_FONT + 1, loc="left")
    lower.set(
        xscale="log",
        xlabel="one-third octave, Hz",
        ylabel=str(level.attrs["long_name"]).replace(", re", "\ndB re"),
    )
    lower.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    lower.xaxis.set_minor_formatter(lambda x, _: f"{x:g}" if f"{x:e}"[0] in "25" else "")
    loudest = float(np.max(level.values)) if level.size else 0.0
    if np.isfinite(loudest):
        lower.set_ylim(loudest - _QUIET_DB, loudest + 5.0)
    for axes in (upper, lower):
        axes.tick_params(labelsize=_FONT, which="both")
        axes.xaxis.label.set_fontsize(_FONT + 1)
        axes.yaxis.label.set_fontsize(_FONT + 1)
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="0.9", linewidth=0.5)
        axes.set_axisbelow(True)
    if len(parts) > 1:
        lower.legend(fontsize=_FONT - 1, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
        upper.legend(fontsize=_FONT - 1, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def _bands(axes: Axes, data: xr.Dataset, level: np.ndarray, colour: str, width: float, label: str) -> None:
    """Levels as steps from edge to edge of the bands."""
    edges = np.append(data["band_lower"].values, data["band_upper"].values[-1:])
    if level.size:
        axes.stairs(level, edges, baseline=None, color=colour, linewidth=width, label=label)


def _shown(time: np.ndarray, history: np.ndarray) -> tuple[float, float]:
    """From first to last value above a hundredth of the largest, and a twentieth on either side."""
    loud = np.flatnonzero(np.abs(history) > 0.01 * np.abs(history).max(initial=0.0))
    if not loud.size:
        return float(time[0]), float(time[-1])
    first, last = float(time[loud[0]]), float(time[loud[-1]])
    margin = 0.05 * max(last - first, 1e-3)
    return max(first - margin, float(time[0])), min(last + margin, float(time[-1]))
