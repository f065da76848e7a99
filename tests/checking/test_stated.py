"""Misprints of the pen: places off the track, phases whose header is wrong."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.checking.check import check
from permway.laws.toml import to_toml
from simulated import CAMPAIGN, FREQUENCY, MODEL, simulate


def test_a_point_far_along_an_endless_rail_is_asked_back(tmp_path: Path) -> None:
    model, campaign = copy.deepcopy(MODEL), copy.deepcopy(CAMPAIGN)
    del model["line"]["bodies"]["rail"]["intervals_m"]
    path = simulate(tmp_path, 3, model=model, campaign=campaign).path
    assert not check(read_campaign(path), threads=1).blunders
    campaign["forces"][0]["x_m"] = 303.0
    path.write_text(to_toml(campaign))
    found = [one for one in check(read_campaign(path), threads=1).blunders if one.kind == "place"]
    assert [one.where for one in found] == ["forces.hit"]
    assert found[0].asked
    assert "3.03" in found[0].remedy


@pytest.mark.parametrize("unit", ["rad", "deg"])
def test_degrees_under_a_header_of_radians_are_asked_back(tmp_path: Path, unit: str) -> None:
    campaign = copy.deepcopy(CAMPAIGN)
    path = simulate(tmp_path, 3, campaign=campaign).path
    (dataset,) = read_campaign(path).load()
    frf, coherence = dataset.data["frf"].values, dataset.data["coherence"].values
    record = campaign["records"][0]
    lines = [f"frequency [Hz],sensor,force,magnitude [(m/s2)/N],phase [{unit}],coherence"]
    for i, sensor in enumerate(record["responses"]):
        for j, force in enumerate(record["references"]):
            for k, f in enumerate(FREQUENCY):
                size, phase = abs(frf[i, j, k]), np.rad2deg(np.angle(frf[i, j, k]))
                lines.append(f"{f},{sensor},{force},{size:.6g},{phase:.6g},{coherence[i, j, k]:.5f}")
    (tmp_path / "frf.csv").write_text("\n".join(lines) + "\n")
    record["file"] = "frf.csv"
    path.write_text(to_toml(campaign))
    found = [one.kind for one in check(read_campaign(path), threads=1).blunders]
    assert found == (["angle"] if unit == "rad" else [])


@pytest.mark.parametrize("unit", ["g/kN", "m/N", "bananas"])
def test_a_header_of_another_unit_is_reported_with_both(tmp_path: Path, unit: str) -> None:
    campaign = copy.deepcopy(CAMPAIGN)
    campaign["sensors"] = campaign["sensors"][:1]
    campaign["forces"] = campaign["forces"][:1]
    record = campaign["records"][0] | {"file": "frf.csv", "responses": {"r": "rail@6"}, "references": {"a": "hit"}}
    campaign["records"] = [record]
    (tmp_path / "model.toml").write_text(to_toml(MODEL))
    (tmp_path / "campaign.toml").write_text(to_toml(campaign))
    rows = [f"frequency [Hz],sensor,force,real [{unit}],imag [{unit}],coherence"]
    rows += [f"{f},r,a,1e-4,2e-4,0.99" for f in FREQUENCY]
    (tmp_path / "frf.csv").write_text("\n".join(rows) + "\n")
    (found,) = check(read_campaign(tmp_path / "campaign.toml"), threads=1).blunders
    assert found.kind == "unreadable"
    assert unit in found.what
    assert "m/s2" in found.what + found.remedy or "unit" in found.what


def test_a_campaign_without_a_tolerance_is_asked_for_one(tmp_path: Path) -> None:
    campaign = copy.deepcopy(CAMPAIGN)
    path = simulate(tmp_path, 3, campaign=campaign).path
    assert not [one for one in check(read_campaign(path), threads=1).blunders if one.where == "parameters"]
    del campaign["parameters"]
    path.write_text(to_toml(campaign))
    (found,) = [one for one in check(read_campaign(path), threads=1).blunders if one.where == "parameters"]
    assert found.asked
    assert "tolerance_2sigma" in found.remedy
