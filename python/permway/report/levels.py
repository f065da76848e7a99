"""Pictures over one-third octaves: a decay rate, an insertion loss."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from permway.arrays import Reals
from permway.files import prepare_folder, write_bytes
from permway.recordings.estimates.bands import bands_between

_SIZE_IN = (6.3, 3.0)
_FONT = 8
_COLOURS = ("#0a6fb4", "#c8431a", "#0b8f6b", "#c77800", "#7b4ea3", "#1d2433", "#8a8f98", "#c2558f")
_MOST_LABELS = 13


def draw_decay_rate(data: xr.Dataset, folder: str | Path, *, dpi: int = 150) -> Path:
    """Draw `track-decay-rate.png`: rings where the grid is too short and the rate an upper bound.

    Parameters
    ----------
    data : Dataset
        From :func:`permway.track_decay_rate`.
    folder : path
        Made if its parent exists.
    dpi : int
    """
    figure = Figure(figsize=_SIZE_IN, layout="constrained")
    axes = figure.subplots()
    rate, good = data["decay_rate"].values, data["suitable"].values
    x = np.arange(rate.size)
    axes.plot(x, rate, color=_COLOURS[0], linewidth=1.2, zorder=1)
    axes.plot(x[good], rate[good], "o", color=_COLOURS[0], markersize=4)
    if not good.all():
        axes.plot(
            x[~good],
            rate[~good],
            "o",
            color=_COLOURS[0],
            markersize=4,
            markerfacecolor="white",
            label="upper bound",
        )
    floor = data.attrs["floor_dB_per_m"]
    axes.axhline(floor, color="0.5", linestyle="--", linewidth=0.9, label=f"least the grid can show, {floor:.2g}")
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(lambda v, _: f"{v:g}")
    axes.set_ylim(0.7 * min(floor, float(rate.min())), 1.5 * float(rate.max()))
    axes.legend(fontsize=_FONT, frameon=False)
    return _write(figure, axes, data, "decay rate, dB/m", Path(folder) / "track-decay-rate.png", dpi)


def draw_insertion_loss(data: xr.Dataset, folder: str | Path, *, dpi: int = 150) -> Path:
    """Draw `insertion-loss.png`: a step for each band, a curve for each place; of receptances for the first force.

    Parameters
    ----------
    data : Dataset
        From :func:`permway.insertion_loss`.
    folder : path
        Made if its parent exists.
    dpi : int
    """
    figure = Figure(figsize=_SIZE_IN, layout="constrained")
    axes = figure.subplots()
    loss = data["insertion_loss"]
    if "force" in loss.dims:
        axes.set_title(f"force: {loss['force'].values[0]}", fontsize=_FONT, loc="left")
        loss = loss.isel(force=0)
    kind = "place" if "place" in loss.dims else "sensor"
    x = np.arange(loss.sizes["band"] + 1) - 0.5
    for index, label in enumerate(loss[kind].values):
        curve = loss.isel({kind: index}).values
        look: dict[str, Any] = {"color": _COLOURS[index % len(_COLOURS)], "linewidth": 1.4}
        axes.step(x, np.append(curve, curve[-1]), where="post", label=str(label), **look)
    axes.axhline(0.0, color="0.3", linewidth=0.8)
    axes.legend(fontsize=_FONT, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return _write(figure, axes, data, "insertion loss, dB", Path(folder) / "insertion-loss.png", dpi)


def _write(figure: Figure, axes: Axes, data: xr.Dataset, label: str, path: Path, dpi: int) -> Path:
    nominal: Reals = data["band"].values
    bands = bands_between(float(nominal[0]), float(nominal[-1]))
    step = 1 if nominal.size <= _MOST_LABELS else 3
    axes.set_xticks(np.arange(0, nominal.size, step), bands.label[::step])
    axes.set_xlabel("one-third octave, Hz", fontsize=_FONT + 1)
    axes.set_ylabel(label, fontsize=_FONT + 1)
    axes.tick_params(labelsize=_FONT)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="0.9", linewidth=0.5)
    axes.set_axisbelow(True)
    prepare_folder(path.parent, [path.name])
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return write_bytes(path, buffer.getvalue())
