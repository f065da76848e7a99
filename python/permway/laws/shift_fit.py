"""Shift factors as the identification sees them: coordinates, bounds, fast values, and the shift itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from permway.arrays import ABSOLUTE_ZERO_C, Reals
from permway.errors import InputError
from permway.laws.shift import GAS_CONSTANT, WLF, Arrhenius, Free, Shift

SHIFTS = ("none", "wlf", "arrhenius", "free")
_CLEAR_OF_SINGULARITY_K = 5.0


@dataclass(frozen=True)
class ShiftFamily:
    """A family of shift factors over the temperatures of one table.

    Attributes
    ----------
    name : str
        As given to `identify`.
    bounds : list of (low, high)
        One per coordinate.
    log10 : callable
        From coordinates, each of shape (p, 1) or (), to log10 alpha of shape (p, n) or (n,).
    shift : callable
        From coordinates to the shift, or None for "none".
    parameters : callable
        From coordinates to the shift's own parameters by name.
    """

    name: str
    bounds: list[tuple[float, float]]
    log10: Callable[[list[Reals]], Reals]
    shift: Callable[[Reals], Shift | None]
    parameters: Callable[[Reals], dict[str, float]]


def shift_family(name: str, temperature_C: Reals | None, nodes_C: Reals, reference_C: float | None) -> ShiftFamily:
    """Look a shift family up by name.

    Parameters
    ----------
    name : {"none", "wlf", "arrhenius", "free"}
        Which.
    temperature_C : ndarray, shape (n,), or None
        Of the table's rows.
    nodes_C : ndarray, shape (m,)
        Of the table's isotherms, rising; nodes of a free shift.
    reference_C : float or None
        Reference temperature.

    Raises
    ------
    InputError
        For an unknown name, a table without temperatures, or a reference that does not go with them.
    """
    if name not in SHIFTS:
        raise InputError("not a shift", where="shift", value=name, remedy="use one of " + ", ".join(SHIFTS))
    if name == "none":
        return ShiftFamily(name, [], lambda x: np.zeros(()), lambda x: None, lambda x: {})
    if temperature_C is None or reference_C is None or len(nodes_C) < 2:
        raise InputError(
            f"a shift needs rows at several temperatures; this table has {len(nodes_C)}",
            where="shift",
            value=name,
            remedy='use shift="none"',
        )
    if name == "wlf":
        return _wlf(temperature_C, reference_C)
    if name == "arrhenius":
        return _arrhenius(temperature_C, reference_C)
    if not nodes_C[0] <= reference_C <= nodes_C[-1]:
        raise InputError(
            f"the reference of a free shift lies within it, {nodes_C[0]:.4g} to {nodes_C[-1]:.4g} degC",
            where="reference_temperature_C",
            value=reference_C,
        )
    return _free(temperature_C, nodes_C, reference_C)


def _wlf(temperature: Reals, reference: float) -> ShiftFamily:
    """Coordinates: lg of the slope c1/c2 (decades per K), and lg c2; c1 and c2 alone go hand in hand."""
    above = temperature - reference
    floor = max(-float(above.min()) + _CLEAR_OF_SINGULARITY_K, 10.0)
    bounds = [(-3.5, 0.0), (float(np.log10(floor)), 3.7)]

    def log10(x: list[Reals]) -> Reals:
        return np.asarray(-(10.0 ** x[0]) * above / (1.0 + above / 10.0 ** x[1]))

    def parameters(x: Reals) -> dict[str, float]:
        return {"c1": float(10.0 ** (x[0] + x[1])), "c2_K": float(10.0 ** x[1])}

    def shift(x: Reals) -> Shift:
        return WLF(**parameters(x), reference_temperature_C=reference)

    return ShiftFamily("wlf", bounds, log10, shift, parameters)


def _arrhenius(temperature: Reals, reference: float) -> ShiftFamily:
    inverse = 1.0 / (temperature - ABSOLUTE_ZERO_C) - 1.0 / (reference - ABSOLUTE_ZERO_C)

    def log10(x: list[Reals]) -> Reals:
        return np.asarray(10.0 ** x[0] / (GAS_CONSTANT * np.log(10.0)) * inverse)

    def parameters(x: Reals) -> dict[str, float]:
        return {"activation_energy_J_per_mol": float(10.0 ** x[0])}

    def shift(x: Reals) -> Shift:
        return Arrhenius(**parameters(x), reference_temperature_C=reference)

    return ShiftFamily("arrhenius", [(3.5, 6.3)], log10, shift, parameters)


def _free(temperature: Reals, nodes: Reals, reference: float) -> ShiftFamily:
    """Coordinates: the falls of lg alpha from one temperature to the next; the zero is at the reference."""

    def at_nodes(x: list[Reals] | Reals) -> Reals:
        falling = -np.concatenate([[0.0], np.cumsum(np.array([float(part) for part in x]))])
        return np.asarray(falling - PchipInterpolator(nodes, falling)(reference))

    def log10(x: list[Reals]) -> Reals:
        return np.asarray(PchipInterpolator(nodes, at_nodes(x))(temperature))

    def shift(x: Reals) -> Shift:
        return Free(temperatures_C=nodes, log10_shift=at_nodes(x))

    def parameters(x: Reals) -> dict[str, float]:
        return {f"log10_shift[{t:.1f} degC]": float(a) for t, a in zip(nodes, at_nodes(x), strict=True)}

    return ShiftFamily("free", [(0.0, 8.0)] * (len(nodes) - 1), log10, shift, parameters)
