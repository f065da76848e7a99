"""Operating deflection shapes on a page: every body and joint, moving."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment, PackageLoader, StrictUndefined

from permway.arrays import Complexes
from permway.errors import InputError, must_be
from permway.files import write_text
from permway.model.line import Line
from permway.report.diagnosis.track import levels
from permway.response.operating import greatest_deg

WIDE, LEVEL, LEFT, TOP = 960.0, 84.0, 84.0, 72.0
"""Of the drawing, in its own units: width, height of a level, margins."""

FARTHEST = 0.4
"""The greatest displacement drawn, in levels."""

DIGITS = 4
"""Of the greatest displacement, which is drawn as 1."""


def animate_shapes(data: xr.Dataset, line: Line, path: str | Path, *, title: str = "") -> Path:
    """Write a page that shows operating deflection shapes in motion; it needs nothing from outside.

    Without scripts, and on paper, the moment is shown at which the place that moves most is farthest down.

    Parameters
    ----------
    data : Dataset
        From :func:`permway.operating_shapes`.
    line : Line
        The same; its bodies and joints are drawn.
    path : path
        Of the page, HTML.
    title : str
        Heading.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        If nothing moves, or the page cannot be written.
    """
    must_be(data, xr.Dataset, "data", remedy="as in animate_shapes(permway.operating_shapes(...), line, path)")
    must_be(line, Line, "line", remedy="of a model it is model.line")
    environment = Environment(
        loader=PackageLoader("permway.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    heights, names = levels(line)
    level = {body: heights[body.partition("[")[0]] for body in map(str, data["place_body"].values)}
    figures = [
        _figure(data.isel(frequency=i, force=j), level, names)
        for i in range(data.sizes["frequency"])
        for j in range(data.sizes["force"])
    ]
    page = environment.get_template("shapes.html.j2").render(title=title or "A line", figures=figures)
    return write_text(Path(path), page)


def _figure(one: xr.Dataset, level: dict[str, float], names: dict[float, str]) -> dict[str, Any]:
    """What the template draws of one frequency and one force."""
    shape: Complexes = np.asarray(one["shape"].values, dtype=np.complex128)
    greatest = float(np.abs(shape).max())
    if not greatest > 0.0:
        raise InputError("nothing moves", where=str(one["force"].item()), remedy="choose another force")
    x, bodies = one["place_x"].values, one["place_body"].values.astype(str)
    low, high = float(min(x.min(), one["force_x"].item())), float(x.max())
    across = (WIDE - LEFT - 20.0) / max(high - low, 1e-9)
    columns = LEFT + (x - low) * across if high > low else np.full(x.size, 0.5 * (WIDE + LEFT))
    deepest = TOP + LEVEL * len(names)
    rows = np.array([deepest - LEVEL * level[body] for body in bodies])
    phase = greatest_deg(shape)
    relative: Complexes = np.asarray(shape / greatest, dtype=np.complex128)
    most = int(np.abs(shape).argmax())
    lines = [np.flatnonzero(bodies == body).tolist() for body in dict.fromkeys(bodies)]
    return {
        "frequency": f"{one['frequency'].item():.4g}",
        "force": str(one["force"].item()),
        "greatest": _metres(greatest),
        "where": f"{bodies[most]} at {x[most]:.4g} m",
        "height": deepest + 44.0,
        "ground": deepest,
        "levels": [(name, deepest - LEVEL * height) for height, name in names.items()],
        "arrow": (LEFT + (one["force_x"].item() - low) * across if high > low else 0.5 * (WIDE + LEFT)),
        "arrow_on": deepest - LEVEL * level[str(one["force_body"].item())],
        "ticks": [(f"{t:g}", LEFT + (t - low) * across) for t in _ticks(low, high)] if high > low else [],
        "phase": round(phase),
        "json": _json(
            {
                "x": _rounded(columns, 1),
                "y": _rounded(rows, 1),
                "re": _rounded(relative.real, DIGITS),
                "im": _rounded(relative.imag, DIGITS),
                "bodies": lines,
                "joints": _joints(one, bodies),
                "ground": deepest,
                "far": FARTHEST * LEVEL,
                "phase": round(phase),
            }
        ),
        "paths": [_path(columns, rows, relative, at, phase) for at in lines],
        "rests": [(columns[at[0]], columns[at[-1]], rows[at[0]]) for at in lines],
    }


def _joints(one: xr.Dataset, bodies: np.ndarray) -> list[list[int]]:
    """Index of the place at either end of each joint, -1 for the ground."""
    x = one["place_x"].values
    found = []
    for upper, lower, at in zip(
        one["joint_body"].values, one["joint_onto"].values, one["joint_x"].values, strict=True
    ):
        ends = []
        for name in (upper, lower):
            own = np.flatnonzero(bodies == str(name))
            ends.append(int(own[np.abs(x[own] - at).argmin()]) if own.size else -1)
        found.append(ends)
    return found


def _path(columns: np.ndarray, rows: np.ndarray, relative: Complexes, at: list[int], phase: float) -> str:
    down = FARTHEST * LEVEL * (relative[at] * np.exp(1j * np.deg2rad(phase))).real
    points = [f"{a:.1f},{b:.1f}" for a, b in zip(columns[at], rows[at] + down, strict=True)]
    return "M" + "L".join(points if len(points) > 1 else points * 2)


def _metres(value: float) -> str:
    """Per newton, with a prefix: what a track moves is from picometres to millimetres."""
    for prefix, size in (("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9)):
        if value >= size:
            return f"{value / size:.3g} {prefix}"
    return f"{value / 1e-12:.3g} pm"


def _ticks(low: float, high: float) -> list[float]:
    rough = (high - low) / 8.0
    size = 10.0 ** np.floor(np.log10(rough))
    step = float(next(size * k for k in (1.0, 2.0, 5.0, 10.0) if size * k >= rough))
    first = np.ceil(low / step) * step
    return [float(round(t, 9)) for t in np.arange(first, high + 1e-9 * step, step)]


def _rounded(values: np.ndarray, digits: int) -> list[float]:
    return [round(float(v), digits) + 0.0 for v in values]


def _json(content: dict[str, Any]) -> str:
    # It stands inside a script element, which nothing in it may end.
    return json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
