"""Fits again."""

from __future__ import annotations

import numpy as np
import pytest
from permway.diagnosis import refit
from permway.diagnosis.evidence import Evidence, Solved
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.learning import learnt
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.refit import moved, relearnt
from simulated import simulate


@pytest.fixture(scope="module")
def fit(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return recalibrate(gather(simulate(tmp_path_factory.mktemp("one") / "c", 4).campaign, threads=1))


def test_learning_that_leads_to_what_is_worse_is_not_kept(fit: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    def astray(evidence: Evidence, solved: Solved) -> tuple[Evidence, float]:
        found, change = learnt(evidence, solved)
        return found.with_sizes({name: 4.0 * size for name, size in found.sizes.items()}), change

    monkeypatch.setattr(refit, "learnt", astray)
    assert recalibrate(astray(fit.evidence, fit.evidence.predicted(fit.campaign))[0], learn=False).objective > (
        fit.objective + 1.0
    )
    kept = relearnt(fit, fit.evidence)
    assert kept.objective <= fit.objective
    assert kept.evidence is fit.evidence


def test_what_is_moved_stays_there_and_its_slopes_are_of_there(fit: Fit) -> None:
    name = fit.free[0].name
    off = moved(fit, {name: 2.5})
    assert off.z[0] == 2.5
    assert np.array_equal(off.z[1:], fit.z[1:])
    assert off.objective > fit.objective
    step = 1e-4
    nearby = moved(fit, {name: 2.5 + step})
    slope = (nearby.deviations - off.deviations) / step
    assert np.abs(off.jacobian[:, 0] - slope).max() < 1e-3 * np.abs(slope).max()


def test_what_is_forgotten_is_made_again(fit: Fit) -> None:
    """Rivals keep what they are told by, and none of what takes their smooth errors out."""
    evidence = fit.evidence.with_sizes(fit.evidence.sizes)
    before = evidence.whitener.square(fit.deviations)
    evidence.forget()
    assert "whitener" not in evidence.__dict__
    assert "columns" not in evidence.__dict__
    assert evidence.whitener.square(fit.deviations) == before
