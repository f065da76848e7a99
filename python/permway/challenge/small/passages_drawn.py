"""Tables of a small campaign of trains that pass one accelerometer, and what is concealed near it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from permway.challenge.small.draws import generator, log_between, rounded

PASSAGES = "passages"

CONCEALED = (None, "mortar_void", "fastener_loss")
"""By the campaign's number, in turn: entries of the catalogue."""

LAWS = {"mortar_void": "ballast", "fastener_loss": "pad"}

SUPPORTS = (19, 24)
"""From and below: a line of 11 to 15 m, of which a train bends two or three."""

RATE_HZ, QUIET_S, AFTER_S, REST_S = 400.0, 0.25, 0.2, 0.2
"""Samples; before the first axle enters, as stated, and after the last one has left; of the prediction alone."""

BAND_HZ = (4.0, 80.0)

RAMP_M = 2.0

SPEEDS = (20.0, 40.0)
"""m/s, of a first passage."""

TWO, SLOWER = 0.5, (0.6, 0.8)
"""Share of campaigns with a second passage, which is held out, and its speed over the first."""

TOLERANCES = {"pad.k": 0.3, "pad.c": 0.5, "ballast.k": 0.3, "ballast.c": 0.5, "load": 0.06}
SPEED, ENTRY_S = 0.01, 0.02
"""Two standard deviations by which a stated speed, and a time of entry, are off."""

REACH = 2
"""Bays from the sensor within which the middle of what is concealed lies."""

FACTORS = (0.02, 0.5)
"""What is left of a support's stiffness and dashpot, evenly in its logarithm."""


@dataclass(frozen=True)
class Drawn:
    """A campaign's tables, and what is true beside its parameters.

    Attributes
    ----------
    model, campaign : dict
    stations : tuple of float
    sensor : (str, float)
        Body and place, m.
    samples : tuple of int
        Of each passage.
    effect : dict or None
        As a truth states it.
    numbers : ndarray of int
        Stations that it changes.
    """

    model: dict[str, Any]
    campaign: dict[str, Any]
    stations: tuple[float, ...]
    sensor: tuple[str, float]
    samples: tuple[int, ...]
    effect: dict[str, Any] | None
    numbers: np.ndarray


def draw(seed: int, index: int) -> Drawn:
    """A track, a train, a sensor, and what is concealed near it."""
    random = generator(seed, index, "layout", tier=PASSAGES)
    spacing = float(random.choice([0.6, 0.63, 0.65]))
    count = int(random.integers(*SUPPORTS))
    x = tuple(round(spacing * i, 3) for i in range(count))
    laws: dict[str, dict[str, Any]] = {}
    for law, low, high, loss, at_Hz in (
        ("pad", 4.0e7, 3.0e8, (0.1, 0.25), 80.0),
        ("ballast", 1.2e7, 6.0e7, (0.2, 0.6), 50.0),
    ):
        stiffness = log_between(random, low, high)
        damping = rounded(float(random.uniform(*loss)) * stiffness / (2.0 * np.pi * at_Hz))
        laws[law] = {"type": "kelvin_voigt", "stiffness": stiffness, "damping": damping}
    rail = {
        "type": "beam",
        "youngs_modulus_Pa": 2.1e11,
        "second_moment_m4": 3.0e-5,
        "density_kg_per_m3": 7850.0,
        "area_m2": 7.7e-3,
        "loss_factor": 0.0,
        "intervals_m": [[-spacing, round(x[-1] + spacing, 3)]],
    }
    sleepers = {"type": "mass", "mass_kg": rounded(float(random.uniform(110.0, 170.0))), "at": list(x)}
    rows = {"of": "sleeper"}
    station = int(random.integers(count // 2 - 2, count // 2 + 3))
    on_rail = bool(random.random() < 0.5)
    place = x[station] + (0.5 * spacing if on_rail and random.random() < 0.5 else 0.0)
    sensor = ("rail" if on_rail else f"sleeper[{station + 1}]", round(place, 3))
    spot = {"body": sensor[0], "x_m": sensor[1]}
    model = {
        "format": 1,
        "frequencies": {"from_Hz": 5.0, "to_Hz": BAND_HZ[1], "step_Hz": 5.0},
        "line": {
            "bodies": {"rail": rail, "sleeper": sleepers},
            "laws": laws,
            "joints": [
                {"between": ["rail", "sleeper"], "law": "pad", "at": rows},
                {"between": ["sleeper", "ground"], "law": "ballast", "at": rows},
            ],
        },
        "forces": [spot],
        "sensors": [spot],
    }
    campaign, samples = _campaign(generator(seed, index, "train", tier=PASSAGES), spot, x)
    effect, numbers = _concealed(generator(seed, index, "effect", tier=PASSAGES), CONCEALED[index % 3], x, station)
    return Drawn(model, campaign, x, sensor, samples, effect, numbers)


def _campaign(
    random: np.random.Generator, spot: dict[str, Any], x: tuple[float, ...]
) -> tuple[dict[str, Any], tuple[int, ...]]:
    """The table of a campaign of one passage or two, and samples of each."""
    wheelbase = round(float(random.uniform(1.8, 2.6)), 2)
    between = round(float(random.uniform(1.5, 3.0)) * wheelbase, 2)
    lags = [0.0, wheelbase, between, round(between + wheelbase, 2)][: int(random.choice([2, 4, 4]))]
    loads = [rounded(float(v)) for v in random.uniform(5.0e4, 1.1e5, len(lags))]
    first = float(random.uniform(*SPEEDS))
    speeds = [first, first * float(random.uniform(*SLOWER))][: 1 + int(random.random() < TWO)]
    conditions, records, samples, parameters = [], [], [], []
    names = [f"train{i + 1}" for i in range(len(speeds))]
    for number, (name, speed) in enumerate(zip(names, speeds, strict=True), start=1):
        speed = round(speed, 2)
        axles = {"body": "rail", "loads_N": loads, "lags_m": lags, "entry_s": QUIET_S, "load_factor": 1.0}
        axles |= {"from_m": x[0], "to_m": x[-1], "ramp_m": RAMP_M}
        conditions.append({"name": name, "kind": "passage", "speed_m_per_s": speed, "axles": axles})
        crossing = (x[-1] - x[0] + lags[-1]) / speed
        samples.append(int((QUIET_S + crossing + AFTER_S) * RATE_HZ))
        records.append(
            {
                "name": f"run{number}",
                "file": f"run{number}.npz",
                "condition": name,
                "statistic": "passage",
                "band_Hz": list(BAND_HZ),
                "channels": {"accelerometer": "accelerometer"},
                "window_s": round(samples[-1] / RATE_HZ + REST_S, 3),
            }
        )
        at = f"campaign.conditions.{name}"
        parameters += [
            {"name": f"speed{number}", "unit": "m/s", "paths": f"{at}.speed_m_per_s", "tolerance_2sigma": SPEED},
            {"name": f"entry{number}", "unit": "s", "paths": f"{at}.axles.entry_s", "acts": "adds"}
            | {"tolerance_2sigma": ENTRY_S, "absolute": True},
        ]
    for law, ending in ((law, e) for law in ("pad", "ballast") for e in ("stiffness", "damping")):
        name = f"{law}.{'k' if ending == 'stiffness' else 'c'}"
        unit = "N/m" if ending == "stiffness" else "N s/m"
        path = f"line.laws.{law}.{ending}"
        parameters.append({"name": name, "unit": unit, "paths": path, "tolerance_2sigma": TOLERANCES[name]})
    factors = [f"campaign.conditions.{name}.axles.load_factor" for name in names]
    parameters.append({"name": "load", "paths": factors, "tolerance_2sigma": TOLERANCES["load"]})
    campaign: dict[str, Any] = {
        "format": 1,
        "title": "Trains that pass an accelerometer beside the track",
        "model": "model.toml",
        "parameters": parameters,
        "sensors": [{"name": "accelerometer", **spot, "unit": "m/s2"}],
        "conditions": conditions,
        "records": records,
    }
    if len(names) > 1:
        campaign["held_out"] = [{"name": "other speed", "axis": "record", "members": ["run2"]}]
    return campaign, tuple(samples)


def _concealed(
    random: np.random.Generator, name: str | None, x: tuple[float, ...], station: int
) -> tuple[dict[str, Any] | None, np.ndarray]:
    """One to three supports near the sensor that keep a share of pad or bed."""
    if name is None:
        return None, np.empty(0, dtype=np.int64)
    count = int(random.integers(1, 4))
    middle = station + int(random.integers(-REACH, REACH + 1))
    numbers = np.arange(count) + middle - (count - 1) // 2
    factor = log_between(random, *FACTORS)
    low, high = x[numbers[0]], x[numbers[-1]]
    effect = {
        "id": name,
        "kind": f"elements: {name}",
        "family": "local loss of support",
        "domain": "path",
        "place": {"joint": LAWS[name], "x_m": [low, high], "near_m": 1.5},
        "parameters": {
            "centre_m": round(0.5 * (low + high), 4),
            "length_m": round(high - low, 4),
            "factor": factor,
        },
        "mechanical": f"{count} of {LAWS[name]} keep {factor:g}",
        "words": [],
    }
    return effect, numbers
