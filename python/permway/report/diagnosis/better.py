"""How much better: deviations in one-third octaves before and after, curves, and parameters that went back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from permway.diagnosis.compare import RAW, RECALIBRATED
from permway.diagnosis.result import Diagnosis
from permway.report.compare.curves import FEW_POINTS
from permway.report.compare.looks import (
    COLOUR,
    FONT,
    INK,
    MEASURED,
    NAME,
    UNITS,
    colour_map,
    logarithmic_hertz,
    name_rows,
    plain,
)
from permway.report.compare.maps import ordered
from permway.report.compare.writing import file_name
from permway.report.diagnosis.changes import Change, changes, most_changed

AMENDED = "amended"
COLOURS = {**COLOUR, AMENDED: "#a8321a"}
NAMES = {**NAME, AMENDED: "amended"}
LEVEL_DB = 6.0
"""Where the colours end."""


def gain_picture(diagnosis: Diagnosis) -> Iterator[tuple[str, Figure]]:
    """Of each record with several bands: channel against one-third octave, recalibrated beside amended."""
    for change in changes(diagnosis):
        if change.before_dB.sizes["band"] > 1:
            yield f"gain-{file_name(change.name)}", _map(diagnosis, change)


def _map(diagnosis: Diagnosis, change: Change) -> Figure:
    models = {RECALIBRATED: change.before_dB}
    if change.after_dB is not None:
        models[AMENDED] = change.after_dB
    frf = change.before.attrs["statistic"] == "frf"
    count = change.before_dB.sizes["channel"]
    order = ordered(diagnosis.comparison.campaign, change.before) if frf else list(range(count))
    labels = [str(change.before["sensor"].values[i]) for i in order]
    height = 0.9 + float(np.clip(0.17 * count, 0.8, 4.6))
    figure = Figure(figsize=(1.4 + 3.2 * len(models), height), layout="constrained")
    panels = figure.subplots(1, len(models), sharey=True, squeeze=False)[0]
    for axes, (model, deviation) in zip(panels, models.items(), strict=True):
        axes.set_facecolor("0.8")
        mesh = colour_map(axes, deviation["band"].values, deviation.values[order], LEVEL_DB)
        name_rows(axes, labels)
        axes.tick_params(axis="y", labelleft=axes is panels[0])
        axes.tick_params(axis="x", labelsize=FONT)
        axes.set_title(NAMES[model], fontsize=FONT + 0.5, loc="left")
        axes.set_xlabel("frequency, Hz", fontsize=FONT + 0.5)
        bands = deviation["band"].values
        logarithmic_hertz(axes, float(bands.min()) / 1.12, float(bands.max()) * 1.12)
    bar = figure.colorbar(mesh, ax=list(panels), extend="both", fraction=0.04, pad=0.01)
    bar.ax.tick_params(labelsize=FONT)
    bar.set_label("deviation, dB", fontsize=FONT)
    return figure


def curve_pictures(diagnosis: Diagnosis) -> Iterator[tuple[str, Figure]]:
    """The channels that changed most, of all records together, a picture for each record."""
    every = changes(diagnosis)
    chosen = most_changed(every)
    for change in every:
        mine = [channel for name, channel in chosen if name == change.name]
        if mine:
            yield f"curves-{file_name(change.name)}", _curves(change, mine)


def first_curve(diagnosis: Diagnosis) -> Iterator[tuple[str, Figure]]:
    """The channel that gains most of the amendment, as `curve`; without one, the channel that deviates most."""
    every = changes(diagnosis)
    ranked = [(float(np.nan_to_num(change.gain()).max()), -i) for i, change in enumerate(every)]
    if ranked:
        change = every[-max(ranked)[1]]
        yield "curve", _curves(change, [int(np.argmax(np.nan_to_num(change.gain())))], height_in=3.7)


def _curves(change: Change, channels: list[int], height_in: float = 3.0) -> Figure:
    columns = min(2, len(channels))
    rows = -(-len(channels) // columns)
    size = 3.7 * columns if columns > 1 else 5.6, 0.5 + height_in * rows
    figure = Figure(figsize=size, layout="constrained")
    cells = figure.subplots(2 * rows, columns, squeeze=False, height_ratios=[2.4, 1.0] * rows)
    for place in range(rows * columns):
        row, column = divmod(place, columns)
        upper, lower = cells[2 * row, column], cells[2 * row + 1, column]
        if place >= len(channels):
            upper.set_visible(False)
            lower.set_visible(False)
            continue
        _modulus(upper, change, channels[place])
        _deviation(lower, change, channels[place])
        upper.tick_params(labelbottom=False)
        lower.set_xlabel("frequency, Hz" if place + columns >= len(channels) else "")
    handles, labels = cells[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=4, fontsize=FONT, frameon=False)
    return figure


def _predictions(change: Change, channel: int, variable: str) -> Iterator[tuple[str, xr.DataArray]]:
    """Of the recalibrated and of the amended model."""
    yield (
        RECALIBRATED if RECALIBRATED in change.before["model"].values else RAW,
        change.before[variable].isel(channel=channel, model=-1),
    )
    if change.after is not None:
        label = str(change.before["channel"].values[channel])
        labels = [str(v) for v in change.after["channel"].values]
        if label in labels:
            yield AMENDED, change.after[variable].isel(channel=labels.index(label), model=-1)


def _modulus(axes: Axes, change: Change, channel: int) -> None:
    one = change.before.isel(channel=channel)
    order = np.argsort(one["frequency"].values, kind="stable")
    frequency, measured = one["frequency"].values[order], np.abs(one["measured"].values)[order]
    low, high = one["low"].values[order], one["high"].values[order]
    floor = float(np.nanmin(measured)) * 1e-3
    if frequency.size > FEW_POINTS:
        axes.fill_between(frequency, np.maximum(low, floor), high, color="0.78", linewidth=0)
    else:
        axes.vlines(frequency, low, high, color="0.6", linewidth=2.0)
    few: dict[str, Any] = (
        {"linestyle": "none", "marker": "o", "markersize": 2.5} if frequency.size <= FEW_POINTS else {}
    )
    axes.plot(frequency, measured, color=MEASURED, linewidth=1.0, label="measured, 95 %", **few)
    every = [measured]
    for model, values in _predictions(change, channel, "predicted"):
        curve, mine = _ascending(values)
        every.append(np.abs(curve))
        axes.plot(mine, np.abs(curve), color=COLOURS[model], linewidth=1.2, label=NAMES[model], **_style(model))
    axes.set_yscale("log")
    # Small ticks take most of the time to draw.
    axes.yaxis.set_minor_locator(NullLocator())
    positive = np.concatenate(every)
    positive = positive[np.isfinite(positive) & (positive > 0.0)]
    if positive.size:
        axes.set_ylim(float(positive.min()) / 1.6, float(positive.max()) * 1.6)
    unit = str(one["unit"].values)
    axes.set_ylabel(UNITS.get(unit, unit))
    axes.set_title(str(one["channel"].values).replace("<", "from"), fontsize=FONT, loc="left")
    plain(axes)
    _span(axes, frequency)


def _deviation(axes: Axes, change: Change, channel: int) -> None:
    """Measured over predicted in dB."""
    axes.axhline(0.0, color=INK, linewidth=0.6)
    largest, frequency = 1.0, np.array([1.0, 2.0])
    for model, values in _predictions(change, channel, "deviation_dB"):
        curve, frequency = _ascending(values)
        axes.plot(frequency, curve, color=COLOURS[model], linewidth=1.1, **_style(model))
        if np.isfinite(curve).any():
            largest = max(largest, float(np.nanpercentile(np.abs(curve), 99.0)))
    reach = min(1.15 * largest, 20.0)
    axes.set_ylim(-reach, reach)
    axes.set_ylabel("dev., dB")
    plain(axes)
    _span(axes, frequency)


def _ascending(values: xr.DataArray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(values["frequency"].values, kind="stable")
    return values.values[order], values["frequency"].values[order]


def _span(axes: Axes, frequency_Hz: np.ndarray) -> None:
    logarithmic_hertz(axes, float(frequency_Hz.min()), float(frequency_Hz.max()))


def _style(model: str) -> dict[str, Any]:
    return {"linestyle": "-" if model == AMENDED else (0, (4, 2))}


def parameter_picture(diagnosis: Diagnosis) -> Figure:
    """The verdict's parameters in standard deviations of their priors, before and after, with 90 % intervals."""
    known = diagnosis.comparison.campaign.parameters.known
    reported, names = diagnosis.verdict.recalibrated, list(known)
    shown = {RECALIBRATED: reported.before} | ({AMENDED: reported.after} if reported.after else {})
    figure = Figure(figsize=(6.8, 0.9 + 0.2 * len(names)), layout="constrained")
    axes = figure.subplots()
    axes.axvspan(-2.0, 2.0, color="0.94", label="tolerance")
    axes.axvline(0.0, color=INK, linewidth=0.7)
    reach = 2.6
    for row, (model, moved) in enumerate(shown.items()):
        shift = 0.18 * (2 * row - len(shown) + 1)
        y, ends = [], []
        for place, name in enumerate(names):
            one = moved.get(name)
            if one is not None:
                low, high = sorted(one.z if end is None else known[name].z(end) for end in (one.low, one.high))
                y.append(place + shift)
                ends.append((one.z - low, one.z, high - one.z))
        if not ends:
            continue
        below, value, above = np.array(ends).T
        axes.errorbar(
            value, y, xerr=(below, above), fmt="o", ms=3.5, lw=1.2, color=COLOURS[model], label=NAMES[model]
        )
        reach = max(reach, float(np.max(np.abs(value) + np.maximum(below, above))) * 1.05)
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_xlim(-reach, reach)
    axes.set_xlabel("found less nominal, standard deviations of the prior")
    plain(axes)
    figure.legend(loc="outside upper left", ncols=3, fontsize=FONT, frameon=False)
    return figure
