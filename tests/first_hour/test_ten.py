"""The first hour: ten campaigns that differ from their model in one thing each, and what is stated about them.

Made by finite elements that share no code with the solver. What a user runs is `permway check`, then
`permway diagnose`; the diagnoses take half a minute of processor each, and are marked.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.predict import predict
from permway.challenge.small.elements_line import Line, scaled
from permway.checking.check import Checked, check
from permway.diagnosis.verdict import Verdict
from permway.posterior.diagnose import diagnose
from ridden import NOISE, PAD_N_PER_M, SPACING_M, SPEED_M_PER_S, ridden, run
from struck import struck_deck, tolerance

LOST_M, RIDDEN_LOST_M = 7.2, 10.2
SOFTER = 0.7
SEED = 1


def without_a_pad(line: Line) -> None:
    scaled(line, "pad", lambda _number, x: 0.0 if abs(x - LOST_M) < 0.01 else 1.0)


def turning(line: Line) -> None:
    """The girder has rotary inertia, which the model's has not."""
    assert line.track is not None
    beam = line.track.beams["girder"]
    section = replace(beam.section, rotary=2500.0 * 0.12)
    line.track.beams["girder"] = replace(beam, section=section)


def up(values: Complexes) -> Complexes:
    return -values


def in_g(values: Complexes) -> Complexes:
    return values / 9.80665


STRUCK: dict[str, dict[str, Any]] = {
    **{
        f"soft at {percent} %": {"pads": SOFTER, "stated": tolerance("pad.k", 0.01 * percent)}
        for percent in (5, 10, 25)
    },
    "fastener missing": {"there": without_a_pad},
    "sign forgotten": {"read": up},
    "g for m/s2": {"read": in_g},
    "rotary inertia": {"there": turning},
}
RIDDEN: dict[str, dict[str, Any]] = {
    "fastener missing, ridden": {"lost": (RIDDEN_LOST_M,)},
    "nothing missing": {},
    "no noise floors": {"lost": (RIDDEN_LOST_M,), "floors": False},
}

BLUNDERS = {
    "sign forgotten": ("sign", 'direction = "up"'),
    "g for m/s2": ("factor", 'unit = "g", not "m/s2"'),
}


@pytest.fixture(scope="module")
def ride(tmp_path_factory: pytest.TempPathFactory) -> Callable[[np.random.Generator, float], Reals]:
    """One ride is the same for all, and takes ten seconds."""
    kept: dict[float, Reals] = {}

    def known(random: np.random.Generator, pads: float) -> Reals:
        if pads not in kept:
            kept[pads] = run(random, pads)
        return kept[pads]

    return known


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory, ride: Any) -> Callable[[str], Path]:
    """Of a campaign's file, by name."""
    folder, made = tmp_path_factory.mktemp("ten"), {}

    def of(name: str) -> Path:
        if name not in made:
            beside = folder / str(len(made))
            made[name] = (
                struck_deck(beside, SEED, **STRUCK[name])
                if name in STRUCK
                else ridden(beside, SEED, rides=ride, **RIDDEN[name])
            )
        return made[name]

    return of


def checked(path: Path) -> Checked:
    return check(read_campaign(path), threads=1)


@cache
def diagnosed(path: Path) -> Verdict:
    """What is stated of a campaign; two tests may ask, and it takes minutes."""
    campaign = read_campaign(path)
    return diagnose(campaign, threads=1).with_blunders(check(campaign, threads=1)).verdict


@pytest.mark.parametrize("name", STRUCK)
def test_blunders_are_reported_and_nothing_else_is_called_one(name: str, path: Callable[[str], Path]) -> None:
    found = checked(path(name)).blunders
    if name not in BLUNDERS:
        assert found == ()
        return
    kind, remedy = BLUNDERS[name]
    assert [one.kind for one in found] == [kind]
    assert remedy in found[0].remedy


@pytest.mark.parametrize("name", RIDDEN)
def test_a_noise_floor_that_was_not_given_is_asked_for(name: str, path: Callable[[str], Path]) -> None:
    found = checked(path(name)).blunders
    asked = {one.where.removeprefix("records.ride: ") for one in found if one.kind == "noise_floor" and one.asked}
    assert len(found) == len(asked)
    assert asked == (set(NOISE) if name == "no noise floors" else set())


def test_a_train_that_rolls_is_predicted(path: Callable[[str], Path]) -> None:
    """Marched in time over the finite elements' fasteners: the line of their passing is in the prediction."""
    campaign = read_campaign(path("nothing missing"))
    pads = float(np.exp(0.5 * np.log1p(0.25) * np.random.default_rng([SEED, 470]).standard_normal()))
    true = campaign.with_values({"pad.k": PAD_N_PER_M * pads})
    (ridden_by,) = [dataset for dataset in campaign.load() if dataset.record.name == "ride"]
    lines = np.abs(ridden_by.frequency_Hz - SPEED_M_PER_S / SPACING_M) < 1.0
    off = {}
    for rolls in (True, False):
        (predicted,) = predict(true if rolls else _standing(true), [ridden_by], threads=1)
        ratio = ridden_by.data["psd"].values[:, lines] / predicted["psd"].values[:, lines]
        off[rolls] = 10.0 * np.log10(ratio).mean(axis=1)
    assert np.abs(off[True]).max() < 1.0
    assert off[False].min() > 2.0


def _standing(campaign: Campaign) -> Campaign:
    known = campaign.stated.irregularity.model_copy(update={"rolling": False})
    return replace(campaign, stated=campaign.stated.model_copy(update={"irregularity": known}))


@pytest.mark.injection
@pytest.mark.parametrize("percent", [5, 10, 25])
def test_pads_softer_than_stated(percent: int, path: Callable[[str], Path]) -> None:
    """With the value that fits, in the sentence, whatever tolerance was stated."""
    verdict = diagnosed(path(f"soft at {percent} %"))
    assert {effect.name for effect in verdict.effects} <= {"owner_value"}
    assert verdict.status in ("named", "outside_tolerance")
    moved = verdict.recalibrated.after or verdict.recalibrated.before
    found = moved["pad.k"]
    assert found.low is not None
    assert found.high is not None
    assert found.low < SOFTER * 3.0e7 < found.high
    assert "pad.k" in verdict.sentence.lower()
    assert re.search(r"21\.\d MN/m", verdict.sentence)


@pytest.mark.injection
@pytest.mark.parametrize("percent", [5, 25])
def test_the_sentence_states_the_value_that_the_table_states(percent: int, path: Callable[[str], Path]) -> None:
    verdict = diagnosed(path(f"soft at {percent} %"))
    (stated,) = re.findall(r"(?:about|at) ([\d.]+) MN/m", verdict.sentence)
    found = (verdict.recalibrated.after or verdict.recalibrated.before)["pad.k"]
    assert float(stated) == pytest.approx(found.value / 1e6, abs=0.06)


@pytest.mark.injection
@pytest.mark.parametrize("name", ["fastener missing", "fastener missing, ridden", "no noise floors"])
def test_a_fastener_missing(name: str, path: Callable[[str], Path]) -> None:
    verdict = diagnosed(path(name))
    assert verdict.status == "named"
    (effect,) = verdict.effects
    assert effect.name == "fastener_loss"
    assert effect.place.x is not None
    there = LOST_M if name in STRUCK else RIDDEN_LOST_M
    assert effect.place.x == pytest.approx((there, there), abs=0.31)
    factor = effect.parameters["factor"]
    assert factor.low is not None
    assert factor.low < 0.1


@pytest.mark.injection
def test_nothing_missing_under_a_train_that_rolls(path: Callable[[str], Path]) -> None:
    verdict = diagnosed(path("nothing missing"))
    assert verdict.status == "recalibrated"
    assert not verdict.effects


@pytest.mark.injection
@pytest.mark.parametrize("name", BLUNDERS)
def test_a_diagnosis_puts_blunders_first(name: str, path: Callable[[str], Path]) -> None:
    verdict = diagnosed(path(name))
    assert [one.kind for one in verdict.blunders] == [BLUNDERS[name][0]]
    assert verdict.sentence.startswith("Put right first: records.blows: ")


@pytest.mark.injection
def test_rotary_inertia_of_a_girder(path: Callable[[str], Path]) -> None:
    """Named, or held beside the girder's other changes; with the band in which Euler's beam is right."""
    verdict = diagnosed(path("rotary inertia"))
    assert verdict.status == "named"
    (effect,) = verdict.effects
    assert effect.name == "girder_shear"
    assert "Hz" in effect.law.words
