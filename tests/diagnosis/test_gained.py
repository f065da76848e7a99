"""What an amendment gains is none of what learning on, integrating out, or one error of a chain would give."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis.fit import Fit, gained
from permway.diagnosis.gather import gather
from permway.diagnosis.heldout import Rest, at_fault, gains
from permway.diagnosis.recalibrate import recalibrate
from simulated import simulate


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return recalibrate(gather(simulate(tmp_path_factory.mktemp("base") / "c", 3).campaign, threads=1))


def test_sizes_that_are_merely_better_learnt_gain_nothing(base: Fit) -> None:
    off = {name: 4.0 * size for name, size in base.evidence.sizes.items()}
    worse = recalibrate(base.evidence.with_sizes(off), start=base.z, learn=False, reweigh=False)
    assert worse.objective - base.objective > 5.0
    assert gained(worse, base) == pytest.approx(0.0, abs=0.5)
    assert gained(base, base) == pytest.approx(0.0, abs=1e-6)


def test_the_size_of_pairs_errors_is_found_whatever_the_chains_do(tmp_path: Path) -> None:
    """The simulated pairs have no error of their own; the chains' are of 0.02 and of 0.1 neper."""
    for smooth in (0.02, 0.1):
        fit = recalibrate(gather(simulate(tmp_path / str(smooth), 3, smooth=smooth).campaign, threads=1))
        (block,) = fit.evidence.blocks
        assert block.pair < 0.003  # type: ignore[attr-defined]


def test_densities_of_what_was_left_out_add_up_to_that_of_all(base: Fit) -> None:
    """Part given the rest, and the rest given the part: each with its marginal is the whole."""
    rest = Rest(base)
    rows = np.isin(base.evidence.rows.sensor, ["deck@3"])
    one, other = rest.scored(rows), rest.scored(~rows)
    whole, _ = rest._evidence(rest._whole, base.deviations, base.z)
    for part, scored in ((rows, one), (~rows, other)):
        volume = rest._whole.log_determinant - rest._of(~part).log_determinant + float(rest._volume[part].sum())
        z, deviations, _ = rest.fitted(~part)
        alone, _ = rest._evidence(rest._of(~part), deviations * ~part, z, ~part)
        assert -2.0 * scored.log_density == pytest.approx(whole - alone + volume, abs=1e-6)
        # More records never make what is known less likely than chance alone would.
        assert whole > alone


def test_what_is_left_out_of_a_channel_at_fault_is_of_that_channel(base: Fit) -> None:
    (part,) = at_fault(base.evidence, ("deck@3",))
    rows = base.evidence.rows
    assert set(rows.sensor[part.rows]) == {"deck@3"}
    mine = rows.frequency_Hz[rows.sensor == "deck@3"]
    assert rows.frequency_Hz[part.rows].min() > np.sqrt(mine.min() * mine.max())
    assert list(at_fault(base.evidence, ("no such channel",))) == []


def test_a_gain_has_the_standard_error_of_two_normal_densities(base: Fit) -> None:
    """Means a shift apart: the log ratio is half its square, give or take the shift."""
    random = np.random.default_rng(1)
    shift = 3.0
    drawn = shift + random.standard_normal(200_000)
    ratio = 0.5 * (drawn**2 - (drawn - shift) ** 2)
    assert ratio.std() == pytest.approx(np.sqrt(2.0 * ratio.mean()), rel=0.02)
    (part,) = at_fault(base.evidence, ("deck@3",))
    quiet = {
        name: (0.25 * size if name == "sensor deck@3" else size) for name, size in base.evidence.sizes.items()
    }
    before, after = Rest(base), Rest(replace(base, evidence=base.evidence.with_sizes(quiet)))
    (one,) = gains(before, after, [part])
    assert one.nats != 0.0
    assert one.standard_error == pytest.approx(np.sqrt(2.0 * abs(one.nats)))
