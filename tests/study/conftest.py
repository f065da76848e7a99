"""A small study that the tests share: one rail on pads, a hammer and two sensors."""

import copy

import pytest

MODEL = {
    "title": "A rail on four pads",
    "frequencies": {"from_Hz": 10.0, "to_Hz": 1000.0, "points": 20},
    "line": {
        "bodies": {
            "rail": {
                "type": "beam",
                "youngs_modulus_Pa": 2.1e11,
                "second_moment_m4": 3.038e-5,
                "density_kg_per_m3": 7850.0,
                "area_m2": 7.67e-3,
            }
        },
        "laws": {"pad": {"type": "hysteretic", "stiffness": 6.0e7, "loss_factor": 0.2}},
        "joints": [
            {"between": ["rail", "ground"], "law": "pad", "at": {"from_m": 0.0, "to_m": 1.8, "spacing_m": 0.6}}
        ],
    },
    "forces": [{"body": "rail", "x_m": 0.9, "name": "hammer"}],
    "sensors": [{"body": "rail", "x_m": 0.9, "name": "here"}, {"body": "rail", "x_m": 1.5, "name": "there"}],
}

TOML = """
format = 1
title = "Pads"
keep = ["receptance"]

[model]
title = "A rail on four pads"
[model.frequencies]
from_Hz = 10.0
to_Hz = 1000.0
points = 20
[model.line.bodies.rail]
type = "beam"
youngs_modulus_Pa = 2.1e11
second_moment_m4 = 3.038e-5
density_kg_per_m3 = 7850.0
area_m2 = 7.67e-3
[model.line.laws.pad]
type = "hysteretic"
stiffness = 6.0e7
loss_factor = 0.2
[[model.line.joints]]
between = ["rail", "ground"]
law = "pad"
at = { from_m = 0.0, to_m = 1.8, spacing_m = 0.6 }
[[model.forces]]
body = "rail"
x_m = 0.9
name = "hammer"
[[model.sensors]]
body = "rail"
x_m = 0.9
name = "here"
[[model.sensors]]
body = "rail"
x_m = 1.5
name = "there"

[axes.stiffness]
path = "line.laws.pad.stiffness"
values = { from = 2e7, to = 9e7, count = COUNT }

[axes.loss]
path = "line.laws.pad.loss_factor"
values = [0.1, 0.2]
"""


@pytest.fixture
def model():
    return copy.deepcopy(MODEL)


@pytest.fixture
def table(model):
    """Three stiffnesses by two loss factors."""
    return {
        "model": model,
        "axes": {
            "stiffness": {"path": "line.laws.pad.stiffness", "values": {"from": 2e7, "to": 8e7, "step": 3e7}},
            "loss": {"path": "line.laws.pad.loss_factor", "values": [0.1, 0.3]},
        },
    }


@pytest.fixture(scope="session")
def study_in():
    """Write a study of 2 x count cases into a folder."""

    def write(folder, count):
        path = folder / "pads.toml"
        path.write_text(TOML.replace("COUNT", str(count)), encoding="utf-8")
        return path

    return write


@pytest.fixture
def study_file(tmp_path, study_in):
    """Write a study of 2 x count cases."""
    return lambda count: study_in(tmp_path, count)
