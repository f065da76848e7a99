"""Small passages at random: a beam, a train, two to four sensors, values that the user states wrongly."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from crossing import Beam, Sensor, Train, histories
from permway.laws.toml import to_toml

RATE_HZ, NOISE = 200.0, (1e-3, 1e-2)
"""Samples; noise of a sample over the largest of its sensor, at random in its logarithm."""

STIFFNESS, SPEED, LOAD, ENTRY_S, SPRING = 0.15, 0.02, 0.2, 0.1, 0.2
"""Two standard deviations by which stated values are off, in proportion, and s."""

GRAVITY, BOUNCE_DAMPING = 9.81, 0.15
"""m/s2; damping ratio of masses on springs."""

GAIN = 0.02
"""Standard deviation of each channel's gain, and of an error that is smooth over frequency, neper and rad."""

UNITS = {
    "displacement": ("mm", 1e3),
    "velocity": ("mm/s", 1e3),
    "acceleration": ("m/s2", 1.0),
    "strain": ("um/m", 1e6),
}


@dataclass(frozen=True)
class Case:
    """A campaign's file, and the true values of its parameters."""

    path: Path
    true: dict[str, float]


def drawn(seed: int, folder: Path, *, sprung: bool) -> Case:
    """Write the campaign of a seed."""
    random = np.random.default_rng([seed, 44])
    length = random.uniform(15.0, 40.0)
    first_Hz = 100.0 / length * random.uniform(0.7, 1.3)
    kg_per_m = random.uniform(6e3, 1.2e4)
    bending = kg_per_m * (2.0 * length**2 * first_Hz / np.pi) ** 2
    damping = random.uniform(0.005, 0.02)
    lags = np.cumsum([0.0, *random.uniform(1.8, 12.0, int(random.integers(1, 5)))])
    loads = random.uniform(8e4, 2.2e5, lags.size)
    speed, entry = random.uniform(12.0, 45.0), random.uniform(0.8, 1.2)
    names = random.permutation(list(UNITS))[: int(random.integers(2, 5))]
    sensors = {str(n): Sensor(str(n), float(random.uniform(0.2, 0.8) * length), 0.9) for n in sorted(names)}
    off = {"E": STIFFNESS, "V": SPEED, **{f"P{i}": LOAD for i in range(loads.size)}}
    factor = {name: float(np.exp(0.5 * sigma * random.standard_normal())) for name, sigma in off.items()}
    late = float(0.5 * ENTRY_S * random.standard_normal())
    true_loads = loads * [factor[f"P{i}"] for i in range(loads.size)]
    bounce = 2.0 * np.pi * float(random.uniform(0.8, 3.0)) if sprung else 0.0
    mass = float(np.mean(loads)) / GRAVITY
    spring, damper = mass * bounce**2, 2.0 * BOUNCE_DAMPING * mass * bounce
    factor |= {"K": float(np.exp(0.5 * SPRING * random.standard_normal()))} if sprung else {}
    train = Train(true_loads, lags, speed * factor["V"], entry + late, spring * factor.get("K", 1.0), damper)
    beam = Beam(length, bending * factor["E"], kg_per_m, damping)
    samples = int((entry + (length + lags[-1]) / speed + 1.5) * RATE_HZ)
    read = histories(beam, train, list(sensors.values()), RATE_HZ, samples)
    columns = {name: _measured(v, random) * UNITS[name][1] for name, v in zip(sensors, read, strict=True)}
    _write(folder, columns)
    deck = {
        "type": "beam",
        "youngs_modulus_Pa": 3.4e10,
        "second_moment_m4": float(bending / 3.4e10),
        "density_kg_per_m3": 2500.0,
        "area_m2": float(kg_per_m / 2500.0),
        "damping_ratio": float(damping),
        "intervals_m": [[0.0, float(length)]],
        "ends": "pinned",
    }
    place = [{"body": "deck", "x_m": float(0.5 * length)}]
    model = {
        "format": 1,
        "frequencies": {"from_Hz": 5.0, "to_Hz": 20.0, "step_Hz": 5.0},
        "line": {"bodies": {"deck": deck}, "laws": {}, "joints": []},
        "forces": place,
        "sensors": place,
    }
    (folder / "model.toml").write_text(to_toml(model), "utf-8")
    stated = {
        "speed_m_per_s": float(speed),
        "entry_s": float(entry),
        "loads_N": loads.tolist(),
        "lags_m": lags.tolist(),
    }
    if sprung:
        stated["suspension"] = {"stiffness_N_per_m": spring, "damping_Ns_per_m": damper}
    high_Hz = float(min(3.0 * first_Hz, 25.0))
    path = folder / "campaign.toml"
    path.write_text(to_toml(_campaign(sensors, stated, high_Hz)), "utf-8")
    true = {"E": 3.4e10 * factor["E"], "V": train.speed, "t0": late}
    true |= {"K": spring * factor["K"]} if sprung else {}
    return Case(path, true | {f"P{i}": float(load) for i, load in enumerate(true_loads)})


def _measured(history: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Through a chain that errs by its gain and, smoothly over frequency, by level and phase; with noise."""
    spectrum = np.fft.rfft(history)
    octaves = np.log2(np.maximum(np.fft.rfftfreq(history.size, 1.0 / RATE_HZ), 0.1))
    error = np.full(octaves.size, GAIN * random.standard_normal(), dtype=np.complex128)
    for unit in (1.0, 1j):
        turn = 2.0 * np.pi * (octaves / random.uniform(2.0, 5.0) + random.uniform())
        error += unit * GAIN * np.sqrt(2.0) * np.cos(turn)
    error[0] = error[0].real
    noise = np.exp(random.uniform(*np.log(NOISE))) * np.abs(history).max()
    return np.fft.irfft(spectrum * np.exp(error), n=history.size) + noise * random.standard_normal(history.size)


def _write(folder: Path, columns: dict[str, np.ndarray]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    time = np.arange(next(iter(columns.values())).size) / RATE_HZ
    header = ",".join(["time [s]", *(f"{name} [{UNITS[name][0]}]" for name in columns)])
    rows = (",".join(f"{v:.9g}" for v in row) for row in zip(time, *columns.values(), strict=True))
    (folder / "run.csv").write_text("\n".join([header, *rows]) + "\n", "utf-8")


def _campaign(sensors: dict[str, Sensor], stated: dict[str, Any], high_Hz: float) -> dict[str, Any]:
    axles = "campaign.conditions.train.axles"
    speed = "campaign.conditions.train.speed_m_per_s"
    loads = [
        {"name": f"P{i}", "unit": "N", "paths": f"{axles}.loads_N[{i}]", "tolerance_2sigma": LOAD}
        for i in range(len(stated["loads_N"]))
    ]
    parameters = [
        {"name": "E", "unit": "Pa", "paths": "line.bodies.deck.youngs_modulus_Pa", "tolerance_2sigma": STIFFNESS},
        {"name": "V", "unit": "m/s", "paths": speed, "tolerance_2sigma": SPEED},
        {"name": "t0", "unit": "s", "paths": f"{axles}.entry_s", "acts": "adds", "tolerance_2sigma": ENTRY_S}
        | {"absolute": True},
        *loads,
    ]
    if "suspension" in stated:
        spring = f"{axles}.suspension.stiffness_N_per_m"
        parameters.append({"name": "K", "unit": "N/m", "paths": spring, "tolerance_2sigma": SPRING})
    condition = {"name": "train", "kind": "passage", "speed_m_per_s": stated.pop("speed_m_per_s")}
    record = {"name": "run", "file": "run.csv", "condition": "train", "statistic": "passage"}
    return {
        "format": 1,
        "model": "model.toml",
        "parameters": parameters,
        "sensors": [
            {"name": name, "body": "deck", "x_m": s.x_m, "quantity": s.quantity, "unit": UNITS[name][0]}
            | ({"height_m": s.height_m} if s.quantity == "strain" else {})
            for name, s in sensors.items()
        ],
        "conditions": [condition | {"axles": {"body": "deck", **stated}}],
        "records": [record | {"band_Hz": [0.1, high_Hz], "channels": {name: name for name in sensors}}],
    }
