"""The page of a diagnosis: what comes first, that it stands alone, and that its pictures show what was found."""

from __future__ import annotations

import re
from dataclasses import replace
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
from permway.diagnosis.result import Diagnosis
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
from permway.diagnosis.weighed import Along, Rival, Weighed
from permway.errors import InputError
from permway.model.changes import Change
from permway.model.joints import GROUND
from permway.report.diagnosis import PAGE, write_report
from permway.report.diagnosis.changes import changes, most_changed
from permway.report.diagnosis.tables import change_table
from permway.report.diagnosis.track import drawing
from permway.report.diagnosis.verdict_page import render_verdict
from simulated import simulate

LOST = Change(from_m=7.1, to_m=7.9, factor=0.05)
FOLDED = ["rivals", "held-out", "better", "recalibrated", "assumed"]
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


@pytest.fixture(scope="module")
def diagnosis(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    """Two fasteners lost, found and put into the model."""
    campaign = simulate(tmp_path_factory.mktemp("page") / "c", 3, amend=lost).campaign
    observations = gather(campaign, threads=1)
    base = recalibrate(observations)
    amended = recalibrate(observations, build=lambda values: lost(campaign.with_values(values)))
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
    weighed = Weighed(
        along=(Along("pad", True, "local loss of support", np.array([7.2, 7.8]), np.array([0.97, 0.97])),),
        aside=(),
        rivals=(Rival(("fastener_loss",), ("pad from 7.2 to 7.8 m",), ("0.05 is left",), 0.97, 0.0, 1),),
        nothing=0.0,
        unknown=0.03,
        tried={},
    )
    return Diagnosis(
        verdict=verdict,
        base=base,
        amended=amended,
        comparison=assemble(observations, base, left_out={"run 7": "the speed is not known"}),
        after=assemble(observations, amended),
        seconds={"recalibrate": 1.5},
        weighed=weighed,
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
        if tag == "img":
            self.pictures.append(str(given["alt"]))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] != ["style"]:
            self.text += data


def test_the_page_stands_alone_and_is_whole(page: str) -> None:
    bare = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", page)
    assert not re.search(r"https?://|<script[^>]+src|@import|url\(|<link", bare)
    reader = Reader(page)
    assert len(reader.ids) == len(set(reader.ids))
    assert [i for i in reader.ids if i in FOLDED] == FOLDED
    assert page.count("data:image/png;base64,") == len(reader.pictures) == 5


def test_the_same_diagnosis_gives_the_same_page(diagnosis: Diagnosis, page: str, tmp_path: Path) -> None:
    assert written(diagnosis, tmp_path) == page


def test_a_folder_that_cannot_be_is_reported_before_drawing(diagnosis: Diagnosis, tmp_path: Path) -> None:
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


def test_text_of_a_campaign_is_no_markup(diagnosis: Diagnosis) -> None:
    (effect,) = diagnosis.verdict.effects
    sly = effect.model_copy(update={"law": Mechanics(words="<script>alert(1)</script>")})
    page = render_verdict(replace(diagnosis, verdict=diagnosis.verdict.model_copy(update={"effects": (sly,)})), {})
    assert "<script>alert" not in page
    assert "&lt;script&gt;" in page
