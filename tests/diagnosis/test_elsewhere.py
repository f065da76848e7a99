"""Of two bearings the softer one, or the other that is stiffer; the verdict states where records leave both."""

from __future__ import annotations

from pathlib import Path

import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._change import with_factors
from permway.posterior.diagnose import diagnose
from simulated import simulate


def softer_at_the_right(campaign: Campaign) -> Campaign:
    return with_factors(campaign, "bearing", lambda x: 1.0 - 0.38 * (x > 6.0))


@pytest.mark.xfail(
    strict=True,
    raises=AssertionError,
    reason="the place is that of the most probable set alone: another that explains as much is not in it",
)
@pytest.mark.parametrize("seed", [3, 5])
def test_the_place_holds_both_bearings_and_words_name_either(tmp_path: Path, seed: int) -> None:
    case = simulate(tmp_path / "c", seed, amend=softer_at_the_right)
    (effect,) = diagnose(case.campaign, threads=1).verdict.effects
    assert effect.name == "bearing_stiffness"
    assert effect.place.within == pytest.approx((0.0, 12.0))
    assert "or, hardly told apart by these records, bearing at" in effect.law.words
