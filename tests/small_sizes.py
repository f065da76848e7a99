"""The smallest campaigns there can be: each variant has one of something, the last one of everything."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from permway.arrays import Reals
from permway.campaign.campaign import Campaign, read_campaign
from permway.laws.toml import to_toml
from simulated import CAMPAIGN, FREQUENCY, MODEL, Simulated, simulate

Tables = dict[str, Any]


def without_parameters(campaign: Tables, model: Tables) -> None:
    """As a file is that leaves them out."""
    del campaign["parameters"]


def one_parameter(campaign: Tables, model: Tables) -> None:
    """The stiffness of pads."""
    del campaign["parameters"][1:]


def one_sensor(campaign: Tables, model: Tables) -> None:
    """On the rail."""
    del campaign["sensors"][1:]
    del campaign["records"][0]["responses"]["d"]


def one_point(campaign: Tables, model: Tables) -> None:
    """On the rail."""
    del campaign["forces"][1:]
    campaign["records"][0]["references"] = {"a": "hit"}


def one_joint(campaign: Tables, model: Tables) -> None:
    """Of pads, below the hammer."""
    model["line"]["joints"][0]["at"] = [6.0]


def one_bearing(campaign: Tables, model: Tables) -> None:
    """And a deck that a spring holds in its middle only."""
    model["line"]["joints"][1]["at"] = [6.0]


def mass_on_a_spring(campaign: Tables, model: Tables) -> None:
    """One body, one joint; hammer and sensor on the mass."""
    line = model["line"]
    line["bodies"] = {"block": {"type": "mass", "mass_kg": 120.0, "at": [6.0]}}
    line["laws"] = {"pad": line["laws"]["pad"]}
    line["joints"] = [{"between": ["block", "ground"], "law": "pad", "at": [6.0]}]
    for table in (*model["forces"], *model["sensors"], *campaign["sensors"], *campaign["forces"]):
        table |= {"body": "block", "x_m": 6.0}
    del campaign["parameters"][2:]
    one_sensor(campaign, model)
    one_point(campaign, model)


def one_of_everything(campaign: Tables, model: Tables) -> None:
    """A mass on a spring with one parameter."""
    mass_on_a_spring(campaign, model)
    one_parameter(campaign, model)


def one_of_everything_exact(campaign: Tables, model: Tables) -> None:
    """A mass on a spring that is known exactly."""
    mass_on_a_spring(campaign, model)
    without_parameters(campaign, model)


@dataclass(frozen=True)
class Small:
    """What is taken from the campaign of `tests/simulated.py`, and the lines that are left of it."""

    cut: Callable[[Tables, Tables], None]
    frequency_Hz: Reals

    def made(
        self, folder: Path, *, seed: int = 3, amend: Callable[[Campaign], Campaign] = lambda campaign: campaign
    ) -> Simulated:
        """Write it."""
        campaign, model = copy.deepcopy(CAMPAIGN), copy.deepcopy(MODEL)
        self.cut(campaign, model)
        return simulate(folder, seed, amend=amend, model=model, campaign=campaign, frequency_Hz=self.frequency_Hz)


LINES = FREQUENCY[::4]
ONE_LINE = np.array([60.0])


def _nothing(campaign: Tables, model: Tables) -> None:
    """Whole."""


SIZES = {
    "no parameters": Small(without_parameters, LINES),
    "one parameter": Small(one_parameter, LINES),
    "one sensor": Small(one_sensor, LINES),
    "one hammer point": Small(one_point, LINES),
    "one pad": Small(one_joint, LINES),
    "one bearing": Small(one_bearing, LINES),
    "a mass on a spring": Small(mass_on_a_spring, LINES),
    "one line": Small(_nothing, ONE_LINE),
    "one line, no parameters": Small(without_parameters, ONE_LINE),
    "one of everything": Small(one_of_everything, ONE_LINE),
    "one of everything, no parameters": Small(one_of_everything_exact, ONE_LINE),
    "a mass on a spring, no parameters": Small(one_of_everything_exact, LINES),
}


# Campaigns of one record that is no frequency response.

RUN_Hz, RUN_S = 256.0, 24.0
"""Sampling and length of a run: two dozen segments of a second."""

TABLES: dict[str, Tables] = {
    "one channel of a run": {"statistic": "psd", "condition": "fast", "channels": {"a": "axle"}},
    "one line of a run": {
        "statistic": "psd",
        "condition": "fast",
        "channels": {"a": "axle"},
        "band_Hz": [19.5, 20.5],
    },
    "one line of two channels": {
        "statistic": "csd",
        "condition": "fast",
        "channels": {"a": "axle", "b": "bogie"},
        "band_Hz": [19.5, 20.5],
    },
    "one band of decay": {
        "statistic": "decay",
        "condition": "still",
        "channels": {"r": "rail@6"},
        "spacing_m": 0.6,
        "band_Hz": [90.0, 110.0],
    },
    "one line of a swept sine": {
        "statistic": "transmissibility",
        "condition": "rig",
        "channels": {"r": "rail@6"},
        "band_Hz": [59.5, 60.5],
    },
    "one modulus": {
        "statistic": "material",
        "condition": "tests",
        "law": "line.laws.pad",
        "band_Hz": [59.5, 60.5],
    },
}
"""The record of each, beside its name and file."""

VEHICLE: Tables = {
    "preset": "crh380a",
    "share": 0.5,
    "bogie_distance_m": 6.0,
    "wheelbase_m": 2.0,
    "car_length_m": 10.0,
}


def alone(folder: Path, record: Tables, *, parameters: int) -> Campaign:
    """A campaign of one record, with the first parameters of the list, or without the list."""
    folder.mkdir(parents=True, exist_ok=True)
    campaign, model = copy.deepcopy(CAMPAIGN), copy.deepcopy(MODEL)
    if parameters:
        del campaign["parameters"][parameters:]
    else:
        del campaign["parameters"]
    model["train"] = {"centre_m": 6.0, "speed_m_per_s": 50.0, "vehicle": VEHICLE}
    model["irregularity"] = {"type": "german_sato", "continuous": True}
    # A decay is measured over some dozens of metres.
    model["line"]["bodies"]["rail"]["intervals_m"] = [[-3.0, 60.0]]
    del campaign["forces"]
    campaign["sensors"] = [
        {"name": "rail@6", "body": "rail", "x_m": 6.0, "unit": "m/s2"},
        {"name": "axle", "degree": "car1.wheelset1", "unit": "m/s2", "chain": {"noise_floor": 1e-5}},
        {"name": "bogie", "degree": "car1.bogie1.bounce", "unit": "m/s2", "chain": {"noise_floor": 1e-5}},
    ]
    campaign["conditions"] = [
        {"name": "still", "kind": "hammer", "temperature_C": 12.0},
        {"name": "fast", "kind": "train", "temperature_C": 12.0, "speed_m_per_s": 50.0},
        {"name": "rig", "kind": "shaker"},
        {"name": "tests", "kind": "table"},
    ]
    sampling = {"sampling_Hz": RUN_Hz, "segment_s": 1.0} if record["statistic"] in ("csd", "psd") else {}
    campaign["records"] = [{"name": "only", "file": "only.csv", **record, **sampling}]
    (folder / "only.csv").write_text(_file(record["statistic"]))
    (folder / "model.toml").write_text(to_toml(model))
    (folder / "campaign.toml").write_text(to_toml(campaign))
    return read_campaign(folder / "campaign.toml")


def _file(statistic: str) -> str:
    """Of plausible values, more than the record uses."""
    match statistic:
        case "csd" | "psd":
            random = np.random.default_rng(5)
            time = np.arange(round(RUN_Hz * RUN_S)) / RUN_Hz
            axle = random.standard_normal(time.size)
            bogie = 0.1 * axle + 0.01 * random.standard_normal(time.size)
            rows = (f"{t:.6f},{a:.6f},{b:.6f}" for t, a, b in zip(time, axle, bogie, strict=True))
            return "time [s],a [m/s2],b [m/s2]\n" + "\n".join(rows) + "\n"
        case "decay":
            return "section,80,100,125\nhere,6.0,7.0,8.0\n"
        case "transmissibility":
            header = "freq_hz,base_accel_ms2,base_phase_rad,mass_accel_ms2,mass_phase_rad\n"
            return header + "".join(f"{f},1.0,0.0,1.4,-0.3\n" for f in (40.0, 60.0, 80.0))
        case _:
            header = "frequency [Hz],storage modulus [Pa],loss modulus [Pa]\n"
            return header + "".join(f"{f},3.1e7,4.6e6\n" for f in (40.0, 60.0, 80.0))
