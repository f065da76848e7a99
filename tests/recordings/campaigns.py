"""A small campaign that tests write: a rail on springs over a deck, a car on it, a hammer."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

from permway.campaign.campaign import Campaign, read_campaign
from permway.laws.toml import to_toml

MODEL: dict[str, Any] = {
    "format": 1,
    "temperature_C": 12.0,
    "frequencies": {"from_Hz": 5.0, "to_Hz": 200.0, "step_Hz": 5.0},
    "line": {
        "bodies": {
            "rail": {
                "type": "beam",
                "theory": "timoshenko",
                "youngs_modulus_Pa": 2.1e11,
                "second_moment_m4": 3.038e-5,
                "density_kg_per_m3": 7850.0,
                "area_m2": 7.67e-3,
                "shear_modulus_Pa": 8.1e10,
                "shear_coefficient": 0.4,
                "loss_factor": 0.01,
            },
            "deck": {
                "type": "beam",
                "youngs_modulus_Pa": 3.4e10,
                "second_moment_m4": 1.2,
                "density_kg_per_m3": 2500.0,
                "area_m2": 4.0,
                "loss_factor": 0.08,
                "intervals_m": [[0.0, 24.0]],
            },
        },
        "laws": {
            "pad": {"type": "hysteretic", "stiffness": 6.0e7, "loss_factor": 0.15},
            "bearing": {"type": "hysteretic", "stiffness": 4.0e9, "loss_factor": 0.2},
        },
        "joints": [
            {"between": ["rail", "deck"], "law": "pad", "at": {"from_m": 0.0, "to_m": 24.0, "spacing_m": 0.6}},
            {
                "between": ["rail", "ground"],
                "law": "pad",
                "at": [
                    {"from_m": -12.0, "to_m": -0.6, "spacing_m": 0.6},
                    {"from_m": 24.6, "to_m": 36.0, "spacing_m": 0.6},
                ],
            },
            {"between": ["deck", "ground"], "law": "bearing", "at": {"of": "deck"}},
        ],
    },
    "forces": [{"body": "rail", "x_m": 12.0}],
    "sensors": [{"body": "rail", "x_m": 12.0}],
    "train": {
        "centre_m": 12.0,
        "speed_m_per_s": 50.0,
        "vehicle": {"preset": "crh380a", "share": 0.5},
    },
    "irregularity": {"type": "german_sato", "continuous": True},
}

CAMPAIGN: dict[str, Any] = {
    "format": 1,
    "title": "A deck of 24 m",
    "model": "model.toml",
    "parameters": [
        {"name": "pad.k", "unit": "N/m", "paths": ["line.laws.pad.stiffness"], "tolerance_2sigma": 0.25},
        {"name": "pad.eta", "paths": "line.laws.pad.loss_factor", "tolerance_2sigma": 0.5},
        {"name": "deck.E", "unit": "Pa", "paths": ["line.bodies.deck.youngs_modulus_Pa"], "tolerance_2sigma": 0.1},
        {
            "name": "wheelset",
            "unit": "kg",
            "paths": ["train.vehicle.wheelset_mass_kg"],
            "nominal": 890.0,
            "tolerance_2sigma": 0.1,
        },
        {
            "name": "level",
            "unit": "dB",
            "paths": ["campaign.irregularity.level_dB"],
            "acts": "sets",
            "tolerance_2sigma": 2.0,
            "absolute": True,
        },
        {
            "name": "gain",
            "paths": ['campaign.sensors["rail@12"].chain.gain'],
            "acts": "scales",
            "tolerance_2sigma": 0.05,
            "bounds": [0.5, 2.0],
        },
    ],
    "sensors": [
        {"name": "rail@12", "body": "rail", "x_m": 12.0, "unit": "m/s2"},
        {"name": "deck@6", "body": "deck", "x_m": 6.0, "unit": "mm/s", "quantity": "velocity"},
        {"name": "axle", "degree": "car1.wheelset1", "unit": "m/s2", "chain": {"noise_floor": 1e-6}},
        {"name": "floor", "degree": "car1.body.bounce", "unit": "g", "direction": "up"},
    ],
    "forces": [{"name": "hit", "body": "rail", "x_m": 12.0}, {"name": "hit far", "body": "rail", "x_m": 15.3}],
    "conditions": [
        {"name": "still", "kind": "hammer", "temperature_C": 12.0},
        {"name": "fast", "kind": "train", "temperature_C": 12.0, "speed_km_per_h": 180.0},
        {"name": "rig", "kind": "shaker"},
        {"name": "tests", "kind": "table"},
    ],
    "irregularity": {"knowledge": "within", "within_dB": 2.0, "rolling": False},
    "records": [
        {
            "name": "blows",
            "file": "frf.csv",
            "condition": "still",
            "statistic": "frf",
            "averages": 8,
            "responses": {"r": "rail@12", "d": "deck@6"},
            "references": {"a": "hit", "b": "hit far"},
        },
        {
            "name": "run",
            "file": "run.csv",
            "condition": "fast",
            "statistic": "csd",
            "sampling_Hz": 512.0,
            "channels": {"axle": "axle", "floor": "floor"},
        },
    ],
    "held_out": [
        {"name": "top", "axis": "band", "band_Hz": [100.0, 150.0]},
        {"name": "speed", "axis": "speed", "members": [50.0]},
        {"name": "far", "axis": "place", "from_to_m": [15.0, 16.0]},
        {"name": "floor", "axis": "channel", "members": ["floor"]},
    ],
}


def tables() -> tuple[dict[str, Any], dict[str, Any]]:
    """Campaign and model as tables of their own, to be changed."""
    return copy.deepcopy(CAMPAIGN), copy.deepcopy(MODEL)


def write(folder: Path, campaign: dict[str, Any] | None = None, model: dict[str, Any] | None = None) -> Path:
    """Write the two files, and records of a line each; the campaign file's path."""
    plain, plain_model = tables()
    (folder / "campaign.toml").write_text(to_toml(plain if campaign is None else campaign))
    (folder / "model.toml").write_text(to_toml(plain_model if model is None else model))
    for name in ("frf.csv", "run.csv"):
        (folder / name).write_text("not read by these tests\n")
    return folder / "campaign.toml"


def small(folder: Path) -> Campaign:
    """The campaign, read."""
    return read_campaign(write(folder))
