"""Effects that somebody has ruled out."""

from __future__ import annotations

from pathlib import Path

import pytest
from permway.cli import app
from permway.diagnosis.catalogue import entries, hypotheses, known
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from permway.errors import InputError
from simulated import simulate


def test_they_are_not_offered_and_all_others_are(tmp_path: Path) -> None:
    campaign = simulate(tmp_path / "c", 1).campaign
    situation = Situation(recalibrate(gather(campaign, campaign.load()), most_steps=0), ())
    every = [one.entry for one in hypotheses(situation)]
    out = ("pad_frequency", "sensor_gain")
    assert set(out) < set(every)
    assert [one.entry for one in hypotheses(situation, out)] == [name for name in every if name not in out]


def test_names_are_sorted_and_unknown_ones_refused() -> None:
    assert known(["wheel_flat", "air_spring", "wheel_flat"]) == ("air_spring", "wheel_flat")
    with pytest.raises(InputError, match=r"no effect of the catalogue.*") as caught:
        known(["pad_frequenzy"])
    assert caught.value.value == "pad_frequenzy"
    assert all(name in str(caught.value.remedy) for name in entries())
    with pytest.raises(InputError, match="no effect of the catalogue"):
        app(["diagnose", "nowhere.toml", "--rule-out", "nonsense"], standalone_mode=False)


@pytest.mark.parametrize("words", ["lost fasteners", "Lost Fasteners", "fastener loss", "fastener_loss"])
def test_the_words_of_a_verdict_rule_out(words: str) -> None:
    assert known([words]) == ("fastener_loss",)
    assert known([words, "bearing stiffness", "bearing_stiffness"]) == ("bearing_stiffness", "fastener_loss")


def test_a_typo_is_answered_with_what_is_near() -> None:
    with pytest.raises(InputError) as caught:
        known(["baering stifness"])
    assert caught.value.remedy.startswith("did you mean 'bearing_stiffness'")
