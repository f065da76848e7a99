"""Rods in place of joints: what they go over to, and a stretch of them that is found."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis import describe
from permway.diagnosis.catalogue._change import with_law
from permway.diagnosis.catalogue._interval import stations_of, weakened
from permway.diagnosis.clock import Clock
from permway.diagnosis.crossed import Loss, with_rods
from permway.diagnosis.diagnose import diagnose
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Where
from permway.laws import Tabulated
from simulated import simulate


def responses(campaign: Campaign) -> np.ndarray:
    """Logarithms of what the hammer's sensors answer."""
    evidence = gather(campaign, threads=1)
    return evidence.deviations(evidence.predicted(campaign).datasets)


def rods(campaign: Campaign, *, share: float = 1.0, delay_s: float = 1e-7) -> Campaign:
    """All pads, or a share of each, as rods of a pad's stiffness and loss."""
    shares = np.full(stations_of(campaign.model.line, "pad").size, share)
    return with_rods(campaign, "pad", shares, stiffness=3e7, delay_s=delay_s, loss=0.15)


@pytest.mark.parametrize("share", [1.0, 0.4])
def test_a_rod_without_mass_is_the_joint_that_it_replaces(tmp_path: Path, share: float) -> None:
    campaign = simulate(tmp_path / "c", 8).campaign
    same = responses(rods(campaign, share=share))
    np.testing.assert_allclose(same, responses(campaign), atol=1e-6 * np.abs(same).max())


def test_a_slow_rod_is_none(tmp_path: Path) -> None:
    campaign = simulate(tmp_path / "c", 8).campaign
    other = responses(rods(campaign, delay_s=3e-3)) - responses(campaign)
    assert np.abs(other).max() > 10.0


def soft(campaign: Campaign) -> Campaign:
    """Four pads that keep a twentieth of their stiffness, as rods that a wave takes 3 ms to cross."""
    x = stations_of(campaign.model.line, "pad")
    share = ((x > 6.3) & (x < 8.7)).astype(float)
    return with_rods(campaign, "pad", share, stiffness=1.5e6, delay_s=3e-3, loss=0.15)


def test_a_soft_layer_that_delays_is_no_loss_of_support(tmp_path: Path) -> None:
    verdict = diagnose(simulate(tmp_path / "c", 8, amend=soft).campaign, threads=1).verdict
    (effect,) = verdict.effects
    assert (verdict.status, effect.name, effect.place.joint) == ("described", None, "pad")
    assert "delay" in effect.law.words
    assert effect.place.x == pytest.approx((6.6, 8.4), abs=0.4)
    said = {name: (p.low, p.high) for name, p in effect.parameters.items()}
    for name, true in (("stiffness_N_per_m", 1.5e6), ("delay_s", 3e-3)):
        low, high = said[name]
        assert low is not None
        assert high is not None
        assert low <= true <= high


def lost(campaign: Campaign) -> Campaign:
    """The same pads, of which a twentieth is left."""
    return weakened(campaign, "pad", 7.5, 1.8, 0.05)


def test_a_loss_of_support_keeps_its_name(tmp_path: Path) -> None:
    verdict = diagnose(simulate(tmp_path / "c", 8, amend=lost).campaign, threads=1).verdict
    assert (verdict.status, [e.name for e in verdict.effects]) == ("named", ["fastener_loss"])


@pytest.mark.parametrize(("what", "tried"), [("pad", True), ("deck", False)])
def test_rods_take_the_place_of_joints_and_of_nothing_else(
    monkeypatch: pytest.MonkeyPatch, what: str, tried: bool
) -> None:
    """A cracked girder has lost stiffness over a stretch, too."""
    line = SimpleNamespace(laws={"pad": None})
    base = SimpleNamespace(campaign=SimpleNamespace(model=SimpleNamespace(line=line)))
    offered: list[Any] = []
    monkeypatch.setattr(describe.crossed, "over_stretch", lambda _, losses: offered.extend(losses))
    monkeypatch.setattr(describe.Description, "_held", lambda *_: None)
    description = describe.Description(cast(Any, base), cast(Any, base), (), Clock(None))
    one = SimpleNamespace(
        values={"centre_m": 5.0, "length_m": 1.0, "factor": 0.1},
        hypothesis=SimpleNamespace(locate=lambda _: Where(what, (4.5, 5.5))),
        fit=SimpleNamespace(heat=2.0),
    )
    rounds = [SimpleNamespace(threshold=10.0)]
    assert description._crossed(cast(Any, rounds), cast(Any, [one])) is None
    assert [loss.law for loss in offered] == (["pad"] if tried else [])


def test_a_law_that_is_no_stiffness_at_low_frequency_is_left_alone(tmp_path: Path) -> None:
    """A table may begin at 5 Hz."""
    campaign = simulate(tmp_path / "c", 8).campaign
    known = cast(Any, SimpleNamespace(campaign=campaign))
    assert len(list(describe.crossed.at_joint(known, "pad", 7.0))) == 2
    table = Tabulated(frequency_Hz=(5.0, 300.0), storage=(3e7, 3e7), loss_factor=(0.1, 0.1))
    later = cast(Any, SimpleNamespace(campaign=with_law(campaign, "pad", table)))
    assert list(describe.crossed.at_joint(later, "pad", 7.0)) == []
    assert list(describe.crossed.over_stretch(later, [Loss("pad", 7.0, 1.0, 0.1)])) == []
