"""What the pictures of a comparison share: colours, axes, maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, NullLocator

from permway.arrays import Reals
from permway.diagnosis.compare import CLEAN, RAW, RECALIBRATED

FONT = 8
INK, MEASURED = "#20242c", "#20242c"
COLOUR = {RAW: "#c77800", RECALIBRATED: "#0a6fb4", CLEAN: "#0b8f6b"}
NAME = {RAW: "nominal values", RECALIBRATED: "recalibrated", CLEAN: "recalibrated,\nsmooth errors taken out"}
"""What pictures call the models."""

UNITS = {
    "(m/s2)/N": "(m/s²)/N",
    "(m/s)/N": "(m/s)/N",
    "(m)/N": "m/N",
    "(N)/N": "N/N",
    "(m/s2)2/Hz": "(m/s²)²/Hz",
    "(m/s)2/Hz": "(m/s)²/Hz",
    "(m)2/Hz": "m²/Hz",
    "(N)2/Hz": "N²/Hz",
    "1": "",
}


def plain(axes: Axes) -> None:
    """Thin axes and small type."""
    axes.tick_params(labelsize=FONT, which="both")
    axes.xaxis.label.set_fontsize(FONT + 0.5)
    axes.yaxis.label.set_fontsize(FONT + 0.5)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="0.9", linewidth=0.5)
    axes.set_axisbelow(True)


def logarithmic_hertz(axes: Axes, low: float, high: float) -> None:
    """A logarithmic frequency axis with plain numbers at 1, 2 and 5."""
    if high <= low:
        low, high = low / 1.1, high * 1.1
    axes.set_xscale("log")
    axes.set_xlim(low, high)
    steps = (1.0, 2.0, 5.0) if high / low <= 300.0 else (1.0,)
    decades = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    ticks = [step * 10.0**d for d in decades for step in steps if low <= step * 10.0**d <= high * (1.0 + 1e-9)]
    # Ticks that are given, and not sought, draw several times faster.
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    axes.xaxis.set_minor_locator(NullLocator())


def edges(frequency_Hz: Reals) -> Reals:
    """Borders between ascending frequencies on a logarithmic axis."""
    if frequency_Hz.size == 1:
        return np.asarray(frequency_Hz[0] * np.array([10.0**-0.05, 10.0**0.05]))
    logs = np.log(frequency_Hz)
    middle = 0.5 * (logs[1:] + logs[:-1])
    whole = np.concatenate([[2.0 * logs[0] - middle[0]], middle, [2.0 * logs[-1] - middle[-1]]])
    return np.asarray(np.exp(whole))


def colour_map(axes: Axes, frequency_Hz: Reals, values: Reals, limit: float, *, first_row: int = 0) -> Any:
    """Rows of signed values on one diverging scale, white at 0, grey where there are none."""
    palette = colormaps["RdBu_r"].with_extremes(bad="0.8")
    rows = first_row + np.arange(values.shape[0] + 1)
    return axes.pcolormesh(
        edges(frequency_Hz),
        rows,
        np.ma.masked_invalid(values),
        cmap=palette,
        vmin=-limit,
        vmax=limit,
        rasterized=True,
    )


def name_rows(axes: Axes, labels: Sequence[str]) -> None:
    """Rows' names from top to bottom; equal neighbours are one group with its name in the middle."""
    starts = [i for i, label in enumerate(labels) if i == 0 or label != labels[i - 1]]
    stops = [*starts[1:], len(labels)]
    axes.set_ylim(len(labels), 0)
    axes.set_yticks([0.5 * (a + b) for a, b in zip(starts, stops, strict=True)], [labels[a] for a in starts])
    axes.tick_params(axis="y", length=0, labelsize=FONT if len(starts) <= 30 else FONT - 2)
    if len(starts) < len(labels):
        for start in starts[1:]:
            axes.axhline(start, color=INK, linewidth=0.6)
