"""What the posterior's search names on small campaigns of the tool's own model, by rates over seeds."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_chain, with_joints
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.verdict import NOVEL, UNPROVED
from permway.laws import Springpot
from permway.model.joints import GROUND, Joints
from permway.posterior.diagnose import diagnose
from simulated import CAMPAIGN, simulate

Amend = Callable[[Campaign], Campaign]


def lost(campaign: Campaign) -> Campaign:
    """Three pads about the drive point keep 0.3."""
    return weakened(campaign, "pad", 6.0, 1.2, 0.3)


def loud(campaign: Campaign) -> Campaign:
    """A sensor reads 1.4 times what is there."""
    chain = campaign.sensor("deck@3").chain
    return with_chain(campaign, "deck@3", chain.model_copy(update={"gain": 1.4}))


def leaning(campaign: Campaign) -> Campaign:
    """The deck leans on the ground by a springpot that no catalogue has."""
    joint = Joints(between=("deck", GROUND), law="lean", at=(4.6,))
    return with_joints(campaign, joint, laws={"lean": Springpot(coefficient=3.0e5, order=0.6)})


def nothing(campaign: Campaign) -> Campaign:
    """As the nominal model has it, within its tolerances."""
    return campaign


@pytest.mark.parametrize(
    ("amend", "names"),
    [(lost, {"fastener_loss"}), (loud, {"sensor_gain"}), (nothing, set())],
    ids=["lost", "gain", "none"],
)
def test_two_of_three_seeds_are_named_rightly_and_no_other_name_is_given(
    tmp_path: Path, amend: Amend, names: set[str]
) -> None:
    right = 0
    for seed in (31, 32, 33):
        verdict = diagnose(simulate(tmp_path / str(seed), seed, amend=amend).campaign, threads=1).verdict
        called = verdict.effects if verdict.status not in UNPROVED else ()
        found = {effect.name for effect in called if effect.name is not None}
        assert found <= names
        right += found == names
    assert right >= 2


def test_what_no_catalogue_has_is_described_at_its_place_and_gets_no_name(tmp_path: Path) -> None:
    described = 0
    for seed in (35, 36, 37):
        verdict = diagnose(simulate(tmp_path / str(seed), seed, amend=leaning).campaign, threads=1).verdict
        assert not {effect.name for effect in verdict.effects} - {None}
        if verdict.status == "described":
            effect = verdict.effects[0]
            assert effect.class_[0].name == NOVEL
            assert effect.place.x is not None
            described += "springpot" in effect.law.words and abs(effect.place.x[0] - 4.6) < 0.5
    assert described >= 2


def test_the_answer_does_not_depend_on_how_many_processes_share_the_work(tmp_path: Path) -> None:
    campaign = simulate(tmp_path / "c", 34, amend=loud).campaign
    assert diagnose(campaign, threads=2).verdict == diagnose(campaign, threads=1).verdict


def test_a_wrong_stated_value_is_reported_with_the_value_that_fits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All pads are softer by some 30 % than stated, at a tolerance of 5 %."""
    stated = [
        {**one, "tolerance_2sigma": 0.05} if one["name"] == "pad.k" else one for one in CAMPAIGN["parameters"]
    ]
    monkeypatch.setitem(CAMPAIGN, "parameters", stated)
    made = simulate(tmp_path / "c", 1, amend=lambda campaign: weakened(campaign, "pad", 6.0, 40.0, 0.7))
    verdict = diagnose(made.campaign, threads=1).verdict
    assert [effect.name for effect in verdict.effects] == ["owner_value"]
    found = verdict.recalibrated.after["pad.k"]
    assert found.low is not None
    assert found.high is not None
    assert found.low < 0.7 * made.truth["pad.k"] < found.high
    words = verdict.effects[0].law.words
    assert "below the stated 30 MN/m" in words
