"""Draws the README's pictures, docs/images/diagnosis.png and viaduct.png: run `python docs/make_pictures.py`."""

from __future__ import annotations

import tempfile
from pathlib import Path

import make_diagnosis_picture
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from permway.paper.conventions import PAPER_FREE_GIRDER
from permway.paper.figures.style import TEMPERATURE, celsius
from permway.paper.identify import BAND_HZ, FAMILIES, PAPERS_FAMILY, TWO_SPRINGPOTS, free_pad, one_law
from permway.paper.pad_layer import PadLayer
from permway.paper.printed import PRINTED, TEMPERATURES_C
from permway.paper.readings import MINIMUM_BAND_HZ, Curves, extremum

IMAGES = Path(__file__).parent / "images"
WIDTH_PX, HEIGHT_PX, DPI = 1360, 660, 160


def curves() -> dict[int, Curves]:
    """The paper's train on its viaduct at three temperatures, with one law for the pads."""
    convention = PAPER_FREE_GIRDER
    layer = PadLayer.of(convention, BAND_HZ)
    free = {t: free_pad(layer, t) for t in TEMPERATURES_C}
    family = {f.name: f for f in FAMILIES}
    simpler = one_law(layer, family[TWO_SPRINGPOTS], free)
    law = one_law(layer, family[PAPERS_FAMILY], free, simpler=simpler).law
    return {t: Curves.of(convention.run(law, t)) for t in TEMPERATURES_C}


def draw(found: dict[int, Curves]) -> Figure:
    """Total flexibility with its minima, wheel-rail force with its peaks, and what the paper prints."""
    figure = Figure(figsize=(WIDTH_PX / DPI, HEIGHT_PX / DPI), dpi=DPI, layout="constrained")
    left, right = figure.subplots(1, 2)
    for t, c in found.items():
        f, look = c.frequency, {"color": TEMPERATURE[t], "linewidth": 1.7}
        left.plot(f, c.total, label=celsius(t), **look)
        right.plot(f, c.force / 1e3, label=celsius(t), **look)
        here = extremum(f, c.total, MINIMUM_BAND_HZ, lowest=True)
        left.plot(here.at_Hz, here.value, "o", color=TEMPERATURE[t], markersize=5.5)
        printed = {r.quantity: r for r in PRINTED if r.temperature_C == t}
        left.axvline(printed["flexibility_minimum_Hz"].value, color=TEMPERATURE[t], linestyle=":", linewidth=1.1)
        force = printed["force"]
        assert force.at_Hz is not None
        right.plot(force.at_Hz, force.value / 1e3, **_diamond(TEMPERATURE[t]))
    left.set(
        ylabel="wheel + track + contact flexibility, m/N",
        title="A colder pad moves the resonance up",
        xlim=(0, 200),
    )
    right.set(
        ylabel="wheel-rail force, kN (as the paper prints it)", title="Wheel-rail force at 350 km/h", xlim=(0, 200)
    )
    left.plot([], [], "o", color="0.35", markersize=5.5, label="minimum, computed")
    left.plot([], [], ":", color="0.35", linewidth=1.1, label="minimum, printed (59, 75, 93 Hz)")
    right.plot([], [], label="peak, printed (Table 5)", **_diamond("0.35"))
    for axes in (left, right):
        _finish(axes)
    right.yaxis.set_major_formatter(lambda y, _: f"{y:g}")
    return figure


def _diamond(colour: str) -> dict[str, object]:
    return {
        "marker": "D",
        "linestyle": "none",
        "markerfacecolor": "none",
        "markeredgecolor": colour,
        "markeredgewidth": 1.6,
        "markersize": 8,
    }


def _finish(axes: Axes) -> None:
    axes.set(yscale="log", xlabel="frequency, Hz", xticks=np.arange(0, 201, 25))
    axes.title.set(fontsize=11)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="0.91", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.legend(fontsize=8.5, facecolor="white", edgecolor="none", framealpha=1.0)


def main() -> None:
    """Both pictures."""
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        diagnosis = make_diagnosis_picture.draw(make_diagnosis_picture.diagnose(Path(folder)))
    for name, figure in (("diagnosis", diagnosis), ("viaduct", draw(curves()))):
        path = IMAGES / f"{name}.png"
        figure.savefig(path, dpi=DPI, metadata={"Software": None})
        print(path)


if __name__ == "__main__":
    main()
