"""Residuals of starts: by low rank where joints change, and by a solve where that fails."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import read_campaign
from permway.challenge.small.make import make_small
from permway.diagnosis.gather import gather
from permway.diagnosis.joint_changes import JointChanges
from permway.errors import SolveError
from permway.posterior.cells import cells
from permway.posterior.changes import Changes
from permway.posterior.recalibrated import recalibrated


def refused(*_: object) -> None:
    raise SolveError("the line cannot be solved")


def test_what_fails_together_is_solved_one_by_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = read_campaign(tmp_path / make_small(5150004, 0, tmp_path) / "campaign.toml")
    fit = recalibrated(gather(campaign, threads=1))
    starts = cells(fit)[:150]
    usual = Changes(fit, small=False).residuals(starts)
    monkeypatch.setattr(JointChanges, "solve", refused)
    alone = Changes(fit, small=False).residuals(starts)
    assert len(usual) == len(alone) == len(starts)
    for by_rank, by_solve in zip(usual, alone, strict=True):
        assert (by_rank is None) == (by_solve is None)
        if by_rank is not None and by_solve is not None:
            np.testing.assert_allclose(by_rank, by_solve, rtol=1e-6, atol=1e-6)
