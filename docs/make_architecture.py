"""Draws the flow of data, docs/images/architecture.svg: run `python docs/make_architecture.py`."""

from __future__ import annotations

from pathlib import Path

from matplotlib import rcParams
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

PATH = Path(__file__).parent / "images" / "architecture.svg"
# Name: (x, y of the middle, width, what it is).
BOXES = {
    "model": (1.7, 5.0, 2.6, "bodies, joints, line,\nvehicle, irregularity,\nplaces, train"),
    "laws": (1.7, 2.9, 2.6, "complex stiffness over\nfrequency, temperature;\nDMA identification"),
    "response": (5.2, 5.0, 2.6, "receptances, train,\npass-by, decay,\nderivatives"),
    "rust/core": (5.2, 2.9, 2.6, "chain and receptance\nformulations, threads;\nno Python in it"),
    "problem": (1.7, 7.1, 2.6, "a line and what is asked\nof it; formats: its file"),
    "recordings": (8.7, 7.1, 2.6, "readers, estimates,\nscreening"),
    "campaign": (8.7, 5.0, 2.6, "records, sensors,\nconditions; prediction\nof every sensor"),
    "study": (8.7, 2.9, 2.6, "many models, resumable,\non a Dask cluster"),
    "diagnosis": (12.2, 5.0, 2.6, "recalibration, catalogue,\ndecision, verdict;\nposterior: search, evidence"),
    "challenge": (12.2, 2.9, 2.6, "campaigns by finite\nelements of its own;\nruns and scores"),
    "report": (12.2, 7.1, 2.6, "pages and pictures"),
    "paper": (5.2, 7.1, 2.6, "the paper's numbers,\nreproduced"),
}
# From, to, what goes along, where the text lies beside the middle.
ARROWS = [
    ("laws", "model", "laws", (0.45, 0.0)),
    ("model", "response", "", (0.0, 0.2)),
    ("response", "rust/core", "beams, joints,\nk[law, f]", (-0.75, 0.0)),
    ("rust/core", "response", "H[f, sensor,\nforce]", (0.62, 0.0)),
    ("model", "problem", "Line, Train", (0.62, 0.0)),
    ("recordings", "campaign", "records", (0.45, 0.0)),
    ("response", "campaign", "datasets", (0.0, 0.2)),
    ("response", "study", "", (0.0, 0.0)),
    ("campaign", "diagnosis", "residuals", (0.0, 0.2)),
    ("challenge", "diagnosis", "campaigns,\nas files", (0.65, 0.0)),
    ("diagnosis", "report", "verdict,\ncomparison", (0.65, 0.0)),
    ("response", "paper", "", (0.0, 0.0)),
]
HEIGHT = 1.15


def draw() -> Figure:
    """Boxes for packages, arrows for data."""
    rcParams["svg.hashsalt"] = "permway"
    figure = Figure(figsize=(8.4, 4.7))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0.1, 13.9), ylim=(2.1, 7.9))
    axes.axis("off")
    for name, (x, y, width, text) in BOXES.items():
        colour = "#f3d9cf" if name == "rust/core" else "#e8eef4"
        style = "round,pad=0.02,rounding_size=0.12"
        box = FancyBboxPatch((x - width / 2, y - HEIGHT / 2), width, HEIGHT, boxstyle=style, fc=colour, ec="0.35")
        axes.add_patch(box)
        axes.text(x, y + 0.4, name, ha="center", va="center", fontsize=10, fontweight="bold")
        axes.text(x, y - 0.15, text, ha="center", va="center", fontsize=7.6, linespacing=1.15)
    for start, end, text, (right, up) in ARROWS:
        tail, head = _edges(start, end)
        axes.add_patch(
            FancyArrowPatch(tail, head, arrowstyle="-|>", mutation_scale=11, color="0.3", linewidth=1.1)
        )
        middle = 0.5 * (tail[0] + head[0]) + right, 0.5 * (tail[1] + head[1]) + up
        axes.text(*middle, text, ha="center", va="center", fontsize=7.4, color="0.25")
    return figure


def _edges(start: str, end: str) -> tuple[tuple[float, float], tuple[float, float]]:
    (xa, ya, wa, _), (xb, yb, wb, _) = BOXES[start], BOXES[end]
    if ya == yb:
        return (xa + wa / 2, ya), (xb - wb / 2, yb)
    side = 0.0
    if {start, end} == {"response", "rust/core"}:
        side = -0.25 if start == "response" else 0.25
    up = HEIGHT / 2 if yb > ya else -HEIGHT / 2
    if xa != xb:
        return (xa + wa / 2, ya + up * 0.9), (xb - wb / 2, yb)
    return (xa + side, ya + up), (xb + side, yb - up)


if __name__ == "__main__":
    draw().savefig(PATH, metadata={"Date": None})
    print(PATH)
