"""Fasteners near wheels in layers of their own: the same track, until a train changes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from permway.diagnosis.catalogue import _under_wheels
from simulated import simulate


@pytest.mark.parametrize("least", [0.0, 1.0])
def test_levels_hold_every_fastener_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, least: float) -> None:
    """Also where a train stands on all of them, and none is far from a wheel."""
    campaign = simulate(tmp_path / "c", 4).campaign
    line = campaign.model.line

    def share(*_: object, **__: object) -> Any:
        return np.linspace(1.0, least, 21)

    monkeypatch.setattr(_under_wheels, "share_of_load", share)
    (condition,) = campaign.said.conditions
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
