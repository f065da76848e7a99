"""A small campaign simulated by the tool itself: hammer tests in warmth and cold, and two runs of a small train.

The nominal values are the true ones but for what is put in; noise is drawn, calibration errors are not.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.load import Dataset
from permway.campaign.predict import predict
from permway.laws.toml import to_toml
from simulated import CAMPAIGN, MODEL

BLOWS, AVERAGES, COHERENCE = 16, 60, 0.98
STRUCK = np.geomspace(6.0, 200.0, 25)
RUN = np.arange(3.0, 91.0)
ON_BOARD = {
    "axlebox1": ("car1.wheelset1", 1e-5),
    "axlebox2": ("car1.wheelset2", 1e-5),
    "axlebox3": ("car1.wheelset3", 1e-5),
    "bogie1": ("car1.bogie1.bounce", 1e-7),
    "carbody": ("car1.body.bounce", 1e-9),
}
"""Degree of each sensor, and the density of its noise."""
VEHICLE: dict[str, Any] = {
    "preset": "crh380a",
    "share": 0.5,
    "bogie_distance_m": 6.0,
    "wheelbase_m": 2.0,
    "car_length_m": 10.0,
}


def tables(*, train: bool = True, cold: bool = True) -> tuple[dict[str, Any], dict[str, Any]]:
    """Campaign and model, with or without a train and a test in the cold."""
    model, campaign = copy.deepcopy(MODEL), copy.deepcopy(CAMPAIGN)
    conditions = campaign["conditions"]
    if cold:
        conditions.append({"name": "cold", "kind": "hammer", "temperature_C": -15.0})
        campaign["records"].append({**campaign["records"][0], "name": "blows in the cold", "condition": "cold"})
    if train:
        model["train"] = {"centre_m": 6.0, "speed_m_per_s": 50.0, "vehicle": VEHICLE}
        model["irregularity"] = {"type": "german_sato", "continuous": True}
        for name, (degree, noise) in ON_BOARD.items():
            sensor = {"name": name, "degree": degree, "unit": "m/s2", "chain": {"noise_floor": noise}}
            campaign["sensors"].append(sensor)
        for name, speed in (("slow", 40.0), ("fast", 80.0)):
            conditions.append({"name": name, "kind": "train", "temperature_C": 12.0, "speed_m_per_s": speed})
            record = {"name": f"run {name}", "file": "frf.npz", "condition": name, "statistic": "csd"}
            campaign["records"].append({**record, "segment_s": 1.0, "channels": {n: n for n in ON_BOARD}})
        for name, path in (
            ("vehicle.kp", "primary_stiffness_N_per_m"),
            ("vehicle.cp", "primary_damping_Ns_per_m"),
            ("vehicle.ks", "secondary_stiffness_N_per_m"),
            ("vehicle.cs", "secondary_damping_Ns_per_m"),
            ("vehicle.Mc", "car_body_mass_kg"),
        ):
            known = {"name": name, "paths": f"train.vehicle.{path}", "tolerance_2sigma": 0.15}
            campaign["parameters"].append(known)
    return campaign, model


def written(folder: Path, campaign: dict[str, Any], model: dict[str, Any]) -> Campaign:
    """Write and read the two files."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(to_toml(model))
    (folder / "campaign.toml").write_text(to_toml(campaign))
    (folder / "frf.npz").write_bytes(b"not read")
    return read_campaign(folder / "campaign.toml")


def blank(campaign: Campaign) -> list[Dataset]:
    """Datasets of the right coordinates, and of zeros."""
    found = []
    for record in campaign.stated.records:
        if record.statistic == "frf":
            names = {"sensor": list(record.responses.values()), "force": list(record.references.values())}
            shape = (*(len(v) for v in names.values()), STRUCK.size)
            data = xr.Dataset(
                {"frf": ((*names, "frequency"), np.zeros(shape, complex))},
                coords={**names, "frequency": STRUCK},
                attrs={"averages": BLOWS},
            )
        else:
            names = {kind: list(record.channels.values()) for kind in ("channel", "channel2")}
            count = len(record.channels)
            data = xr.Dataset(
                {
                    "csd": ((*names, "frequency"), np.zeros((count, count, RUN.size), complex)),
                    "psd": (("channel", "frequency"), np.zeros((count, RUN.size))),
                },
                coords={**names, "frequency": RUN},
                attrs={"averages": AVERAGES},
            )
        found.append(Dataset(record, campaign.condition(record.condition), data))
    return found


def measured(
    campaign: Campaign, seed: int, amend: Callable[[Campaign], Campaign] = lambda campaign: campaign
) -> list[Dataset]:
    """Records of the campaign with something concealed in them."""
    random = np.random.default_rng(seed)
    datasets = blank(campaign)
    for dataset, right in zip(datasets, predict(amend(campaign), datasets, threads=1), strict=True):
        data = dataset.data
        if dataset.record.statistic == "frf":
            variance = (1.0 - COHERENCE) / (2.0 * BLOWS * COHERENCE)
            noise = _normal(random, right["frf"].shape) * np.sqrt(variance)
            data["frf"] = right["frf"].copy(data=right["frf"].values * np.exp(noise))
            data["coherence"] = right["frf"].copy(data=np.full(right["frf"].shape, COHERENCE))
            data["log_variance"] = right["frf"].copy(data=np.full(right["frf"].shape, variance))
        else:
            root = np.linalg.cholesky(np.moveaxis(right["csd"].values, -1, 0))
            draws = root @ _normal(random, (RUN.size, root.shape[1], AVERAGES)) / np.sqrt(2.0)
            estimate = np.moveaxis(draws @ draws.conj().transpose(0, 2, 1), 0, -1) / AVERAGES
            data["csd"] = right["csd"].copy(data=estimate)
            data["psd"] = data["psd"].copy(data=np.einsum("ccf->cf", estimate).real)
    return datasets


def _normal(random: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    return random.standard_normal(shape) + 1j * random.standard_normal(shape)
