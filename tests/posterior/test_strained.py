"""Several changes at once that large errors of chains could stand for: a mass on a spring with a damper."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.diagnosis.gather import gather
from permway.laws.toml import to_toml
from permway.posterior.hyper import STRAINED, Hyper
from permway.posterior.member import Member
from permway.posterior.search import _next_root
from searched import searched

STATED = {"stiffness": 988.0, "damping": 36.0}
TRUE = {"stiffness": 745.0, "damping": 3.0}
MASS_KG, GAIN = 0.77, 0.89


def written(folder: Path) -> Campaign:
    """The response of the true one by the closed form, at a model with the stated values."""
    place = [{"body": "mass", "x_m": 0.0}]
    model = {
        "format": 1,
        "frequencies": {"from_Hz": 1.0, "to_Hz": 9.0, "points": 50},
        "line": {
            "bodies": {"mass": {"type": "mass", "mass_kg": MASS_KG}},
            "laws": {"joint": {"type": "kelvin_voigt", **STATED}},
            "joints": [{"between": ["mass", "ground"], "law": "joint", "at": [0.0]}],
        },
        "forces": place,
        "sensors": place,
    }
    known = {"stiffness": 0.03, "damping": 0.5}
    campaign = {
        "format": 1,
        "model": "model.toml",
        "parameters": [
            {"name": name, "paths": f"line.laws.joint.{name}", "unit": "1", "tolerance_2sigma": wide}
            for name, wide in known.items()
        ],
        "sensors": [{"name": "out", **place[0], "quantity": "displacement", "unit": "mm"}],
        "forces": [{"name": "in", **place[0], "unit": "N"}],
        "conditions": [{"name": "rig", "kind": "shaker"}],
        "records": [
            {
                "name": "response",
                "file": "frf.csv",
                "condition": "rig",
                "statistic": "frf",
                "band_Hz": [1.0, 9.0],
                "responses": {"out": "out"},
                "references": {"in": "in"},
                "noise": "scatter",
                "unit": "mm/N",
            }
        ],
    }
    frequency = np.arange(1.0, 9.0, 0.025)
    omega = 2.0 * np.pi * frequency
    frf = 1e3 * GAIN / (TRUE["stiffness"] - MASS_KG * omega**2 + 1j * omega * TRUE["damping"])
    random = np.random.default_rng(5)
    frf = frf * np.exp(0.003 * (random.standard_normal(frf.size) + 1j * random.standard_normal(frf.size)))
    rows = [f"{f:.6g},out,in,{v.real:.9g},{v.imag:.9g}" for f, v in zip(frequency, frf, strict=True)]
    (folder / "frf.csv").write_text("\n".join(["frequency [Hz],sensor,point,real,imaginary", *rows]) + "\n")
    (folder / "model.toml").write_text(to_toml(model))
    (folder / "campaign.toml").write_text(to_toml(campaign))
    return read_campaign(folder / "campaign.toml")


def test_two_wrong_values_are_not_errors_of_a_chain(tmp_path: Path) -> None:
    best = searched(gather(written(tmp_path), threads=1), "owner_value").members[0]
    assert best.names == ("owner_value", "owner_value")
    assert not best.fit.hyper.strained
    model = best.fit.state.solved.campaign.model.line.laws["joint"]
    assert model.damping == pytest.approx(TRUE["damping"], rel=0.1)
    for index, amendment in enumerate(best.amendments):
        # Words, verdict and amended model state one number.
        known = best.fit.frame.observations.campaign.parameters.known[amendment.moves]
        whole = known.value(best.values(index)["deviations"])
        assert whole == pytest.approx(getattr(model, amendment.moves), rel=1e-9)
    # The gain of the force counts as an error of its chain, and the stiffness bears a part of it.
    assert model.stiffness == pytest.approx(TRUE["stiffness"], rel=0.05)


def member(count: int, size: float, mass: float, *, far_behind: bool = False) -> Member:
    hyper = Hyper(("sensor", "length", "discrepancy frf"), np.log([size, 0.8, 0.003]))
    fit = SimpleNamespace(hyper=hyper)
    fake = SimpleNamespace(amendments=(None,) * count, fit=fit, log_mass=mass, far_behind=far_behind)
    return cast(Member, fake)


def test_sets_grow_past_one_that_strains_its_chains() -> None:
    plain, strained = 0.5 * STRAINED, 2.0 * STRAINED
    empty, hidden = member(0, plain, 0.0), member(0, strained, 0.0)
    one, bent = member(1, plain, -20.0), member(1, strained, -1.0)
    assert _next_root([one, empty], 1) is one
    assert _next_root([empty, one], 1) is None
    assert _next_root([hidden, bent, one], 1) is one
    assert _next_root([hidden, bent], 1) is None
    # What is kept to be shown alone is not searched from.
    assert _next_root([hidden, member(1, plain, -20.0, far_behind=True)], 1) is None
