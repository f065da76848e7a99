"""A small campaign simulated by the tool itself: a rail on a deck, struck by a hammer.

Truth is drawn from the owner's priors, the smooth errors of sensors and hammer from theirs, noise blow by blow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from permway.arrays import Reals
from permway.laws.toml import to_toml
from permway.recordings.campaign import Campaign, read_campaign
from permway.recordings.predict import predict

BLOWS = 32
FREQUENCY = np.arange(8.0, 201.0, 2.0)
SPACING = {"from_m": 0.0, "to_m": 12.0, "spacing_m": 0.6}

MODEL: dict[str, Any] = {
    "format": 1,
    "temperature_C": 12.0,
    "frequencies": {"from_Hz": 5.0, "to_Hz": 200.0, "step_Hz": 5.0},
    "line": {
        "bodies": {
            "rail": {
                "type": "beam",
                "youngs_modulus_Pa": 2.1e11,
                "second_moment_m4": 3.0e-5,
                "density_kg_per_m3": 7850.0,
                "area_m2": 7.7e-3,
                "loss_factor": 0.02,
                "intervals_m": [[-3.0, 15.0]],
            },
            "deck": {
                "type": "beam",
                "youngs_modulus_Pa": 3.4e10,
                "second_moment_m4": 0.12,
                "density_kg_per_m3": 2500.0,
                "area_m2": 1.5,
                "loss_factor": 0.06,
                "intervals_m": [[0.0, 12.0]],
            },
        },
        "laws": {
            "pad": {"type": "hysteretic", "stiffness": 3.0e7, "loss_factor": 0.15},
            "bearing": {"type": "hysteretic", "stiffness": 8.0e8, "loss_factor": 0.2},
        },
        "joints": [
            {"between": ["rail", "deck"], "law": "pad", "at": SPACING},
            {"between": ["deck", "ground"], "law": "bearing", "at": {"of": "deck"}},
        ],
    },
    "forces": [{"body": "rail", "x_m": 6.0}],
    "sensors": [{"body": "rail", "x_m": 6.0}],
}

CAMPAIGN: dict[str, Any] = {
    "format": 1,
    "title": "A deck of 12 m",
    "model": "model.toml",
    "parameters": [
        {"name": "pad.k", "unit": "N/m", "paths": "line.laws.pad.stiffness", "tolerance_2sigma": 0.3},
        {"name": "pad.eta", "paths": "line.laws.pad.loss_factor", "tolerance_2sigma": 0.5},
        {"name": "bearing.k", "unit": "N/m", "paths": "line.laws.bearing.stiffness", "tolerance_2sigma": 0.4},
        {"name": "deck.E", "unit": "Pa", "paths": "line.bodies.deck.youngs_modulus_Pa", "tolerance_2sigma": 0.15},
        {"name": "deck.eta", "paths": "line.bodies.deck.loss_factor", "tolerance_2sigma": 0.5},
    ],
    "sensors": [
        {"name": "rail@6", "body": "rail", "x_m": 6.0, "unit": "m/s2"},
        {"name": "deck@3", "body": "deck", "x_m": 3.0, "unit": "m/s2"},
    ],
    "forces": [
        {"name": "hit", "body": "rail", "x_m": 6.0},
        {"name": "hit far", "body": "rail", "x_m": 9.3},
        {"name": "deck hit", "body": "deck", "x_m": 4.5},
    ],
    "conditions": [{"name": "still", "kind": "hammer", "temperature_C": 12.0}],
    "records": [
        {
            "name": "blows",
            "file": "frf.npz",
            "condition": "still",
            "statistic": "frf",
            "averages": BLOWS,
            "responses": {"r": "rail@6", "d": "deck@3"},
            "references": {"a": "hit", "b": "hit far", "c": "deck hit"},
        }
    ],
}


@dataclass(frozen=True)
class Simulated:
    """A campaign on disc and what it was made from."""

    path: Path
    campaign: Campaign
    truth: dict[str, float]
    noise: np.ndarray
    """Standard deviation of the estimate's real part, and of its imaginary part, (sensor, point)."""


def simulate(
    folder: Path,
    seed: int,
    *,
    noise: float = 0.05,
    smooth: float = 0.02,
    octaves: float = 1.0,
    amend: Callable[[Campaign], Campaign] = lambda campaign: campaign,
    model: dict[str, Any] = MODEL,
    campaign: dict[str, Any] = CAMPAIGN,
    frequency_Hz: Reals = FREQUENCY,
) -> Simulated:
    """Write a campaign whose truth is drawn from its priors.

    Parameters
    ----------
    folder : Path
    seed : int
    noise : float
        Standard deviation of a blow's noise, real and imaginary, over the median modulus of its pair.
    smooth : float
        Standard deviation of sensors' and points' smooth errors, neper and rad, at each knot.
    octaves : float
        From knot to knot.
    amend : callable
        What is concealed in the records.
    model, campaign : dict
        Tables of the two files; the first record is a frequency response, and the only one.
    frequency_Hz : ndarray, shape (F,)
        Lines of it.
    """
    random = np.random.default_rng(seed)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(to_toml(model))
    path = folder / "campaign.toml"
    path.write_text(to_toml(campaign))
    record = campaign["records"][0]
    columns, rows = list(record["references"]), list(record["responses"])
    shape = (frequency_Hz.size, len(rows), len(columns))
    names = {"sensor": np.array(rows), "hammer": np.array(columns)}
    save = folder / "frf.npz"
    np.savez(save, f=frequency_Hz, frf=np.ones(shape, complex), coh=np.full(shape, 0.9), **names)
    read = read_campaign(path)
    truth = {k.name: k.value(float(random.standard_normal())) for k in read.parameters.known.values()}
    (right,) = predict(amend(read.with_values(truth)), read.load(), threads=1)
    gains = [
        np.exp(_smooth(random, frequency_Hz / frequency_Hz[0], count, smooth, octaves)) for count in shape[1:]
    ]
    values = np.moveaxis(right["frf"].values, -1, 0) * gains[0][:, :, None] * gains[1][:, None, :]
    size = noise * np.median(np.abs(values), axis=0)
    blows = (BLOWS, *shape)
    each = values + size * (random.standard_normal(blows) + 1j * random.standard_normal(blows))
    estimate = each.mean(axis=0)
    coherence = np.abs(estimate) ** 2 / (np.abs(each) ** 2).mean(axis=0)
    np.savez(save, f=frequency_Hz, frf=estimate, coh=coherence, **names)
    return Simulated(path, read, truth, size / np.sqrt(BLOWS))


def _smooth(random: np.random.Generator, ratio: Reals, count: int, size: float, length: float) -> np.ndarray:
    """Straight over the logarithm of frequency from knot to knot, (F, count)."""
    place = np.log2(ratio) / length
    knots = np.linspace(0.0, place[-1], round(place[-1]) + 1)
    draw = random.standard_normal((2, count, knots.size)) * size
    found = np.array(
        [np.interp(place, knots, a) + 1j * np.interp(place, knots, b) for a, b in zip(*draw, strict=True)]
    )
    return found.T
