"""How much an amendment changes what is predicted."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue import pad_frequency
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._relaxing import relaxing
from permway.diagnosis.felt import FELT, changed, moved
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.search import search
from simulated import simulate


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return recalibrate(gather(simulate(tmp_path_factory.mktemp("felt") / "c", 5).campaign, threads=1))


def test_the_sensor_that_changes_most_counts(base: Fit) -> None:
    assert moved(base, base, "path") == pytest.approx(0.0, abs=1e-12)

    def louder(values: Mapping[str, float]) -> Campaign:
        campaign = base.build(values)
        chain = campaign.sensor("deck@3").chain
        return with_chain(campaign, "deck@3", chain.model_copy(update={"gain": 1.05}))

    amended = recalibrate(base.evidence, build=louder, free=base.free, start=base.z, learn=False, most_steps=0)
    assert moved(base, amended, "path") == pytest.approx(np.log(1.05), rel=1e-6)


def test_of_what_excites_one_line_is_felt(base: Fit) -> None:
    """A wheel out of round shows at a line of hundreds, and nothing of the structure looks so."""
    before = base.evidence.predicted(base.campaign).datasets
    after = [one.copy(deep=True) for one in before]
    after[0]["frf"][0, 0, 7] *= 1.1
    count = after[0]["frf"][0].size
    for domain, expected in (("path", np.log(1.1) / np.sqrt(count)), ("irregularity", np.log(1.1))):
        assert changed(base.evidence, before, after, domain) == pytest.approx(expected, rel=1e-6)


def test_what_nobody_would_feel_is_no_finalist_however_sure(tmp_path: Path) -> None:
    """A springpot of four in a thousand, in records without errors: a sure gain, and next to no change."""

    def slight(campaign: Campaign) -> Campaign:
        return relaxing(campaign, "pad", stiffness_factor=1.0, order=0.5, share=0.004, rest=1.0)

    campaign = simulate(tmp_path / "c", 6, noise=1e-4, smooth=1e-6, amend=slight).campaign
    fit = recalibrate(gather(campaign, threads=1))
    found = search(
        fit,
        pad_frequency.hypotheses(Situation(fit, ())),
        learnt_base=fit,
        prefix="1.",
        threshold=lambda _ring, _screened: -1e9,
        progress=lambda *_: None,
    )
    assert found.followed
    assert all(moved(fit, finalist.fit, finalist.hypothesis.domain) > FELT for finalist in found.finalists)
    assert not found.finalists
