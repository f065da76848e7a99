"""Pictures of what a solved model's dataset holds."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from itertools import cycle
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from permway.errors import must_be
from permway.files import prepare_folder, write_bytes
from permway.report.passby import passage
from permway.response.decay import decay_rate

_WIDTH_IN = 6.3
_FONT = 8
_FEW = 40
"""Up to so many frequencies are marked on their curves."""
_COLOURS = ("#0a6fb4", "#c8431a", "#0b8f6b", "#c77800", "#7b4ea3", "#1d2433", "#8a8f98", "#c2558f")
_STYLES = ("-", "--", ":")
_UNITS = {"m2/Hz": "m²/Hz", "(m/s)2/Hz": "(m/s)²/Hz", "(m/s2)2/Hz": "(m/s²)²/Hz", "N2/Hz": "N²/Hz"}


def draw_dataset(data: xr.Dataset, folder: Path, *, dpi: int = 150) -> list[Path]:
    """Draw what a dataset of `permway solve` holds, one PNG each.

    Parameters
    ----------
    data : Dataset
        From :func:`permway.problem.solve.solve`.
    folder : Path
        Made if its parent exists.
    dpi : int
        Dots per inch; 300 for print.

    Returns
    -------
    list of Path
        Those of these that the data give: `receptance-FORCE.png` for each force, `wheel-rail-force.png`,
        `vehicle-acceleration.png`, `line-acceleration.png`, `contact-receptance.png`, `decay-rate.png`,
        `passby-SENSOR.png` for each sensor.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    must_be(data, xr.Dataset, "data", remedy="as in draw_dataset(solve(model), folder)")
    drawn = dict(_pictures(data))
    prepare_folder(Path(folder), drawn)
    paths = []
    for name, figure in drawn.items():
        buffer = io.BytesIO()
        # No date and no version inside: the same data give the same file.
        figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
        paths.append(write_bytes(Path(folder) / name, buffer.getvalue()))
    return paths


def _pictures(data: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    if "receptance" in data:
        names = _file_names([str(f) for f in data["force"].values])
        for force, name in names.items():
            yield f"receptance-{name}.png", _receptance(data, force)
    for variable, name, dimension, title in (
        ("wheel_rail_force_psd", "wheel-rail-force", "wheel", "wheel-rail force"),
        ("vehicle_acceleration_psd", "vehicle-acceleration", "degree", "acceleration"),
        ("line_acceleration_psd", "line-acceleration", "place", "acceleration"),
    ):
        if variable in data:
            yield f"{name}.png", _densities(data[variable], dimension, title)
    if "passby_history" in data:
        for sensor, name in _file_names([str(s) for s in data["sensor"].values]).items():
            yield f"passby-{name}.png", passage(data, sensor)
    if "track_receptance" in data:
        yield "contact-receptance.png", _contact(data)
        if data.sizes["wheel"] > 1:
            yield "decay-rate.png", _decay(data)


def _receptance(data: xr.Dataset, force: str) -> Figure:
    """Modulus and phase at all sensors for one force."""
    chosen = data["receptance"].sel(force=force)
    curves = [(str(s), chosen.sel(sensor=s).values) for s in data["sensor"].values]
    return _modulus_and_phase(data, curves, f"force: {force}")


def _contact(data: xr.Dataset) -> Figure:
    """Wheel, track, contact and total at the first wheel."""
    first = {"wheel": data["wheel"][0], "wheel_force": data["wheel"][0]}
    curves = [(part, data[f"{part}_receptance"].sel(first).values) for part in ("wheel", "track")]
    contact = np.full(data.sizes["frequency"], complex(data["contact_receptance"]))
    curves += [("contact", contact), ("total", data["total_receptance"].sel(first).values)]
    return _modulus_and_phase(data, curves, f"flexibilities at {data['wheel'].values[0]}")


def _modulus_and_phase(data: xr.Dataset, curves: Sequence[tuple[str, np.ndarray]], title: str) -> Figure:
    figure = Figure(figsize=(_WIDTH_IN, 4.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    for (name, value), (colour, style) in zip(curves, _looks(), strict=False):
        look = {"color": colour, "linestyle": style, "linewidth": 1.2}
        upper.plot(data["frequency"], np.abs(value), label=name, **look)
        lower.plot(*_phase(data["frequency"].values, value), **look)
    upper.set(yscale="log", ylabel="receptance, m/N")
    upper.set_title(title, fontsize=_FONT + 1, loc="left")
    lower.set(ylabel="phase, degrees", yticks=np.arange(-180, 181, 90), ylim=(-190, 190))
    return _finish(figure, data, upper, lower)


def _densities(density: xr.DataArray, dimension: str, title: str) -> Figure:
    """One panel of power spectra; a second one for angles, whose unit is another."""
    labels = [str(label) for label in density[dimension].values]
    angles = [label for label in labels if dimension == "degree" and label.endswith("pitch")]
    groups = [[label for label in labels if label not in angles], angles]
    groups = [group for group in groups if group]
    figure = Figure(figsize=(_WIDTH_IN, 0.4 + 2.7 * len(groups)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(len(groups), 1, sharex=True))
    unit = _UNITS.get(str(density.attrs["units"]), str(density.attrs["units"]))
    for panel, group in zip(panels, groups, strict=True):
        for label, (colour, style) in zip(group, _looks(), strict=False):
            curve = density.sel({dimension: label})
            panel.plot(density["frequency"], curve, label=label, color=colour, linestyle=style, linewidth=1.2)
        angular = group is angles
        panel.set(
            yscale="log",
            ylabel=f"{'angular ' if angular else ''}{title}, {unit.replace('(m', '(rad') if angular else unit}",
        )
        # Where delays cancel, nothing is left but rounding; the axis does not follow it there.
        top = float(density.sel({dimension: group}).max())
        panel.set_ylim(bottom=max(panel.get_ylim()[0], top * 1e-12))
    return _finish(figure, density, *panels)


def _decay(data: xr.Dataset) -> Figure:
    """Decay rate from the first contact point to each of the others."""
    first = data["wheel"].values[0]
    track = data["track_receptance"].sel(wheel_force=first)
    x = {str(p): float(v) for p, v in zip(data["place"].values, data["place_x"].values, strict=True)}
    figure = Figure(figsize=(_WIDTH_IN, 3.0), layout="constrained")
    axes = figure.subplots()
    for wheel, (colour, style) in zip(data["wheel"].values[1:], _looks(), strict=False):
        distance = abs(x[str(wheel)] - x[str(first)])
        rate = decay_rate(track.sel(wheel=first).values, track.sel(wheel=wheel).values, distance)
        label = f"{first} to {wheel}, {distance:g} m"
        axes.plot(data["frequency"], rate, label=label, color=colour, linestyle=style, linewidth=1.2)
    axes.set(ylabel="decay rate, dB/m")
    return _finish(figure, data, axes)


def _finish(figure: Figure, data: xr.Dataset | xr.DataArray, *panels: Axes) -> Figure:
    f = data["frequency"].values
    logarithmic = f.size > 2 and not np.allclose(np.diff(f), f[1] - f[0])
    for axes in panels:
        axes.set_xlim(f[0], f[-1] if f.size > 1 else f[0] * 1.01)
        if logarithmic:
            axes.set_xscale("log")
            axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
            if f[-1] / f[0] < 100.0:
                axes.xaxis.set_minor_formatter(lambda x, _: f"{x:g}" if f"{x:e}"[0] in "25" else "")
            else:
                axes.xaxis.set_minor_formatter("")
        if f.size <= _FEW:
            for curve in axes.lines:
                curve.set(marker="o", markersize=2.5)
        axes.tick_params(labelsize=_FONT, which="both")
        axes.yaxis.label.set_fontsize(_FONT + 1)
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="0.9", linewidth=0.5)
        axes.set_axisbelow(True)
        if axes.get_legend_handles_labels()[1]:
            axes.legend(fontsize=_FONT - 1, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    panels[-1].set_xlabel("frequency, Hz", fontsize=_FONT + 1)
    return figure


def _looks() -> Iterator[tuple[str, str]]:
    """Colours, then the same again in another line style."""
    return ((colour, style) for style in cycle(_STYLES) for colour in _COLOURS)


def _phase(frequency: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequency and degrees between -180 and 180."""
    degrees = np.degrees(np.angle(value))
    # Rounding must not make -180 a +180.
    degrees = np.where(degrees > 179.999, -180.0, degrees)
    # A turn past 180 is no line across the panel: the curve is lifted there.
    turns = np.flatnonzero(np.abs(np.diff(degrees)) > 180.0) + 1
    return np.insert(frequency, turns, np.nan), np.insert(degrees, turns, np.nan)


def _file_names(labels: Sequence[str]) -> dict[str, str]:
    """Labels to names that any file system takes, each its own."""
    names: dict[str, str] = {}
    for label in labels:
        stem = re.sub(r"[^A-Za-z0-9.]+", "-", label).strip("-.") or "force"
        name, number = stem, 2
        while name.lower() in (taken.lower() for taken in names.values()):
            name, number = f"{stem}-{number}", number + 1
        names[label] = name
    return names
