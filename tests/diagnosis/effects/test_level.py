"""A line much rougher than its owner says: recalibration takes it up, and the verdict names it all the same."""

from __future__ import annotations

from pathlib import Path

import pytest
from permway.campaign.campaign import read_campaign
from permway.diagnosis.catalogue._excite import with_irregularity
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.level import beyond
from permway.diagnosis.recalibrate import UNFIT, recalibrate
from permway.laws.toml import to_toml
from trains import CAMPAIGN, campaign_in, drawn

THRESHOLD = 10.0


@pytest.fixture(scope="module", params=[-7.0, -2.0, 0.0, 2.5, 6.0])
def fitted(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[float, Fit]:
    """The true level, dB, and the base."""
    owner = campaign_in(Path(tmp_path_factory.mktemp("level")))
    truth = with_irregularity(owner, level_dB=request.param)
    return request.param, recalibrate(gather(owner, drawn(truth, 11), threads=1))


def test_the_level_is_an_effect_where_nobody_would_believe_it(fitted: tuple[float, Fit]) -> None:
    true, fit = fitted
    assert fit.heat < UNFIT
    effect = beyond(fit, THRESHOLD)
    if abs(true) < 3.0:
        assert effect is None
        return
    assert effect is not None
    assert (effect.domain, effect.name) == ("irregularity", "irregularity_level")
    level = effect.parameters["level_dB"]
    assert level.low is not None
    assert level.high is not None
    assert level.low <= true <= level.high
    assert level.high - level.low < 1.5
    # The owner's word draws the base's own level nearer.
    assert abs(fit.values()["level"]) < abs(level.value)
    assert beyond(fit, 60.0) is None


def test_a_campaign_without_such_a_parameter_has_no_such_effect(tmp_path: Path) -> None:
    owner = campaign_in(tmp_path)
    plain = {**CAMPAIGN, "parameters": CAMPAIGN["parameters"][:2]}
    (tmp_path / "campaign.toml").write_text(to_toml(plain))
    truth = with_irregularity(owner, level_dB=7.0)
    assert beyond(recalibrate(gather(read_campaign(tmp_path / "campaign.toml"), drawn(truth, 11))), 0.0) is None
