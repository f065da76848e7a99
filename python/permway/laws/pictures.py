"""Pictures of an identified law: master curve, shift factor, surfaces (the paper's figure 9), residuals."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, MultipleLocator, NullFormatter

from permway.arrays import Reals
from permway.errors import InputError
from permway.laws.identify import Identification
from permway.laws.overlay import overlay
from permway.laws.shift import Free
from permway.laws.tfdv import TFDV

_WIDTH_IN = 6.3
_COLOURS = "viridis"
_LAW: dict[str, Any] = {"color": "#b2182b", "linewidth": 1.3}
_POINTS: dict[str, Any] = {"s": 9, "linewidths": 0.0, "alpha": 0.85}
_FONT = 8


def master_curve(found: Identification) -> Figure:
    """Draw storage, loss and loss factor over reduced frequency, measured and identified.

    Parameters
    ----------
    found : Identification
        With or without a shift.

    Returns
    -------
    matplotlib.figure.Figure
        Two panels, modulus above loss factor.
    """
    table = found.table
    reduced = table.frequency_Hz * 10.0 ** _shift(found)
    vertical = _vertical(found)
    line = np.geomspace(reduced.min() / 2.0, reduced.max() * 2.0, 300)
    value = found.law.complex(line, found.reference_temperature_C)
    figure = Figure(figsize=(_WIDTH_IN, 4.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    _scatter(upper, found, reduced, table.storage_Pa / vertical / 1e6, marker="o")
    _scatter(upper, found, reduced, table.loss_Pa / vertical / 1e6, marker="^")
    upper.plot(line, value.real / 1e6, **_LAW)
    upper.plot(line, value.imag / 1e6, linestyle="--", **_LAW)
    upper.set(xscale="log", yscale="log", ylabel="modulus, MPa")
    for marker, style, name in (("o", "-", "storage"), ("^", "--", "loss")):
        upper.plot([], [], marker=marker, linestyle=style, markersize=3.5, label=name, **_LAW)
    upper.legend(fontsize=_FONT, frameon=False, loc="upper left")
    mapped = _scatter(lower, found, reduced, table.loss_factor, marker="o")
    lower.plot(line, value.imag / value.real, **_LAW)
    what = "frequency, Hz"
    if found.reference_temperature_C is not None:
        what = f"reduced frequency $\\alpha_T f$, Hz (reference {found.reference_temperature_C:g} °C)"
    top = 1.1 * max(float(table.loss_factor.max()), float((value.imag / value.real).max()))
    lower.set(xscale="log", xlabel=what, ylabel="loss factor", ylim=(0.0, top))
    upper.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    upper.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
    upper.yaxis.set_minor_formatter(NullFormatter())
    _temperature_bar(figure, [upper, lower], mapped)
    return _finish(figure, upper, lower)


def shift_factors(found: Identification) -> Figure:
    """Draw the shift factor over temperature, and what overlaying the isotherms gives without a law.

    Raises
    ------
    InputError
        If no shift was identified.
    """
    law = found.law
    if not isinstance(law, TFDV) or found.table.temperature_C is None:
        raise InputError(
            "no shift was identified", where="found", value=found.shift, remedy="identify with a shift"
        )
    low, high = found.table.temperature_C.min(), found.table.temperature_C.max()
    dense = np.linspace(low, high, 200)
    figure = Figure(figsize=(_WIDTH_IN * 0.62, 2.9), layout="constrained")
    axes = figure.subplots()
    axes.axhline(0.0, color="0.75", linewidth=0.6)
    axes.axvline(law.reference_temperature_C, color="0.75", linewidth=0.6)
    names = {"wlf": "WLF", "arrhenius": "Arrhenius", "wlf_arrhenius": "WLF, Arrhenius below"}
    axes.plot(dense, law.log10_shift(dense), label=names.get(law.shift.type, "free, monotone between"), **_LAW)
    if isinstance(law.shift, Free):
        nodes = np.array(law.shift.temperatures_C)
        spread = _node_intervals(found)
        axes.errorbar(nodes, law.log10_shift(nodes), yerr=spread, fmt="none", color="0.15", capsize=2, lw=0.8)
    laid = overlay(found.table).log10_shift()
    if len(laid) > 1:
        # What is laid over each other states differences only: it begins on the law at the warmest temperature.
        nodes = np.clip(np.array(list(laid)), low, high)
        at = np.array(list(laid.values())) + law.log10_shift(nodes[0])
        axes.plot(nodes, at, "o", color="0.15", markersize=3.5, label="overlaid without a law")
    axes.set(xlabel="temperature, °C", ylabel=r"shift factor $\log_{10}\alpha_T$")
    axes.legend(fontsize=_FONT, frameon=False)
    return _finish(figure, axes)


def surfaces(
    found: Identification,
    *,
    band_Hz: tuple[float, float] | None = None,
    temperatures_C: tuple[float, float] | None = None,
) -> Figure:
    """Draw storage modulus and loss factor over log frequency and temperature, as in figure 9 of the paper.

    Parameters
    ----------
    found : Identification
        With a shift.
    band_Hz, temperatures_C : (float, float), optional
        Ranges; those of the table if not given.

    Raises
    ------
    InputError
        If no shift was identified, or the shift does not reach the temperatures.
    """
    table, law = found.table, found.law
    if not isinstance(law, TFDV) or table.temperature_C is None:
        raise InputError(
            "no shift was identified", where="found", value=found.shift, remedy="identify with a shift"
        )
    low, high = band_Hz or (float(table.frequency_Hz.min()), float(table.frequency_Hz.max()))
    cold, warm = temperatures_C or (float(table.temperature_C.min()), float(table.temperature_C.max()))
    frequency, temperature = np.meshgrid(np.geomspace(low, high, 45), np.linspace(cold, warm, 45))
    value = law.complex(frequency, temperature)
    figure = Figure(figsize=(_WIDTH_IN * 1.12, 3.3))
    measured = (
        np.log10(table.frequency_Hz),
        table.temperature_C,
        np.log10(table.storage_Pa / 1e6),
        table.loss_factor,
    )
    inside = (table.frequency_Hz >= low) & (table.frequency_Hz <= high)
    inside &= (table.temperature_C >= cold) & (table.temperature_C <= warm)
    panels: tuple[tuple[str, Reals, Reals], ...] = (
        ("(a) storage modulus, MPa", np.log10(value.real / 1e6), measured[2]),
        ("(b) loss factor", value.imag / value.real, measured[3]),
    )
    for place, (title, height, points) in enumerate(panels, start=1):
        axes: Any = figure.add_subplot(1, 2, place, projection="3d", computed_zorder=False)
        axes.plot_surface(
            np.log10(frequency),
            temperature,
            height,
            cmap=_COLOURS,
            rcount=45,
            ccount=45,
            linewidth=0.0,
            alpha=0.9,
        )
        axes.scatter(measured[0][inside], measured[1][inside], points[inside], color="#b2182b", s=1.5, zorder=5)
        axes.set_title(title, fontsize=_FONT + 1, y=0.98)
        axes.set_xlabel("frequency, Hz", fontsize=_FONT, labelpad=-2)
        axes.set_ylabel("temperature, °C", fontsize=_FONT, labelpad=-2)
        axes.tick_params(labelsize=_FONT - 1, pad=-1)
        axes.xaxis.set_major_locator(MultipleLocator(1.0))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"$10^{{{x:.0f}}}$"))
        if place == 1:
            steps = np.add.outer(np.arange(-3, 7), np.log10([1.0, 2.0, 5.0])).ravel()
            bottom, top = min(height.min(), points.min()), max(height.max(), points.max())
            axes.zaxis.set_major_locator(FixedLocator(steps[(steps >= bottom - 0.1) & (steps <= top + 0.1)]))
            axes.zaxis.set_major_formatter(FuncFormatter(lambda z, _: f"{10.0**z:g}"))
        # Cold at the back: the hill rises there and would hide the rest.
        axes.invert_yaxis()
        axes.view_init(elev=22, azim=-122)
        axes.set_box_aspect((1.0, 1.0, 0.85), zoom=0.95)
    figure.subplots_adjust(left=0.0, right=0.96, bottom=0.04, top=0.97, wspace=0.06)
    return figure


def residuals(found: Identification) -> Figure:
    """Draw what the law leaves over: error of log10 storage and of the loss factor over frequency."""
    figure = Figure(figsize=(_WIDTH_IN, 3.8), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    frequency = found.table.frequency_Hz
    _scatter(upper, found, frequency, found.log10_storage_error, marker="o")
    mapped = _scatter(lower, found, frequency, found.loss_factor_error, marker="o")
    upper.set(xscale="log", ylabel=r"error of $\log_{10}$ storage")
    lower.set(xlabel="frequency, Hz", ylabel="error of loss factor")
    for axes, rms in ((upper, found.rms_log10_modulus), (lower, found.rms_loss_factor)):
        axes.axhline(0.0, color="0.3", linewidth=0.6)
        axes.axhspan(-rms, rms, color="0.88", zorder=0, label=f"rms {rms:.3g}")
        axes.legend(fontsize=_FONT, frameon=False, loc="upper right")
        reach = 1.25 * max(float(np.abs(axes.dataLim.intervaly).max()), rms)
        axes.set_ylim(-reach, reach)
    _temperature_bar(figure, [upper, lower], mapped)
    return _finish(figure, upper, lower)


def _shift(found: Identification) -> Reals:
    if isinstance(found.law, TFDV) and found.table.temperature_C is not None:
        return found.law.log10_shift(found.table.temperature_C)
    return np.zeros(len(found.table))


def _vertical(found: Identification) -> Reals:
    if isinstance(found.law, TFDV) and found.table.temperature_C is not None:
        return found.law.vertical_factor(found.table.temperature_C)
    return np.ones(len(found.table))


def _node_intervals(found: Identification) -> Reals:
    nodes = [p for p in found.parameters if p.name.startswith("shift.log10_shift")]
    return np.array([[max(p.value - p.low, 0.0) for p in nodes], [max(p.high - p.value, 0.0) for p in nodes]])


def _scatter(axes: Axes, found: Identification, x: Reals, y: Reals, *, marker: str) -> Any:
    temperature = found.table.temperature_C
    if temperature is None or np.ptp(temperature) == 0.0:
        axes.scatter(x, y, marker=marker, color="0.25", zorder=2, **_POINTS)
        return None
    norm = Normalize(temperature.min(), temperature.max())
    return axes.scatter(x, y, marker=marker, c=temperature, cmap=_COLOURS, norm=norm, zorder=2, **_POINTS)


def _temperature_bar(figure: Figure, panels: list[Axes], mapped: Any) -> None:
    if mapped is not None:
        bar = figure.colorbar(mapped, ax=panels, aspect=35, pad=0.015)
        bar.set_label("temperature, °C", fontsize=_FONT)
        bar.ax.tick_params(labelsize=_FONT)


def _finish(figure: Figure, *panels: Axes) -> Figure:
    for axes in panels:
        axes.tick_params(labelsize=_FONT, which="both")
        axes.xaxis.label.set_fontsize(_FONT + 1)
        axes.yaxis.label.set_fontsize(_FONT + 1)
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="0.93", linewidth=0.5)
        axes.set_axisbelow(True)
    return figure
