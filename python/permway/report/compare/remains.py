"""Recalibrated parameters, and what is left of the residuals beside noise."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from permway.diagnosis.compare import CLEAN, Comparison
from permway.diagnosis.fit import WIDTH
from permway.diagnosis.residuals import lag_correlation
from permway.report.compare.looks import COLOUR, FONT, INK, plain
from permway.report.compare.maps import groups
from permway.report.compare.writing import file_name

REACH = 5.0
"""Standard deviations that the histogram shows."""


def parameter_picture(comparison: Comparison) -> Figure:
    """Every parameter in standard deviations of its prior, with its 90 % interval."""
    table = comparison.parameters
    count = table.sizes["parameter"]
    figure = Figure(figsize=(6.3, 0.8 + 0.17 * count), layout="constrained")
    axes = figure.subplots()
    y = np.arange(count)
    z, sigma = table["z"].values, table["sigma_over_prior"].values
    axes.axvspan(-2.0, 2.0, color="0.94", label="tolerance: two standard deviations")
    axes.axvline(0.0, color=INK, linewidth=0.7)
    nothing = table["not_informed"].values
    for chosen, colour, words in (
        (~nothing, COLOUR["recalibrated"], "found, 90 % interval"),
        (nothing, "0.6", "the records say nothing of it"),
    ):
        if chosen.any():
            axes.errorbar(
                z[chosen],
                y[chosen],
                xerr=WIDTH * sigma[chosen],
                fmt="o",
                ms=3.5,
                lw=1.2,
                color=colour,
                label=words,
            )
    axes.set_yticks(y, table["parameter"].values.astype(str))
    axes.set_ylim(count - 0.4, -0.6)
    reach = max(2.6, float(np.max(np.abs(z) + WIDTH * sigma)) * 1.05)
    axes.set_xlim(-reach, reach)
    axes.set_xlabel("found less nominal, standard deviations of the prior")
    plain(axes)
    figure.legend(loc="outside upper left", ncols=3, fontsize=FONT - 0.5, frameon=False)
    return figure


def noise_pictures(comparison: Comparison) -> Iterator[tuple[str, Figure]]:
    """Histogram against the normal law, and correlation between neighbouring lines, sensor by sensor."""
    for name, members in groups(comparison):
        if comparison.records[members[0]].attrs["statistic"] == "material":
            continue
        kept = [comparison.residuals[i]["z"].sel(model=CLEAN) for i in members]
        yield f"left-{file_name(name)}", _noise(kept)


def _noise(parts: list[xr.DataArray]) -> Figure:
    values = np.concatenate([z.values.reshape(2, -1) for z in parts], axis=1)
    phase = bool(np.isfinite(values[1]).any())
    shown = 2 if phase else 1
    figure = Figure(figsize=(9.0, 0.3 + 2.5 * shown), layout="constrained")
    axes = figure.subplots(shown, 2, squeeze=False, width_ratios=(2, 3))
    x = np.linspace(-REACH, REACH, 201)
    for row in range(shown):
        mine = values[row][np.isfinite(values[row])]
        left, right = axes[row]
        bins = np.linspace(-REACH, REACH, 61 if mine.size > 2000 else 21)
        outside = int(np.count_nonzero(np.abs(mine) > REACH))
        left.hist(mine, bins=bins, density=True, color="#9cc3de", label=f"{mine.size} residuals")
        left.plot(x, np.exp(-0.5 * x**2) / np.sqrt(2.0 * np.pi), color=INK, linewidth=1.0, label="normal law")
        rms = np.sqrt(np.mean(mine**2))
        title = f"{'phase' if row else 'level'}: rms {rms:.2f}, {outside} beyond ±{REACH:g}"
        left.set_title(title, fontsize=FONT, loc="left")
        left.set_ylim(top=max(0.62, left.get_ylim()[1] * 1.15))
        left.legend(fontsize=FONT - 1, frameon=False, loc="upper left")
        left.set_xlabel("standard deviations")
        chance = 0.0
        for z in parts:
            found = lag_correlation(z).isel(part=row)
            for sensor in found["sensor"].values:
                curve = found["correlation"].sel(sensor=sensor)
                right.plot(found["lag"], curve, marker="o", markersize=2.5, linewidth=0.9, label=str(sensor))
            chance = max(chance, float(np.nanmax(found["chance"].values, initial=0.0)))
        right.axhspan(-chance, chance, color="0.93", label="95 % by chance")
        right.axhline(0.0, color=INK, linewidth=0.7)
        right.set_ylim(-1.0, 1.0)
        right.set_title("correlation with lines further on", fontsize=FONT, loc="left")
        right.set_xlabel("lines apart")
        if len(right.get_legend_handles_labels()[1]) <= 16:
            right.legend(fontsize=FONT - 2, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.05))
        for panel in (left, right):
            plain(panel)
    return figure
