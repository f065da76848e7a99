"""The page of a diagnosis by the posterior: what is acted on first, with its map, and no underscore for people."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from browser import DESK, PHONE, hidden, opened, overflow, pictures, smallest_print
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue import entries
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.verdict import NOVEL
from permway.diagnosis.verdict_parts import (
    ClassMember,
    Doubt,
    Mechanics,
    Moved,
    NextMeasurement,
    Place,
    Recalibrated,
)
from permway.posterior import cells
from permway.posterior.diagnose import diagnose
from permway.report.diagnosis import write_report
from permway.report.diagnosis.acting import next_steps, rival_rows, rival_tables
from permway.report.diagnosis.assumed import assumed
from permway.report.diagnosis.places import map_picture
from permway.report.diagnosis.verdict_page import render_verdict
from simulated import simulate

FEW = {"fastener_loss", "sensor_gain"}
"""Effects that are tried, so that it takes seconds."""


def lost(campaign: Campaign) -> Campaign:
    """Three pads about the drive point keep 0.3."""
    return weakened(campaign, "pad", 6.0, 1.2, 0.3)


def loud(campaign: Campaign) -> Campaign:
    """A sensor reads 1.4 times what is there."""
    chain = campaign.sensor("deck@3").chain
    return with_chain(campaign, "deck@3", chain.model_copy(update={"gain": 1.4}))


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Diagnosis]:
    folder = tmp_path_factory.mktemp("made")
    others = set(entries()) - FEW
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cells, "BESIDE", {})
        return {
            name: diagnose(simulate(folder / name, 41, amend=amend).campaign, threads=1, ruled_out=others)
            for name, amend in (("lost", lost), ("loud", loud), ("nothing", lambda c: c))
        }


@pytest.fixture(scope="module")
def pages(found: dict[str, Diagnosis], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("written")
    return {name: write_report(one, folder / name, dpi=60) for name, one in found.items()}


def text_of(path: Path) -> str:
    return read(path.read_text("utf-8"))


def read(page: str) -> str:
    """What is read of a page."""
    bare = re.sub(r"<style>.*?</style>|<script.*?</script>", " ", page, flags=re.DOTALL)
    return " ".join(re.sub(r"<[^>]+>", " ", bare).split())


def test_what_to_act_on_comes_first_and_what_it_rests_on_is_folded(pages: dict[str, Path]) -> None:
    page = pages["lost"].read_text("utf-8")
    order = [
        page.index(f'id="{name}"') for name in ("verdict", "next", "where", "curve", "what", "sure", "rivals")
    ]
    assert order == sorted(order)
    assert page.index("<details") > page.index('id="sure"')
    assert "<details open" not in page
    assert not re.search(r"https?://|<script[^>]+src|@import|<link", page)
    text = text_of(pages["lost"])
    assert "Lost fasteners at pad from 5.4 to 6.6 m" in text
    assert "probability above 0.99" in text
    assert "Inspect on site: pad from 5.4 to 6.6 m" in text
    assert re.search(r"3 joints have lost (69|70|71) % of their stiffness", text)


@pytest.mark.parametrize("name", ["lost", "loud", "nothing"])
def test_nobody_reads_an_underscore(pages: dict[str, Path], name: str) -> None:
    assert re.findall(r"\b\w*[A-Za-z]_[A-Za-z]\w*", text_of(pages[name])) == []


def test_the_map_has_the_probability_at_its_joints(found: dict[str, Diagnosis]) -> None:
    figure = map_picture(found["lost"])
    above, below = figure.axes
    bars = {round(float(b.get_x() + 0.5 * b.get_width()), 3): float(b.get_height()) for b in above.patches}
    assert all(bars[x] > 0.9 for x in (5.4, 6.0, 6.6))
    assert sum(bars.values()) < 3.5
    assert below.get_xlabel() == "x, m"
    assert {"sensor", "hammer point"} <= set(below.get_legend_handles_labels()[1])


def test_a_sensor_at_fault_is_ringed_with_its_probability(found: dict[str, Diagnosis]) -> None:
    (only,) = map_picture(found["loud"]).axes
    (note,) = [one.get_text() for one in only.texts]
    assert note == "deck@3: 1.00"


def test_where_nothing_is_missing_the_map_shows_where_was_looked(
    found: dict[str, Diagnosis], pages: dict[str, Path]
) -> None:
    weighed = found["nothing"].weighed
    assert weighed is not None
    assert weighed.along == ()
    assert weighed.tried["pad"].size > 10
    (only,) = map_picture(found["nothing"]).axes
    assert {"sensor", "hammer point"} <= set(only.get_legend_handles_labels()[1])
    text = text_of(pages["nothing"])
    assert "Where was looked" in text
    assert text.index("What would have been seen") < text.index("What it rests on")
    assert re.search(r"Lost fasteners a change of [0-9.]+ %", text)


def test_rivals_are_ranked_by_probability_and_all_sum_to_one(found: dict[str, Diagnosis]) -> None:
    for one in found.values():
        assert one.weighed is not None
        shares = [rival.probability for rival in one.weighed.rivals]
        assert sum(shares) + one.weighed.unknown == pytest.approx(1.0)
        assert shares == sorted(shares, reverse=True)
        assert min(rival.behind_nats for rival in one.weighed.rivals) == 0.0
    lost_rows = rival_rows(found["lost"].weighed)  # type: ignore[arg-type]
    assert lost_rows[0]["names"] == "Lost fasteners"
    assert "pad from 5.4 to 6.6 m" in lost_rows[0]["what"]
    assert lost_rows[-1]["names"] == "Nothing missing"
    assert float(lost_rows[-1]["behind"]) > 20.0


def test_the_best_set_of_each_size_is_shown_openly(found: dict[str, Diagnosis]) -> None:
    one = found["lost"].weighed
    assert one is not None
    many = tuple(replace(one.rivals[0], behind_nats=float(i)) for i in range(20))
    rows, others = rival_tables(replace(one, rivals=(*many, one.rivals[-1]), unknown=0.1))
    assert [row["names"] for row in rows[-2:]] == ["Nothing missing", "Something the catalogue does not hold"]
    assert [len(rows), len(others)] == [14, 8]


def test_parameters_have_units_that_fit(pages: dict[str, Path]) -> None:
    text = text_of(pages["lost"])
    assert re.search(r"pad\.k 30 MN/m 2[0-9] to 4[0-9] MN/m [0-9.]+ MN/m [0-9.]+ to [0-9.]+ MN/m", text)
    assert re.search(r"deck\.E 34 GPa", text)


def test_held_out_groups_have_nats_and_decibels(found: dict[str, Diagnosis], pages: dict[str, Path]) -> None:
    text = text_of(pages["lost"])
    assert found["lost"].verdict.held_out
    for name in found["lost"].verdict.held_out:
        assert re.search(rf"{re.escape(name)} −?[0-9.]+ [0-9.]+ dB [0-9.]+ dB", text), name


def test_calibration_errors_are_those_of_the_amended_model_and_are_explained(
    found: dict[str, Diagnosis], pages: dict[str, Path]
) -> None:
    after, text = found["lost"].after, text_of(pages["lost"])
    assert after is not None
    rows = assumed(found["lost"])["smooth"]
    largest = max(float(v) for v in after.calibration["size_dB"].values)
    before = max(float(v) for v in found["lost"].comparison.calibration["size_dB"].values)
    assert before > largest + 0.02
    assert max(float(row["largest"]) for row in rows) == pytest.approx(largest, abs=0.006)
    assert "estimated from the records with the amended model" in text
    assert "Above 1.8 dB" in text
    assert "with the recalibrated model, by which" in text_of(pages["nothing"])


def test_each_status_states_what_to_do(found: dict[str, Diagnosis]) -> None:
    loud_one, fine = found["loud"], found["nothing"]
    assert next_steps(loud_one)[0].startswith("Check deck@3: mounting")
    assert next_steps(fine)[0].startswith("Nothing to repair")
    far = Recalibrated(before={"pad.k": Moved(value=2.1e7, prior=3e7, z=-4.4)})
    off = fine.verdict.model_copy(update={"status": "outside_tolerance", "recalibrated": far})
    assert next_steps(replace(fine, verdict=off))[0].startswith("Check what was stated of pad.k")
    unsure = fine.verdict.model_copy(update={"status": "insufficient"})
    assert "do not decide" in next_steps(replace(fine, verdict=unsure))[0]
    advice = NextMeasurement(
        measurement="a blow on the deck at 7.5 m",
        separates=("fastener_loss", "recalibrated"),
        separation_before=4.0,
        separation_after=31.0,
    )
    advised = unsure.model_copy(update={"next": (advice,)})
    assert next_steps(replace(fine, verdict=advised)) == [
        "Measure: a blow on the deck at 7.5 m, to be sure of lost fasteners."
    ]
    doubt = Doubt(kind="sign", where="records.blows", what="has the other sign", remedy='sign = "-"')
    doubted = fine.verdict.model_copy(update={"blunders": (doubt,)})
    assert next_steps(replace(fine, verdict=doubted))[0] == (
        'Put right in the campaign file: records.blows: sign = "-".'
    )


def test_effects_that_share_a_place_are_looked_for_in_one_step(found: dict[str, Diagnosis]) -> None:
    one = found["lost"]
    (effect,) = one.verdict.effects
    there = effect.model_copy(update={"place": Place(body="deck")})
    void = there.model_copy(update={"name": "mortar_void"})
    verdict = one.verdict.model_copy(update={"effects": (there, effect, there, void)})
    steps = next_steps(replace(one, verdict=verdict))
    assert steps[0] == "Check: deck. Expected: lost fasteners, and void below the slab."
    assert [step.partition(":")[0] for step in steps[1:]] == [
        "Inspect on site",
        "Predict with amended.toml, the model with the effect in it.",
    ]


LOST, VOID = ClassMember(name="fastener_loss", probability=0.6), ClassMember(name="mortar_void", probability=0.4)
SURE = ClassMember(name=NOVEL, probability=0.95)


@pytest.mark.parametrize(
    ("status", "changes", "expected"),
    [
        ("ambiguous", {"name": None, "class_": (LOST, VOID)}, ("Lost fasteners or void below the slab", "(0.40)")),
        ("insufficient", {}, ("What is suspected", "Lost fasteners")),
        (
            "described",
            {"name": None, "class_": (SURE,), "law": Mechanics(words="spring of 3 MN/m")},
            ("acts what the catalogue does not hold", "Expected: something the catalogue does not hold"),
        ),
        (
            "located",
            {"name": None, "class_": (SURE,), "parameters": {}, "size": None, "law": Mechanics()},
            ("physics is missing that these records cannot describe", "Inspect on site: pad from 5.4 to 6.6 m"),
        ),
        (
            "measurement",
            {"domain": "measurement", "name": "sensor_labels", "class_": (), "place": Place(channels=("a", "b"))},
            ("Swapped labels", "Check a and b: mounting"),
        ),
        (
            "named",
            {"name": "owner_value", "class_": (), "place": Place(body="pad.k"), "parameters": {}, "size": None},
            ("Wrong stated value", "Check what was stated of pad.k"),
        ),
        (
            "named",
            {"domain": "vehicle", "name": "air_spring", "place": Place()},
            ("Air spring", "Check: vehicle. Expected: air spring."),
        ),
    ],
)
def test_a_page_of_every_status_states_its_effect(
    found: dict[str, Diagnosis], status: str, changes: dict[str, object], expected: tuple[str, ...]
) -> None:
    one = found["lost"]
    effect = one.verdict.effects[0].model_copy(update=changes)
    verdict = one.verdict.model_copy(update={"status": status, "effects": (effect,)})
    text = read(render_verdict(replace(one, verdict=verdict), {}))
    for words in expected:
        assert words in text, words
    assert re.findall(r"\b\w*[A-Za-z]_[A-Za-z]\w*", text) == []


def test_text_of_a_campaign_is_no_markup(found: dict[str, Diagnosis]) -> None:
    one = found["lost"]
    effect = one.verdict.effects[0].model_copy(update={"law": Mechanics(words="<script>alert(1)</script>")})
    page = render_verdict(replace(one, verdict=one.verdict.model_copy(update={"effects": (effect,)})), {})
    assert "<script>alert" not in page
    assert "&lt;script&gt;" in page


def test_the_same_diagnosis_gives_the_same_page(
    found: dict[str, Diagnosis], pages: dict[str, Path], tmp_path: Path
) -> None:
    again = write_report(found["loud"], tmp_path / "again", dpi=60)
    assert again.read_text("utf-8") == pages["loud"].read_text("utf-8")


@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
def test_in_a_browser_nothing_is_cut_off(pages: dict[str, Path], size: tuple[int, int]) -> None:
    with opened(pages["lost"], size) as (page, complaints):
        assert complaints == []
        assert overflow(page) <= 0
        assert pictures(page)[1] == 0
        assert page.evaluate("[...document.querySelectorAll('details')].every((one) => !one.open)")
        page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
        assert overflow(page) <= 0
        assert hidden(page) == []
        assert smallest_print(page) >= 11.0
        wide = page.evaluate("[...document.images].map((i) => i.getBoundingClientRect().width)")
        assert np.max(wide) <= size[0]
