"""The picture of a check: where sensors and points stand, and levels and phases against the model as it is."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from permway.arrays import Reals
from permway.checking.check import Checked
from permway.checking.compared import Compared
from permway.checking.deviations import levels_dB, phases_deg
from permway.checking.table import labels
from permway.files import prepare_folder, write_bytes
from permway.report.compare.looks import FONT, INK, colour_map, logarithmic_hertz, name_rows, plain
from permway.report.diagnosis.track import HALF, draw, drawing

PICTURE = "check.png"

MOST_DB = 30.0
"""Where the colours of levels end: g for m/s2 is 20 dB, and a thousand shows as it is."""

MOST_ROWS = 24
"""Rows of a record that are drawn; of more, evenly chosen ones. A row is 4 mm high."""

WIDTH_IN, ROW_IN, DRAWING_IN = 8.6, 0.17, 0.55


def draw_check(checked: Checked, folder: Path, *, dpi: int = 130) -> Path | None:
    """Draw `check.png`: the model with its sensors coloured by level, and of each record maps of level and phase.

    Parameters
    ----------
    checked : Checked
    folder : Path
        Made if its parent exists.
    dpi : int

    Returns
    -------
    Path or None
        None if no record can be compared with the model.
    """
    records = [(dataset.record.name, given) for dataset, given, _ in checked.records if given.used.any()]
    if not records:
        return None
    plan = drawing(checked.campaign)
    rows = [min(MOST_ROWS, max(int(one.levelled.sum()), int(one.phased.sum()), 3)) for _, one in records]
    heights = [0.4 + DRAWING_IN * plan.rows, *(0.55 + ROW_IN * count for count in rows)]
    figure = Figure(figsize=(WIDTH_IN, sum(heights) + 0.5), layout="constrained")
    top, *panels = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    axes = top.subplots()
    draw(axes, checked.campaign, plan, {})
    _coloured(axes, checked, plan.level)
    axes.set_xlabel("x, m", fontsize=FONT)
    axes.tick_params(axis="x", labelsize=FONT)
    axes.set_title(
        "median level, measured over predicted: circles are sensors, triangles are hammer points",
        fontsize=FONT + 0.5,
        loc="left",
    )
    for panel, (name, one) in zip(panels, records, strict=True):
        left, right = panel.subplots(1, 2)
        level = _map(left, one, levels_dB(one), one.levelled, MOST_DB)
        left.set_title(f"{name}: level, dB above the model", fontsize=FONT + 0.5, loc="left")
        panel.colorbar(level, ax=left, pad=0.01).ax.tick_params(labelsize=FONT - 1)
        if not one.phased.any():
            right.set_visible(False)
            continue
        phase = _map(right, one, phases_deg(one), one.phased, 180.0)
        right.set_title("phase, degrees ahead of the model", fontsize=FONT + 0.5, loc="left")
        phase.set_cmap(colormaps["twilight_shifted"].with_extremes(bad="0.8"))
        panel.colorbar(phase, ax=right, pad=0.01, ticks=[-180, -90, 0, 90, 180]).ax.tick_params(labelsize=FONT - 1)
    prepare_folder(folder, (PICTURE,))
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return write_bytes(folder / PICTURE, buffer.getvalue())


def _map(axes: Axes, one: Compared, values: Reals, rows: np.ndarray, limit: float) -> Any:
    chosen = np.unique(np.linspace(0, values.shape[0] - 1, min(MOST_ROWS, values.shape[0])).round().astype(int))
    names = np.array(labels(one, rows))[chosen].tolist()
    found = colour_map(axes, one.frequency_Hz, values[chosen], limit)
    logarithmic_hertz(axes, float(one.frequency_Hz[0]), float(one.frequency_Hz[-1]))
    plain(axes)
    name_rows(axes, names)
    axes.grid(visible=False)
    axes.tick_params(axis="y", labelsize=FONT - 1.5)
    axes.set_xlabel("frequency, Hz", fontsize=FONT)
    return found


def _coloured(axes: Axes, checked: Checked, level: object) -> None:
    """Sensors and points on the line, in the colour of their median level."""
    palette, scale = colormaps["RdBu_r"], Normalize(-MOST_DB, MOST_DB)
    campaign, heights = checked.campaign, dict(level)  # type: ignore[call-overload]
    medians: dict[tuple[str, str], list[float]] = {}
    for _, one, _ in checked.records:
        levels, names = levels_dB(one), [*one.channels, *one.points]
        for member, name in enumerate(names):
            mine = (one.first == member) | (one.second == member)
            seen = levels[mine[one.levelled]]
            if np.isfinite(seen).any():
                kind = "sensor" if member < len(one.channels) else "point"
                medians.setdefault((kind, name), []).append(float(np.nanmedian(seen)))
    for (kind, name), values in medians.items():
        place = campaign.sensor(name) if kind == "sensor" else campaign.point(name)
        at = heights.get(place.body or "")
        if at is None or place.x_m is None:
            continue
        mark, up = ("o", 0.0) if kind == "sensor" else ("v", HALF + 0.16)
        colour = palette(scale(float(np.median(values))))
        axes.plot([place.x_m], [at + up], mark, ms=6.5, mfc=colour, mec=INK, mew=1.0, zorder=8)
