"""The track drawing: bodies, joints, sensors and force points along x, in colours that are given."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from permway.campaign.campaign import Campaign
from permway.model.bodies import Mass
from permway.model.line import Line
from permway.report.compare.looks import FONT, INK

HALF = 0.13
"""Half the height of a drawn body; levels are 1 apart."""

UNKNOWN = "0.86"
"""Colour of what was not scanned."""


Colour = str | tuple[float, ...]


@dataclass(frozen=True)
class Stripe:
    """A coloured stretch of a body, or of one of its segments."""

    what: str
    from_m: float
    to_m: float
    colour: Colour


@dataclass(frozen=True)
class Drawing:
    """Where everything of a line is drawn.

    Attributes
    ----------
    reach_m : (float, float)
    level : mapping of body to float
        Height; the ground is 0.
    names : mapping of level to str
    """

    reach_m: tuple[float, float]
    level: Mapping[str, float]
    names: Mapping[float, str]

    @property
    def rows(self) -> int:
        """Levels above the ground."""
        return len(self.names)


def drawing(campaign: Campaign) -> Drawing:
    """Lay a campaign's line out: every body on its level, those that hang lower below."""
    level, names = levels(campaign.model.line)
    return Drawing(_reach(campaign), level, names)


def levels(line: Line) -> tuple[dict[str, float], dict[float, str]]:
    """Height of each body above the ground, which is 0, and names by height, the highest first."""
    depth = _depths(line)
    # Single masses of one kind (sleeper0, sleeper1, ...) share a level.
    kind = {n: re.sub(r"[\d_-]+$", "", n) or n if isinstance(b, Mass) else n for n, b in line.bodies.items()}
    kinds: dict[str, int] = {}
    for name, one in kind.items():
        kinds[one] = min(depth[name], kinds.get(one, depth[name]))
    ordered = sorted(kinds, key=lambda one: kinds[one])
    height = {one: float(len(ordered) - i) for i, one in enumerate(ordered)}
    return {n: height[kind[n]] for n in kind}, {height[one]: one for one in ordered}


def _depths(line: Line) -> dict[str, int]:
    """How many layers of joints are above each body."""
    pairs = {tuple(name.split("[")[0] for name in layer.between) for layer in line.joints}
    depth = dict.fromkeys(line.bodies, 0)
    # A circle of joints would go on for ever.
    for _ in line.bodies:
        for upper, lower in pairs:
            if upper != lower and lower in depth:
                depth[lower] = min(max(depth[lower], depth[upper] + 1), len(depth))
    return depth


def _reach(campaign: Campaign) -> tuple[float, float]:
    x = campaign.model.line.joint_table().x.tolist()
    x += [s.x_m for s in campaign.stated.sensors if s.x_m is not None and s.body in campaign.model.line.bodies]
    x += [p.x_m for p in campaign.stated.forces]
    low, high = (min(x), max(x)) if x else (0.0, 1.0)
    margin = max(0.02 * (high - low), 0.5)
    return low - margin, high + margin


def draw(
    axes: Axes, campaign: Campaign, plan: Drawing, joints: Mapping[int, Colour], stripes: Sequence[Stripe] = ()
) -> None:
    """Draw the line with sensors and hammer points.

    Parameters
    ----------
    axes : Axes
    campaign : Campaign
    plan : Drawing
    joints : mapping of int to colour
        By the joint's number; others are grey.
    stripes : sequence of Stripe
        Coloured stretches of bodies; what is not covered is grey.
    """
    low, high = plan.reach_m
    line = campaign.model.line
    table, segments = line.joint_table(), line.segments()
    lines, colours = [], []
    for j, x in enumerate(table.x.tolist()):
        upper, lower = (plan.level[segments[i].body] if i >= 0 else 0.0 for i in (table.upper[j], table.lower[j]))
        lines.append([(x, upper - HALF), (x, lower + (HALF if lower else 0.0))])
        colours.append(joints.get(j, UNKNOWN))
    # Wide enough to be seen, and apart from each other where there is room.
    width = float(np.clip(160.0 / max(1, np.unique(table.x).size), 1.2, 5.0))
    # A pale joint on white paper needs an edge.
    axes.add_collection(LineCollection(lines, colors="0.6", linewidths=width + 0.8, capstyle="butt", zorder=1.9))
    axes.add_collection(LineCollection(lines, colors=colours, linewidths=width, capstyle="butt"))
    for segment in segments:
        level = plan.level[segment.body]
        if isinstance(line.bodies[segment.body], Mass):
            at = segment.start if np.isfinite(segment.start) else _held_at(campaign, segment.name)
            axes.plot(at, level, "s", ms=3.5, color=INK, zorder=4)
            continue
        start, stop = max(segment.start, low), min(segment.stop, high)
        if stop <= start:
            continue
        axes.fill_between([start, stop], level - HALF, level + HALF, color=UNKNOWN, linewidth=0)
        for stripe in stripes:
            ends = max(stripe.from_m, start), min(stripe.to_m, stop)
            if stripe.what in (segment.name, segment.body) and ends[0] < ends[1]:
                axes.fill_between(ends, level - HALF, level + HALF, color=stripe.colour, linewidth=0)
        axes.plot(
            [start, stop, stop, start, start],
            [level - HALF, level - HALF, level + HALF, level + HALF, level - HALF],
            color=INK,
            linewidth=0.6,
        )
    axes.axhline(0.0, color=INK, linewidth=1.2)
    _instruments(axes, campaign, plan)
    heights = sorted(plan.names)
    axes.set_yticks([0.0, *heights], ["ground", *(plan.names[h] for h in heights)])
    axes.set_ylim(-0.15, plan.rows + 0.75)
    axes.set_xlim(low, high)
    axes.tick_params(axis="y", length=0, labelsize=FONT)
    axes.spines[["top", "right", "left"]].set_visible(False)


def _held_at(campaign: Campaign, mass: str) -> float:
    """Where the joints are that hold a mass."""
    line = campaign.model.line
    table, names = line.joint_table(), [s.name for s in line.segments()]
    mine = names.index(mass)
    x = table.x[(table.upper == mine) | (table.lower == mine)]
    return float(x.mean()) if x.size else float("nan")


def _instruments(axes: Axes, campaign: Campaign, plan: Drawing) -> None:
    sensors = [(s.x_m, plan.level.get(s.body or "")) for s in campaign.stated.sensors]
    points = [(p.x_m, plan.level.get(p.body)) for p in campaign.stated.forces]
    shown = np.array([p for p in points if p[1] is not None], dtype=np.float64).reshape(-1, 2)
    if shown.size:
        x, y = shown.T
        axes.plot(
            x, y + HALF + 0.16, "v", ms=4.5, color="#c77800", label="hammer point", linestyle="none", zorder=5
        )
    shown = np.array([s for s in sensors if None not in s], dtype=np.float64).reshape(-1, 2)
    if shown.size:
        axes.plot(*shown.T, "o", ms=4.5, mfc="white", mec=INK, mew=1.2, label="sensor", linestyle="none", zorder=6)
