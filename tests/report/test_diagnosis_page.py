"""The page of a diagnosis: what comes first, that it stands alone, and that its pictures show what was found."""

from __future__ import annotations

import re
from dataclasses import replace
from html import escape
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from lines import hysteretic, supported, uic60
from permway.campaign.campaign import Campaign
from permway.diagnosis.compare import assemble
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Where
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.recalibrated_values import recalibrated_of
from permway.diagnosis.result import Candidate, Diagnosis
from permway.diagnosis.spot import Found, Spot
from permway.diagnosis.verdict import (
    ClassMember,
    Effect,
    Estimate,
    HeldOutGain,
    Mechanics,
    NextMeasurement,
    Place,
    Recalibrated,
    Smallest,
    Verdict,
    Weight,
)
from permway.errors import InputError
from permway.model.changes import Change
from permway.model.joints import GROUND
from permway.report.diagnosis import PAGE, write_report
from permway.report.diagnosis.changes import changes, most_changed
from permway.report.diagnosis.page import render
from permway.report.diagnosis.pictures import pictures
from permway.report.diagnosis.tables import candidate_rows, change_table, headline, held_out_rows, parameter_rows
from permway.report.diagnosis.track import drawing
from permway.report.diagnosis.where import groups, track_picture
from permway.report.readout import Drawn
from simulated import simulate

LOST = Change(from_m=7.1, to_m=7.9, factor=0.05)
SECTIONS = ["where", "what", "sure", "better", "next", "detectable", "recalibrated", "assumed"]
VOID = {"meta", "img", "br", "hr", "link", "input"}

SMALLEST = {
    "fastener_loss": Smallest(parameter="factor", value=0.62, unit="1", none=1.0),
    "girder_crack": Smallest(parameter="length_m", value=None, unit="m"),
}


def lost(campaign: Campaign) -> Campaign:
    """Without the pads at 7.2 and 7.8 m, nearly."""
    pads, *others = campaign.model.line.joints
    joints = (pads.model_copy(update={"changes": (LOST,)}), *others)
    line = campaign.model.line.model_copy(update={"joints": joints})
    return campaign.with_model(campaign.model.model_copy(update={"line": line}))


def mapped(campaign: Campaign, most: float) -> tuple[Found, ...]:
    """A map that is darkest between the lost pads, drawn and not computed."""
    table, laws = campaign.model.line.joint_table(), list(campaign.model.line.laws)
    spots = [Spot("joint", laws[table.law[j]], (float(x), float(x)), (j,)) for j, x in enumerate(table.x.tolist())]
    spots += [Spot("body", "deck", (float(x), float(x))) for x in range(13)]
    frequency, share = np.geomspace(8.0, 200.0, 12), np.full(12, 1.0 / 12.0)
    found = []
    for spot in spots:
        near = float(np.exp(-(((spot.x_m[0] - 7.5) / 2.0) ** 2))) * (1.0 if spot.name == "pad" else 0.5)
        gain = 12.0 + most * near
        found.append(Found(spot, gain, 12, frequency, 0j * frequency, 1.0 + 0.0 * share, gain * share, 2.0 * most))
    return tuple(sorted(found, key=lambda one: -one.surplus))


@pytest.fixture(scope="module")
def diagnosis(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    """Two fasteners lost, found and put into the model."""
    campaign = simulate(tmp_path_factory.mktemp("page") / "c", 3, amend=lost).campaign
    evidence = gather(campaign, threads=1)
    base = recalibrate(evidence)
    amended = recalibrate(evidence, build=lambda values: lost(campaign.with_values(values)))
    place = Where("pad", (7.2, 7.8))
    effect = Effect(
        domain="path",
        place=Place.of(place, campaign.model.line, within=(6.9, 8.1)),
        bands=((40.0, 120.0),),
        name="fastener_loss",
        class_=(ClassMember(name="fastener_loss", probability=0.97), ClassMember(name="novel", probability=0.02)),
        law=Mechanics(words="0.05 of the stiffness is left"),
        parameters={"factor": Estimate(value=0.05, unit="1", low=0.03, high=0.08)},
    )
    verdict = Verdict(
        status="named",
        effects=(effect,),
        evidence=Weight(log10_bayes_factor=110.0, misfit_before=41.0, misfit_after=1.04),
        held_out={
            "place": HeldOutGain(gain_nats=140.0, standard_error=9.0, db_before=3.1, db_after=0.4),
            "band": HeldOutGain(gain_nats=-30.0, standard_error=9.0, db_before=1.0, db_after=1.2),
        },
        placebo={"place": HeldOutGain(gain_nats=-3.0, standard_error=2.5)},
        recalibrated=Recalibrated(before=recalibrated_of(base), after=recalibrated_of(amended)),
        next=(
            NextMeasurement(
                measurement="a blow on the deck at 7.5 m",
                separates=("fastener_loss", "mortar_void"),
                separation_before=4.0,
                separation_after=31.0,
            ),
        ),
        detectable=SMALLEST,
    )
    candidates = (
        Candidate(
            "fastener_loss",
            "local loss of support",
            "path",
            place,
            "0.05 of the stiffness is left",
            base.objective - amended.objective,
            255.0,
            {"factor": (0.05, 0.03, 0.08, "1")},
            "full",
        ),
        Candidate(
            "sensor_gain", "chain", "measurement", Where(channels=("deck@3",)), "", 2.0, -4.0, {}, "screened"
        ),
    )
    return Diagnosis(
        verdict=verdict,
        base=base,
        amended=amended,
        found=mapped(campaign, 900.0),
        left=mapped(campaign, 3.0),
        candidates=candidates,
        comparison=assemble(evidence, base, left_out={"run 7": "the speed is not known"}),
        after=assemble(evidence, amended),
        seconds={"recalibrate": 1.5, "scan": 0.2},
    )


@pytest.fixture(scope="module")
def nothing(diagnosis: Diagnosis) -> Diagnosis:
    """The same campaign, had nothing been found."""
    verdict = Verdict(
        status="recalibrated",
        evidence=Weight(log10_bayes_factor=0.0, misfit_before=1.02),
        recalibrated=Recalibrated(before=diagnosis.verdict.recalibrated.before),
        detectable=SMALLEST,
    )
    return replace(
        diagnosis,
        verdict=verdict,
        amended=None,
        after=None,
        left=(),
        candidates=diagnosis.candidates[1:],
    )


@pytest.fixture(scope="module")
def page(diagnosis: Diagnosis, tmp_path_factory: pytest.TempPathFactory) -> str:
    return written(diagnosis, tmp_path_factory.mktemp("written"))


def written(diagnosis: Diagnosis, folder: Path) -> str:
    path = write_report(diagnosis, folder / "out", dpi=50)
    assert path == folder / "out" / PAGE
    assert [p.name for p in path.parent.iterdir()] == [PAGE]
    return path.read_text(encoding="utf-8")


class Reader(HTMLParser):
    """Balance of tags, places that links lead to, headings and all text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.links: list[str] = []
        self.pictures: list[str] = []
        self.text = ""
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag not in VOID:
            self.open.append(tag)
        if "id" in given:
            self.ids.append(str(given["id"]))
        if tag == "a":
            self.links.append(str(given["href"]))
        if tag == "img":
            self.pictures.append(str(given["alt"]))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] != ["style"]:
            self.text += data

    def section(self, start: str, stop: str) -> str:
        return self.text[self.text.index(start) : self.text.index(stop)]


def test_the_page_stands_alone_and_is_whole(page: str) -> None:
    bare = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", page)
    assert not re.search(r"https?://|<script[^>]+src|@import|url\(|<link", bare)
    reader = Reader(page)
    assert len(reader.ids) == len(set(reader.ids))
    assert {link.removeprefix("#") for link in reader.links} == set(SECTIONS)
    assert [i for i in reader.ids if i in SECTIONS] == SECTIONS
    assert page.count("data:image/png;base64,") == len(reader.pictures) == 5


def test_the_verdict_comes_first(page: str, diagnosis: Diagnosis) -> None:
    assert f'<p class="first" id="verdict">{escape(diagnosis.verdict.sentence)}</p>' in page
    top = page[: page.index("<nav>")]
    for value in ("Effect named", "0.97"):
        assert f"<b>{value}</b>" in top


def test_every_section_has_its_numbers(page: str) -> None:
    text = Reader(page).text
    for stated in (
        "6.9 to 8.1 m",
        "40 to 120 Hz",
        "0.03 to 0.08",
        "Bayes factor over nothing missing, common logarithm",
        "110",
        "fastener_loss, its class: fastener_loss (0.97), novel (0.02)",
        "140 ± 9",
        "−3 ± 2.5",
        "a blow on the deck at 7.5 m",
        "fastener_loss from mortar_void",
        "a change of 38 %",
        "none would have been seen",
        "the speed is not known",
        "each pair of sensor and point",
        "permway",
        "1.5 s",
    ):
        assert stated in " ".join(text.split()), stated


def test_gains_count_beyond_two_standard_errors(diagnosis: Diagnosis) -> None:
    place, band = held_out_rows(diagnosis.verdict)
    assert (place["clear"], place["harm"]) == (True, False)
    assert (band["clear"], band["harm"]) == (False, True)
    assert (band["before"], band["after"], band["placebo"]) == ("1.0 dB", "1.2 dB", "")


def test_a_candidate_that_was_only_screened_has_no_interval(diagnosis: Diagnosis) -> None:
    found, screened = diagnosis.candidates
    bare = replace(screened, parameters={"gain": (1.02, np.nan, np.nan, "1")}, log_evidence=-np.inf)
    first, second = candidate_rows(replace(diagnosis, candidates=(found, bare)))
    assert (first["parameters"], first["probability"]) == ("factor 0.05 (0.03 to 0.08)", "0.97")
    assert (second["parameters"], second["probability"], second["log_evidence"]) == ("gain 1.02", "", "")


def test_rivals_without_a_name_are_said_to_be_one_class(diagnosis: Diagnosis) -> None:
    (effect,) = diagnosis.verdict.effects
    members = (
        ClassMember(name="fastener_loss", probability=0.6),
        ClassMember(name="mortar_void", probability=0.3),
    )
    unsure = effect.model_copy(update={"name": None, "class_": members})
    verdict = diagnosis.verdict.model_copy(update={"status": "ambiguous", "effects": (unsure,)})
    text = " ".join(Reader(render(replace(diagnosis, verdict=verdict), {})).text.split())
    assert "These data cannot distinguish: fastener_loss (0.60), mortar_void (0.30)." in text


def test_the_numbers_beside_the_status_say_what_they_are_of(diagnosis: Diagnosis) -> None:
    def beside(**changes: object) -> dict[str, str]:
        effect = diagnosis.verdict.effects[0].model_copy(update=changes)
        verdict = diagnosis.verdict.model_copy(update={"effects": (effect,)})
        return {words: value for value, words in headline(verdict)}

    novel, void = ClassMember(name="novel", probability=0.6), ClassMember(name="mortar_void", probability=0.4)
    assert beside()["probability of the name, among all that was tried"] == "0.97"
    described = beside(name=None, class_=(novel, void))
    assert described["probability of no name of the catalogue, among all that was tried"] == "0.60"
    assert beside(name=None, class_=(void, novel))["probability of the likeliest name, among all that was tried"]


def test_nothing_found_says_what_was_looked_for_and_what_would_have_been_seen(nothing: Diagnosis) -> None:
    drawn = dict.fromkeys((name for name, _ in pictures(nothing)), Drawn(b"", "[]"))
    reader = Reader(render(nothing, drawn))
    order = [i for i in reader.ids if i in SECTIONS]
    assert order[:2] == ["detectable", "where"]
    text = " ".join(reader.text.split())
    assert "1 effects" not in text
    assert "1 effect was held against the records: sensor_gain." in text
    assert f"A free stiffness was tried at {len(nothing.found)} places" in text
    assert "No effect is called missing." in text
    assert "How well the recalibrated model fits" in text
    # No amended model, no place to mark.
    assert list(drawn) == ["track", "frequency", "gain-blows", "curves-blows", "parameters"]
    assert len(reader.pictures) == 5
    assert not re.search("amended|Dashed", text)


def test_what_is_only_suspected_is_said_to_be(diagnosis: Diagnosis) -> None:
    evidence = diagnosis.verdict.evidence.model_copy(update={"unmet": ("held_out",)})
    verdict = diagnosis.verdict.model_copy(update={"status": "insufficient", "evidence": evidence})
    text = " ".join(Reader(render(replace(diagnosis, verdict=verdict), {})).text.split())
    assert "; records that were left out are not foretold better by it" in text
    assert "No effect is called missing. Suspected, without passing every bar:" in text
    assert "the suspicion is lost fasteners at pad from 7.2 to 7.8 m" in text


def test_without_hammer_tests_there_is_a_page_without_maps(diagnosis: Diagnosis) -> None:
    blind = replace(diagnosis, found=(), left=())
    assert [name for name, _ in pictures(blind)] == ["gain-blows", "curves-blows", "parameters"]
    assert "A gain at a place" not in Reader(render(blind, {})).text


def test_text_of_a_campaign_is_no_markup(diagnosis: Diagnosis) -> None:
    sly = replace(diagnosis.candidates[0], law="<script>alert(1)</script>")
    page = render(replace(diagnosis, candidates=(sly,)), {})
    assert "<script>alert" not in page
    assert "&lt;script&gt;" in page


def test_the_same_diagnosis_gives_the_same_page(diagnosis: Diagnosis, page: str, tmp_path: Path) -> None:
    assert written(diagnosis, tmp_path) == page


def test_a_folder_that_cannot_be_is_said_before_drawing(diagnosis: Diagnosis, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        write_report(diagnosis, tmp_path / "a" / "b")


def test_the_amendment_lessens_what_deviates_and_the_most_changed_come_first(diagnosis: Diagnosis) -> None:
    (change,) = changes(diagnosis)
    before, after = change.mean_square()
    assert after is not None
    assert np.nansum(after) < 0.1 * np.nansum(before)
    worth = np.abs(before - after)[change.order()]
    assert np.all(np.diff(worth[np.isfinite(worth)]) <= 0.0)
    table, rest = change_table(change)
    first = change.order()[0]
    assert rest is None
    assert table.rows[0][0] == str(change.before["channel"].values[first]).replace("<", "from")
    marked = [mark for _, _, mark in table.rows[0][1]]
    assert marked == (np.abs(change.after_dB.values[first]) >= 1.0).tolist()


def test_every_sensor_is_drawn_before_a_second_channel_of_one(diagnosis: Diagnosis) -> None:
    (change,) = changes(diagnosis)
    sensors = change.before["sensor"].values.astype(str)
    chosen = most_changed([change])
    assert len(chosen) == 6
    assert {sensors[channel] for _, channel in chosen[:2]} == {"rail@6", "deck@3"}
    assert chosen[0][1] == change.order()[0]


def test_the_map_is_darkest_where_the_fasteners_are_lost(diagnosis: Diagnosis) -> None:
    above, below = track_picture(diagnosis).axes[:2]
    name, mine = groups(diagnosis.found)[0]
    assert name == "pad"
    (curve,) = [line for line in above.lines if line.get_label() == "pad"]
    x, gain = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
    assert abs(x[np.argmax(gain)] - 7.5) < 0.7
    assert gain.max() == pytest.approx(max(f.surplus for f in mine))
    # Joints are drawn in the colours of their gains.
    _edges, joints = [c for c in below.collections if len(getattr(c, "get_segments", list)()) == 23]
    segments = joints.get_segments()
    darkness = np.asarray(joints.get_colors())[:, :3].sum(axis=1)
    assert abs(segments[int(np.argmin(darkness))][0][0] - 7.5) < 0.7
    spans = sorted({float(line.get_xdata()[0]) for line in below.lines if line.get_label() == "place"})
    assert spans == [7.2, 7.8]


def test_bodies_hang_in_the_order_of_their_joints(diagnosis: Diagnosis) -> None:
    plan = drawing(diagnosis.base.campaign)
    assert plan.level["rail"] > plan.level["deck"] > 0.0
    low, high = plan.reach_m
    assert low < 0.0
    assert high > 12.0


def test_single_sleepers_share_a_level(diagnosis: Diagnosis) -> None:
    ballast, pad = hysteretic(2e7 + 1e6j), hysteretic(1e8 + 1e7j)
    line = supported(uic60(), count=5, spacing_m=0.6, pad=pad, ballast=ballast, sleeper_kg=100.0)
    assert line.joints[-1].between[1] == GROUND
    campaign = diagnosis.base.campaign
    stated = campaign.stated.model_copy(update={"sensors": (), "forces": ()})
    bare = replace(campaign, stated=stated, model=campaign.model.model_copy(update={"line": line}))
    plan = drawing(bare)
    assert {plan.level[f"sleeper{i}"] for i in range(5)} == {1.0}
    assert plan.names == {2.0: "rail", 1.0: "sleeper"}


def test_parameters_say_where_they_went(diagnosis: Diagnosis) -> None:
    rows = {row["name"]: row for row in parameter_rows(diagnosis)}
    moved_before = diagnosis.verdict.recalibrated.before
    for name, row in rows.items():
        assert row["left"] == (abs(moved_before[name].z) > 2.0)
        after = diagnosis.verdict.recalibrated.after[name]
        assert (row["said"] == "outside its tolerance") == (abs(after.z) > 2.0)
        low, high = diagnosis.base.intervals()[name]
        assert low <= moved_before[name].value <= high
        assert row["before_span"]
    assert list(rows) == [f.name for f in diagnosis.base.free]


def test_the_page_says_that_something_is_left() -> None:
    effect = Effect(domain="path", place=Place(joint="pad"), name="fastener_loss")
    for left, stated in ((1.1, False), (74.4, True)):
        verdict = Verdict(
            status="named", effects=(effect,), evidence=Weight(misfit_before=90.0, misfit_after=left)
        )
        words = [f"{value} {text}" for value, text in headline(verdict)]
        assert any(line.startswith("74.4 ") and "not all of it" in line for line in words) == stated
