"""What notebooks show: a line as a drawing, a model and a campaign as a drawing and a few rows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from permway.campaign.campaign import Campaign
from permway.model.bodies import Mass
from permway.model.line import Line
from permway.problem.model import Model

WIDTH, LEFT, RIGHT, ROW, TOP = 860.0, 110.0, 20.0, 46.0, 26.0
MOST_DRAWN = 400
"""Joints of a layer, or masses of a row, that are drawn; of more every second, third and on."""

Location = tuple[str, float]
"""Name of a body, or of one of a row, and x, m."""


def line_svg(line: Line, *, forces: Sequence[Location] = (), sensors: Sequence[Location] = ()) -> str:
    """A line as a drawing: bodies from above downwards, joints between them, forces and sensors.

    Parameters
    ----------
    line : Line
    forces, sensors : sequence of (body, x in m)
        Triangles and circles.

    Returns
    -------
    str
        An `svg` element that needs nothing from outside; its ink is that of the text around it.
    """
    segments, table = line.segments(), line.joint_table()
    rows = {name: TOP + ROW * (index + 0.5) for index, name in enumerate(line.bodies)}
    ground = TOP + ROW * len(rows) + 8.0
    low, high = _reach(line, [x for _, x in (*forces, *sensors)])

    def at(x: float) -> float:
        share = (min(max(x, low), high) - low) / (high - low)
        return LEFT + share * (WIDTH - LEFT - RIGHT)

    parts = []
    for index, layer in enumerate(line.joints):
        own = np.flatnonzero(table.layer == index)
        shown = own[:: max(1, -(-own.size // MOST_DRAWN))]
        ties = "".join(
            f"M{at(table.x[j]):.1f} {rows[segments[table.upper[j]].body]:.1f}"
            f"V{ground if table.lower[j] < 0 else rows[segments[table.lower[j]].body]:.1f}"
            for j in shown
        )
        title = f"{own.size} x {layer.law}, {layer.between[0]} on {layer.between[1]}"
        parts.append(f'<path d="{ties}" stroke="#8a929c"><title>{escape(title)}</title></path>')
    for name, body in line.bodies.items():
        of_it = [s for s in segments if s.body == name]
        y = rows[name]
        if isinstance(body, Mass):
            # One that its joints place stands in the middle.
            places = [0.5 * (low + high) if np.isinf(s.start) else s.start for s in of_it]
            shapes = "".join(
                f'<rect x="{at(x) - 5.0:.1f}" y="{y - 5.0:.1f}" width="10" height="10" rx="2"/>'
                for x in places[:: max(1, -(-len(places) // MOST_DRAWN))]
            )
        else:
            spans = [(at(s.start), max(at(s.stop) - at(s.start) - 1.0, 1.0)) for s in of_it]
            shapes = "".join(
                f'<rect x="{x:.1f}" y="{y - 4.0:.1f}" width="{width:.1f}" height="8" rx="1"/>'
                for x, width in spans
            )
        parts.append(f'<g fill="#4f7ea8"><title>{escape(name)}</title>{shapes}</g>')
        parts.append(f'<text x="{LEFT - 12.0:g}" y="{y + 4.0:.1f}" text-anchor="end">{escape(name)}</text>')
    parts.append(f'<path d="M{LEFT} {ground}H{WIDTH - RIGHT}" stroke="currentColor" stroke-width="1.5"/>')
    parts.append(f'<text x="{LEFT - 12.0:g}" y="{ground + 4.0:.1f}" text-anchor="end">ground</text>')
    parts += [
        _mark("force", f"M{at(x):.1f} {y - 5.0:.1f}l-5 -10h10z", "#c46a00", s) for s, x, y in _on(forces, rows)
    ]
    circle = "m-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0"
    parts += [_mark("sensor", f"M{at(x):.1f} {y:.1f}{circle}", "#fff", s) for s, x, y in _on(sensors, rows)]
    parts.append(_scale(low, high, at(low), at(high), ground + 22.0))
    return (
        f'<svg viewBox="0 0 {WIDTH:g} {ground + 34.0:g}" role="img" style="max-width:{WIDTH:g}px;width:100%" '
        'font-family="sans-serif" font-size="12" fill="currentColor" stroke-width="1">' + "".join(parts) + "</svg>"
    )


def html(thing: object) -> str:
    """A line, a model or a campaign as HTML."""
    match thing:
        case Line():
            return line_html(thing)
        case Model():
            return model_html(thing)
        case Campaign():
            return campaign_html(thing)
    raise TypeError(f"a {type(thing).__name__} has no drawing")


def line_html(line: Line) -> str:
    """A line as a drawing, and its layers."""
    rows = [(f"{j.between[0]} on {j.between[1]}", j.law) for j in line.joints]
    return line_svg(line) + _table([("bodies", ", ".join(line.bodies)), *rows])


def model_html(model: Model) -> str:
    """A model as a drawing with its forces and sensors, its band, and what runs over it."""
    frequency = model.frequencies.array()
    rows = [("frequencies", f"{frequency.size} from {frequency[0]:g} to {frequency[-1]:g} Hz")]
    if model.temperature_C is not None:
        rows.append(("temperature", f"{model.temperature_C:g} °C"))
    if model.train is not None:
        rows.append(("train", f"at {3.6 * model.train.speed_m_per_s:g} km/h"))
    if model.irregularity is not None:
        rows.append(("irregularity", type(model.irregularity).__name__))
    places = {"forces": model.forces, "sensors": model.sensors}
    drawn = {key: [(p.body, p.x_m) for p in found] for key, found in places.items()}
    return _head(model.title or "Model") + line_svg(model.line, **drawn) + _table(rows)


def campaign_html(campaign: Campaign) -> str:
    """A campaign as a drawing of its line with sensors and blows, and how much there is."""
    stated = campaign.stated
    sensors = [(s.body, s.x_m) for s in stated.sensors if s.body is not None and s.x_m is not None]
    drawing = line_svg(campaign.model.line, forces=[(p.body, p.x_m) for p in stated.forces], sensors=sensors)
    rows = [(r.name, f"{r.statistic} of {r.file}, {r.condition}") for r in stated.records]
    rows.append(("parameters", ", ".join(p.name for p in stated.parameters) or "none"))
    return _head(stated.title or "Campaign") + drawing + _table(rows)


def _reach(line: Line, places: Iterable[float]) -> tuple[float, float]:
    """From and to of what is drawn, m: all that has a place, and a twentieth more on both sides."""
    ends = [x for s in line.segments() for x in (s.start, s.stop) if np.isfinite(x)]
    known = np.array([*line.joint_table().x.tolist(), *ends, *places])
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    margin = 0.05 * (high - low) or 1.0
    return low - margin, high + margin


def _on(locations: Sequence[Location], rows: dict[str, float]) -> list[tuple[str, float, float]]:
    """Label, x and height of each mark."""
    return [(f"{body} at {x:g} m", x, rows[body.partition("[")[0]]) for body, x in locations]


def _mark(kind: str, path: str, colour: str, label: str) -> str:
    ink = ' stroke="#222" stroke-width="1.5"' if kind == "sensor" else ""
    return f'<path d="{path}" fill="{colour}"{ink}><title>{kind}: {escape(label)}</title></path>'


def _scale(low: float, high: float, left: float, right: float, y: float) -> str:
    step = 10.0 ** np.floor(np.log10((high - low) / 3.0))
    step *= next((k for k in (1.0, 2.0, 5.0) if (high - low) / (k * step) <= 8.0), 10.0)
    marks = np.arange(np.ceil(low / step), np.floor(high / step) + 1.0) * step
    return "".join(
        f'<text x="{left + (x - low) / (high - low) * (right - left):.1f}" y="{y:.1f}" text-anchor="middle" '
        f'font-size="11">{x + 0.0:g}{" m" if x == marks[-1] else ""}</text>'
        for x in marks
    )


def _head(title: str) -> str:
    return f"<p style='margin:0 0 4px'><b>{escape(title)}</b></p>"


def _table(rows: Iterable[tuple[str, str]]) -> str:
    cells = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(text)}</td></tr>"
        for name, text in rows
    )
    return f"<table>{cells}</table>"
