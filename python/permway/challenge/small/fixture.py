"""A fixture in the tool's own model: a rail on a deck of 12 m, struck by a hammer, three pads at the point struck.

Truth is drawn from the priors, the calibration errors of sensors and hammer from theirs, noise blow by blow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.predict import predict
from permway.challenge.small.write import write_arrays, write_tables, write_truth
from permway.diagnosis.catalogue._interval import weakened
from permway.errors import InputError

FIXTURE = "fixture"

SEEDS, FACTORS = tuple(range(1, 21)), (0.3, 0.05)
"""Of its forty campaigns: seeds, and what is left of the stiffness of three pads about the point struck."""

CENTRE_M, LENGTH_M = 6.0, 1.2

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
        Standard deviation of sensors' and points' calibration errors, neper and rad, at each knot.
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
    path = write_tables(folder, campaign, model)
    record = campaign["records"][0]
    columns, rows = list(record["references"]), list(record["responses"])
    shape = (frequency_Hz.size, len(rows), len(columns))
    names = {"sensor": np.array(rows), "hammer": np.array(columns)}
    save = folder / "frf.npz"
    write_arrays(save, {"f": frequency_Hz, "frf": np.ones(shape, complex), "coh": np.full(shape, 0.9), **names})
    read = read_campaign(path)
    truth = {k.name: k.value(float(random.standard_normal())) for k in read.parameters.known.values()}
    (right,) = predict(amend(read.with_values(truth)), read.load(), threads=1)
    gains = [np.exp(_smooth(random, frequency_Hz, count, smooth, octaves)) for count in shape[1:]]
    values = np.moveaxis(right["frf"].values, -1, 0) * gains[0][:, :, None] * gains[1][:, None, :]
    size = noise * np.median(np.abs(values), axis=0)
    blows = (BLOWS, *shape)
    each = values + size * (random.standard_normal(blows) + 1j * random.standard_normal(blows))
    estimate = each.mean(axis=0)
    coherence = np.abs(estimate) ** 2 / (np.abs(each) ** 2).mean(axis=0)
    write_arrays(save, {"f": frequency_Hz, "frf": estimate, "coh": coherence, **names})
    return Simulated(path, read, truth, size / np.sqrt(BLOWS))


def _smooth(
    random: np.random.Generator, frequency_Hz: Reals, count: int, size: float, octaves: float
) -> np.ndarray:
    """Straight over the logarithm of frequency from knot to knot, (F, count)."""
    place = np.log2(frequency_Hz / frequency_Hz[0]) / octaves
    knots = np.linspace(0.0, place[-1], round(place[-1]) + 1)
    draw = random.standard_normal((2, count, knots.size)) * size
    found = np.array(
        [np.interp(place, knots, a) + 1j * np.interp(place, knots, b) for a, b in zip(*draw, strict=True)]
    )
    return found.T


def fixture_names() -> list[str]:
    """Folders of its campaigns."""
    return [f"{FIXTURE}-{factor:g}-{seed:02d}" for seed in SEEDS for factor in FACTORS]


def make_fixture(name: str, folder: Path) -> str:
    """Write one of its campaigns and the truth, unless they are there; its name.

    Raises
    ------
    InputError
        For another name than those of :func:`fixture_names`.
    """
    if name not in fixture_names():
        raise InputError("is no campaign of the fixture", where="name", value=name)
    truth = Path(folder) / "truth" / f"{name}.json"
    if truth.is_file():
        return name
    _, factor, seed = name.split("-")
    left = float(factor)
    made = simulate(Path(folder) / name, int(seed), amend=lambda c: weakened(c, "pad", CENTRE_M, LENGTH_M, left))
    effect = {
        "id": "fastener_loss",
        "kind": "catalogue: fastener_loss",
        "family": "local loss of support",
        "domain": "path",
        "place": {"joint": "pad", "x_m": [CENTRE_M - LENGTH_M / 2, CENTRE_M + LENGTH_M / 2], "near_m": 0.6},
        "parameters": {"centre_m": CENTRE_M, "length_m": LENGTH_M, "factor": left},
        "mechanical": f"three pads about {CENTRE_M:g} m keep {left:g}",
        "words": [],
    }
    write_truth(
        truth,
        {
            "format": 1,
            "tier": FIXTURE,
            "seed": int(seed),
            "maker": "model",
            "layout": "deck",
            "errors": {"size_dB": 0.25, "length_octaves": 1.0, "noise": 0.05},
            "effects": [effect],
            "parameters": made.truth,
        },
    )
    return name
