"""Table 8, the rail's acceleration: why it cannot come out, and what was tried."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import xarray as xr

from permway.arrays import Complexes
from permway.paper.conventions import CONTACT_N_PER_M, Convention, train
from permway.paper.printed import PRINTED, TEMPERATURES_C
from permway.response.pseudo import pseudo_excitation


@dataclass(frozen=True)
class Bound:
    """The most that the rail's acceleration can be, by the paper's own tables.

    Equation (19) ties the contact: rail = wheel - irregularity - force / k_c, so that
    `|a_rail| <= omega^2 (|z_wheel| + |R| + |P| / k_c)`, whatever track, bridge and pad.
    """

    temperature_C: int
    at_Hz: float
    wheelset: float
    force: float
    bound: float
    printed: float

    def as_dict(self) -> dict[str, Any]:
        """The bound as plain data."""
        return {**asdict(self), "contradiction": bool(self.printed > self.bound)}


def bounds(convention: Convention, contact_N_per_m: float = CONTACT_N_PER_M) -> list[Bound]:
    """Bounds where tables 5, 7 and 8 are printed for one frequency (not at -30 degC)."""
    printed = {(r.quantity, r.temperature_C): r for r in PRINTED}
    found = []
    for t in TEMPERATURES_C:
        rail, wheelset, force = (printed[q, t] for q in ("rail", "wheelset", "force"))
        if rail.at_Hz != wheelset.at_Hz or rail.at_Hz is None:
            continue
        density = convention.irregularity.density([rail.at_Hz], train().speed_m_per_s, convention.conversion)
        omega2 = (2.0 * np.pi * rail.at_Hz) ** 2
        largest = np.sqrt(wheelset.value) + omega2 * (np.sqrt(density[0]) + force.value / contact_N_per_m)
        found.append(Bound(t, rail.at_Hz, wheelset.value, force.value, float(largest**2), rail.value))
    return found


@dataclass(frozen=True)
class Trial:
    """A reading of "rail acceleration" that a mistake might have made, against print.

    Attributes
    ----------
    name : str
    ratios : dict of temperature to computed over printed, at the printed frequency
    peaks_Hz : dict of temperature to the peak's frequency
    spread_below_20_Hz : float
        Largest relative difference between the temperatures; the paper says "no obvious difference".
    """

    name: str
    ratios: dict[int, float]
    peaks_Hz: dict[int, float]
    spread_below_20_Hz: float

    def as_dict(self) -> dict[str, Any]:
        """The trial as plain data."""
        return asdict(self)


def trials(convention: Convention, runs: Mapping[int, xr.Dataset]) -> list[Trial]:
    """The rail's acceleration and its likelier misreadings, each by one convention for all temperatures."""
    vehicle = train().vehicle
    parts: dict[int, dict[str, Complexes]] = {}
    for t, data in runs.items():
        f = data["frequency"].values
        force = data["wheel_rail_force"].values
        profile = pseudo_excitation(f, data["irregularity_psd"].values, vehicle.lags_m(), train().speed_m_per_s)
        wheel = np.einsum("fij,fj->fi", data["wheel_receptance"].values, -force)
        rail = np.einsum("fij,fj->fi", data["track_receptance"].values, force)
        contact = force[:, 0] / CONTACT_N_PER_M
        direct = data["track_receptance"].values[:, 0, 0] * force[:, 0]
        z, w, r = rail[:, 0], wheel[:, 0], profile[:, 0]
        parts[t] = {
            "the rail under wheel 1, as the equations give it": z,
            "the force under wheel 1 alone": direct,
            "contact spring forgotten: z_w - R": z + contact,
            "contact spring's sign slipped: z_w - R + P/k_c": z + 2.0 * contact,
            "irregularity subtracted once more: z_r - R": z - r,
            "irregularity's sign slipped": z + 2.0 * r,
            "irregularity's sign slipped, contact forgotten": w + r,
            "the wheel itself": w,
            "moduli added: |z_w| + |R| + |P|/k_c (the bound)": np.abs(w) + np.abs(r) + np.abs(contact) + 0j,
            "twice the rail (both rails added)": 2.0 * z,
            "z_r - R with its density doubled": np.sqrt(2.0) * (z - r),
        }
    printed = {r.temperature_C: r for r in PRINTED if r.quantity == "rail"}
    found = []
    for name in parts[20]:
        ratios, peaks, slow = {}, {}, []
        for t, data in runs.items():
            f = data["frequency"].values
            density = (2.0 * np.pi * f) ** 4 * np.abs(parts[t][name]) ** 2
            at = printed[t].at_Hz
            assert at is not None
            # Print reads the peak; the peak within 4 Hz of the printed frequency is compared.
            near = np.abs(f - at) <= 4.0
            ratios[t] = float(density[near].max() / printed[t].value)
            band = (f >= 40.0) & (f <= 130.0)
            peaks[t] = float(f[band][np.argmax(density[band])])
            slow.append(density[f <= 20.0])
        spread = float((np.max(slow, axis=0) / np.min(slow, axis=0)).max() - 1.0)
        found.append(Trial(name, ratios, peaks, spread))
    return found
