"""What: the stiffness that the records ask for at the most informative place, beside that of the named law."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from permway.arrays import Reals
from permway.diagnosis.fit import WIDTH
from permway.diagnosis.result import Diagnosis
from permway.report.compare.looks import FONT, INK, logarithmic_hertz, plain
from permway.report.diagnosis.where import COLOURS


def law_picture(diagnosis: Diagnosis) -> Figure:
    """Real and imaginary part of dZ with its 90 % band, and of the laws that were named."""
    best = diagnosis.found[0]
    frequency, stiffness, sigma = best.frequency_Hz, best.stiffness_N_per_m, WIDTH * best.sigma_N_per_m
    remaining = diagnosis.remaining
    if remaining is not None and remaining.frequency_Hz.size == frequency.size:
        # About the amended model a linear step is no guess.
        stiffness = remaining.stiffness_N_per_m + sum(diagnosis.law_dZ.values())
        sigma = WIDTH * remaining.sigma_N_per_m
    figure = Figure(figsize=(6.8, 4.3), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    laws = {name: values for name, values in diagnosis.law_dZ.items() if values.size == frequency.size}
    for axes, part, words in zip(panels, (np.real, np.imag), ("stiffness", "loss"), strict=True):
        free = part(stiffness)
        axes.fill_between(
            frequency, free - sigma, free + sigma, color="0.82", linewidth=0, label="recovered, 90 %"
        )
        axes.plot(frequency, free, color=INK, linewidth=1.0, label="recovered")
        for index, (name, values) in enumerate(laws.items()):
            colour = COLOURS[index % len(COLOURS)]
            axes.plot(frequency, part(values), color=colour, linewidth=1.6, label=name)
        axes.axhline(0.0, color=INK, linewidth=0.5)
        axes.set_ylim(*_limits(free, sigma, [part(v) for v in laws.values()]))
        axes.set_ylabel(f"added {words}, N/m")
        axes.ticklabel_format(axis="y", style="sci", scilimits=(-3, 3), useMathText=True)
        axes.yaxis.get_offset_text().set_fontsize(FONT)
        plain(axes)
        logarithmic_hertz(axes, float(frequency.min()), float(frequency.max()))
    panels[-1].set_xlabel("frequency, Hz")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=4, fontsize=FONT, frameon=False)
    return figure


def _limits(free: Reals, half: Reals, laws: list[Reals]) -> tuple[float, float]:
    """An axis that shows the laws, and what was recovered where that is well known."""
    sure = np.abs(free) + half
    size = max([float(np.abs(v).max(initial=0.0)) for v in laws], default=0.0)
    size = max(size, float(np.quantile(sure, 0.9)) if not laws else float(sure.min()), 1e-12)
    inside = [v[np.abs(v) <= 2.0 * size] for v in (free - half, free + half, *laws)]
    low, high = (float(end([end(v, initial=0.0) for v in inside])) for end in (np.min, np.max))
    room = 0.1 * max(high - low, size)
    return low - room, high + room
