"""The map: how probable it is that something acts at each place of the line, family by family."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.weighed import Along, Aside, Weighed
from permway.report.compare.looks import FONT, plain
from permway.report.diagnosis.track import HALF, Colour, Drawing, Stripe, draw, drawing

COLOURS = ("#a8321a", "#0a6fb4", "#0b8f6b", "#6a4fa0", "#8a6d00", "#c2548f", "#59606b")
"""Of families, the most probable first; amber is the hammer's."""

WIDTH_IN = 5.6
"""As wide as a phone's screen can show with type that can be read."""

LEAST = 0.02
"""Probability that is drawn."""

RINGED = 0.05
"""Probability from which a sensor is ringed."""

TRIED = "#7f93a8"
"""Of places where effects were tried, and nothing is missing."""


def map_picture(diagnosis: Diagnosis) -> Figure:
    """Probability along x above the drawing of the line; the drawing alone where nothing acts along it."""
    weighed, campaign = diagnosis.weighed, diagnosis.base.campaign
    plan = drawing(campaign)
    shown = along(weighed)
    whole = [one for one in weighed.aside if one.what in campaign.model.line.laws]
    colours = _colours(weighed, shown)
    below_in = 0.5 + 0.5 * plan.rows
    if shown:
        figure = Figure(figsize=(WIDTH_IN, 2.0 + below_in), layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.4, below_in))
        for one in shown:
            _bars(above, one, colours[one.family])
        above.set_ylim(0.0, 1.05)
        above.set_ylabel("probability")
        plain(above)
        above.tick_params(labelbottom=False)
    else:
        figure = Figure(figsize=(WIDTH_IN, 0.6 + below_in), layout="constrained")
        below = figure.subplots()
    if shown or ringed(weighed, campaign) or any(one.probability >= LEAST for one in whole):
        joints = _all_along(below, campaign, whole, colours) | _of_joints(campaign, shown, colours)
        draw(below, campaign, plan, joints, _of_bodies(shown, colours))
        _mark_sensors(below, campaign, plan, weighed, colours)
    else:
        draw(below, campaign, plan, _tried_joints(campaign, weighed.tried))
        _mark_tried(below, plan, weighed.tried)
    below.set_xlabel("x, m", fontsize=FONT + 0.5)
    below.tick_params(axis="x", labelsize=FONT)
    _legend(figure)
    return figure


def along(weighed: Weighed) -> list[Along]:
    """What is drawn along the line."""
    return [one for one in weighed.along if one.probability.max() >= LEAST]


def _colours(weighed: Weighed, shown: Sequence[Along]) -> dict[str, str]:
    families = dict.fromkeys([*(one.family for one in shown), *(one.family for one in weighed.aside)])
    return {family: COLOURS[index % len(COLOURS)] for index, family in enumerate(families)}


def _bars(axes: Axes, one: Along, colour: str) -> None:
    """A bar at each joint, or a band along a body."""
    label = f"{one.family}, {one.what}"
    apart = float(np.diff(one.x_m).min()) if one.x_m.size > 1 else 0.5
    if one.joints:
        there = one.probability >= LEAST / 4.0
        axes.bar(one.x_m[there], one.probability[there], 0.7 * apart, color=colour, alpha=0.75, label=label)
        return
    axes.fill_between(one.x_m, one.probability, step="mid", color=colour, alpha=0.45, linewidth=0, label=label)
    axes.step(one.x_m, one.probability, where="mid", color=colour, linewidth=0.9)


def _of_joints(campaign: Campaign, shown: Sequence[Along], colours: Mapping[str, str]) -> dict[int, Colour]:
    """Joints in the colour of the most probable family, the deeper the more probable."""
    table, laws = campaign.model.line.joint_table(), list(campaign.model.line.laws)
    best: dict[int, float] = {}
    found: dict[int, Colour] = {}
    for one in (one for one in shown if one.joints):
        for joint in np.flatnonzero(table.law == laws.index(one.what)).tolist():
            probability = float(one.probability[np.argmin(np.abs(one.x_m - table.x[joint]))])
            if probability >= max(LEAST, best.get(joint, 0.0)):
                best[joint], found[joint] = probability, _shade(colours[one.family], probability)
    return found


def _all_along(
    axes: Axes, campaign: Campaign, whole: Sequence[Aside], colours: Mapping[str, str]
) -> dict[int, Colour]:
    """All joints of laws that are probably another, paler than what acts at some of them."""
    table, laws = campaign.model.line.joint_table(), list(campaign.model.line.laws)
    found: dict[int, Colour] = {}
    for one in reversed(whole):
        if one.probability < LEAST:
            continue
        shade = _shade(colours[one.family], 0.4 * one.probability)
        found |= dict.fromkeys(np.flatnonzero(table.law == laws.index(one.what)).tolist(), shade)
        axes.fill_between([], [], color=shade, label=f"{one.family}, all of {one.what}")
    return found


def _of_bodies(shown: Sequence[Along], colours: Mapping[str, str]) -> list[Stripe]:
    found = []
    for one in sorted((one for one in shown if not one.joints), key=lambda one: float(one.probability.max())):
        half = 0.5 * float(np.diff(one.x_m).min()) if one.x_m.size > 1 else 0.5
        for x, probability in zip(one.x_m.tolist(), one.probability.tolist(), strict=True):
            if probability >= LEAST / 4.0:
                found.append(Stripe(one.what, x - half, x + half, _shade(colours[one.family], probability)))
    return found


def _shade(colour: str, probability: float) -> Colour:
    """From white to the colour; what is improbable is still seen."""
    share = 0.2 + 0.8 * min(probability, 1.0)
    return tuple(1.0 - share * (1.0 - one) for one in to_rgb(colour))


def ringed(weighed: Weighed, campaign: Campaign) -> dict[str, tuple[str, float]]:
    """Sensors that are probably at fault: family and probability."""
    known = {s.name for s in campaign.stated.sensors}
    return {
        channel: (one.family, one.probability)
        for one in reversed(weighed.aside)
        if one.probability >= RINGED
        for channel in one.channels
        if channel in known
    }


def _mark_sensors(
    axes: Axes, campaign: Campaign, plan: Drawing, weighed: Weighed, colours: Mapping[str, str]
) -> None:
    """Rings about sensors that are probably at fault."""
    for name, (family, probability) in ringed(weighed, campaign).items():
        sensor = campaign.sensor(name)
        level = plan.level.get(sensor.body or "")
        if sensor.x_m is None or level is None:
            continue
        colour = colours[family]
        axes.plot(
            sensor.x_m, level, "o", ms=11, mfc="none", mec=colour, mew=2.2, alpha=0.3 + 0.7 * probability, zorder=7
        )
        axes.annotate(
            f"{name}: {probability:.2f}",
            (sensor.x_m, level),
            xytext=(0.0, -13.0),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=FONT,
            color=colour,
            zorder=8,
            bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.7},
        )


def _tried_joints(campaign: Campaign, tried: Mapping[str, Reals]) -> dict[int, Colour]:
    table, laws = campaign.model.line.joint_table(), list(campaign.model.line.laws)
    return {j: TRIED for j in range(table.x.size) if laws[table.law[j]] in tried}


def _mark_tried(axes: Axes, plan: Drawing, tried: Mapping[str, Reals]) -> None:
    """Ticks along bodies where effects were tried."""
    label = "effects tried here"
    for body, x in tried.items():
        level = plan.level.get(body)
        if level is not None:
            axes.vlines(x, level - HALF, level + HALF, color=TRIED, linewidth=1.0, zorder=3, label=label)
            label = "_"


def _legend(figure: Figure) -> None:
    found: dict[str, Artist] = {}
    for axes in figure.axes:
        handles, labels = axes.get_legend_handles_labels()
        found |= dict(zip(labels, handles, strict=True))
    figure.legend(
        list(found.values()), list(found), loc="outside upper left", ncols=2, fontsize=FONT, frameon=False
    )
