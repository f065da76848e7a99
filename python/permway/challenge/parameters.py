"""A truth's parameters as the catalogue counts them: the generator's own, and what follows from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

Numbers = Mapping[str, Any]

HALF = 0.5
"""Share of a vehicle that the generator has on its rail."""


def in_catalogue(kind: str, true: Numbers) -> dict[str, float]:
    """Parameters by the names of the catalogue, SI; those that it does not have are left out.

    Parameters
    ----------
    kind : str
        Of the effect, as the generator calls it.
    true : mapping of str to number
        Its parameters, as the truth has them.
    """
    translated = _TRANSLATED.get(kind)
    found = dict(true) if translated is None else translated(true)
    return {name: float(v) for name, v in found.items() if isinstance(v, int | float)}


def _resonator(true: Numbers) -> Numbers:
    kept = {name: true[name] for name in ("mass_kg", "x_m") if name in true}
    return {**kept, "frequency_Hz": true["tuned_Hz"], "loss_factor": true["loss"]}


def _on_board(true: Numbers) -> Numbers:
    """Of whole wheelsets: the generator's vehicle is the half of one."""
    return {**_resonator(true), "mass_kg": true["mass_kg"] / HALF}


def _parted(true: Numbers) -> Numbers:
    """Boxes of a share of the mass on a spring to the wheels, as a mode of the free wheelset."""
    wheels = 1.0 - true["share"]
    shape = {"ratio": wheels / true["share"], "contact": -true["share"] / wheels}
    return {**shape, "frequency_Hz": true["frequency_Hz"], "loss_factor": true["loss"]}


def _viscous(true: Numbers) -> Numbers:
    """A mount with a dashpot, by where it swings most: by the catalogue's constant loss its frequency."""
    quality = true["quality"]
    largest = true["resonance_Hz"] * np.sqrt(max(1.0 - 0.5 / quality**2, 0.0))
    return {"mount_Hz": float(largest), "loss_factor": 1.0 / quality}


_TRANSLATED: dict[str, Callable[[Numbers], Numbers]] = {
    "attached_resonator": _resonator,
    "rail_absorber": _resonator,
    "axlebox_absorber": _on_board,
    "wheelset_bending": _parted,
    "damper_series": lambda t: {"relaxation_time_s": 1.0 / (2.0 * np.pi * t["corner_Hz"])},
    # Of both sides; the velocity rounds off two different laws.
    "primary_friction": lambda t: {"force_N": t["friction_N"] / HALF},
    "blow_off_damper": lambda t: {"force_N": t["most_N"] / HALF},
    "mains_lines": lambda t: {
        "frequency_Hz": t["hertz"],
        "amplitude": t["amplitude"],
        "third": t["share_of_third"],
    },
    "baseplate_mass": lambda t: {
        "mass_kg": t["mass_kg"],
        "share": t["lower_over_upper"] / (1.0 + t["lower_over_upper"]),
    },
    "support_gradient": lambda t: {"ratio": (1.0 + t["slope"]) / (1.0 - t["slope"])},
    "irregularity_level": lambda t: {"level_dB": t["gain_dB"]},
    "sensor_mounting": _viscous,
    "noise_floor": lambda t: {"noise_ratio": t["factor"] ** 2},
    # The share is at a frequency that is the generator's own.
    "pad_springpot": lambda t: {"order": t["order"]},
    "body_bending": lambda t: {"frequency_Hz": t["frequency_Hz"], "loss_factor": t["loss"]},
    # Of a band's edge the two shapes say different things.
    # How deep they seem depends on how far wheels fly.
    "dipped_welds": lambda t: {"length_m": t["length_m"]},
    "rail_corrugation": lambda t: {"wavelength_m": t["wavelength_m"]},
}
