"""Measured and predicted curves, each with its 95 % interval."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from permway.campaign.campaign import Campaign
from permway.campaign.compare import NEPER_DB, POWER_DB, POWERS
from permway.campaign.kinds import KINDS
from permway.diagnosis.compare import Comparison
from permway.report.compare.looks import COLOUR, FONT, MEASURED, NAME, UNITS, logarithmic_hertz, plain
from permway.report.compare.maps import UNSEEN_DB, groups
from permway.report.compare.writing import file_name

MOST_PANELS = 24
"""Tables of more channels than this are drawn in several pictures."""

FEW_POINTS = 30
"""Up to so many, measured values are points with bars, not a curve with a band."""

REACH = 1.96


def nearest_points(campaign: Campaign, record: xr.Dataset) -> list[int]:
    """Of frequency responses the channel of every sensor whose force fell nearest, on its own body if any did."""
    sensors, forces = record["sensor"].values.astype(str), record["force"].values.astype(str)
    measured = np.isfinite(record["measured"].values).any(axis=-1)

    def far(channel: int) -> tuple[bool, float]:
        sensor, point = campaign.sensor(str(sensors[channel])), campaign.point(str(forces[channel]))
        return sensor.body != point.body, abs(float(sensor.x_m or 0.0) - point.x_m)

    chosen = []
    for sensor in dict.fromkeys(sensors):
        mine = [int(i) for i in np.flatnonzero((sensors == sensor) & measured)]
        if mine:
            chosen.append(min(mine, key=far))
    return chosen


def curve_pictures(comparison: Comparison) -> Iterator[tuple[str, Figure]]:
    """A picture for each sensor of a hammer test, for each run, and for all tables of a kind."""
    for name, members in groups(comparison):
        record = comparison.records[members[0]]
        statistic = record.attrs["statistic"]
        if statistic == "frf":
            for channel in nearest_points(comparison.campaign, record):
                sensor = file_name(str(record["sensor"].values[channel]))
                figure = _grid([(record, channel)], columns=1, width=6.3)
                yield f"curves-{file_name(name)}-{sensor}", figure
        elif KINDS[statistic].tabular:
            cells = [
                (comparison.records[i], c) for i in members for c in range(comparison.records[i].sizes["channel"])
            ]
            for start in range(0, len(cells), MOST_PANELS):
                number = f"-{start // MOST_PANELS + 1}" if len(cells) > MOST_PANELS else ""
                figure = _grid(cells[start : start + MOST_PANELS], columns=3, width=9.0)
                yield f"curves-{file_name(KINDS[statistic].title)}{number}", figure
        else:
            cells = [(record, c) for c in range(record.sizes["channel"])]
            yield f"curves-{file_name(name)}", _grid(cells, columns=2, width=9.0)


def _grid(cells: list[tuple[xr.Dataset, int]], *, columns: int, width: float) -> Figure:
    """Each cell: modulus, deviation in dB, and of complex values the phase, below each other."""
    columns = min(columns, len(cells))
    rows = -(-len(cells) // columns)
    draw = [_modulus, _deviation] + ([_phase] if np.iscomplexobj(cells[0][0]["measured"].values) else [])
    ratios = [3.0, 1.4, 1.6][: len(draw)]
    each = sum(ratios) * (0.82 if columns == 1 else 0.62)
    figure = Figure(figsize=(width if columns > 1 else 6.8, 0.6 + each * rows), layout="constrained")
    axes = figure.subplots(len(draw) * rows, columns, squeeze=False, height_ratios=ratios * rows)
    for place in range(rows * columns):
        row, column = divmod(place, columns)
        panels = axes[len(draw) * row : len(draw) * (row + 1), column]
        for panel, one in zip(panels, draw, strict=True):
            if place >= len(cells):
                panel.set_visible(False)
                continue
            one(panel, *cells[place])
            plain(panel)
            panel.tick_params(labelbottom=panel is panels[-1], which="both")
        if place + columns >= len(cells):
            panels[-1].set_xlabel("frequency, Hz")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        loc="outside upper left",
        ncols=len(labels),
        fontsize=FONT,
        frameon=False,
        handlelength=1.8,
    )
    return figure


def _deviation(axes: Axes, record: xr.Dataset, channel: int) -> None:
    """Measured over predicted in dB; the band is what noise may do."""
    one = record.isel(channel=channel)
    order = np.argsort(one["frequency"].values, kind="stable")
    frequency, scatter = one["frequency"].values[order], REACH * one["scatter_dB"].values[order]
    scatter = np.where(np.isfinite(scatter), scatter, 99.0)
    axes.fill_between(frequency, -scatter, scatter, color="0.82", linewidth=0)
    axes.axhline(0.0, color=MEASURED, linewidth=0.5)
    points = record.attrs["statistic"] == "material"
    for model in record["model"].values.astype(str):
        style = _POINTS if points else _style(model)
        axes.plot(frequency, one["deviation_dB"].sel(model=model).values[order], color=COLOUR[model], **style)
    sure = one["deviation_dB"].values[:, one["scatter_dB"].values < UNSEEN_DB]
    largest = float(np.nanmax(np.abs(sure), initial=0.0)) if np.isfinite(sure).any() else 1.0
    reach = float(np.clip(1.15 * largest, 1.0, 12.0))
    axes.set_ylim(-reach, reach)
    axes.set_ylabel("dev., dB")
    logarithmic_hertz(axes, *_ends(frequency))


def _modulus(axes: Axes, record: xr.Dataset, channel: int) -> None:
    one = record.isel(channel=channel)
    order = np.argsort(one["frequency"].values, kind="stable")
    frequency = one["frequency"].values[order]
    measured = np.abs(one["measured"].values)[order]
    material = record.attrs["statistic"] == "material"
    assumed = KINDS[record.attrs["statistic"]].tabular
    stated = record.attrs["statistic"] == "modes"
    words = "measured, assumed scatter (95 %)" if assumed and not stated else "measured, 95 % interval"
    low, high = one["low"].values[order], one["high"].values[order]
    there = np.isfinite(measured) & (measured > 0.0)
    if material or frequency.size <= FEW_POINTS:
        reach = np.stack([measured - low, high - measured])
        axes.errorbar(
            frequency, measured, yerr=reach, fmt="o", ms=2.2, lw=0.7, color=MEASURED, label=words, zorder=3
        )
    else:
        axes.fill_between(
            frequency, np.maximum(low, measured.min() * 1e-3), high, color="0.72", linewidth=0, label=words
        )
        axes.plot(frequency, measured, color=MEASURED, linewidth=0.8)
    scale = POWER_DB if record.attrs["variable"] in POWERS else NEPER_DB
    for model in record["model"].values.astype(str):
        curve = np.abs(one["predicted"].sel(model=model).values)[order]
        reach = np.exp(REACH * one["predicted_dB"].sel(model=model).values[order] / scale)
        style = _POINTS if material else _style(model)
        axes.plot(frequency, curve, color=COLOUR[model], label=NAME[model], **style)
        if not material and np.isfinite(reach).all():
            axes.fill_between(
                frequency, curve / reach, curve * reach, color=COLOUR[model], alpha=0.16, linewidth=0
            )
    axes.set_yscale("log")
    if there.any():
        _limits(axes, one, measured[there])
    logarithmic_hertz(axes, *_ends(frequency))
    unit = UNITS.get(str(one["unit"].values), str(one["unit"].values))
    axes.set_ylabel(_quantity(one) + (f", {unit}" if unit else ""))
    label = str(one["channel"].values)
    at = f", {record.attrs['temperature_C']:g} °C".replace("-", "−") if "temperature_C" in record.attrs else ""
    table = KINDS[record.attrs["statistic"]].tabular
    title = f"{record.attrs['record']}{at}" if table else label.replace("<", "from")
    axes.set_title(title, fontsize=FONT, loc="left")


_POINTS: dict[str, Any] = {"linestyle": "none", "marker": "x", "markersize": 3.0}


def _ends(frequency_Hz: np.ndarray) -> tuple[float, float]:
    """Of the axis; single points stand clear of its ends."""
    clear = 1.12 if np.unique(frequency_Hz).size <= FEW_POINTS else 1.0
    return float(frequency_Hz.min()) / clear, float(frequency_Hz.max()) * clear


def _style(model: str) -> dict[str, Any]:
    return {"linewidth": 1.1, "linestyle": (0, (4, 2)) if model == "raw" else "-"}


def _limits(axes: Axes, one: xr.Dataset, measured: np.ndarray) -> None:
    """The axis follows curves, not intervals that reach to zero."""
    curves = np.abs(one["predicted"].values).ravel()
    all_values = np.concatenate([measured, curves[np.isfinite(curves) & (curves > 0.0)]])
    axes.set_ylim(float(all_values.min()) / 2.0, float(all_values.max()) * 2.0)


def _quantity(record: xr.Dataset) -> str:
    return {
        "frf": "modulus",
        "psd": "density",
        "decay_rate": "decay rate",
        "transmissibility": "modulus",
        "modulus": "modulus",
        "modes": str(np.ravel(record["channel"].values)[0]),
        "spectrum": "modulus",
    }[str(record.attrs["variable"])]


def _phase(axes: Axes, record: xr.Dataset, channel: int) -> None:
    one = record.isel(channel=channel)
    frequency = one["frequency"].values
    material = record.attrs["statistic"] == "material"
    measured = np.degrees(np.angle(one["measured"].values))
    half = np.minimum(np.degrees(one["phase_half_rad"].values), 180.0)
    dense = not material and frequency.size > FEW_POINTS
    axes.errorbar(
        frequency,
        measured,
        yerr=None if not np.isfinite(half).any() else half,
        fmt="none" if dense else "o",
        ms=2.2,
        lw=0.7,
        color=MEASURED,
        ecolor="0.72" if dense else MEASURED,
    )
    if dense:
        axes.plot(*lifted(frequency, measured), color=MEASURED, linewidth=0.8)
    for model in record["model"].values.astype(str):
        degrees = np.degrees(np.angle(one["predicted"].sel(model=model).values))
        if material:
            axes.plot(frequency, degrees, color=COLOUR[model], linestyle="none", marker="x", markersize=3.0)
        else:
            axes.plot(*lifted(frequency, degrees), color=COLOUR[model], **_style(model))
    logarithmic_hertz(axes, *_ends(frequency))
    if material:
        axes.set_ylabel("loss angle, deg.")
        return
    axes.set(ylabel="phase, deg.", yticks=np.arange(-180, 181, 90), ylim=(-190, 190))


def lifted(frequency_Hz: np.ndarray, degrees: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A curve that is lifted where its phase passes half a turn."""
    turns = np.flatnonzero(np.abs(np.diff(degrees)) > 180.0) + 1
    return np.insert(frequency_Hz, turns, np.nan), np.insert(degrees, turns, np.nan)
