"""Shift factors as the identification sees them: coordinates, bounds, fast values, and the shift itself.

The coordinates are those of a reference within the table, midway between its coldest and its warmest row. Which
reference the user asks for then has no part in the search: the answer is only written for it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from permway.arrays import ABSOLUTE_ZERO_C, Reals
from permway.errors import InputError
from permway.laws.shift import GAS_CONSTANT, WLF, Arrhenius, Free, Shift, WLFArrhenius

SHIFTS = ("none", "wlf", "arrhenius", "wlf_arrhenius", "free")
_CLEAR_OF_SINGULARITY_K = 5.0
"""Between the coldest row and the singular temperature of WLF. Half lets a fit run to where a degree is a decade;
twice would refuse cold rows that WLF still describes."""
_SLOPE = (-3.5, 0.0)
"""Decades of the slope c1/c2 in decades per kelvin; rubber has -2 to -0.5."""
_MOST_C2 = 3.7
_ENERGY = (3.5, 6.3)
"""Decades of J/mol; rubber has 4.7 to 5.7."""


@dataclass(frozen=True)
class ShiftFamily:
    """A family of shift factors over the temperatures of one table.

    Attributes
    ----------
    name : str
        As given to `identify`.
    bounds : list of (low, high)
        One per coordinate.
    kinds : tuple of str
        What each coordinate is: "slope", "c2", "energy", "transition", "fall".
    log10 : callable
        From coordinates, each of shape (p, 1) or (), to log10 alpha of shape (p, n) or (n,), relative to
        :func:`middle` of the table.
    shift : callable
        From coordinates to the shift, or None for "none".
    parameters : callable
        From coordinates to the shift's own parameters by name, for the user's reference.
    at_reference : callable
        From coordinates to log10 alpha at the user's reference, relative to the middle.
    """

    name: str
    bounds: list[tuple[float, float]]
    kinds: tuple[str, ...]
    log10: Callable[[list[Reals]], Reals]
    shift: Callable[[Reals], Shift | None]
    parameters: Callable[[Reals], dict[str, float]]
    at_reference: Callable[[Reals], float]


def middle(temperature_C: Reals) -> float:
    """Midway between the coldest and the warmest row, degrees Celsius."""
    return 0.5 * float(temperature_C.min() + temperature_C.max())


def shift_family(name: str, temperature_C: Reals | None, nodes_C: Reals, reference_C: float | None) -> ShiftFamily:
    """Look a shift family up by name.

    Parameters
    ----------
    name : {"none", "wlf", "arrhenius", "wlf_arrhenius", "free"}
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
        return ShiftFamily(name, [], (), lambda x: np.zeros(()), lambda x: None, lambda x: {}, lambda x: 0.0)
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
    if name == "wlf_arrhenius":
        return _wlf_arrhenius(temperature_C, reference_C)
    if not nodes_C[0] <= reference_C <= nodes_C[-1]:
        raise InputError(
            f"the reference of a free shift lies within it, {nodes_C[0]:.4g} to {nodes_C[-1]:.4g} degC",
            where="reference_temperature_C",
            value=reference_C,
        )
    return _free(temperature_C, nodes_C, reference_C)


def _wlf(temperature: Reals, reference: float) -> ShiftFamily:
    """Coordinates: lg of the slope c1/c2 (decades per K), and lg c2; c1 and c2 alone go hand in hand."""
    centre = middle(temperature)
    above = temperature - centre
    floor = max(-float(above.min()) + _CLEAR_OF_SINGULARITY_K, 10.0)
    bounds = [_SLOPE, (float(np.log10(floor)), _MOST_C2)]

    def log10(x: list[Reals]) -> Reals:
        return np.asarray(-(10.0 ** x[0]) * above / (1.0 + above / 10.0 ** x[1]))

    def parameters(x: Reals) -> dict[str, float]:
        c1, c2 = 10.0 ** (x[0] + x[1]), 10.0 ** x[1]
        shifted = c2 + reference - centre
        if shifted <= 0.0:
            raise InputError(
                f"at or below {centre - c2:.4g} degC, where the WLF shift of this table is singular",
                where="reference_temperature_C",
                value=reference,
                remedy="give a reference within the table, or use the shift wlf_arrhenius",
            )
        return {"c1": float(c1 * c2 / shifted), "c2_K": float(shifted)}

    def shift(x: Reals) -> Shift:
        return WLF(**parameters(x), reference_temperature_C=reference)

    def at_reference(x: Reals) -> float:
        warmer = reference - centre
        return float(-(10.0 ** x[0]) * warmer / (1.0 + warmer / 10.0 ** x[1]))

    return ShiftFamily("wlf", bounds, ("slope", "c2"), log10, shift, parameters, at_reference)


def _arrhenius(temperature: Reals, reference: float) -> ShiftFamily:
    def inverse(t: Reals | float) -> Reals:
        centre = middle(temperature)
        return np.asarray(1.0 / (t - ABSOLUTE_ZERO_C) - 1.0 / (centre - ABSOLUTE_ZERO_C))

    rows = inverse(temperature)

    def log10(x: list[Reals]) -> Reals:
        return np.asarray(10.0 ** x[0] / (GAS_CONSTANT * np.log(10.0)) * rows)

    def parameters(x: Reals) -> dict[str, float]:
        return {"activation_energy_J_per_mol": float(10.0 ** x[0])}

    def shift(x: Reals) -> Shift:
        return Arrhenius(**parameters(x), reference_temperature_C=reference)

    def at_reference(x: Reals) -> float:
        return float(10.0 ** x[0] / (GAS_CONSTANT * np.log(10.0)) * inverse(reference))

    return ShiftFamily("arrhenius", [_ENERGY], ("energy",), log10, shift, parameters, at_reference)


def _wlf_arrhenius(temperature: Reals, reference: float) -> ShiftFamily:
    """Coordinates: lg of the slope c1/c2 just above the transition, lg c2, the transition, lg of the energy."""
    centre = np.asarray(middle(temperature))
    low, high = float(temperature.min()), float(temperature.max())
    bounds = [_SLOPE, (float(np.log10(_CLEAR_OF_SINGULARITY_K)), _MOST_C2), (low, high), _ENERGY]

    def from_transition(x: list[Reals] | Reals, t: Reals) -> Reals:
        above = np.maximum(t - x[2], 0.0)
        below = np.minimum(t, x[2]) - ABSOLUTE_ZERO_C
        frozen = 10.0 ** x[3] / (GAS_CONSTANT * np.log(10.0)) * (1.0 / below - 1.0 / (x[2] - ABSOLUTE_ZERO_C))
        return np.asarray(frozen - 10.0 ** x[0] * above / (1.0 + above / 10.0 ** x[1]))

    def log10(x: list[Reals]) -> Reals:
        return from_transition(x, temperature) - from_transition(x, centre)

    def parameters(x: Reals) -> dict[str, float]:
        return {
            "c1": float(10.0 ** (x[0] + x[1])),
            "c2_K": float(10.0 ** x[1]),
            "transition_C": float(x[2]),
            "activation_energy_J_per_mol": float(10.0 ** x[3]),
        }

    def shift(x: Reals) -> Shift:
        return WLFArrhenius(**parameters(x))

    def at_reference(x: Reals) -> float:
        return float(from_transition(x, np.asarray(reference)) - from_transition(x, centre))

    kinds = ("slope", "c2_above", "transition", "energy")
    return ShiftFamily("wlf_arrhenius", bounds, kinds, log10, shift, parameters, at_reference)


def _free(temperature: Reals, nodes: Reals, reference: float) -> ShiftFamily:
    """Coordinates: the falls of lg alpha from one temperature to the next."""
    centre = middle(temperature)

    def at_nodes(x: list[Reals] | Reals, zero: float) -> Reals:
        falling = -np.concatenate([[0.0], np.cumsum(np.array([float(part) for part in x]))])
        return np.asarray(falling - PchipInterpolator(nodes, falling)(zero))

    def log10(x: list[Reals]) -> Reals:
        return np.asarray(PchipInterpolator(nodes, at_nodes(x, centre))(temperature))

    def shift(x: Reals) -> Shift:
        return Free(temperatures_C=nodes, log10_shift=at_nodes(x, reference))

    def parameters(x: Reals) -> dict[str, float]:
        return {f"log10_shift[{t:.1f} degC]": float(a) for t, a in zip(nodes, at_nodes(x, reference), strict=True)}

    def at_reference(x: Reals) -> float:
        return float(PchipInterpolator(nodes, at_nodes(x, centre))(reference))

    bounds = [(0.0, 8.0)] * (len(nodes) - 1)
    return ShiftFamily("free", bounds, ("fall",) * len(bounds), log10, shift, parameters, at_reference)
