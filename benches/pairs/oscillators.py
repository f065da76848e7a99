"""One mass on one joint: cmu-cart, silverbox, brake-reuss-beam.

The nominal model is what a fit to the base's record gives, of one mass, spring and dashpot; of the cart its mass
as weighed and a force constant of 1, as the rig's software has it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, permutations
from pathlib import Path
from typing import Any

import numpy as np
from pair_folders import RECORDINGS, columns, factor, lay, one_response, responses
from permway.recordings.estimates.frf import frequency_response
from permway.recordings.estimates.welch import cross_spectra
from scipy import optimize

CART = (1, 2, 3, 4, 5, 7)
CART_HZ = (1.0, 9.0)
"""Below is noise, above the cart hardly moves."""

CART_KG = 0.77
"""Weighed."""

SILVER_HZ, SILVER_RATE, SILVER_SEGMENT_S = (20.0, 150.0), 610.35, 1.0
SILVER_ENDS = np.linspace(0, 40_500, 6).astype(int)
"""Samples of noise that grows, in five parts."""

REUSS_HZ = (79.0, 81.2)


def carts(folder: Path) -> dict[str, Path]:
    """Thirty campaigns, by base and target."""
    found = {}
    for base, target in permutations(CART, 2):
        stated = _identified(*_cart(base), mass_kg=CART_KG, order=0, gain=True)
        into = folder / f"cart-{base}-{target}"
        frequency, frf = _cart(target)
        file = responses(into / "frf.csv", frequency, frf)
        record = one_response("response", file, "rig", CART_HZ, noise="scatter", unit="mm/N")
        condition = {"name": "rig", "kind": "shaker"}
        found[f"cart-{base}-{target}"] = lay(
            into, _campaign([record], [condition], "displacement", "mm"), _model(CART_KG, *stated, CART_HZ)
        )
    return found


def _cart(number: int) -> tuple[np.ndarray, np.ndarray]:
    """Frequency, and displacement over force in mm/N; its phase falls, so that of exp(+i omega t)."""
    frequency, size, phase = columns(RECORDINGS / "cmu-cart" / f"frf_{number}.csv")
    return frequency, size * np.exp(1j * phase)


def silverbox(folder: Path) -> dict[str, Path]:
    """All levels in one campaign, and each by itself."""
    force, motion = np.loadtxt(RECORDINGS / "silverbox" / "SNLS80mV.csv", delimiter=",", skiprows=1)[:40_500].T
    level, made = [], []
    for start, stop in pairwise(SILVER_ENDS):
        both = np.stack([force[start:stop], motion[start:stop]])
        spectra = cross_spectra(both, sampling_Hz=SILVER_RATE, segment_s=SILVER_SEGMENT_S, channels=["in", "out"])
        found = frequency_response(spectra, references=["in"]).isel(reference=0, response=0)
        made.append((found["frequency"].values, found["frf"].values, found["coherence"].values))
        averages = float(spectra.attrs["averages"])
        level.append(float(np.sqrt(np.mean(both[0] ** 2))))
    more = {"averages": round(averages, 2), "lines_per_frequency": 400.0}
    return _at_levels(folder, "silverbox", level, made, "displacement", "m", SILVER_HZ, 0, more)


def reuss(folder: Path) -> dict[str, Path]:
    """All levels in one campaign, and each by itself."""
    level, made = [], []
    for number in range(1, 9):
        source = RECORDINGS / "brake-reuss-beam" / f"ResponseControl_{number}.csv"
        frequency, force, motion, phase = columns(source)
        # The phase falls from 0 to -pi over the resonance, as that of a displacement does: an accelerometer's is
        # half a turn from there.
        made.append((frequency, -motion / force * np.exp(1j * phase), None))
        level.append(float(np.median(motion)))
    more = {"noise": "scatter", "lines_per_frequency": 4000.0}
    return _at_levels(folder, "reuss", level, made, "acceleration", "m/s2", REUSS_HZ, 2, more)


Made = tuple[np.ndarray, np.ndarray, np.ndarray | None]


def _at_levels(
    folder: Path,
    name: str,
    level: Sequence[float],
    made: Sequence[Made],
    quantity: str,
    unit: str,
    band_Hz: tuple[float, float],
    order: int,
    more: dict[str, Any],
) -> dict[str, Path]:
    """The lowest level states the model of all; of one level by itself, that level does."""
    found = {}
    for chosen in (range(len(level)), *((i,) for i in range(len(level)))):
        alone = len(chosen) == 1
        key = f"{name}-{chosen[0] + 1}" if alone else f"{name}-levels"
        frequency, frf, _ = made[chosen[0]]
        used = (frequency >= band_Hz[0]) & (frequency <= band_Hz[1])
        stated = _identified(frequency[used], frf[used], mass_kg=None, order=order, gain=False)
        conditions, records = [], []
        for index in chosen:
            file = responses(folder / key / f"level_{index + 1}.csv", *made[index])
            conditions.append({"name": f"level {index + 1}", "kind": "shaker", "level": level[index]})
            records.append(one_response(f"level {index + 1}", file, f"level {index + 1}", band_Hz, **more))
        found[key] = lay(folder / key, _campaign(records, conditions, quantity, unit), _model(*stated, band_Hz))
    return found


def _identified(
    frequency_Hz: np.ndarray, frf: np.ndarray, *, mass_kg: float | None, order: int, gain: bool
) -> tuple[float, ...]:
    """Stiffness and damping of a known mass, or mass, stiffness and damping, that fit a record's logarithm best.

    With `gain` the record's level is left aside: the user reads frequency and width of the resonance.
    """
    omega = 2.0 * np.pi * frequency_Hz
    within = (frequency_Hz >= CART_HZ[0]) & (frequency_Hz <= CART_HZ[1]) if mass_kg is not None else omega > 0.0
    moved = np.abs(frf / omega**order)[within]
    peak = float(omega[within][np.argmax(moved)])
    scale = 1e3 if mass_kg is not None else 1.0

    def fitted(loss: float) -> optimize.OptimizeResult:
        mass = mass_kg or 1.0 / float(moved.max() * loss * peak**2)

        def numbers(z: np.ndarray) -> tuple[float, float, float, float]:
            grown = np.exp(z)
            m = mass if mass_kg else mass * grown[3]
            return (
                float(m),
                float(mass * peak**2 * grown[0]),
                float(loss * mass * peak * grown[1]),
                float(grown[2]),
            )

        def off(z: np.ndarray) -> np.ndarray:
            m, k, c, g = numbers(z)
            model = (g if gain else 1.0) * scale * (1j * omega) ** order / (k - m * omega**2 + 1j * omega * c)
            ratio = np.log((frf / model)[within])
            return np.concatenate([ratio.real, ratio.imag, 1e-9 * z])

        found = optimize.least_squares(off, np.zeros(4), loss="soft_l1", f_scale=0.1)
        found.numbers = numbers(found.x)
        return found

    m, k, c, _ = min((fitted(loss) for loss in (0.005, 0.05, 0.5)), key=lambda one: one.cost).numbers
    return (k, c) if mass_kg is not None else (m, k, c)


def _campaign(
    records: list[dict[str, Any]], conditions: list[dict[str, Any]], quantity: str, unit: str
) -> dict[str, Any]:
    place = {"body": "mass", "x_m": 0.0}
    known = {
        "spring": ("line.laws.joint.stiffness", 0.03),
        "damper": ("line.laws.joint.damping", 0.5),
        "mass": ("line.bodies.mass.mass_kg", 0.01),
    }
    return {
        "parameters": [factor(name, path, two_sigma) for name, (path, two_sigma) in known.items()],
        "sensors": [{"name": "out", **place, "quantity": quantity, "unit": unit}],
        "forces": [{"name": "in", **place, "unit": "N"}],
        "conditions": conditions,
        "records": records,
    }


def _model(mass: float, stiffness: float, damping: float, band_Hz: tuple[float, float]) -> dict[str, Any]:
    place = [{"body": "mass", "x_m": 0.0}]
    return {
        "format": 1,
        "frequencies": {"from_Hz": band_Hz[0], "to_Hz": band_Hz[1], "points": 50},
        "line": {
            "bodies": {"mass": {"type": "mass", "mass_kg": mass}},
            "laws": {"joint": {"type": "kelvin_voigt", "stiffness": stiffness, "damping": damping}},
            "joints": [{"between": ["mass", "ground"], "law": "joint", "at": [0.0]}],
        },
        "forces": place,
        "sensors": place,
    }
