"""Beams and shafts as the core's columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from permway.model.bodies import Beam, BeamChange, Shaft
from permway.model.segments import Segment
from permway.model.shafts import ShaftChange
from permway.model.slender import SectionChange
from permway.model.stations import TOUCH_M

Dashpots = tuple[float, float, float, float]
"""Viscous losses of bending (N m2 s), shear (N s), and per metre of motion (N s/m2) and rotation (N s)."""

Section = tuple[complex, complex, float, float, Dashpots]
"""Bending stiffness (N m2, 0 of a shaft), shear stiffness (N), mass (kg/m), rotary inertia (kg m), losses."""


def section(body: Beam | Shaft, change: SectionChange | None = None) -> Section:
    """The section of a body, or what a change makes of it."""
    bending, shear, mass, rotary = body.bending_Nm2, body.shear_N, body.mass_kg_per_m, body.rotary_kg_m
    if change is not None:
        mass, rotary = mass * change.mass_factor, rotary * change.mass_factor
        if isinstance(change, ShaftChange):
            shear *= change.torsion_factor
        if isinstance(change, BeamChange):
            bending, shear = bending * change.bending_factor, shear * change.shear_factor
    return bending, shear, mass, rotary, _dashpots(body, bending.real, shear.real, mass, rotary)


def _dashpots(body: Beam | Shaft, bending: float, shear: float, mass: float, rotary: float) -> Dashpots:
    if not isinstance(body, Beam):
        return 0.0, 0.0, 0.0, 0.0
    by_mass, by_stiffness = body.mass_damping_per_s, body.stiffness_damping_s
    # Dashpots against rotation, evenly along a beam: on pinned ends its n-th mode then has 2 zeta omega_n m.
    turning = 2.0 * body.damping_ratio * (bending * mass) ** 0.5
    return by_stiffness * bending, by_stiffness * shear, by_mass * mass, by_mass * rotary + turning


def sections(body: Beam | Shaft) -> list[Section]:
    """All sections that a body has somewhere."""
    return [section(body), *(section(body, change) for change in body.changes)]


def beam_columns(pairs: Sequence[tuple[Beam | Shaft, Segment]]) -> dict[str, Any]:
    """Columns of the beams and shafts, and of the stretches where their sections change.

    Parameters
    ----------
    pairs : sequence of (Beam or Shaft, Segment)
        In the core's order.
    """
    reach = [(s.start, s.stop) for _, s in pairs]
    stretches: list[tuple[int, float, float, Section]] = []
    for index, (body, segment) in enumerate(pairs):
        for change in sorted(body.changes, key=lambda c: c.from_m):
            if segment.start - TOUCH_M <= change.from_m and change.to_m <= segment.stop + TOUCH_M:
                stretches.append((index, change.from_m, change.to_m, section(body, change)))
    return {
        **_columns([section(body) for body, _ in pairs], reach),
        "pinned": np.array([b.pinned for b, _ in pairs], dtype=np.bool_).reshape(-1, 2),
        "modes": np.array([b.modes or 0 for b, _ in pairs], dtype=np.int64),
        "stretches": {
            "body": np.array([index for index, _, _, _ in stretches], dtype=np.int64),
            **_columns([s for _, _, _, s in stretches], [(a, b) for _, a, b, _ in stretches]),
        },
    }


def _columns(found: Sequence[Section], reach: Sequence[tuple[float, float]]) -> dict[str, Any]:
    return {
        "bending": np.array([s[0] for s in found], dtype=np.complex128),
        "shear": np.array([s[1] for s in found], dtype=np.complex128),
        "mass": np.array([s[2] for s in found], dtype=np.float64),
        "rotary": np.array([s[3] for s in found], dtype=np.float64),
        "dashpots": np.array([s[4] for s in found], dtype=np.float64).reshape(-1, 4),
        "interval": np.array(reach, dtype=np.float64).reshape(-1, 2),
    }
