"""A clamped beam with shunted piezoelectric patches at its root: piezo-shunt-beam.

Dimensions are not given, and the force is a current. So length and mass are chosen, 10 m and 10 t, which scales
metres and kilograms of any answer and no frequency; stiffness, the patches' stiffening of the root, damping, the
force constant and how far from the end coil and laser are is what fits the base's record.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from pair_folders import RECORDINGS, columns, factor, lay, one_response, responses
from permway.formats.model_file import model_from_dict
from permway.response.modes import poles_between
from permway.response.receptance import receptance
from scipy import optimize

PEAKS_HZ = np.array([20.08, 115.58])
BAND_HZ = (12.0, 200.0)
AVERAGES = 11
LENGTH_M, ROOT_M, KG_PER_M = 10.0, 2.0, 1000.0
"""Patches cover a fifth of the beam: an assumption."""

BASE, PAIRS = (
    "sc_sc_double_piezo",
    {"day": "sc_sc_new", "resistor": "R_sc", "absorbers": "rl_rl_double_piezo_first"},
)


def beams(folder: Path) -> dict[str, Path]:
    """A campaign for each state, all with the base's model."""
    stated = _identified()
    found = {}
    for name, state in PAIRS.items():
        into = folder / f"piezo-{name}"
        frequency, real, imaginary, coherence = columns(RECORDINGS / "piezo-shunt-beam" / f"{state}.csv")
        file = responses(into / "frf.csv", frequency, real + 1j * imaginary, coherence)
        more = {"averages": AVERAGES, "lines_per_frequency": 150.0}
        record = one_response("response", file, "rig", BAND_HZ, **more)
        found[f"piezo-{name}"] = lay(
            into, _campaign(record, *map(float, stated[4:])), _model(*map(float, stated[:5]))
        )
    return found


def _model(bending: float, root: float, loss: float, air: float, at_m: float) -> dict[str, Any]:
    tip = [{"body": "beam", "x_m": at_m}]
    beam = {
        "type": "beam",
        "youngs_modulus_Pa": bending,
        "second_moment_m4": 1.0,
        "density_kg_per_m3": KG_PER_M,
        "area_m2": 1.0,
        "loss_factor": loss,
        "intervals_m": [[0.0, LENGTH_M]],
        "ends": ["clamped", "free"],
        "changes": [{"from_m": 0.0, "to_m": ROOT_M, "bending_factor": root}],
    }
    return {
        "format": 1,
        "frequencies": {"from_Hz": BAND_HZ[0], "to_Hz": BAND_HZ[1], "points": 50},
        "line": {
            "bodies": {"beam": beam},
            "laws": {"air": {"type": "kelvin_voigt", "stiffness": 0.0, "damping": air}},
            "joints": [
                {
                    "between": ["beam", "ground"],
                    "law": "air",
                    "at": {"from_m": 1.0, "to_m": 10.0, "spacing_m": 1.0},
                }
            ],
        },
        "forces": tip,
        "sensors": tip,
    }


def _identified() -> np.ndarray:
    """Bending stiffness, its factor at the root, loss factor, damping of the air, place of the coil, gain."""
    frequency, real, imaginary, coherence = columns(RECORDINGS / "piezo-shunt-beam" / f"{BASE}.csv")
    used = (frequency >= BAND_HZ[0]) & (frequency <= BAND_HZ[1]) & (coherence > 0.9)
    # The laser looks the other way: at resonance velocity and current are half a turn apart.
    frequency, frf = frequency[used], -(real + 1j * imaginary)[used]
    omega = 2.0 * np.pi * frequency
    # Of a uniform cantilever; then as natural frequencies have it, within which the response leads on.
    start = np.array([KG_PER_M * (2.0 * np.pi * PEAKS_HZ[0] * LENGTH_M**2 / 1.875104**2) ** 2, 1.0, 0.005, 500.0])

    def natural(z: np.ndarray) -> np.ndarray:
        model = model_from_dict(_model(*(start * np.exp([z[0], z[1], 0.0, 0.0])), LENGTH_M))
        found = poles_between(model.line, 10.0, 200.0, places=[*model.sensors])
        return np.asarray(np.log(np.sort(found.omega.real)[:2] / (2.0 * np.pi) / PEAKS_HZ))

    start[:2] *= np.exp(optimize.least_squares(natural, np.zeros(2)).x)

    def bare(z: np.ndarray) -> np.ndarray:
        model = model_from_dict(_model(*(start * np.exp(z[:4])), LENGTH_M * (1.0 - z[5])))
        place = [*model.sensors]
        found = receptance(model.line, frequency, forces=[*model.forces], sensors=place, threads=1)
        return np.asarray(1j * omega * found["receptance"].values.reshape(-1, frequency.size)[0])

    def off(z: np.ndarray) -> np.ndarray:
        ratio = np.log(frf / bare(z)) - z[4]
        return np.concatenate([ratio.real * weight, ratio.imag * weight])

    # The lower mode has fewer lines.
    weight = np.sqrt(PEAKS_HZ[0] / frequency)
    gain = np.log(np.median(np.abs(frf / bare(np.zeros(6)))))
    found = optimize.least_squares(off, np.array([0.0, 0.0, 0.0, 0.0, gain, 0.05]), loss="soft_l1", f_scale=0.1)
    return np.array([*(start * np.exp(found.x[:4])), LENGTH_M * (1.0 - found.x[5]), np.exp(found.x[4])])


def _campaign(record: dict[str, Any], at_m: float, gain: float) -> dict[str, Any]:
    place = {"body": "beam", "x_m": at_m}
    known = {
        "bending": ("line.bodies.beam.youngs_modulus_Pa", 0.05),
        "root": ("line.bodies.beam.changes[0].bending_factor", 0.1),
        "loss": ("line.bodies.beam.loss_factor", 0.9),
        "air": ("line.laws.air.damping", 0.9),
        "gain": ("campaign.sensors.out.chain.gain", 0.2),
    }
    return {
        "parameters": [factor(name, path, two_sigma) for name, (path, two_sigma) in known.items()],
        "sensors": [
            {
                "name": "out",
                **place,
                "quantity": "velocity",
                "unit": "m/s",
                "chain": {"gain": gain, "polarity": -1},
            }
        ],
        "forces": [{"name": "in", **place, "unit": "N"}],
        "conditions": [{"name": "rig", "kind": "shaker"}],
        "records": [record],
    }
