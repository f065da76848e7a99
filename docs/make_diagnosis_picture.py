"""Draws the diagnosis of `permway demo`: where, what and how much better. Called by `docs/make_pictures.py`.

Everything is read from the files that the command leaves, as a user would read them.
"""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import permway
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from permway.campaign.campaign import read_campaign
from permway.demo.run import run

WIDTH_PX, HEIGHT_PX, DPI = 1360, 600, 160
MEASURED, BEFORE, AFTER, PLACE = "#20242c", "#c8431a", "#0a6fb4", "#f6d5c8"


def diagnose(folder: Path) -> dict[str, Any]:
    """Run the demo into a folder; its verdict, campaign file, measured responses, and both models' responses.

    Parameters
    ----------
    folder : Path
        Gets `campaign/` and `diagnosis/`.
    """
    run(folder, threads=1)
    campaign = folder / "campaign" / "campaign.toml"
    stated = tomllib.loads(campaign.read_text("utf-8"))
    (record,) = read_campaign(campaign).load()
    models = {"before": folder / "campaign" / "model.toml", "after": folder / "diagnosis" / "amended.toml"}
    return {
        "verdict": json.loads((folder / "diagnosis" / "verdict.json").read_text("utf-8")),
        "campaign": stated,
        "measured": record.data,
        **{name: predicted(permway.read_model(path), stated, record.data) for name, path in models.items()},
    }


def predicted(model: permway.Model, campaign: dict[str, Any], measured: Any) -> Any:
    """Accelerance of a model at the campaign's points and sensors, complex (frequency, sensor, force)."""
    places = {
        kind: [permway.Place(body=one["body"], x_m=one["x_m"]) for one in campaign[kind]]
        for kind in ("forces", "sensors")
    }
    frequency = measured["frequency"].values
    data = permway.receptance(
        model.line, frequency, forces=places["forces"], sensors=places["sensors"], temperature_C=12.0
    )
    return data["receptance"].values * -((2 * np.pi * frequency[:, None, None]) ** 2)


def draw(found: dict[str, Any]) -> Figure:
    """Three panels: the track with the place, one response, and the error on records left out."""
    figure = Figure(figsize=(WIDTH_PX / DPI, HEIGHT_PX / DPI), dpi=DPI, layout="constrained")
    where, what, better = figure.subplots(1, 3, width_ratios=[1.15, 1.1, 0.75])
    effect = found["verdict"]["effects"][0]
    _where(where, found, effect["place"])
    _what(what, found, effect)
    _better(better, found["verdict"]["held_out"])
    for axes in (where, what, better):
        axes.title.set(fontsize=11)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _where(axes: Axes, found: dict[str, Any], place: dict[str, Any]) -> None:
    """Mean error of the responses to each blow, over the track; the verdict's place is shaded."""
    rail = [(i, one["x_m"]) for i, one in enumerate(found["campaign"]["forces"]) if one["body"] == "rail"]
    at = [x for _, x in rail]
    for model, colour, text in (("before", BEFORE, "model as it was"), ("after", AFTER, "amended model")):
        error = [_error_dB(found, model, index) for index, _ in rail]
        axes.plot(at, error, "o-", color=colour, label=text, markersize=4.5)
    start, end = place["x"]
    axes.axvspan(start - 0.32, end + 0.32, color=PLACE, zorder=0, label="place of the verdict")
    axes.set(
        title=f"Where: rail pads from {start:g} to {end:g} m",
        xlabel="hammer point along the rail, m",
        ylabel="error of the responses, dB",
        ylim=(0.0, 18.5),
        xticks=range(0, 17, 4),
    )
    # Beside the shaded place, not over it.
    axes.legend(fontsize=8.5, frameon=False, loc="upper right", bbox_to_anchor=(1.07, 1.0), handlelength=1.4)


def _error_dB(found: dict[str, Any], model: str, force: int) -> float:
    """Root mean square over sensors and lines whose coherence is above a half."""
    measured = found["measured"]
    ratio = found[model].transpose(1, 2, 0)[:, force] / measured["frf"].values[:, force]
    level = 20.0 * np.log10(np.abs(ratio))
    return float(np.sqrt(np.mean(level[measured["coherence"].values[:, force] > 0.5] ** 2)))


def _what(axes: Axes, found: dict[str, Any], effect: dict[str, Any]) -> None:
    """The response of the rail struck nearest to the place, read at the next sensor."""
    middle = sum(effect["place"]["x"]) / 2.0
    pick = {
        kind: min(
            (i for i, one in enumerate(found["campaign"][kind]) if one["body"] == "rail"),
            key=lambda i, kind=kind: abs(found["campaign"][kind][i]["x_m"] - middle),
        )
        for kind in ("sensors", "forces")
    }
    frequency = found["measured"]["frequency"].values
    force, sensor = pick["forces"], pick["sensors"]
    measured = np.abs(found["measured"]["frf"].values[sensor, force])
    axes.plot(frequency, measured, "o", color=MEASURED, markersize=3, label="measured")
    for model, colour, text in (("before", BEFORE, "model as it was"), ("after", AFTER, "amended model")):
        axes.plot(frequency, np.abs(found[model][:, sensor, force]), color=colour, label=text, linewidth=1.6)
    axes.set(
        title=f"What: {effect['parameters']['factor']['value']:.0%} of their stiffness is left".replace("%", " %"),
        xlabel="frequency, Hz",
        ylabel="accelerance of the rail, (m/s²)/N",
        yscale="log",
        xlim=(0, 200),
    )
    axes.legend(fontsize=8.5, frameon=False, loc="lower right")


def _better(axes: Axes, held_out: dict[str, dict[str, float]]) -> None:
    """Errors on records that neither model was fitted to."""
    axis_of = [name.partition(": ")[0] for name in held_out]
    names = list(dict.fromkeys(axis_of))
    for shift, key, colour in ((-0.2, "db_before", BEFORE), (0.2, "db_after", AFTER)):
        each = np.array([one[key] for one in held_out.values()])
        # Root mean square over all that was left out one by one.
        values = [float(np.sqrt(np.mean(each[np.array(axis_of) == name] ** 2))) for name in names]
        bars = axes.bar([i + shift for i in range(len(names))], values, 0.38, color=colour)
        axes.bar_label(bars, [f"{value:.1f}" for value in values], fontsize=8.5, padding=2)
    axes.set_xticks(range(len(names)), names)
    axes.set(
        title="How much better",
        ylim=(0, 13.0),
        xlabel="left-out records, by",
        ylabel="error of the prediction, dB",
    )
