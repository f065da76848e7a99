"""An effect that is told in more detail where fewer numbers leave a misfit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.bases import bases
from permway.diagnosis.catalogue import support_scatter
from permway.diagnosis.catalogue._change import with_factors
from permway.diagnosis.clock import Clock
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.in_detail import NEARLY
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.search import Finalist, search
from simulated import simulate


def scattered(folder: Path, **waves: float) -> Finalist:
    """What is found of pads that differ by so many cosines."""

    def amend(campaign: Campaign) -> Campaign:
        def factors(x: np.ndarray) -> np.ndarray:
            return np.exp(sum(size * np.cos(int(name[4:]) * np.pi * x / 12.0) for name, size in waves.items()))

        return with_factors(campaign, "pad", factors)

    campaign = simulate(folder / "c", 4, noise=0.03, smooth=0.005, amend=amend).campaign
    base, searched = bases(gather(campaign, threads=1), Clock(None))
    found = search(
        searched,
        support_scatter.hypotheses(Situation(searched, ())),
        learnt_base=base,
        prefix="1.",
        threshold=lambda _ring, _screened: 10.0,
        progress=lambda *_: None,
    )
    return found.finalists[0]


def test_pads_that_differ_from_one_to_the_next_are_told_by_more_waves(tmp_path: Path) -> None:
    best = scattered(tmp_path, wave2=0.2, wave5=-0.1, wave12=0.06, wave15=-0.04)
    assert len(best.hypothesis.free) == 20
    assert best.fit.heat < NEARLY
    assert best.values["wave2"] == pytest.approx(0.2, abs=0.03)
    assert best.values["wave12"] == pytest.approx(0.06, abs=0.03)
    assert "20 half waves" in best.hypothesis.law(best.values)


def test_what_changes_slowly_is_told_by_no_more_than_it_takes(tmp_path: Path) -> None:
    best = scattered(tmp_path, wave2=0.15, wave3=-0.1)
    assert len(best.hypothesis.free) == 4


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return recalibrate(gather(simulate(tmp_path_factory.mktemp("detail") / "c", 5).campaign, threads=1))


def test_detail_begins_from_what_is_known_and_ends_with_the_pads(base: Fit) -> None:
    few, many = support_scatter.hypotheses(Situation(base, ()))
    known = {f.name: 0.1 * (-1.0) ** index for index, f in enumerate(many.free)}
    finer = many.finer(known)
    assert finer is not None
    assert [f.name for f in finer.free] == [f"wave{order}" for order in range(1, 21)]
    begun = {f.name: f.value(z) for f, z in zip(finer.free, finer.starts[0], strict=True)}
    (joints, _), (others, _) = (
        (amended.model.line.joint_table().scale, amended)
        for amended in (many.amend(base.campaign, known), finer.amend(base.campaign, begun))
    )
    np.testing.assert_allclose(joints, others, rtol=1e-12)
    # 21 pads are not told by 40 waves.
    assert finer.finer(begun) is None
    assert len((few.finer(known) or few).free) == 10
