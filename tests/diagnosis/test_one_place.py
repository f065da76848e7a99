"""Sensors, or hammer points, that share a place: each has its own name and its own chain."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.predict import predict
from permway.diagnosis.separability import separability
from permway.errors import InputError
from permway.laws.toml import to_toml
from permway.model.place import Place
from permway.posterior.compare import compare
from permway.posterior.diagnose import diagnose
from permway.response.receptance import receptance
from simulated import BLOWS, CAMPAIGN, FREQUENCY, MODEL

SENSORS = (("left", "rail", 6.45), ("right", "rail", 6.45), ("deck", "deck", 3.0))
POINTS = (("hit", "rail", 6.45), ("hit again", "rail", 6.45), ("hit deck", "deck", 4.5))
NOISE = 0.01


def campaign(folder: Path, sensors: Any, points: Any, *, turned: str = "") -> Campaign:
    """Records of the tool's own model, with noise; one sensor may be mounted the wrong way round."""
    stated: dict[str, Any] = copy.deepcopy(CAMPAIGN)
    stated["sensors"] = [{"name": n, "body": b, "x_m": x, "unit": "m/s2"} for n, b, x in sensors]
    stated["forces"] = [{"name": n, "body": b, "x_m": x} for n, b, x in points]
    stated["records"][0] |= {
        "responses": {f"s{i}": name for i, (name, _, _) in enumerate(sensors)},
        "references": {f"p{i}": name for i, (name, _, _) in enumerate(points)},
    }
    (folder / "model.toml").write_text(to_toml(MODEL))
    (folder / "campaign.toml").write_text(to_toml(stated))
    shape = (FREQUENCY.size, len(sensors), len(points))
    ends: dict[str, Any] = {"sensor": np.array([*stated["records"][0]["responses"]])}
    ends["hammer"] = np.array([*stated["records"][0]["references"]])
    coherence = np.full(shape, 1.0 / (1.0 + 2.0 * BLOWS * NOISE**2))
    np.savez(folder / "frf.npz", f=FREQUENCY, frf=np.ones(shape, complex), coh=coherence, **ends)
    read = read_campaign(folder / "campaign.toml")
    (right,) = predict(read, read.load(), threads=1)
    random = np.random.default_rng(11)
    noise = NOISE * (random.standard_normal(shape) + 1j * random.standard_normal(shape))
    sign = np.array([-1.0 if name == turned else 1.0 for name, _, _ in sensors])[:, None]
    values = np.moveaxis(right["frf"].values, -1, 0) * sign * np.exp(noise)
    np.savez(folder / "frf.npz", f=FREQUENCY, frf=values, coh=coherence, **ends)
    return read


SHARED = {
    "sensors": (SENSORS, (POINTS[0], POINTS[2])),
    "points": ((SENSORS[0], SENSORS[2]), POINTS),
    "both": (SENSORS, POINTS),
}


@pytest.mark.parametrize("which", SHARED)
def test_compare_holds_each_against_the_model(tmp_path: Path, which: str) -> None:
    sensors, points = SHARED[which]
    found = compare(campaign(tmp_path, sensors, points), threads=1)
    (record,) = found.records
    pairs = set(zip(record["sensor"].values.tolist(), record["force"].values.tolist(), strict=True))
    assert pairs == {(s, p) for s, _, _ in sensors for p, _, _ in points}
    # Records of the nominal values: the recalibrated ones stay there.
    assert (found.parameters["value"] / found.parameters["nominal"]).values == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("which", SHARED)
def test_separability_states_what_each_could_show(tmp_path: Path, which: str) -> None:
    found = separability(campaign(tmp_path, *SHARED[which]), threads=1)
    assert {"sensor_gain", "fastener_loss"} <= set(found.entries)
    assert np.isfinite(found.seen).all()
    gains = [name for name, entry in zip(found.names, found.entries, strict=True) if entry == "sensor_gain"]
    assert all(any(name in gain for gain in gains) for name, _, _ in SHARED[which][0])


@pytest.mark.parametrize("turned", ["left", "right"])
def test_diagnose_names_the_one_of_two_that_is_turned_round(tmp_path: Path, turned: str) -> None:
    found = diagnose(campaign(tmp_path, *SHARED["sensors"], turned=turned), threads=1).verdict
    assert [effect.name for effect in found.effects] == ["sensor_polarity"]
    assert found.effects[0].place.channels == (turned,)


def test_diagnose_calls_nothing_where_all_is_right(tmp_path: Path) -> None:
    assert diagnose(campaign(tmp_path, *SHARED["both"]), threads=1).verdict.status == "recalibrated"


def test_places_without_a_name_are_refused_by_what_they_lack(tmp_path: Path) -> None:
    line = campaign(tmp_path, SENSORS, POINTS).model.line
    unnamed = Place(body="rail", x_m=6.45)
    with pytest.raises(InputError, match=r"sensors\[1\]: has no name, and the one made of its place stands twice"):
        receptance(line, [20.0], forces=[unnamed], sensors=[unnamed, unnamed], threads=1)
    # Places a tenth of a micrometre apart are two.
    near = Place(body="rail", x_m=6.4500001)
    data = receptance(line, [20.0], forces=[unnamed], sensors=[unnamed, near], threads=1)
    assert data["sensor"].values.tolist() == ["rail@6.45", "rail@6.4500001"]
