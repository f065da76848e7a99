"""Deviations as maps, channel against frequency: in decibels and in standard deviations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from permway.campaign.campaign import Campaign
from permway.campaign.kinds import KINDS
from permway.diagnosis.compare import Comparison
from permway.report.compare.looks import FONT, NAME, colour_map, edges, logarithmic_hertz, name_rows
from permway.report.compare.writing import file_name

LEVEL_DB, SIGMAS = 6.0, 4.0
"""Where the colours end."""

UNSEEN_DB = 3.0
"""Lines of larger standard deviation are not shown."""

FEW_ROWS = 60
"""Up to so many rows each has room for its name."""


def groups(comparison: Comparison) -> Iterator[tuple[str, list[int]]]:
    """What is drawn together: each measurement by itself, all tables of one kind together."""
    statistics = [str(record.attrs["statistic"]) for record in comparison.records]
    for index, record in enumerate(comparison.records):
        if not KINDS[statistics[index]].tabular:
            yield str(record.attrs["record"]), [index]
    for statistic in dict.fromkeys(s for s in statistics if KINDS[s].tabular):
        yield KINDS[statistic].title, [i for i, s in enumerate(statistics) if s == statistic]


def ordered(campaign: Campaign, record: xr.Dataset) -> list[int]:
    """Channels sensor by sensor, within each the force points along the line."""
    sensors = [str(name) for name in record["sensor"].values]
    forces = [str(name) for name in record["force"].values]
    first = {name: place for place, name in reversed(list(enumerate(sensors)))}
    points = {p.name: (p.body, p.x_m) for p in campaign.stated.forces}
    return sorted(range(len(sensors)), key=lambda i: (first[sensors[i]], points.get(forces[i], ("", 0.0))))


Part = tuple[np.ndarray, np.ndarray, list[str]]
"""Frequencies, values (model, row, frequency), names of rows."""


def level_maps(comparison: Comparison) -> Iterator[tuple[str, Figure]]:
    """Measured over predicted in dB, the nominal values beside the recalibrated."""
    for name, members in groups(comparison):
        parts: list[Part] = []
        for i in members:
            record = comparison.records[i]
            if record.attrs["statistic"] == "material":
                # Points of several temperatures repeat frequencies, so bands stand for them.
                record = comparison.bands[i].rename(band="frequency")
                values, labels = record["deviation_dB"].values, record["channel"].values.astype(str).tolist()
            else:
                order = ordered(comparison.campaign, record)
                unsure = record["scatter_dB"].values > UNSEEN_DB
                values = np.where(unsure, np.nan, record["deviation_dB"].values)[:, order]
                labels = [_row_name(record, channel) for channel in order]
            parts.append((record["frequency"].values, values, labels))
        figure = _side_by_side(comparison.models, {"": parts}, LEVEL_DB)
        figure.axes[-1].set_ylabel("deviation, dB", fontsize=FONT)
        yield f"level-{file_name(name)}", figure


def sigma_maps(comparison: Comparison) -> Iterator[tuple[str, Figure]]:
    """Deviations over their standard deviations, level above phase."""
    for name, members in groups(comparison):
        if comparison.records[members[0]].attrs["statistic"] == "material":
            continue
        panels: dict[str, list[Part]] = {"level": [], "phase": []}
        for i in members:
            data, record = comparison.residuals[i], comparison.records[i]
            if record.attrs["statistic"] == "frf":
                order = ordered(comparison.campaign, record)
                labels = [_row_name(record, channel) for channel in order]
            else:
                order = list(range(data.sizes["row"]))
                labels = data["row"].values.astype(str).tolist()
            values = data["z"].values[:, :, order]
            for index, panel in enumerate(("level", "phase")):
                # Powers have no phase.
                there = np.flatnonzero(np.isfinite(values[:, index]).any(axis=(0, 2)))
                if there.size:
                    mine = [labels[row] for row in there]
                    panels[panel].append((data["frequency"].values, values[:, index, there], mine))
        shown = {panel: parts for panel, parts in panels.items() if parts}
        models = [str(m) for m in comparison.residuals[members[0]]["model"].values]
        figure = _side_by_side(models, shown if len(shown) > 1 else {"": shown["level"]}, SIGMAS)
        figure.axes[-1].set_ylabel("standard deviations", fontsize=FONT)
        yield f"sigma-{file_name(name)}", figure


def _row_name(record: xr.Dataset, channel: int) -> str:
    return str(record["sensor"].values[channel])


def _side_by_side(models: Sequence[str], panels: Mapping[str, Sequence[Part]], limit: float) -> Figure:
    """A column for each model, a row for each panel."""
    heights = []
    for parts in panels.values():
        count = sum(len(labels) for _, _, labels in parts)
        few = float(np.clip(0.17 * count, 1.3, 4.6))
        heights.append(few if count <= FEW_ROWS else (5.6 if len(panels) == 1 else 4.2))
    width = 1.3 + min(4.6, 9.2 / len(models)) * len(models)
    figure = Figure(figsize=(width, 0.7 + sum(heights) + 0.2 * len(heights)), layout="constrained")
    axes = figure.subplots(len(panels), len(models), sharex=True, squeeze=False, height_ratios=heights)
    every = [part for parts in panels.values() for part in parts]
    low = min(float(edges(f)[0]) for f, _, _ in every)
    high = max(float(edges(f)[-1]) for f, _, _ in every)
    for row, (panel, parts) in enumerate(panels.items()):
        labels = [label for _, _, mine in parts for label in mine]
        for column, model in enumerate(models):
            cell, first = axes[row, column], 0
            cell.set_facecolor("0.8")
            for frequency, values, mine in parts:
                mesh = colour_map(cell, frequency, values[column], limit, first_row=first)
                first += len(mine)
            logarithmic_hertz(cell, low, high)
            name_rows(cell, labels)
            cell.tick_params(labelsize=FONT, axis="x", which="both", labelbottom=row == len(panels) - 1)
            cell.tick_params(axis="y", labelleft=column == 0)
            title = NAME.get(model, model).replace("\n", " ")
            cell.set_title(f"{title}: {panel}" if panel else title, fontsize=FONT + 0.5, loc="left")
            if row == len(panels) - 1:
                cell.set_xlabel("frequency, Hz", fontsize=FONT + 0.5)
    bar = figure.colorbar(mesh, ax=axes, extend="both", fraction=0.03, pad=0.01)
    bar.ax.tick_params(labelsize=FONT)
    return figure
