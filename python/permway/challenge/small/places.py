"""Where a small campaign is struck and read, under which conditions, and which parameters have tolerances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from permway.challenge.small.draws import log_between
from permway.challenge.small.layouts import RUNS_ON, Layout

UNSTATED = 0.1
"""Share of campaigns without any parameter: the format's default, and the truth has the file's values."""

RUN, COLD = 0.4, 0.3
"""Share of campaigns with a run of a small vehicle (of the model's maker, on layouts with a rail), and of those
with hammer tests at two temperatures."""

BLOWS = 8

LOWEST_HZ, FEWEST_LINES, MOST_LINES = 8.0, 44, 61
"""First line of hammer tests, and their number: a diagnosis takes in proportion to it."""

SAMPLING_HZ, RUN_S, RUN_BAND_HZ = 256.0, 40.0, (3.0, 90.0)
"""Of a run, of which a diagnosis uses every second line of a second's segments: 44 lines."""

ON_BOARD = {
    "axlebox1": ("car1.wheelset1", 1e-5),
    "axlebox2": ("car1.wheelset2", 1e-5),
    "bogie1": ("car1.bogie1.bounce", 1e-7),
    "carbody": ("car1.body.bounce", 1e-9),
}
"""Degree of each sensor on board, and the density of its noise, (m/s2)2/Hz."""

VEHICLE = {
    "vehicle.kp": "primary_stiffness_N_per_m",
    "vehicle.cp": "primary_damping_Ns_per_m",
    "vehicle.ks": "secondary_stiffness_N_per_m",
}


@dataclass(frozen=True)
class Tests:
    """A campaign file and a model file as tables, and what they leave open.

    Attributes
    ----------
    campaign, model : dict
    frequency_Hz : ndarray
        Lines of the hammer tests.
    temperatures_C : tuple of float
        Of each hammer test.
    speed_m_per_s : float or None
        Of the run, if there is one.
    """

    campaign: dict[str, Any]
    model: dict[str, Any]
    frequency_Hz: np.ndarray
    temperatures_C: tuple[float, ...]
    speed_m_per_s: float | None

    @property
    def sensors(self) -> list[dict[str, Any]]:
        """Sensors on the line."""
        return [sensor for sensor in self.campaign["sensors"] if "body" in sensor]

    @property
    def forces(self) -> list[dict[str, Any]]:
        """Hammer points."""
        return list(self.campaign["forces"])


def draw_tests(random: np.random.Generator, layout: Layout, *, runs: bool) -> Tests:
    """Two to six sensors and two to eight hammer points at random, and what else is measured.

    Parameters
    ----------
    random : Generator
    layout : Layout
    runs : bool
        Whether a vehicle may run.
    """
    sensors = _locations(random, layout, int(random.integers(2, 7)))
    points = _locations(random, layout, int(random.integers(2, 9)))
    if random.random() < 0.5 and layout.name != "rig":
        # As most teams do: one sensor beside a hammer point.
        points[0] = sensors[0]
    names = [f"s{i + 1}" for i in range(len(sensors))]
    hits = [f"h{i + 1}" for i in range(len(points))]
    warm = round(float(random.uniform(5.0, 25.0)), 1)
    temperatures = (warm, round(warm - float(random.uniform(20.0, 35.0)), 1))[: 1 + int(random.random() < COLD)]
    conditions: list[dict[str, Any]] = []
    records: list[dict[str, Any]] = []
    for index, temperature in enumerate(temperatures):
        conditions.append({"name": f"still{index + 1}", "kind": "hammer", "temperature_C": temperature})
        records.append(
            {
                "name": f"blows{index + 1}",
                "file": f"blows{index + 1}.npz",
                "condition": f"still{index + 1}",
                "statistic": "frf",
                "averages": BLOWS,
                "responses": {name: name for name in names},
                "references": {name: name for name in hits},
            }
        )
    campaign: dict[str, Any] = {
        "format": 1,
        "title": f"Small campaign: {layout.name} {layout.variant}".strip(),
        "model": "model.toml",
        "sensors": [
            {"name": name, "body": body, "x_m": x, "unit": "m/s2"}
            for name, (body, x) in zip(names, sensors, strict=True)
        ],
        "forces": [{"name": n, "body": b, "x_m": x} for n, (b, x) in zip(hits, points, strict=True)],
        "conditions": conditions,
        "records": records,
    }
    body, (low, high) = next(iter(layout.locations.items()))
    middle = {"body": body, "x_m": round(0.5 * (low + high), 3)}
    model: dict[str, Any] = {
        "format": 1,
        "temperature_C": warm,
        "frequencies": {"from_Hz": 5.0, "to_Hz": layout.top_Hz, "step_Hz": 5.0},
        "line": layout.line,
        "forces": [middle],
        "sensors": [middle],
    }
    speed = None
    if layout.name in RUNS_ON and random.random() < RUN and runs:
        speed = _run(random, layout, campaign, model)
    if random.random() >= UNSTATED:
        campaign["parameters"] = _parameters(random, layout, running=speed is not None)
    lines = int(random.integers(FEWEST_LINES, MOST_LINES))
    step = max(1.0, round(2.0 * (layout.top_Hz - LOWEST_HZ) / lines) / 2.0)
    frequency = LOWEST_HZ + step * np.arange(lines)
    return Tests(campaign, model, frequency, temperatures, speed)


def _locations(random: np.random.Generator, layout: Layout, count: int) -> list[tuple[str, float]]:
    """Places on bodies that are drawn by kind, the first of them on the first body; to 5 cm."""
    kinds: dict[str, list[str]] = {}
    for name in layout.locations:
        kinds.setdefault(name.split("[")[0], []).append(name)
    found: list[tuple[str, float]] = []
    for number in range(count):
        kind = list(kinds)[0 if number == 0 else int(random.integers(len(kinds)))]
        body = kinds[kind][int(random.integers(len(kinds[kind])))]
        low, high = layout.locations[body]
        x = round(20.0 * float(random.uniform(low, high))) / 20.0 if high > low else low
        found.append((body, round(min(max(x, low), high), 3)))
    # Two at one place would say the same twice; on a rig there are few places.
    return list(dict.fromkeys(found))


def _run(random: np.random.Generator, layout: Layout, campaign: dict[str, Any], model: dict[str, Any]) -> float:
    """Put in a short run of a small vehicle; its speed, m/s."""
    speed = round(float(random.uniform(25.0, 80.0)), 1)
    vehicle = {
        "preset": "crh380a",
        "share": 0.5,
        "bogie_distance_m": round(0.5 * layout.length_m, 1),
        "wheelbase_m": 2.0,
        "car_length_m": round(layout.length_m, 1),
    }
    centre = round(0.5 * layout.length_m, 2)
    model["train"] = {"centre_m": centre, "speed_m_per_s": 50.0, "vehicle": vehicle}
    model["irregularity"] = {"type": "german_sato", "continuous": True}
    # The model that makes the records has its train stand.
    campaign["irregularity"] = {"rolling": False}
    names = ["axlebox1", *(n for n in list(ON_BOARD)[1:] if random.random() < 0.6)]
    for name in names:
        degree, noise = ON_BOARD[name]
        sensor = {"name": name, "degree": degree, "unit": "m/s2", "chain": {"noise_floor": noise}}
        campaign["sensors"].append(sensor)
    warm = campaign["conditions"][0]["temperature_C"]
    campaign["conditions"].append({"name": "run", "kind": "train", "temperature_C": warm, "speed_m_per_s": speed})
    campaign["records"].append(
        {
            "name": "run",
            "file": "run.npz",
            "condition": "run",
            "statistic": "csd",
            "segment_s": 1.0,
            "band_Hz": list(RUN_BAND_HZ),
            "channels": {name: name for name in names},
        }
    )
    return speed


def _parameters(random: np.random.Generator, layout: Layout, *, running: bool) -> list[dict[str, Any]]:
    """Stiffness and loss of every layer, stiffness of every body but the rail, with tolerances drawn."""
    found: list[dict[str, Any]] = []

    def add(name: str, path: str, unit: str, low: float, high: float) -> None:
        tolerance = round(log_between(random, low, high), 3)
        found.append({"name": name, "unit": unit, "paths": path, "tolerance_2sigma": tolerance})

    for law in layout.line["laws"]:
        if law != "clamp":
            add(f"{law}.k", f"line.laws.{law}.stiffness", "N/m", 0.1, 0.5)
            add(f"{law}.eta", f"line.laws.{law}.loss_factor", "1", 0.3, 0.6)
    for name, body in layout.line["bodies"].items():
        if body["type"] == "beam" and name != "rail":
            add(f"{name}.E", f"line.bodies.{name}.youngs_modulus_Pa", "Pa", 0.05, 0.2)
            add(f"{name}.eta", f"line.bodies.{name}.loss_factor", "1", 0.3, 0.6)
    if running:
        for name, path in VEHICLE.items():
            add(name, f"train.vehicle.{path}", "1", 0.05, 0.2)
    return found
