"""Pictures of a track's waves, and of an irregularity over spatial frequency and along the track."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from permway.arrays import Reals
from permway.files import prepare_folder, write_bytes
from permway.model.irregularity_spectra import Irregularity
from permway.model.track_quality import BANDS_M, density_per_cycle
from permway.response.dispersion import Dispersion

_SIZE_IN = (6.3, 3.2)
_FONT = 8
_HIGHEST_HZ = 2000.0
"""Of the picture of waves: half hides the wave of a rail on stiff pads, twice squeezes the rest."""


def draw_dispersion(found: Dispersion, folder: str | Path) -> Path:
    """Draw `dispersion.png`: frequency and phase speed over wavenumber, and the critical speed.

    Parameters
    ----------
    found : Dispersion
    folder : Path
        Made if its parent exists.

    Returns
    -------
    Path
        The picture.
    """
    figure = Figure(figsize=_SIZE_IN, layout="constrained")
    left, right = figure.subplots(1, 2)
    kappa = found.wavenumber_rad_per_m
    for branch in range(found.frequency_Hz.shape[1]):
        left.plot(kappa, found.frequency_Hz[:, branch], color=f"C{branch}", linewidth=1.2)
        right.plot(kappa, found.phase_speed_m_per_s[:, branch], color=f"C{branch}", linewidth=1.2)
    top = min(_HIGHEST_HZ, 1.05 * float(found.frequency_Hz.max()))
    left.set(xlabel="wavenumber, rad/m", ylabel="frequency, Hz", ylim=(0.0, top), xlim=(0.0, kappa[-1]))
    slowest = float(found.phase_speed_m_per_s.min())
    right.set(xlabel="wavenumber, rad/m", ylabel="phase speed, m/s", xscale="log", yscale="log")
    right.set_ylim(0.7 * slowest, 100.0 * slowest)
    speed, at = found.critical_speed_m_per_s, found.critical_wavenumber_rad_per_m
    if speed is not None and at is not None:
        name = f"{speed:.0f} m/s ({3.6 * speed:.0f} km/h)"
        left.plot(kappa, kappa * speed / (2.0 * np.pi), color="0.4", linestyle="--", linewidth=0.9, label=name)
        right.axhline(speed, color="0.4", linestyle="--", linewidth=0.9, label=name)
        left.plot([at], [at * speed / (2.0 * np.pi)], "o", color="0.1", markersize=3.5)
        right.plot([at], [speed], "o", color="0.1", markersize=3.5)
        right.legend(fontsize=_FONT, frameon=False, loc="upper right")
    return _write(figure, (left, right), folder, "dispersion.png")


def draw_irregularity(irregularity: Irregularity, x_m: Reals, profile_m: Reals, folder: str | Path) -> Path:
    """Draw `irregularity.png`: the density over cycles per metre with the bands D1 to D3, and a profile.

    Parameters
    ----------
    irregularity : Irregularity
    x_m, profile_m : ndarray, shape (n,)
        Places and heights.
    folder : Path
        Made if its parent exists.
    """
    figure = Figure(figsize=_SIZE_IN, layout="constrained")
    left, right = figure.subplots(1, 2)
    shortest, longest = irregularity.valid_wavelength_m
    cycles = np.geomspace(1.0 / longest * (1.0 + 1e-9), 1.0 / shortest * (1.0 - 1e-9), 400)
    left.loglog(cycles, 1e6 * density_per_cycle(irregularity, cycles), color="C0", linewidth=1.2)
    for (name, (short, long)), shade in zip(BANDS_M.items(), ("0.93", "0.88", "0.93"), strict=True):
        if long > shortest and short < longest:
            left.axvspan(1.0 / long, 1.0 / short, color=shade, zorder=0)
            middle = (max(1.0 / long, cycles[0]) * min(1.0 / short, cycles[-1])) ** 0.5
            left.text(
                middle, 0.97, name, transform=left.get_xaxis_transform(), fontsize=_FONT, va="top", ha="center"
            )
    left.set(xlabel="spatial frequency, 1/m", ylabel="density, mm² m", xlim=(cycles[0], cycles[-1]))
    left.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    left.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    left.xaxis.set_minor_formatter(NullFormatter())
    right.plot(x_m, 1e3 * profile_m, color="C0", linewidth=0.7)
    right.set(xlabel="place, m", ylabel="longitudinal level, mm", xlim=(x_m[0], x_m[-1]))
    return _write(figure, (left, right), folder, "irregularity.png")


def _write(figure: Figure, panels: tuple[Axes, ...], where: str | Path, name: str) -> Path:
    folder = Path(where)
    for axes in panels:
        axes.tick_params(labelsize=_FONT)
        axes.xaxis.label.set_fontsize(_FONT)
        axes.yaxis.label.set_fontsize(_FONT)
        axes.grid(color="0.9", linewidth=0.5)
    prepare_folder(folder)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=150, metadata={"Software": None})
    return write_bytes(folder / name, buffer.getvalue())
