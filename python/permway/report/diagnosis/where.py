"""Where: what a free stiffness explains along the track, and in which band."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.spot import Found
from permway.report.compare.looks import FONT, edges, plain
from permway.report.diagnosis.track import Colour, Drawing, Stripe, draw, drawing

COLOURS = ("#0a6fb4", "#c77800", "#0b8f6b", "#a8321a", "#6a4fa0", "#59606b", "#8a6d00", "#c2548f")
PLACE = "#a8321a"
"""Of the place that the verdict names."""

WIDTH_IN = 7.4
QUIET = 5.0
"""Gain per free number at which the colours end at least: chance alone stays pale."""

MOST_MAPS = 3
LINES_PER_OCTAVE = 6
"""Of the map place against frequency."""


def track_picture(diagnosis: Diagnosis) -> Figure:
    """Gain along x, layer by layer and body by body, above the track drawing in its colours."""
    campaign, found = diagnosis.base.campaign, diagnosis.found
    plan = drawing(campaign)
    highest = max(float(found[0].degrees), max(f.surplus for f in found))
    figure = Figure(figsize=(WIDTH_IN, 2.9 + 0.55 * plan.rows), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.9, 0.4 + 0.55 * plan.rows))
    left = dict(groups(diagnosis.left))
    for index, (name, mine) in enumerate(groups(found)):
        mark = "o" if mine[0].spot.kind == "joint" else "s"
        colour = COLOURS[index % len(COLOURS)]
        above.plot(*_along(mine), marker=mark, ms=2.6, lw=1.0, color=colour, label=name)
        if name in left:
            above.plot(*_along(left[name]), linestyle=":", lw=1.1, color=colour, label="after the amendment")
    # The root of a gain counts standard deviations, and shows small ones, too.
    above.set_yscale("function", functions=(_root, np.square))
    above.set_ylim(0.0, highest * 1.15)
    above.yaxis.set_major_locator(MaxNLocator(5))
    above.set_ylabel("gain beyond chance")
    plain(above)
    above.tick_params(labelbottom=False)
    palette, scale = colormaps["YlOrRd"], PowerNorm(0.5, 0.0, max(highest, QUIET * found[0].degrees))
    colours = {j: palette(scale(max(f.surplus, 0.0))) for f in found for j in f.spot.joints}
    draw(below, campaign, plan, colours, _stripes(campaign, plan, found, lambda gain: palette(scale(gain))))
    below.set_xlabel("x, m", fontsize=FONT + 0.5)
    below.tick_params(axis="x", labelsize=FONT)
    for axes in (above, below):
        _mark_places(axes, diagnosis)
    handles, labels = above.get_legend_handles_labels()
    more, words = below.get_legend_handles_labels()
    unique = dict(zip([*labels, *words], [*handles, *more], strict=True))
    figure.legend(
        list(unique.values()),
        list(unique),
        loc="outside upper left",
        ncols=min(6, len(unique)),
        fontsize=FONT - 0.5,
        frameon=False,
    )
    return figure


def _stripes(
    campaign: Campaign, plan: Drawing, found: Sequence[Found], colour: Callable[[float], Colour]
) -> list[Stripe]:
    """Each scanned place of a body's segment, to halfway to its neighbours."""
    stripes = []
    for segment in campaign.model.line.segments():
        start, stop = max(segment.start, plan.reach_m[0]), min(segment.stop, plan.reach_m[1])
        here = sorted(
            (f.spot.x_m[0], max(f.surplus, 0.0))
            for f in found
            if f.spot.kind == "body" and f.spot.name == segment.name and start <= f.spot.x_m[0] <= stop
        )
        x = np.array([one[0] for one in here])
        borders = [start, *(0.5 * (x[1:] + x[:-1])).tolist(), stop]
        for (_, gain), low, high in zip(here, borders, borders[1:], strict=False):
            stripes.append(Stripe(segment.name, low, high, colour(gain)))
    return stripes


def frequency_picture(diagnosis: Diagnosis) -> Figure:
    """Place against frequency of the most informative layers or bodies."""
    chosen = groups(diagnosis.found)[:MOST_MAPS]
    plan = drawing(diagnosis.base.campaign)
    figure = Figure(figsize=(WIDTH_IN, 0.5 + 1.9 * len(chosen)), layout="constrained")
    panels = figure.subplots(len(chosen), 1, sharex=True, squeeze=False)[:, 0]
    maps = [_banded(mine) for _, mine in chosen]
    limit = max(float(diagnosis.found[0].degrees), max(float(values.max(initial=0.0)) for _, _, values in maps))
    palette, scale = colormaps["YlOrRd"], PowerNorm(0.5, 0.0, limit)
    for axes, (name, mine), (x, frequency, values) in zip(panels, chosen, maps, strict=True):
        wide = np.diff(x).min() if x.size > 1 else 1.0
        borders = np.concatenate([[x[0] - 0.5 * wide], 0.5 * (x[1:] + x[:-1]), [x[-1] + 0.5 * wide]])
        axes.set_facecolor("0.94")
        mesh = axes.pcolormesh(borders, edges(frequency), values, cmap=palette, norm=scale, rasterized=True)
        axes.set_yscale("log")
        _hertz(axes, frequency)
        axes.set_ylabel("Hz")
        kind = "joints" if mine[0].spot.kind == "joint" else "body"
        axes.set_title(f"{name} ({kind})", fontsize=FONT, loc="left")
        axes.set_xlim(*plan.reach_m)
        plain(axes)
        axes.grid(visible=False)
        axes.tick_params(labelbottom=axes is panels[-1])
        _mark_places(axes, diagnosis, shaded=False)
    panels[-1].set_xlabel("x, m")
    bar = figure.colorbar(mesh, ax=list(panels), fraction=0.03, pad=0.01)
    bar.ax.tick_params(labelsize=FONT)
    bar.set_label("gain in the band", fontsize=FONT)
    return figure


def groups(found: tuple[Found, ...]) -> list[tuple[str, list[Found]]]:
    """Spots by layer or body, each along x; the most informative first."""
    sorted_by: dict[tuple[str, str], list[Found]] = {}
    for one in found:
        sorted_by.setdefault((one.spot.kind, one.spot.name), []).append(one)
    for mine in sorted_by.values():
        mine.sort(key=lambda f: f.spot.x_m)
    ranked = sorted(sorted_by.items(), key=lambda item: -max(f.surplus for f in item[1]))
    names = [name for (_, name), _ in ranked]
    # A body may bear a law's name.
    return [(f"{n}, {kind}" if names.count(n) > 1 else n, mine) for (kind, n), mine in ranked]


def _along(mine: list[Found]) -> tuple[Reals, Reals]:
    """Places and gains beyond chance, never below 0."""
    return np.array([f.spot.x_m[0] for f in mine]), np.maximum([f.surplus for f in mine], 0.0)


def _root(values: Reals) -> Reals:
    return np.asarray(np.sqrt(np.maximum(values, 0.0)))


def _banded(mine: list[Found]) -> tuple[Reals, Reals, Reals]:
    """Places, middles of bands and the gain in each, never below 0: (x, frequency, values (F, x))."""
    x = np.array([f.spot.x_m[0] for f in mine])
    number = [np.round(LINES_PER_OCTAVE * np.log2(f.frequency_Hz)).astype(int) for f in mine]
    bands = np.arange(min(n.min() for n in number), max(n.max() for n in number) + 1)
    values = np.array([[f.by_band[n == band].sum() for band in bands] for f, n in zip(mine, number, strict=True)])
    where, first = np.unique(x, return_index=True)
    return where, np.asarray(2.0 ** (bands / LINES_PER_OCTAVE)), np.maximum(values[first].T, 0.0)


def _hertz(axes: Axes, frequency_Hz: Reals) -> None:
    low, high = float(frequency_Hz.min()), float(frequency_Hz.max())
    ticks = [s * 10.0**d for d in range(-1, 5) for s in (1.0, 2.0, 5.0) if low <= s * 10.0**d <= high]
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.yaxis.set_major_formatter(lambda v, _: f"{v:g}")
    axes.yaxis.set_minor_locator(NullLocator())


def _mark_places(axes: Axes, diagnosis: Diagnosis, *, shaded: bool = True) -> None:
    """The places of the verdict: the changed stretch between lines, what holds it with 90 % shaded or dotted."""
    for effect in diagnosis.verdict.effects:
        within, stretch = effect.place.within, effect.place.x
        if within is not None and shaded:
            axes.axvspan(*within, color=PLACE, alpha=0.15, linewidth=0, zorder=0.5, label="place, 90 %")
        for x in within if within is not None and not shaded else ():
            axes.axvline(x, color=PLACE, linewidth=1.0, linestyle=":", zorder=3)
        for x in stretch or ():
            axes.axvline(x, color=PLACE, linewidth=0.9, linestyle=(0, (4, 2)), label="place", zorder=3)
