"""Records that leave something open, and what is advised to close it, measured."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from permway.campaign.campaign import Campaign
from permway.challenge.case import draw, write_truth
from permway.challenge.effects import NEAR_DEGENERATE
from permway.challenge.follow import ADVICE, FOLLOWED, Advice, follow, measured_again, separated
from permway.challenge.sparse import FEWEST, MOST
from permway.diagnosis.gather import predictable
from permway.diagnosis.menu import item_of, menu
from permway.errors import InputError
from short_deck import small_case
from simulated import simulate


@pytest.mark.parametrize("seed", range(300, 312))
def test_sparse_records_are_few_and_hide_a_twin(seed: int) -> None:
    case = draw(seed, "sparse")
    tests = case.tests
    assert FEWEST <= len(tests.sensors) <= MOST
    assert FEWEST <= len(tests.points) <= MOST
    assert len(tests.temperatures_C) == 1
    assert 1 <= len(tests.speeds_kmh) <= 2
    assert tests.sensors[0][0] == tests.points[0][0] == "rail"
    (effect,) = case.effects
    assert type(effect) in NEAR_DEGENERATE
    assert draw(seed, "sparse") == case


def test_seeds_differ_in_what_is_left() -> None:
    drawn = [draw(seed, "sparse").tests for seed in range(300, 312)]
    assert len({len(tests.sensors) for tests in drawn}) > 1
    assert len({len(tests.speeds_kmh) for tests in drawn}) == 2


@pytest.mark.parametrize(
    ("advice", "changed"),
    [
        (Advice("sensor", "slab", 4.5), {"sensors": ("slab", 4.5)}),
        (Advice("blows", "girder", 6.4), {"points": ("girder", 6.4)}),
        (Advice("temperature", value=-13.0), {"temperatures_C": -13.0}),
        (Advice("speed", value=260.0), {"speeds_kmh": 260.0}),
    ],
)
def test_what_is_advised_is_measured_beside_all_else(advice: Advice, changed: dict[str, Any]) -> None:
    before = small_case(11, "sparse")
    after = measured_again(before, advice)
    ((name, new),) = changed.items()
    assert getattr(after.tests, name) == (*getattr(before.tests, name), new)
    assert replace(after.tests, **{name: getattr(before.tests, name)}) == before.tests
    assert after.true == before.true
    assert after.effects == before.effects
    assert len(after.chain.warmer_C) >= len(after.tests.temperatures_C)
    assert len(after.chain.speed) >= len(after.tests.speeds_kmh)
    hammers, runs = after.measure()
    assert hammers[0].frf.shape[1:] == (len(after.tests.sensors), len(after.tests.points))
    assert (len(hammers), len(runs)) == (len(after.tests.temperatures_C), len(after.tests.speeds_kmh))


def test_a_test_made_again_has_more_blows() -> None:
    case = small_case(11, "sparse")
    assert measured_again(case, Advice("repeat", value=4.0)).tests == replace(
        case.tests, blows=4 * case.tests.blows
    )


def test_what_cannot_be_made_is_refused() -> None:
    with pytest.raises(InputError, match="is no measurement that can be made"):
        measured_again(small_case(11, "sparse"), Advice("drone"))  # type: ignore[arg-type]


def verdict(status: str, *classes: list[str], advised: tuple[str, str] | None = None) -> dict[str, Any]:
    """As much of a verdict as is read."""
    effects = [
        {"name": names[0] if len(names) == 1 else None, "class": [{"name": name} for name in names]}
        for names in classes
    ]
    more = [] if advised is None else [{"measurement": "a sensor on slab at 4.5 m", "separates": list(advised)}]
    return {"status": status, "effects": effects, "next": more}


def write_verdict(folder: Path, name: str, verdict: dict[str, Any]) -> None:
    path = folder / "verdicts" / name / "verdict.json"
    path.parent.mkdir(parents=True)
    path.write_text(json.dumps(verdict))


def test_verdicts_that_advise_are_followed_once(tmp_path: Path) -> None:
    write_verdict(tmp_path, "sparse-301", verdict("ambiguous", ["a", "b"], advised=("a", "b")))
    write_verdict(tmp_path, "sparse-302", verdict("named", ["a"]))
    for name in ("sparse-301", "sparse-302"):
        (tmp_path / "truth").mkdir(exist_ok=True)
        (tmp_path / "truth" / f"{name}.json").write_text("{}")
    asked: list[str] = []

    def read(campaign: Path, words: str) -> Advice:
        asked.append(words)
        assert campaign.parts[-3:] == ("sparse-301", "campaign", "campaign.toml")
        return Advice("sensor", "slab", 4.5)

    for _ in range(2):
        assert follow(tmp_path, read) == [tmp_path / FOLLOWED / "sparse-301"]
    assert asked == ["a sensor on slab at 4.5 m"]
    sheet = json.loads((tmp_path / FOLLOWED / "sparse-301" / "sheet.json").read_text())
    assert ["slab", 4.5] in sheet["hammer"]["sensors"]
    truth = json.loads((tmp_path / FOLLOWED / "truth" / "sparse-301.json").read_text())
    assert truth["effects"] == draw(301, "sparse").truth["effects"]
    assert separated(tmp_path) == []


def test_what_was_faded_is_measured_again_as_it_was(tmp_path: Path) -> None:
    write_verdict(tmp_path, "graded-301", verdict("insufficient", ["a"], advised=("a", "recalibrated")))
    faded = draw(301, "graded").faded(0.2)
    (tmp_path / "truth").mkdir()
    write_truth(faded, tmp_path / "truth" / "graded-301.json")
    follow(tmp_path, lambda *_: Advice("repeat", value=4.0))
    again = json.loads((tmp_path / FOLLOWED / "truth" / "graded-301.json").read_text())
    assert again["effects"] == faded.truth["effects"]
    assert again["share"] == 0.2


def test_without_its_truth_nothing_is_followed(tmp_path: Path) -> None:
    write_verdict(tmp_path, "sparse-301", verdict("ambiguous", ["a", "b"], advised=("a", "b")))
    with pytest.raises(InputError, match=r"sparse-301.json: is not there"):
        follow(tmp_path, lambda *_: Advice("repeat", value=4.0))


def test_where_nothing_is_advised_there_is_nothing_to_follow(tmp_path: Path) -> None:
    write_verdict(tmp_path, "sparse-302", verdict("named", ["a"]))
    with pytest.raises(InputError, match="no verdict advises"):
        follow(tmp_path, lambda *_: Advice("repeat"))


@pytest.mark.parametrize(
    ("truth", "rivals", "after", "apart", "right"),
    [
        (["a"], ("a", "b"), verdict("named", ["a"]), True, True),
        (["a"], ("a", "b"), verdict("named", ["b"]), True, False),
        (["a"], ("a", "b"), verdict("ambiguous", ["a", "b"]), False, False),
        (["a"], ("a", "b"), verdict("ambiguous", ["a", "c"]), True, True),
        (["a"], ("a", "b"), verdict("insufficient", ["a"]), False, False),
        (["a"], ("a", "b"), verdict("named", ["c"]), False, False),
        (["c"], ("a", "b"), verdict("named", ["a"]), True, None),
        (["a"], ("a", "recalibrated"), verdict("named", ["a"]), True, True),
        (["a"], ("a", "recalibrated"), verdict("recalibrated"), True, False),
        ([], ("a", "recalibrated"), verdict("recalibrated"), True, True),
        (["a"], ("a", "recalibrated"), verdict("insufficient", ["a"]), False, False),
    ],
)
def test_rivals_are_apart_when_one_is_reported_and_the_other_not(
    tmp_path: Path,
    truth: list[str],
    rivals: tuple[str, str],
    after: dict[str, Any],
    apart: bool,
    right: bool | None,
) -> None:
    out = tmp_path / FOLLOWED
    for place in (ADVICE, "truth"):
        (out / place).mkdir(parents=True)
    (out / ADVICE / "sparse-1.json").write_text(json.dumps({"measurement": "blows", "separates": rivals}))
    (out / "truth" / "sparse-1.json").write_text(json.dumps({"effects": [{"id": name} for name in truth]}))
    write_verdict(out, "sparse-1", after)
    (one,) = separated(tmp_path)
    assert (one.apart, one.right) == (apart, right)


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    return simulate(tmp_path_factory.mktemp("menu") / "c", 5).campaign


def test_words_of_a_verdict_lead_back_to_what_they_ask_for(campaign: Campaign) -> None:
    datasets = predictable(campaign).kept
    for item in menu(campaign, datasets):
        found = item_of(campaign, datasets, item.words)
        assert (found.kind, found.body) == (item.kind, item.body)
        if item.kind in ("sensor", "blows"):
            assert f"on {item.body} at {item.value:g} m" in item.words
        if item.kind == "repeat":
            assert f"{item.value:g} times the blows" in item.words
    with pytest.raises(InputError, match="is no measurement that could come next"):
        item_of(campaign, datasets, "a drone")
