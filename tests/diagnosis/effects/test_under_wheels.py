"""Fasteners near wheels: in layers of their own, and by the load that the rail spreads to them."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from permway.diagnosis.catalogue import _under_wheels
from permway.errors import SolveError
from simulated import simulate


@pytest.mark.parametrize("least", [0.0, 1.0])
def test_levels_hold_every_fastener_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, least: float) -> None:
    """Also where a train stands on all of them, and none is far from a wheel."""
    campaign = simulate(tmp_path / "c", 4).campaign
    line = campaign.model.line

    def share(*_: object, **__: object) -> Any:
        return np.linspace(1.0, least, 21)

    monkeypatch.setattr(_under_wheels, "share_of_load", share)
    (condition,) = campaign.stated.conditions
    changed, levels = _under_wheels.levelled(cast(Any, campaign), ["pad"], [condition.name])
    table, before = changed.model.line.joint_table(), line.joint_table()
    np.testing.assert_array_equal(np.sort(table.x), np.sort(before.x))
    assert levels["pad"][0][0] == "pad"
    # A layer without a place could be solved, and not be written to an amended model that is read again.
    assert all(layer.at != () for layer in changed.model.line.joints)
    frequency = np.array([20.0, 90.0])
    np.testing.assert_array_equal(
        np.unique(changed.model.line.stiffness(frequency)), np.unique(line.stiffness(frequency))
    )


def test_springs_carry_what_stands_on_them_and_on_an_even_bed_as_winkler_states() -> None:
    x, wheels, rigidity, spring = np.arange(-12.0, 12.0, 0.1), np.array([-1.25, 1.25]), 6.4e6, 5e6
    carried = _under_wheels._carried(x, np.full(x.size, spring), rigidity, wheels)
    assert carried.sum() == pytest.approx(2.0, rel=1e-6)
    b = (spring / 0.1 / (4.0 * rigidity)) ** 0.25
    along = b * np.abs(x[:, None] - wheels)
    bed = 0.05 * b * (np.exp(-along) * (np.cos(along) + np.sin(along))).sum(axis=1)
    np.testing.assert_allclose(carried, bed, atol=0.01 * bed.max())
    # What is stiffer where the wheels stand draws load there.
    below = np.abs(x) < 1.5
    drawn = _under_wheels._carried(x, np.where(below, 2.0, 1.0) * spring, rigidity, wheels)
    assert drawn[below].sum() > 1.05 * carried[below].sum()


def test_springs_that_pull_hold_no_train_and_are_reported() -> None:
    """An earlier round may have given a layer a negative stiffness: no diagnosis falls over it."""
    x = np.arange(-12.0, 12.0, 0.6)
    with pytest.raises(SolveError, match=r"holds nothing: -5e\+06 N/m"):
        _under_wheels._carried(x, np.full(x.size, -5e6), 6.4e6, np.array([-1.25, 1.25]))
