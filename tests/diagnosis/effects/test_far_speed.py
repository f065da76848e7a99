"""Speeds that are further off than any note: the base stops at turns of phases, and is left for the search."""

from __future__ import annotations

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.diagnosis.catalogue import speed_error
from permway.diagnosis.catalogue._excite import with_speed
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from permway.laws.toml import to_toml
from searched import searched
from trains import CAMPAIGN, campaign_in, evidence_of

RUNS = ("slow", "fast")
OWN = {"slow": 1.0005, "fast": 0.9992}
"""What the runs differ by themselves."""


@pytest.fixture(scope="module")
def owner(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    """Whose notes of the speeds are good to half a percent, he says."""
    folder = tmp_path_factory.mktemp("far")
    campaign_in(folder)
    speeds = [
        {
            "name": f"speed.{name}",
            "unit": "m/s",
            "paths": f"campaign.conditions.{name}.speed_m_per_s",
            "tolerance_2sigma": 0.005,
            "bounds": [0.99 * speed, 1.01 * speed],
        }
        for name, speed in (("slow", 50.0), ("fast", 71.0))
    ]
    said = {**CAMPAIGN, "parameters": [*CAMPAIGN["parameters"], *speeds]}
    (folder / "campaign.toml").write_text(to_toml(said))
    return read_campaign(folder / "campaign.toml")


def measured(owner: Campaign, factor: float) -> Evidence:
    """All runs at `factor` times what was noted, each a little off beside."""

    def amend(truth: Campaign) -> Campaign:
        for name in RUNS:
            truth = with_speed(truth, factor * OWN[name], name)
        return truth

    return evidence_of(owner, 5, amend=amend)


@pytest.mark.xfail(
    strict=True, raises=AssertionError, reason="speeds 6 % off are found, and told to 3e-4 instead of 2e-4"
)
def test_a_speed_far_off_is_found_and_measured(owner: Campaign) -> None:
    evidence = measured(owner, 0.94)
    base = recalibrate(evidence)
    own = {name: base.z[[f.name for f in base.free].index(f"speed.{name}")] for name in RUNS}
    assert max(abs(z) for z in own.values()) > speed_error.FAR
    best = searched(evidence, "speed_error").best()
    assert best is not None
    assert best.fit.hyper.novel < 0.5
    values = best.fit.values()
    for name, noted in (("slow", 50.0), ("fast", 71.0)):
        # Each run's speed is told by phases; how much of it all have in common, by priors alone.
        assert values["1.factor"] * values[f"speed.{name}"] == pytest.approx(0.94 * OWN[name] * noted, rel=2e-4)
    common = np.exp(np.mean(np.log(list(OWN.values()))))
    assert values["1.factor"] == pytest.approx(0.94 * common, rel=1e-3)


def test_speeds_within_what_was_noted_are_begun_near_it(owner: Campaign) -> None:
    situation = Situation(recalibrate(measured(owner, 1.0)), ())
    for hypothesis in speed_error.hypotheses(situation):
        assert hypothesis.starts == speed_error.STARTS
