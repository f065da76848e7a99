"""Joints that answer to the level they are driven at: closed forms, and what a diagnosis makes of them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.predict import predict
from permway.diagnosis.catalogue import level_friction, level_stiffness
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.recalibrate import recalibrate
from permway.errors import InputError
from permway.laws.toml import to_toml
from permway.posterior.diagnose import diagnose

MASS, STIFFNESS, DAMPING = 2.0, 8.0e4, 24.0
LEVELS = (1.0, 2.0, 4.0)
FREQUENCY = np.arange(15.0, 60.0, 0.75)
NOISE = 0.01
"""Over the response at rest."""


def receptance(stiffness: float = 1.0, loss: float = 1.0) -> Complexes:
    """Of one level, factors on stiffness and on loss over stiffness; the closed form."""
    omega = 2.0 * np.pi * FREQUENCY
    return np.asarray(1.0 / (STIFFNESS * stiffness - MASS * omega**2 + 1j * omega * DAMPING * stiffness * loss))


def written(folder: Path, responses: list[Complexes], levels: tuple[float | None, ...] = LEVELS) -> Campaign:
    """A mass on a spring and a dashpot, a record at each level, its noise estimated from the scatter of lines."""
    random, place = np.random.default_rng(7), {"body": "mass", "x_m": 0.0}
    records, conditions = [], []
    for number, (response, level) in enumerate(zip(responses, levels, strict=True)):
        noise = random.standard_normal((2, FREQUENCY.size))
        values = response + NOISE / STIFFNESS * (noise[0] + 1j * noise[1])
        rows = ["frequency [Hz],sensor,point,real,imaginary"]
        rows += [
            f"{f!r},out,in,{v.real!r},{v.imag!r}" for f, v in zip(FREQUENCY.tolist(), values.tolist(), strict=True)
        ]
        (folder / f"{number}.csv").write_text("\n".join(rows) + "\n")
        condition: dict[str, Any] = {"name": f"c{number}", "kind": "shaker"}
        conditions.append(condition if level is None else {**condition, "level": level})
        records.append(
            {
                "name": f"r{number}",
                "file": f"{number}.csv",
                "condition": f"c{number}",
                "statistic": "frf",
                "noise": "scatter",
                "lines_per_frequency": 200.0,
                "responses": ["out"],
                "references": ["in"],
            }
        )
    model = {
        "format": 1,
        "frequencies": {"from_Hz": 15.0, "to_Hz": 60.0, "points": 20},
        "line": {
            "bodies": {"mass": {"type": "mass", "mass_kg": MASS}},
            "laws": {"joint": {"type": "kelvin_voigt", "stiffness": STIFFNESS, "damping": DAMPING}},
            "joints": [{"between": ["mass", "ground"], "law": "joint", "at": [0.0]}],
        },
        "forces": [place],
        "sensors": [place],
    }
    campaign = {
        "format": 1,
        "model": "model.toml",
        "parameters": [
            {"name": "k", "unit": "N/m", "paths": "line.laws.joint.stiffness", "tolerance_2sigma": 0.05},
            {"name": "c", "unit": "N s/m", "paths": "line.laws.joint.damping", "tolerance_2sigma": 0.3},
        ],
        "sensors": [{"name": "out", **place, "quantity": "displacement", "unit": "m"}],
        "forces": [{"name": "in", **place, "unit": "N"}],
        "conditions": conditions,
        "records": records,
    }
    (folder / "model.toml").write_text(to_toml(model))
    (folder / "campaign.toml").write_text(to_toml(campaign))
    return read_campaign(folder / "campaign.toml")


def offered(campaign: Campaign, module: Any) -> list[Hypothesis]:
    return list(module.hypotheses(Situation(recalibrate(gather(campaign, threads=1)), ())))


def responses_of(campaign: Campaign, hypothesis: Hypothesis, values: Mapping[str, float]) -> list[Reals]:
    datasets = campaign.load()
    found = predict(hypothesis.amend(campaign, values), datasets, threads=1)
    return [one["frf"].values[0, 0] for one in found]


def test_stiffness_grows_by_a_power_of_the_level(tmp_path: Path) -> None:
    campaign = written(tmp_path, [receptance()] * 3)
    (one,) = offered(campaign, level_stiffness)
    found = responses_of(campaign, one, {"change": 0.2, "exponent": 2.0})
    for level, response in zip(LEVELS, found, strict=True):
        factor = 1.0 + 0.2 * (level / 4.0) ** 2
        assert response == pytest.approx(receptance(factor, 1.0 / factor), rel=1e-9)
    for response in responses_of(campaign, one, {"change": 0.0, "exponent": 2.0}):
        assert response == pytest.approx(receptance(), rel=1e-9)


def test_friction_loses_more_and_softens(tmp_path: Path) -> None:
    campaign = written(tmp_path, [receptance()] * 3)
    (one,) = offered(campaign, level_friction)
    found = responses_of(campaign, one, {"growth": 1.5, "softening": 0.1, "exponent": 0.5})
    for level, response in zip(LEVELS, found, strict=True):
        share = (level / 4.0) ** 0.5
        assert response == pytest.approx(receptance(1.0 - 0.1 * share, 1.0 + 1.5 * share), rel=1e-9)


@pytest.mark.parametrize("levels", [(None, None, None), (2.0, 2.0, None)])
def test_without_two_levels_none_is_tried(tmp_path: Path, levels: tuple[float | None, ...]) -> None:
    campaign = written(tmp_path, [receptance()] * 3, levels)
    assert not offered(campaign, level_stiffness)
    assert not offered(campaign, level_friction)


def test_a_level_is_above_zero(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"conditions\[0\]\.level"):
        written(tmp_path, [receptance()] * 3, (0.0, 1.0, 2.0))


@pytest.mark.injection
@pytest.mark.parametrize(
    ("at_levels", "name"),
    [
        ([(1.0 + 0.1 * x**2, 1.0 / (1.0 + 0.1 * x**2)) for x in (0.25, 0.5, 1.0)], "level_stiffness"),
        ([(1.0 - 0.02 * x, 1.0 + 1.0 * x) for x in (0.25, 0.5, 1.0)], "level_friction"),
        ([(1.0, 1.0)] * 3, None),
    ],
)
def test_the_posterior_names_what_goes_with_the_level(
    tmp_path: Path, at_levels: list[tuple[float, float]], name: str | None
) -> None:
    verdict = diagnose(written(tmp_path, [receptance(*one) for one in at_levels]), threads=1).verdict
    if name is None:
        assert verdict.status == "recalibrated"
        return
    (effect,) = verdict.effects
    assert (verdict.status, effect.name) == ("named", name)
