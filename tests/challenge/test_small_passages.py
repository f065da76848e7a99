"""Passages of the challenge: as a closed form and the solver have them; the same bytes for the same seed."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.campaign.predict import predict
from permway.challenge.beams import Section
from permway.challenge.small import passages
from permway.challenge.small import passed as of_time
from permway.challenge.small.draws import generator
from permway.challenge.small.errors import Errors
from permway.challenge.small.make import true_values
from permway.challenge.small.passages import make_passages, passed, track_of
from permway.challenge.small.passages_drawn import CONCEALED, RATE_HZ, draw
from permway.challenge.small.passed import Axles, Ballasted
from permway.challenge.small.suite import names_of
from permway.challenge.small.write import write_tables
from permway.diagnosis.catalogue._interval import weakened

SEED = 5


def made(folder: Path, index: int, *, concealed: bool) -> tuple[np.ndarray, np.ndarray]:
    """Spectra of a campaign's passages with true values, recorded without errors, and as the solver has them."""
    drawn = draw(SEED, index)
    campaign = read_campaign(write_tables(folder, drawn.campaign, drawn.model))
    values, _ = true_values(campaign, generator(SEED, index, "parameters", tier="passages"))
    there = passed(drawn, values, track_of(drawn, values, concealed=concealed))
    passages._write(drawn, there, Errors(0.0, 1.0, 1e-9), np.random.default_rng(1), folder)
    true = read_campaign(folder / "campaign.toml").with_values(values)
    if concealed:
        at = drawn.effect["parameters"]
        true = weakened(true, drawn.effect["place"]["joint"], at["centre_m"], at["length_m"], at["factor"])
    data = true.load()
    found = predict(true, data, threads=1)
    return tuple(
        np.concatenate([one["spectrum"].values.ravel() for one in which])
        for which in ([d.data for d in data], found)
    )


@pytest.mark.parametrize(("index", "concealed"), [(0, False), (2, False), (1, True), (2, True)])
def test_two_codes_agree_with_and_without_what_is_concealed(tmp_path: Path, index: int, concealed: bool) -> None:
    recorded, predicted = made(tmp_path, index, concealed=concealed)
    size = np.sqrt(np.mean(np.abs(recorded) ** 2))
    assert np.sqrt(np.mean(np.abs(recorded - predicted) ** 2)) < 1e-3 * size


def test_a_slow_load_moves_a_long_even_track_as_winkler_states(monkeypatch: pytest.MonkeyPatch) -> None:
    """Second derivative in time of w = P/(8 E I b^3) e^-bs (cos bs + sin bs), b^4 = k/(4 E I)."""
    monkeypatch.setattr(of_time, "PARTS", 1)
    bending, spacing, each, load, speed = 6.3e6, 0.15, 5.0e6, 8.0e4, 12.0
    stations = tuple(spacing * i for i in range(101))
    ones = (1.0,) * 101
    track = Ballasted(
        # Hard pads and hardly any mass: quasi-static.
        Section(bending, 1.0),
        (-spacing, stations[-1] + spacing),
        stations,
        0.1,
        (1e4 * each, 1e3),
        (each, 1e3),
        ones,
        ones,
    )
    axles = Axles(np.array([load]), np.array([0.0]), speed, 0.1)
    x = stations[50]
    read = track.acceleration(
        axles, track.reads("rail", x), rate_Hz=400.0, samples=700, ramp=(0.0, stations[-1], 2.0)
    )
    b = (each / spacing / (4.0 * bending)) ** 0.25
    s = np.abs((np.arange(700) / 400.0 - 0.1) * speed - x)
    curved = load / (8.0 * bending * b**3) * 2.0 * b**2 * np.exp(-b * s) * (np.sin(b * s) - np.cos(b * s))
    # Away from the load the kink of curvature under it is no matter for the filter.
    far = (s > 1.0) & (s < 4.0)
    assert read[far] == pytest.approx(speed**2 * curved[far], abs=0.02 * np.abs(speed**2 * curved[far]).max())


def test_loads_act_in_proportion_and_a_late_train_is_late() -> None:
    drawn = draw(SEED, 0)
    values = {"pad.k": 1e8, "pad.c": 4e4, "ballast.k": 3e7, "ballast.c": 4e4, "load": 1.0}
    values |= {f"{name}{i}": v for i in (1, 2) for name, v in (("speed", 25.0), ("entry", 0.0))}
    track = track_of(drawn, values, concealed=False)
    one = passed(drawn, values, track)[0]
    assert passed(drawn, values | {"load": 1.1}, track)[0] == pytest.approx(1.1 * one, abs=1e-12)
    late = passed(drawn, values | {"entry1": 4 / RATE_HZ}, track)[0]
    assert late[4:] == pytest.approx(one[:-4], abs=1e-9 * np.abs(one).max())


def digests(folder: Path) -> dict[str, str]:
    """Of all files below a folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def test_a_seed_and_a_number_give_the_same_bytes_and_a_truth_that_fits(tmp_path: Path) -> None:
    for index in range(3):
        name = make_passages(SEED, index, tmp_path / "one")
        make_passages(SEED, index, tmp_path / "other")
        truth = json.loads((tmp_path / "one" / "truth" / f"{name}.json").read_text())
        assert [e["id"] for e in truth["effects"]] == [c for c in [CONCEALED[index]] if c]
        assert bool(truth["effects"]) == (truth["deviance"] > 0.0)
        campaign = read_campaign(tmp_path / "one" / name / "campaign.toml")
        assert set(truth["parameters"]) == set(campaign.parameters.known)
        assert len(campaign.load()) == truth["records"]["passages"]
    assert digests(tmp_path / "one") == digests(tmp_path / "other")


def test_what_shows_more_weighs_more() -> None:
    drawn = draw(SEED, 1)
    errors = Errors(0.5, 1.0, 3e-3)
    names = [p["name"] for p in drawn.campaign["parameters"]]
    values = {"pad.k": 1e8, "pad.c": 4e4, "ballast.k": 3e7, "ballast.c": 4e4, "load": 1.0}
    values |= {n: 25.0 if n.startswith("speed") else 0.0 for n in names if n[:5] in ("speed", "entry")}
    base = passed(drawn, values, track_of(drawn, values, concealed=False))
    slopes = [passed(drawn, values | {"load": 1.0 + 1e-3 * 0.03}, track_of(drawn, values, concealed=False))]
    weights = []
    for factor in (0.9, 0.5, 0.1):
        effect = {**drawn.effect, "parameters": {**drawn.effect["parameters"], "factor": factor}}
        weaker = replace(drawn, effect=effect)
        there = passed(weaker, values, track_of(weaker, values, concealed=True))
        weights.append(passages.deviance_of(base, slopes, there, errors))
    assert 0.0 < weights[0] < weights[1] < weights[2]
    # Another load is no effect: recalibration takes it up, but for what its prior costs.
    louder = passed(drawn, values | {"load": 1.03}, track_of(drawn, values, concealed=False))
    assert passages.deviance_of(base, slopes, louder, errors) < 1.1


def test_a_suite_has_forty() -> None:
    assert names_of(["passages"], 7, None)[-1] == "passages-7-0039"
    assert names_of(["passages"], 7, 2) == ["passages-7-0000", "passages-7-0001"]
