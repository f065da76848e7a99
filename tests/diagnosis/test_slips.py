"""How much of a further effect may be how the first was idealised, where the further one shows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis.gather import gather
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.refit import moved
from permway.diagnosis.slips import SLIP, gain_by_cell, mended
from simulated import simulate


@pytest.mark.parametrize(
    ("further", "share"),
    [
        # It shows where the first shows, where the first does not, and half and half.
        ([20.0, 0.0], 1.0),
        ([50.0, 0.0], SLIP * 1000.0 / 50.0),
        ([0.0, 50.0], SLIP * 10.0 / 50.0),
        ([25.0, 25.0], (25.0 + SLIP * 10.0) / 50.0),
        # What a record loses tells nothing.
        ([-20.0, 50.0], SLIP * 10.0 / 50.0),
        # By priors alone.
        ([0.0, -3.0], 1.0),
    ],
)
def test_a_further_effect_is_held_against_the_first_where_it_shows(further: list[float], share: float) -> None:
    first, second = (np.array([gains]) for gains in ([1000.0, 10.0], further))
    assert mended(first, second) == pytest.approx(share)
    assert mended(first.T, second.T) == pytest.approx(share)


def test_at_one_place_octaves_do_not_tell_two_effects_apart() -> None:
    first, further = np.array([[1000.0, 0.0], [0.0, 0.0]]), np.array([[0.0, 20.0], [0.0, 0.0]])
    assert mended(first, further) == 0.0
    assert mended(first, further, one_place=True) == 1.0
    assert mended(first, further[::-1], one_place=True) == 0.0


def test_what_records_gain_adds_up_to_what_the_quadratic_form_gains(tmp_path: Path) -> None:
    fit = recalibrate(gather(simulate(tmp_path / "c", 4).campaign, threads=1))
    off = moved(fit, {fit.free[0].name: float(fit.z[0]) + 1.0})
    found = gain_by_cell(off, fit)
    assert found.shape[0] == len(fit.evidence.blocks)
    assert found.shape[1] > 4
    assert found.sum() == pytest.approx(off.chi2 - fit.chi2, rel=1e-6)
    assert found.sum() > 0.0
    # What one sensor tells, and what the others do.
    names = sorted(set(fit.evidence.rows.sensor.tolist()))
    parts = [gain_by_cell(off, fit, [name]) for name in names]
    assert len(parts) > 1
    np.testing.assert_allclose(sum(parts), found, rtol=1e-9, atol=1e-9 * np.abs(found).max())
