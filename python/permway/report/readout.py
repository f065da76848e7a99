"""Pictures for pages: the image, and what a pointer reads off it, the numbers behind its lines and maps."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from permway.arrays import Reals

DIGITS = 4
"""Significant, of every number that is read off."""

Names = dict[tuple[str, str, str], str]
"""By colour, stroke and mark."""

MOST_POINTS = 600
"""Of a line; a longer one is thinned, for the page."""


@dataclass(frozen=True)
class Drawn:
    """A picture on a page.

    Attributes
    ----------
    png : bytes
    readout : str
        JSON, see :func:`readout`.
    """

    png: bytes
    readout: str

    @property
    def base64(self) -> str:
        """The image as text."""
        return base64.b64encode(self.png).decode("ascii")


def drawn(figures: Iterable[tuple[str, Figure]], dpi: int) -> dict[str, Drawn]:
    """Draw figures, by name.

    No date and no version inside: the same data give the same images.
    """
    found = {}
    for name, figure in figures:
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
        found[name] = Drawn(buffer.getvalue(), readout(figure))
    return found


def readout(figure: Figure) -> str:
    """Lines and maps of a figure as JSON, for `readout.js`; the figure has to be drawn.

    Parameters
    ----------
    figure : matplotlib Figure
        After `savefig`, so that everything has its place.

    Returns
    -------
    str
        A list of axes: `box` (left, top, right, bottom as fractions of the image), `x` and `y` (label, limits,
        whether logarithmic, names of ticks), `lines` (label, x, y, whether its points stand alone), `maps` (label,
        edges, values).
    """
    names, bar = _names(figure), ""
    for axes in figure.axes:
        bar = axes.get_ylabel() or axes.get_xlabel() if axes.get_label() == "<colorbar>" else bar
    found = [_axes(axes, names, bar) for axes in figure.axes if axes.get_label() != "<colorbar>"]
    text = json.dumps(
        [one for one in found if one["lines"] or one["maps"]], allow_nan=False, separators=(",", ":")
    )
    # It stands inside a script element, which a label must not end.
    return text.replace("<", "\\u003c")


def _looks(line: Line2D) -> tuple[str, str, str]:
    """Colour, stroke and mark."""
    return to_hex(line.get_color()), str(line.get_linestyle()), str(line.get_marker())


def _names(figure: Figure) -> Names:
    """What lines of certain looks are called, in whatever panel it is stated."""
    lines = (line for axes in figure.axes for line in axes.lines)
    stated = ((_looks(line), str(line.get_label())) for line in lines)
    return {looks: " ".join(label.split()) for looks, label in stated if not label.startswith("_")}


def _axes(axes: Axes, names: Names, bar: str) -> dict[str, Any]:
    box = axes.get_position()
    lines = [made for line in axes.lines if (made := _line(line, axes, names)) is not None]
    maps = [_map(mesh, bar) for mesh in axes.collections if isinstance(mesh, QuadMesh)]
    return {
        "box": [_number(v) for v in (box.x0, 1.0 - box.y1, box.x1, 1.0 - box.y0)],
        "x": _scale(axes, "x"),
        "y": _scale(axes, "y"),
        "lines": lines,
        "maps": maps,
    }


def _scale(axes: Axes, which: str) -> dict[str, Any]:
    axis = getattr(axes, f"{which}axis")
    shared = getattr(axes, f"get_shared_{which}_axes")().get_siblings(axes)
    labels = [text for other in shared if (text := getattr(other, f"get_{which}label")())]
    low, high = getattr(axes, f"get_{which}lim")()
    ticks = [(_number(tick.get_loc()), tick.label1.get_text()) for tick in axis.get_major_ticks()]
    words = [[place, text] for place, text in ticks if any(c.isalpha() for c in text.replace("mathdefault", ""))]
    label = getattr(axes, f"get_{which}label")() or (labels[0] if labels else "")
    return {
        "label": label,
        "limits": [_number(low), _number(high)],
        "log": axis.get_scale() == "log",
        "names": words,
    }


def _line(line: Line2D, axes: Axes, names: Names) -> dict[str, Any] | None:
    """A line that has a name and runs over the axes' own coordinates; None for a mere guide."""
    if line.get_transform() != axes.transData:
        return None
    label = names.get(_looks(line), "")
    x, y = (np.asarray(v, dtype=np.float64) for v in line.get_data())
    alone = line.get_linestyle() in ("None", "none", "", " ")
    inside = np.isfinite(x) & np.isfinite(y)
    if not label or inside.sum() < (1 if alone else 3):
        return None
    kept = np.flatnonzero(inside)
    kept = kept[:: max(1, -(-kept.size // MOST_POINTS))]
    return {"label": label, "x": _numbers(x[kept]), "y": _numbers(y[kept]), "alone": alone}


def _map(mesh: QuadMesh, label: str) -> dict[str, Any]:
    corners = np.asarray(mesh.get_coordinates(), dtype=np.float64)
    values = np.ma.asarray(mesh.get_array(), dtype=np.float64).reshape(corners.shape[0] - 1, corners.shape[1] - 1)
    rows = [[None if np.ma.is_masked(v) or not np.isfinite(v) else _number(v) for v in row] for row in values]
    return {"label": label, "x": _numbers(corners[0, :, 0]), "y": _numbers(corners[:, 0, 1]), "values": rows}


def _number(value: float) -> float:
    return float(f"{float(value):.{DIGITS}g}")


def _numbers(values: Reals | Sequence[float]) -> list[float]:
    return [float(f"{float(v):.{DIGITS + 1}g}") for v in values]
