"""Parameters of a structure whose stiffnesses are no constants: they come out wrong by what is said."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.idealised import APART, OFF, STEP, _hump, _parts, idealised
from permway.diagnosis.nearby import Nearby
from permway.diagnosis.recalibrate import recalibrate
from simulated import FREQUENCY, simulate

DRAWS = 12


def test_a_share_at_all_frequencies_is_a_parameter_moved(tmp_path: Path) -> None:
    campaign: Campaign = simulate(tmp_path / "c", 3).campaign
    evidence = gather(campaign, threads=1)
    plain = evidence.predicted(campaign)
    nearby, values = Nearby(evidence, plain), campaign.parameters.nominal()
    for name, part, index in (("pad.k", "law", 0), ("bearing.k", "law", 1), ("deck.E", "beam", 1)):
        bent = nearby.bent(part, [index], lambda frequency: np.full(frequency.size, 1e-5))  # type: ignore[arg-type]
        assert bent is not None
        solved = evidence.predicted(campaign.with_values({**values, name: values[name] * (1.0 + 1e-5)}))
        found, right = (s.datasets[0]["frf"].values - plain.datasets[0]["frf"].values for s in (bent, solved))
        assert np.linalg.norm(found - right) < 1e-3 * np.linalg.norm(right), name


def _refit(evidence: Evidence, frf: np.ndarray) -> Fit:
    """To other responses, weighed alike."""
    dataset = evidence.datasets[0]
    measured = dataset.data.assign(frf=(dataset.data["frf"].dims, frf))
    return recalibrate(evidence.of(evidence.campaign, [replace(dataset, data=measured)]))


def test_parameters_come_out_wrong_by_as_much_as_is_said(tmp_path: Path) -> None:
    """Every law and every body off by humps of the size that is taken, many times as large as noise and errors."""
    made = simulate(tmp_path / "c", 4, noise=1e-4, smooth=0.0)
    campaign = made.campaign
    evidence = gather(campaign.with_values(made.truth), threads=1)
    solved = evidence.predicted(evidence.campaign)
    nearby, plain = Nearby(evidence, solved), solved.datasets[0]["frf"].values
    fit = recalibrate(evidence)
    sigma = np.sqrt(idealised(fit))
    random, pulls = np.random.default_rng(5), []
    for _ in range(DRAWS):
        moved = np.zeros_like(plain)
        for part, indices in _parts(campaign.model.line):
            for centre in np.arange(np.log2(FREQUENCY[0]), np.log2(FREQUENCY[-1]) + APART, APART):
                bent = nearby.bent(part, indices, partial(_hump, centre=float(centre)))
                assert bent is not None
                size = OFF[part] / STEP * random.standard_normal()
                moved += size * (bent.datasets[0]["frf"].values - plain)
        pulls.append((_refit(evidence, plain + moved).z - _refit(evidence, plain).z) / sigma)
    assert np.sqrt(np.mean(np.array(pulls) ** 2)) == pytest.approx(1.0, abs=0.3)
