"""A supported beam that axles pass, its closed form by modes, and a campaign of it, as tests write them."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
from permway.laws.toml import to_toml
from scipy.signal import resample_poly

LENGTH_M, MODULUS_PA, INERTIA_M4, MASS_KG_PER_M = 24.0, 3.4e10, 1.2, 1.0e4
BENDING_NM2 = MODULUS_PA * INERTIA_M4
HEIGHT_M = 0.9
SPEED, ENTRY_S = 30.0, 0.8
LAGS_M, LOADS_N = (0.0, 2.5, 17.5, 20.0), (1.2e5, 1.2e5, 1.4e5, 1.4e5)
RATE_HZ, DURATION_S = 200.0, 4.5
FINER, AFTER = 32, 100
"""Times the rate at which the closed form is taken before it is filtered, and samples more, for the filter."""

PLACES_M = {"w": 12.0, "v": 7.0, "a": 8.0, "e": 12.0, "M": 9.0}
SENSORS: dict[str, dict[str, Any]] = {
    "w": {"quantity": "displacement", "unit": "mm"},
    "v": {"quantity": "velocity", "unit": "mm/s"},
    "a": {"quantity": "acceleration", "unit": "m/s2"},
    "e": {"quantity": "strain", "unit": "um/m", "height_m": HEIGHT_M},
    "M": {"quantity": "bending_moment", "unit": "kN*m"},
}
PER_UNIT = {"w": 1e3, "v": 1e3, "a": 1.0, "e": 1e6, "M": 1e-3}


def model(loss_factor: float = 0.04) -> dict[str, Any]:
    """The table of the model file."""
    deck = {
        "type": "beam",
        "youngs_modulus_Pa": MODULUS_PA,
        "second_moment_m4": INERTIA_M4,
        "density_kg_per_m3": 2500.0,
        "area_m2": MASS_KG_PER_M / 2500.0,
        "loss_factor": loss_factor,
        "intervals_m": [[0.0, LENGTH_M]],
        "ends": "pinned",
    }
    place = [{"body": "deck", "x_m": 12.0}]
    return {
        "format": 1,
        "frequencies": {"from_Hz": 5.0, "to_Hz": 20.0, "step_Hz": 5.0},
        "line": {"bodies": {"deck": deck}, "laws": {}, "joints": []},
        "forces": place,
        "sensors": place,
    }


def campaign(names: str = "wvaeM", *, high_Hz: float = 15.0) -> dict[str, Any]:
    """The table of the campaign file: sensors by their letters."""
    axles = "campaign.conditions.train.axles"
    loads = [
        {"name": f"P{i}", "unit": "N", "paths": f"{axles}.loads_N[{i}]", "tolerance_2sigma": 0.2}
        for i in range(len(LOADS_N))
    ]
    return {
        "format": 1,
        "title": "A beam that a train passes",
        "model": "model.toml",
        "parameters": [
            {"name": "E", "paths": "line.bodies.deck.youngs_modulus_Pa", "unit": "Pa", "tolerance_2sigma": 0.15},
            {
                "name": "V",
                "paths": "campaign.conditions.train.speed_m_per_s",
                "unit": "m/s",
                "tolerance_2sigma": 0.02,
            },
            {
                "name": "t0",
                "paths": f"{axles}.entry_s",
                "unit": "s",
                "acts": "adds",
                "tolerance_2sigma": 0.1,
                "absolute": True,
            },
            *loads,
        ],
        "sensors": [{"name": n, "body": "deck", "x_m": PLACES_M[n], **SENSORS[n]} for n in names],
        "conditions": [
            {
                "name": "train",
                "kind": "passage",
                "speed_m_per_s": SPEED,
                "axles": {
                    "loads_N": list(LOADS_N),
                    "lags_m": list(LAGS_M),
                    "body": "deck",
                    "entry_s": ENTRY_S,
                },
            }
        ],
        "records": [
            {
                "name": "run",
                "file": "run.csv",
                "condition": "train",
                "statistic": "passage",
                "band_Hz": [0.1, high_Hz],
                "channels": {n: n for n in names},
            }
        ],
    }


def closed_form(time_s: np.ndarray, x_m: float, zeta: float, *, lags=LAGS_M, loads=LOADS_N, modes: int = 60):
    """Displacement, velocity, acceleration and curvature -w'' at a place, SI, by modes with viscous damping.

    Fryba, Vibration of Solids and Structures under Moving Loads (1999), chapter 1.4: a force P at V t excites mode
    n as 2 P/(m L) sin(n pi V t/L); exact between entry and leaving, free after it.
    """
    n = np.arange(1, modes + 1)
    natural = (n * np.pi / LENGTH_M) ** 2 * np.sqrt(BENDING_NM2 / MASS_KG_PER_M)
    driven = n * np.pi * SPEED / LENGTH_M
    pole = natural * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    damped = natural * np.sqrt(1.0 - zeta**2)
    force = 2.0 / (MASS_KG_PER_M * LENGTH_M)
    # Steady answer to exp(i driven t), whose imaginary part is that to the sine.
    steady = force / (natural**2 - driven**2 + 2j * zeta * natural * driven)
    total = np.zeros((3, modes, time_s.size))

    def free(q: np.ndarray, u: np.ndarray, since: np.ndarray) -> np.ndarray:
        """Displacement, velocity, acceleration after a state; 0 before it."""
        late = since >= 0.0
        amplitude = (q + (u + zeta * natural * q) / (1j * damped))[:, None]
        moved = amplitude * np.exp(pole[:, None] * np.where(late, since, 0.0))
        return late * np.stack([(moved * pole[:, None] ** k).real for k in range(3)])

    leaving = LENGTH_M / SPEED
    for lag, load in zip(lags, loads, strict=True):
        since = time_s - ENTRY_S - lag / SPEED
        on = (since >= 0.0) & (since < leaving)
        turning = steady[:, None] * np.exp(1j * driven[:, None] * np.where(on, since, 0.0))
        found = on * np.stack([(turning * (1j * driven[:, None]) ** k).imag for k in range(3)])
        started = free(-steady.imag, -(1j * driven * steady).imag, since)
        at_end = steady * np.exp(1j * driven * leaving)
        rest = np.array([leaving])
        left = free(-steady.imag, -(1j * driven * steady).imag, rest)[:, :, 0]
        q = at_end.imag + left[0]
        u = (1j * driven * at_end).imag + left[1]
        total += load * (found + np.where(since < leaving, started, 0.0) + free(q, u, since - leaving))
    shape = np.sin(n * np.pi * x_m / LENGTH_M)
    w, v, a = np.einsum("n,knt->kt", shape, total)
    curvature = np.einsum("n,nt->t", shape * (n * np.pi / LENGTH_M) ** 2, total[0])
    return w, v, a, curvature


def history(name: str, time_s: np.ndarray, zeta: float) -> np.ndarray:
    """What a sensor reads, in its unit, by the closed form, behind an anti-aliasing filter.

    Axles that enter and leave make steps of acceleration, which samples alone would fold into the band. So many
    modes are summed as finer samples hold.
    """
    step = time_s[1] - time_s[0]
    fine = time_s[0] + step / FINER * np.arange((time_s.size + AFTER) * FINER)
    first = np.pi / 2.0 * np.sqrt(BENDING_NM2 / MASS_KG_PER_M) / LENGTH_M**2
    modes = int(np.sqrt(0.45 * FINER / step / first))
    w, v, a, curvature = closed_form(fine, PLACES_M[name], zeta, modes=modes)
    values = {"w": w, "v": v, "a": a, "e": HEIGHT_M * curvature, "M": BENDING_NM2 * curvature}
    return resample_poly(values[name], 1, FINER)[: time_s.size] * PER_UNIT[name]


def time_s() -> np.ndarray:
    """Of the samples."""
    return np.arange(round(DURATION_S * RATE_HZ)) / RATE_HZ


def write(
    folder: Path,
    columns: dict[str, np.ndarray],
    *,
    table: dict[str, Any] | None = None,
    loss_factor: float = 0.04,
    **deck: Any,
) -> Path:
    """A campaign with these histories, in the sensors' units; keys of the deck may differ."""
    folder.mkdir(parents=True, exist_ok=True)
    table = campaign("".join(columns)) if table is None else copy.deepcopy(table)
    header = ",".join(["time [s]", *(f"{n} [{SENSORS[n]['unit']}]" for n in columns)])
    rows = [",".join(f"{v:.12g}" for v in row) for row in zip(time_s(), *columns.values(), strict=True)]
    (folder / "run.csv").write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    line = model(loss_factor)
    line["line"]["bodies"]["deck"] |= deck
    (folder / "model.toml").write_text(to_toml(line), encoding="utf-8")
    path = folder / "campaign.toml"
    path.write_text(to_toml(table), encoding="utf-8")
    return path
