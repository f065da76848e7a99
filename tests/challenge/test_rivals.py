"""What simpler methods say, and how their answers are kept and scored."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.challenge.rivals import answered
from permway.challenge.score import score
from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.classifier import Classifier
from permway.diagnosis.compete import Ring
from permway.diagnosis.discrepancy import beyond, discrepancy
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.locate import scanned
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.rivals import NONE, RIVALS, independent, rivals
from permway.errors import InputError
from simulated import simulate


def same(_: Path, __: Sequence[str]) -> dict[str, Any]:
    return {"always": {"status": "named", "effects": [], "held_out": {}}}


def test_without_guards_smooth_errors_are_called_an_effect(tmp_path: Path) -> None:
    campaign = simulate(tmp_path / "c", 3, smooth=0.08).campaign
    said = rivals(campaign, threads=1)
    assert set(said) == set(RIVALS)
    assert said["recalibration only"]["effects"] == []
    parts_of = said["recalibration only"]["held_out"]
    assert len(parts_of) > 1
    assert all(one["db_before"] == one["db_after"] and one["gain_nats"] == 0.0 for one in parts_of.values())
    assert all(set(one["held_out"]) == set(parts_of) for one in said.values())
    # Nothing is missing: both take the calibration errors of chains for something.
    for name in ("smallest residual", "BIC, independent errors"):
        assert said[name]["effects"]
    assert rivals(campaign, threads=1) == said
    # What is ruled out is offered to no rival.
    best = said["smallest residual"]["effects"][0]["name"]
    without = rivals(campaign, ruled_out=[best], threads=1)
    assert all(effect["name"] != best for one in without.values() for effect in one["effects"])


def test_a_gaussian_process_says_that_and_near_which_sensor_and_not_what(tmp_path: Path) -> None:
    def lost(campaign: Campaign) -> Campaign:
        return weakened(campaign, "pad", 6.0, 1.2, 0.05)

    plain, missing = (
        independent_fit(simulate(tmp_path / name, 3, smooth=1e-9, amend=amend).campaign)
        for name, amend in (("plain", lambda campaign: campaign), ("missing", lost))
    )
    assert discrepancy(plain).gain <= 0.0
    found = discrepancy(missing)
    assert found.gain > 100.0
    assert found.sensor.name == "rail@6"
    # It cannot tell a chain's calibration error from what a model lacks.
    assert discrepancy(independent_fit(simulate(tmp_path / "smooth", 3, smooth=0.08).campaign)).gain > 100.0


def test_what_is_left_out_is_foretold_by_what_is_right(tmp_path: Path) -> None:
    def lost(campaign: Campaign) -> Campaign:
        return weakened(campaign, "pad", 6.0, 1.2, 0.05)

    said = rivals(simulate(tmp_path / "c", 3, smooth=1e-3, amend=lost).campaign, threads=1)
    best, process = (said[name]["held_out"] for name in ("smallest residual", "Gaussian process"))
    for name, one in said["recalibration only"]["held_out"].items():
        assert best[name]["db_after"] < 0.5 * one["db_after"]
        assert best[name]["gain_nats"] > 10.0
        assert one["db_before"] == process[name]["db_before"]
    # What a discrepancy is in one pair of sensor and point states nothing of another.
    band, place = (next(name for name in process if name.startswith(kind)) for kind in ("band", "place"))
    assert process[band]["db_after"] < 0.9 * process[band]["db_before"]
    assert process[place]["db_after"] > 2.0 * best[place]["db_after"]


def test_a_discrepancy_is_expected_near_lines_that_are_known(tmp_path: Path) -> None:
    fit = independent_fit(simulate(tmp_path / "c", 3, smooth=0.08).campaign)
    evidence = discrepancy(fit).on(fit.evidence)
    rows = evidence.rows
    levels = evidence.levels_dB(evidence.predicted(fit.campaign).datasets)
    pair = (rows.channel == rows.channel[0]) & np.isfinite(levels)
    lines = np.flatnonzero(pair & (rows.scale_dB < 0.2))
    known = np.ones(levels.size, dtype=bool)
    known[lines[1::2]] = False
    left = beyond(evidence, levels, known)
    assert np.array_equal(left[known], levels[known], equal_nan=True)
    assert np.std(left[lines[1::2]]) < 0.5 * np.std(levels[lines[1::2]])
    # Of a pair of which nothing is known nothing is expected.
    assert np.array_equal(beyond(evidence, levels, ~pair), levels, equal_nan=True)


def independent_fit(campaign: Campaign) -> Fit:
    fit = recalibrate(independent(gather(campaign, threads=1)), learn=False, reweigh=True)
    return replace(fit, heat=1.0)


def test_independent_errors_explain_nothing_smooth(tmp_path: Path) -> None:
    evidence = independent(gather(simulate(tmp_path / "c", 3).campaign, threads=1))
    deviations = evidence.deviations(evidence.predicted(evidence.campaign).datasets)
    square = evidence.whitener.square(deviations)
    assert square == pytest.approx(float(deviations @ deviations), rel=1e-3)
    assert set(evidence.sizes.values()) == {NONE}


def test_answers_are_kept_once_and_scored(tmp_path: Path) -> None:
    campaign = tmp_path / "verdicts" / "null-1" / "campaign"
    campaign.mkdir(parents=True)
    (campaign / "campaign.toml").write_text("")
    (tmp_path / "truth").mkdir()
    (tmp_path / "truth" / "null-1.json").write_text('{"effects": []}')
    assert answered(tmp_path, same) == 1
    kept = tmp_path / "rivals" / "always" / "null-1" / "verdict.json"
    before = kept.stat().st_mtime_ns
    assert answered(tmp_path, same) == 1
    assert kept.stat().st_mtime_ns == before
    assert json.loads(kept.read_text())["status"] == "named"
    (scored,) = score(tmp_path, {}, tmp_path / "rivals" / "always")
    assert scored.status == "named"
    with pytest.raises(InputError, match="no campaign that was run"):
        answered(tmp_path / "truth", same)


def test_a_classifier_knows_again_what_it_was_trained_on(tmp_path: Path) -> None:
    """Of simulations that it has not seen, and thirty effects or none to choose from."""
    fit = independent_fit(simulate(tmp_path / "c", 3).campaign)
    ring = Ring(fit)
    screened = [ring.screen(h) for h in hypotheses(Situation(fit, scanned(fit)))]
    trained = Classifier(ring, [quick for quick in screened if np.isfinite(quick.gain)])
    random = np.random.default_rng(77)
    drawn = ["", *trained.known] * 3
    right = [trained.says(trained.simulate(name, random)) == name for name in drawn]
    assert len(trained.known) > 15
    # Half of the sizes are too small to be seen beside calibration errors.
    assert np.mean(right) > 5.0 / len(set(drawn))
    answer = trained.answer(trained.simulate("fastener_loss", random))
    assert answer is None or answer in screened


def test_without_its_library_a_classifier_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "sklearn.ensemble", None)
    ring = Ring(independent_fit(simulate(tmp_path / "c", 3).campaign))
    with pytest.raises(InputError, match=r"pip install 'permway\[challenge\]'"):
        Classifier(ring, [])
