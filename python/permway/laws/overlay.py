"""Shift factors by overlaying neighbouring isotherms, without any law.

The storage modulus rises with frequency. Where two neighbouring isotherms show the same values, each is met at
two frequencies, and the mean of their difference in log frequency over the shared values is the shift between the
two (Gergesova and others, The closed form t-T-P shifting algorithm, Journal of Rheology 55 (2011) 1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import isotonic_regression

from permway.arrays import Reals
from permway.laws.dma import DmaTable

_FEWEST = 3
"""Frequencies of an isotherm; two give no scatter, six would leave out short sweeps."""
_UNDETERMINED_DECADES = 0.5
"""Standard error above which a step is left out: half refuses usable pairs, twice keeps chance."""


@dataclass(frozen=True)
class Step:
    """The shift from one isotherm to the next warmer one.

    Attributes
    ----------
    cold_C, warm_C : float
        Degrees Celsius.
    decades : float or None
        log10 alpha of the cold one minus that of the warm one; None if it cannot be determined.
    error : float
        Standard error from the scatter of both isotherms, decades.
    why : str
        Why it cannot be determined.
    """

    cold_C: float
    warm_C: float
    decades: float | None
    error: float
    why: str = ""


@dataclass(frozen=True)
class Overlay:
    """Steps between neighbouring isotherms, from the coldest to the warmest."""

    steps: tuple[Step, ...]

    @property
    def unbroken(self) -> bool:
        """Whether all steps could be determined."""
        return all(step.decades is not None for step in self.steps)

    def log10_shift(self) -> dict[float, float]:
        """log10 alpha by temperature, zero at the warmest isotherm, down to where the steps break off."""
        if not self.steps:
            return {}
        total, shifts = 0.0, {self.steps[-1].warm_C: 0.0}
        for step in reversed(self.steps):
            if step.decades is None:
                break
            total += step.decades
            shifts[step.cold_C] = total
        return shifts


def overlay(table: DmaTable) -> Overlay:
    """Lay neighbouring isotherms of a table over each other.

    Parameters
    ----------
    table : DmaTable
        With temperatures.

    Returns
    -------
    Overlay
        Without steps for a table of fewer than two isotherms.
    """
    nodes = table.isotherms()
    if table.temperature_C is None or len(nodes) < 2:
        return Overlay(())
    nearest = np.abs(table.temperature_C[:, None] - nodes).argmin(axis=1)
    curves = [_curve(table, nearest == index) for index in range(len(nodes))]
    return Overlay(
        tuple(_step(float(nodes[i]), float(nodes[i + 1]), curves[i], curves[i + 1]) for i in range(len(nodes) - 1))
    )


@dataclass(frozen=True)
class _Curve:
    """Log frequency, ln of the storage modulus made monotone, and its scatter."""

    lg_frequency: Reals
    ln_storage: Reals
    scatter: float


def _curve(table: DmaTable, rows: np.ndarray) -> _Curve | None:
    frequency, place = np.unique(table.frequency_Hz[rows], return_inverse=True)
    if len(frequency) < _FEWEST:
        return None
    u = np.log10(frequency)
    y = np.bincount(place, np.log(table.storage_Pa[rows])) / np.bincount(place)
    smooth = np.polyval(np.polyfit(u, y, 2), u) if len(u) > _FEWEST else np.polyval(np.polyfit(u, y, 1), u)
    freedom = len(u) - (3 if len(u) > _FEWEST else 2)
    scatter = float(np.sqrt(np.sum((y - smooth) ** 2) / freedom))
    return _Curve(u, np.asarray(isotonic_regression(y).x), scatter)


def _step(cold_C: float, warm_C: float, cold: _Curve | None, warm: _Curve | None) -> Step:
    if cold is None or warm is None:
        why = f"fewer than {_FEWEST} frequencies at one of the two temperatures"
        return Step(cold_C, warm_C, None, np.inf, why)
    low = max(cold.ln_storage[0], warm.ln_storage[0])
    high = min(cold.ln_storage[-1], warm.ln_storage[-1])
    if high <= low:
        why = (
            "the two share no value of the storage modulus; measure at a temperature between, or over more decades"
        )
        return Step(cold_C, warm_C, None, np.inf, why)
    values = np.linspace(low, high, 201)
    difference = _at(warm, values) - _at(cold, values)
    decades = float(np.mean(difference))
    slope = min(np.ptp(c.ln_storage) / np.ptp(c.lg_frequency) for c in (cold, warm))
    shared = [max(int(np.sum((c.ln_storage >= low) & (c.ln_storage <= high))), 1) for c in (cold, warm)]
    error = float(
        np.sqrt(cold.scatter**2 / shared[0] + warm.scatter**2 / shared[1]) / max(slope, np.finfo(float).tiny)
    )
    if error > _UNDETERMINED_DECADES:
        why = "the storage modulus hardly changes with frequency here, as in the glass or at rest"
        return Step(cold_C, warm_C, None, error, why)
    return Step(cold_C, warm_C, decades, error)


def _at(curve: _Curve, values: Reals) -> Reals:
    """Log frequency at values; where the curve is flat the middle of the flat part."""
    left = np.searchsorted(curve.ln_storage, values, side="left")
    right = np.searchsorted(curve.ln_storage, values, side="right")
    inside = np.interp(values, curve.ln_storage, curve.lg_frequency)
    flat = right > left + 1
    middle = 0.5 * (
        curve.lg_frequency[np.minimum(left, len(curve.lg_frequency) - 1)] + curve.lg_frequency[right - 1]
    )
    return np.where(flat, middle, inside)
