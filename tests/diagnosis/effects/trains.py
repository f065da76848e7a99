"""A small campaign with runs, simulated by the tool itself: a car at two speeds over a deck, and a hammer.

The records are drawn where the campaign would load them: cross spectra from the Wishart distribution about what is
expected of Welch's method, frequency responses with noise blow by blow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.load import Dataset, log_variance
from permway.campaign.predict import predict
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.observations import Observations
from permway.diagnosis.recalibrate import recalibrate
from permway.laws.toml import to_toml

AVERAGES, BLOWS, DURATION_S = 120, 16, 60.0
HAMMER_HZ = np.geomspace(8.0, 160.0, 30)
RUN_HZ = np.arange(4.0, 141.0)
RAIL = {"from_m": 0.0, "to_m": 24.0, "spacing_m": 0.6}
BESIDE = [{"from_m": -6.0, "to_m": -0.6, "spacing_m": 0.6}, {"from_m": 24.6, "to_m": 30.0, "spacing_m": 0.6}]
ON_BOARD = {
    "axle1": "car1.wheelset1",
    "axle2": "car1.wheelset2",
    "axle3": "car1.wheelset3",
    "bogie": "car1.bogie1.bounce",
    "floor": "car1.body.bounce",
}
ON_TRACK = {"rail@12": ("rail", 12.0), "deck@9": ("deck", 9.0)}

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
            {"between": ["rail", "deck"], "law": "pad", "at": RAIL},
            {"between": ["rail", "ground"], "law": "pad", "at": BESIDE},
            {"between": ["deck", "ground"], "law": "bearing", "at": {"of": "deck"}},
        ],
    },
    "forces": [{"body": "rail", "x_m": 12.0}],
    "sensors": [{"body": "rail", "x_m": 12.0}],
    "train": {"centre_m": 12.0, "speed_m_per_s": 50.0, "vehicle": {"preset": "crh380a", "share": 0.5}},
    "irregularity": {"type": "german_sato", "continuous": True},
}

CAMPAIGN: dict[str, Any] = {
    "format": 1,
    "title": "A deck of 24 m, and a car",
    "model": "model.toml",
    "parameters": [
        {"name": "pad.k", "unit": "N/m", "paths": "line.laws.pad.stiffness", "tolerance_2sigma": 0.25},
        {"name": "pad.eta", "paths": "line.laws.pad.loss_factor", "tolerance_2sigma": 0.5},
        {
            "name": "level",
            "unit": "dB",
            "paths": "campaign.irregularity.level_dB",
            "acts": "sets",
            "tolerance_2sigma": 2.0,
            "absolute": True,
        },
    ],
    "sensors": [
        *({"name": n, "body": body, "x_m": x, "unit": "m/s2"} for n, (body, x) in ON_TRACK.items()),
        *({"name": n, "degree": d, "unit": "m/s2", "chain": {"noise_floor": 1e-7}} for n, d in ON_BOARD.items()),
    ],
    "forces": [{"name": "hit", "body": "rail", "x_m": 12.0}, {"name": "hit far", "body": "rail", "x_m": 15.3}],
    "conditions": [
        {"name": "still", "kind": "hammer", "temperature_C": 12.0},
        {"name": "slow", "kind": "train", "temperature_C": 12.0, "speed_m_per_s": 50.0},
        {"name": "fast", "kind": "train", "temperature_C": 12.0, "speed_m_per_s": 71.0},
    ],
    "irregularity": {"knowledge": "within", "within_dB": 2.0, "rolling": False},
    "records": [
        {
            "name": "blows",
            "file": "none.csv",
            "condition": "still",
            "statistic": "frf",
            "averages": BLOWS,
            "responses": {n: n for n in ON_TRACK},
            "references": {"a": "hit", "b": "hit far"},
        },
        *(
            {
                "name": f"run {name}",
                "file": "none.csv",
                "condition": name,
                "statistic": "csd",
                "sampling_Hz": 512.0,
                "channels": {n: n for n in ON_BOARD},
            }
            for name in ("slow", "fast")
        ),
    ],
}


def campaign_in(folder: Path) -> Campaign:
    """The campaign with its nominal values; its records are drawn, and their file is empty."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(to_toml(MODEL))
    (folder / "none.csv").write_text("drawn, not read\n")
    (folder / "campaign.toml").write_text(to_toml(CAMPAIGN))
    return read_campaign(folder / "campaign.toml")


def blank(campaign: Campaign) -> list[Dataset]:
    """Datasets of ones, of which only the coordinates count."""
    found = []
    for record in campaign.stated.records:
        if record.statistic == "frf":
            names = {"sensor": list(ON_TRACK), "force": ["hit", "hit far"], "frequency": HAMMER_HZ}
            data = _ones("frf", names)
        else:
            names = {"channel": list(ON_BOARD), "channel2": list(ON_BOARD), "frequency": RUN_HZ}
            data = _ones("csd", names)
            data["psd"] = (("channel", "frequency"), np.ones((len(ON_BOARD), RUN_HZ.size)))
            data.attrs["duration_s"] = DURATION_S
        found.append(Dataset(record, campaign.condition(record.condition), data))
    return found


def _ones(name: str, coordinates: dict[str, Any]) -> xr.Dataset:
    shape = [len(c) for c in coordinates.values()]
    return xr.Dataset({name: (list(coordinates), np.ones(shape, dtype=complex))}, coords=coordinates)


def drawn(truth: Campaign, seed: int, *, noise: float = 0.03) -> list[Dataset]:
    """What would be measured of a campaign."""
    random = np.random.default_rng(seed)
    found = []
    datasets = blank(truth)
    for dataset, right in zip(datasets, predict(truth, datasets, threads=1), strict=True):
        data = dataset.data
        if "frf" in data:
            values = right["frf"].values
            size = noise * np.median(np.abs(values), axis=-1)[:, :, None]
            blows = (BLOWS, *values.shape)
            read = values + size * (random.standard_normal(blows) + 1j * random.standard_normal(blows))
            mean = read.mean(axis=0)
            coherence = np.abs(mean) ** 2 / (np.abs(read) ** 2).mean(axis=0)
            data["frf"] = data["frf"].copy(data=mean)
            data["log_variance"] = (data["frf"].dims, log_variance(coherence, BLOWS))
            found.append(replace(dataset, data=data.assign_attrs(averages=BLOWS)))
        else:
            root = np.linalg.cholesky(np.moveaxis(right["csd"].values, -1, 0))
            shape = (*root.shape[:2], AVERAGES)
            z = np.sqrt(0.5) * (random.standard_normal(shape) + 1j * random.standard_normal(shape))
            x = root @ z
            matrix = np.moveaxis(x @ np.conj(np.swapaxes(x, 1, 2)) / AVERAGES, 0, -1)
            data["csd"] = data["csd"].copy(data=matrix)
            data["psd"] = data["psd"].copy(data=np.einsum("ccf->cf", matrix).real)
            found.append(replace(dataset, data=data.assign_attrs(averages=AVERAGES)))
    return found


def situation_of(
    nominal_campaign: Campaign, seed: int, *, amend: Callable[[Campaign], Campaign] = lambda campaign: campaign
) -> Situation:
    """The nominal campaign recalibrated on what was measured of another truth; nothing was located."""
    return Situation(recalibrate(observations_of(nominal_campaign, seed, amend=amend)), ())


def observations_of(
    nominal_campaign: Campaign, seed: int, *, amend: Callable[[Campaign], Campaign] = lambda campaign: campaign
) -> Observations:
    """What was measured of another truth, made ready to be held against the nominal model."""
    truth = nominal_campaign.with_values({"pad.k": 6.4e7, "pad.eta": 0.17, "level": 0.7})
    return gather(nominal_campaign, drawn(amend(truth), seed), threads=1)
