"""Speeds that are further off than any note: phases have turned many times, and the search begins far off."""

from __future__ import annotations

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.diagnosis.catalogue import speed_error
from permway.diagnosis.catalogue._excite import with_speed
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.observations import Observations
from permway.diagnosis.recalibrate import recalibrate
from permway.laws.toml import to_toml
from searched import searched
from trains import CAMPAIGN, campaign_in, observations_of

RUNS = ("slow", "fast")
OWN = {"slow": 1.0005, "fast": 0.9992}
"""What the runs differ by themselves."""


@pytest.fixture(scope="module")
def nominal_campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
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
    stated = {**CAMPAIGN, "parameters": [*CAMPAIGN["parameters"], *speeds]}
    (folder / "campaign.toml").write_text(to_toml(stated))
    return read_campaign(folder / "campaign.toml")


def measured(nominal_campaign: Campaign, factor: float) -> Observations:
    """All runs at `factor` times what was noted, each a little off beside."""

    def amend(truth: Campaign) -> Campaign:
        for name in RUNS:
            truth = with_speed(truth, factor * OWN[name], name)
        return truth

    return observations_of(nominal_campaign, 5, amend=amend)


@pytest.mark.injection
def test_a_speed_far_off_is_found_and_measured(nominal_campaign: Campaign) -> None:
    observations = measured(nominal_campaign, 0.94)
    best = searched(observations, "speed_error").best()
    assert best is not None
    assert best.fit.hyper.novel < 0.5
    values = best.fit.values()
    for name, noted in (("slow", 50.0), ("fast", 71.0)):
        # Each run's speed is constrained by phases; how much of it all have in common, by priors alone.
        assert values["1.factor"] * values[f"speed.{name}"] == pytest.approx(0.94 * OWN[name] * noted, rel=2e-4)
    common = np.exp(np.mean(np.log(list(OWN.values()))))
    assert values["1.factor"] == pytest.approx(0.94 * common, rel=1e-3)


def test_one_run_is_begun_near_its_note_and_all_runs_also_far_from_it(nominal_campaign: Campaign) -> None:
    situation = Situation(recalibrate(measured(nominal_campaign, 1.0)), ())
    for hypothesis in speed_error.hypotheses(situation):
        alone = hypothesis.locate({"factor": 1.0}).what != "speed"
        assert hypothesis.starts == (speed_error.STARTS if alone else speed_error.WIDE)
