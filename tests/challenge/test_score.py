"""Scores of verdicts that are written by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.challenge.effects import Site
from permway.challenge.effects.bridge import DeckAttachment
from permway.challenge.layout import draw_layout, draw_tests
from permway.challenge.score import score
from permway.challenge.summary import interval, summary
from permway.cli import app
from permway.errors import InputError
from typer.testing import CliRunner

FAMILIES = {"fastener_loss": "local loss", "mortar_void": "local loss", "sensor_gain": "level"}


def truth(*effects: dict[str, Any]) -> dict[str, Any]:
    return {"effects": [{"kind": "lost", **one} for one in effects]}


def verdict(status: str, *effects: dict[str, Any], gain: float = 5.0) -> dict[str, Any]:
    return {
        "status": status,
        "effects": list(effects),
        "held_out": {"place": {"gain_nats": gain, "standard_error": 1.0}} if effects else {},
    }


def effect(name: str | None, *members: str, x: tuple[float, float] = (10.0, 12.0)) -> dict[str, Any]:
    return {
        "domain": "path",
        "name": name,
        "class": [{"name": m, "probability": 0.5} for m in members],
        "place": {"x": x, "within": x, "channels": []},
        "parameters": {"factor": {"value": 0.1, "low": 0.05, "high": 0.2}},
    }


LOST = {
    "id": "fastener_loss",
    "family": "local loss",
    "domain": "path",
    "place": {"joint": "pad", "x_m": [10.5, 11.5]},
    "parameters": {"factor": 0.15},
}


def folder(root: Path, cases: dict[str, tuple[dict[str, Any], dict[str, Any]]]) -> Path:
    (root / "truth").mkdir(parents=True)
    for name, (true, stated) in cases.items():
        (root / "truth" / f"{name}.json").write_text(json.dumps(true))
        (root / "verdicts" / name).mkdir(parents=True)
        (root / "verdicts" / name / "verdict.json").write_text(json.dumps(stated))
    return root


@pytest.mark.parametrize(("gain", "harmed"), [(-2.0, False), (-4.0, True)])
def test_what_is_left_out_is_predicted_worse_by_odds_of_twenty(tmp_path: Path, gain: float, harmed: bool) -> None:
    lost = verdict("named", effect("fastener_loss", "fastener_loss"), gain=gain)
    (one,) = score(folder(tmp_path, {"single-1": (truth(LOST), lost)}), FAMILIES)
    assert one.harmed is harmed


def test_what_is_right_wrong_and_kept_back(tmp_path: Path) -> None:
    cases = {
        "null-1": (truth(), verdict("recalibrated")),
        "null-2": (truth(), verdict("named", effect("sensor_gain", "sensor_gain"))),
        "single-1": (truth(LOST), verdict("named", effect("fastener_loss", "fastener_loss"))),
        "single-2": (truth(LOST), verdict("named", effect("mortar_void", "mortar_void", "fastener_loss"))),
        "single-3": (
            truth(LOST),
            verdict("named", effect("sensor_gain", "sensor_gain", x=(30.0, 31.0)), gain=-9.0),
        ),
        "single-4": (truth(LOST), verdict("insufficient", effect("sensor_gain", "sensor_gain"))),
    }
    scored = {s.name: s for s in score(folder(tmp_path, cases), FAMILIES)}
    assert scored["null-1"].found is None
    assert not scored["null-1"].false_name
    assert scored["null-2"].false_name
    right, twin, wrong, quiet = (scored[f"single-{i}"] for i in (1, 2, 3, 4))
    assert (right.found, right.placed, right.family, right.in_class, right.false_name) == (*[True] * 4, False)
    assert right.covered == (True,)
    assert (twin.family, twin.in_class, twin.false_name, twin.covered) == (True, True, False, ())
    assert (wrong.placed, wrong.family, wrong.false_name, wrong.harmed) == (False, False, True, True)
    # What is suspected and not called is neither found nor a false name.
    assert (quiet.found, quiet.false_name) == (False, False)
    rows = {row["tier"]: row for row in summary(scored.values())}
    assert rows["null"]["called"].startswith("1/2")
    assert rows["single"]["found"].startswith("3/4")
    assert rows["single"]["false_name"].startswith("1/4")


def test_places_are_read_as_the_generator_writes_them(tmp_path: Path) -> None:
    """An attachment of the generator, stated to be where it is, and ten metres off."""
    random = np.random.default_rng(5)
    layout = draw_layout(random)
    attached = DeckAttachment.draw(random, "strong", Site(layout, draw_tests(random, layout, temperatures=1)))
    true = json.loads(json.dumps({"effects": [attached.truth()]}))
    near, far = ((attached.x_m + d - 0.2, attached.x_m + d + 0.2) for d in (0.0, 10.0))
    cases = {
        f"single-{i}": (true, verdict("named", effect("deck_attachment", "deck_attachment", x=x)))
        for i, x in enumerate((near, far))
    }
    assert [s.placed for s in score(folder(tmp_path, cases), FAMILIES)] == [True, False]


def test_a_sensor_is_the_same_however_its_place_is_written(tmp_path: Path) -> None:
    wrong = {"id": "sensor_gain", "domain": "measurement", "place": {"channels": ["rail@42.0"]}}
    gains = [{**effect("sensor_gain", "sensor_gain"), "domain": "measurement"} for _ in range(2)]
    for one, name in zip(gains, ("rail@42", "rail@4.2"), strict=True):
        one["place"] = {"x": None, "within": None, "channels": [name]}
    cases = {f"single-{i}": (truth(wrong), verdict("measurement", one)) for i, one in enumerate(gains)}
    assert [s.placed for s in score(folder(tmp_path, cases), FAMILIES)] == [True, False]


GAIN = {"id": "sensor_gain", "family": "level", "domain": "path", "place": {"x_m": [30.0, 30.0]}, "parameters": {}}


def test_of_several_effects_each_is_looked_for_and_the_strongest_counts(tmp_path: Path) -> None:
    lost, gain = (effect(n, n, x=x) for n, x in (("fastener_loss", (10.0, 12.0)), ("sensor_gain", (29.0, 31.0))))
    cases = {
        "multiple-1": (truth(LOST, GAIN), verdict("named", lost, gain)),
        "multiple-2": (truth(LOST, GAIN), verdict("named", lost)),
        "multiple-3": (truth(LOST, GAIN), verdict("named", lost)),
        "multiple-4": (truth(LOST, GAIN), verdict("named", lost)),
    }
    place = folder(tmp_path, cases)
    (place / "weights").mkdir()
    (place / "weights" / "multiple-4.json").write_text('{"deviance": 790.0, "each": [800.0, 14.0]}')
    (place / "weights" / "multiple-3.json").write_text('{"deviance": 900.0, "each": [100.0, 800.0]}')
    scored = [(s.all_found, s.family, s.truth[0]) for s in score(place, FAMILIES)]
    assert scored == [
        (True, True, "fastener_loss"),
        (False, True, "fastener_loss"),
        # By what each does alone, the gain is the stronger one, and it was not found.
        (False, False, "sensor_gain"),
        # Of the gain alone the records do not decide.
        (None, True, "fastener_loss"),
    ]


def test_of_two_effects_of_one_name_the_one_at_the_place_is_held_against_the_truth(tmp_path: Path) -> None:
    there, elsewhere = effect("fastener_loss"), effect("fastener_loss", x=(20.0, 22.0))
    elsewhere["parameters"] = {"factor": {"value": 0.7, "low": 0.6, "high": 0.8}}
    second = {**there, "parameters": {"factor": {"value": 0.9, "low": 0.85, "high": 0.95}}}
    cases = {
        "single-1": (truth(LOST), verdict("named", there, elsewhere)),
        "single-2": (truth(LOST), verdict("named", elsewhere, there)),
        "single-3": (truth(LOST), verdict("named", there, second)),
        "single-4": (truth(LOST), verdict("named", second, there)),
    }
    found = score(folder(tmp_path, cases), FAMILIES)
    # Of two at its place the stronger, which comes first.
    assert [one.covered for one in found] == [(True,), (True,), (True,), (False,)]


def test_words_of_what_no_catalogue_holds(tmp_path: Path) -> None:
    hidden = {**LOST, "id": None, "family": "inertia", "words": ["inertance"]}
    unnamed = effect(None, "novel")
    cases = {
        f"outside-{i}": (truth(hidden), verdict("described", {**unnamed, "law": {"words": words}}))
        for i, words in enumerate(("an inertance of 3 kg beside one joint", "a dashpot of 1 N s/m on the body"))
    }
    # Rivals say that something is there, and no words.
    cases["outside-2"] = (truth(hidden), verdict("located", {k: v for k, v in unnamed.items() if k != "law"}))
    assert [s.mechanics for s in score(folder(tmp_path, cases), FAMILIES)] == [True, False, False]


def test_intervals_of_shares() -> None:
    # Clopper and Pearson (1934): none of 20 leaves up to 13.9 % at 90 %, two-sided.
    assert interval(0, 20) == (0.0, pytest.approx(1.0 - 0.05 ** (1.0 / 20.0)))
    low, high = interval(10, 20)
    assert low == pytest.approx(1.0 - high)


def test_a_folder_without_verdicts_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no verdict"):
        score(tmp_path, FAMILIES)


def test_scores_of_verdicts_without_times_are_json(tmp_path: Path) -> None:
    """Such as were made by `permway diagnose`, one by one."""
    place = folder(
        tmp_path, {"single-1": (truth(LOST), verdict("named", effect("fastener_loss", "fastener_loss")))}
    )
    ended = CliRunner().invoke(app, ["challenge", "score", str(place), "--json"])
    assert ended.exit_code == 0
    (case,) = json.loads(ended.stdout)["cases"]
    assert (case["found"], case["seconds"]) == (True, None)
