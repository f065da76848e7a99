"""Priors that span the records: resonators over the band, starts beside nothing, sizes of many orders."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from permway.arrays import Complexes
from permway.diagnosis.catalogue._change import attached_mass
from permway.diagnosis.hypothesis import Hypothesis, Where, linear_free, log_free
from permway.posterior.spans import WIDER, tuned, widened, with_starts

BAND_HZ = (2.0, 1600.0)


def resonator() -> Hypothesis:
    """As an entry states it: about 140 Hz."""
    return Hypothesis(
        entry="rail_absorber",
        domain="path",
        family="absorber",
        free=(log_free("mass_kg", "kg", 5.0, 2.5), log_free("frequency_Hz", "Hz", 140.0, 1.9)),
        amend=lambda campaign, _: campaign,
        locate=lambda _: Where("rail"),
        starts=((-0.3, 0.0), (0.7, 1.0)),
        law=lambda _: "",
        size="mass_kg",
        none=0.0,
    )


def level() -> Hypothesis:
    """Of which an entry starts at nothing."""
    return Hypothesis(
        entry="irregularity_level",
        domain="irregularity",
        family="level",
        free=(linear_free("level_dB", "dB", 0.0, 5.0, -20.0, 20.0),),
        amend=lambda campaign, _: campaign,
        locate=lambda _: Where("irregularity"),
        starts=((0.0,),),
        law=lambda _: "",
        size="level_dB",
        none=0.0,
    )


def test_a_damper_of_any_frequency_of_the_records_has_a_start_within_a_tenth_of_an_octave() -> None:
    made = tuned(resonator(), BAND_HZ)
    begins = np.array([made.free[1].value(start[1]) for start in made.starts])
    for frequency in np.geomspace(*BAND_HZ, 200):
        assert np.abs(np.log2(begins / frequency)).min() < 0.11
    # Every size that the entry starts with, at every frequency.
    assert {start[0] for start in made.starts} == {-0.3, 0.7}
    assert len(made.starts) == 2 * len(set(begins))


def test_a_narrow_resonator_shows_at_the_nearest_start() -> None:
    """A look at small changes predicts the share of its gain that its direction has in common with a start's."""
    damped = replace(resonator(), free=(*resonator().free, log_free("loss_factor", "1", 0.05, 2.0)))
    made = tuned(replace(damped, starts=((0.0, 0.0, 0.3),)), BAND_HZ)
    lines = np.geomspace(*BAND_HZ, 400)

    def stiffness(frequency: float, loss_factor: float) -> Complexes:
        return attached_mass(1.0, frequency, loss_factor, 0.5).complex(lines, None)

    starts = [stiffness(*(made.free[i].value(start[i]) for i in (1, 2))) for start in made.starts]
    shares = []
    for frequency in np.geomspace(2.0 * BAND_HZ[0], 0.5 * BAND_HZ[1], 60):
        own = stiffness(frequency, 0.03)
        each = [np.vdot(one, own).real ** 2 / (np.vdot(one, one).real * np.vdot(own, own).real) for one in starts]
        shares.append(max(each))
    assert np.median(shares) > 0.3
    assert np.quantile(shares, 0.1) > 0.2


def test_its_frequency_is_evenly_likely_in_its_logarithm() -> None:
    value = tuned(resonator(), BAND_HZ).free[1].value
    drawn = np.log([value(z) for z in np.random.default_rng(1).standard_normal(4000)])
    share = (drawn - np.log(BAND_HZ[0])) / np.log(BAND_HZ[1] / BAND_HZ[0])
    assert share.mean() == pytest.approx(0.5, abs=0.02)
    assert share.std() == pytest.approx(12.0**-0.5, abs=0.01)


def test_what_starts_at_nothing_starts_on_either_side() -> None:
    assert with_starts(level()).starts == ((-1.0,), (1.0,))
    assert with_starts(resonator()).starts == resonator().starts


def test_sizes_span_four_times_as_many_orders_from_the_same_starts() -> None:
    before, after = resonator(), widened(resonator())
    assert after.free[0].value(0.5) == pytest.approx(before.free[0].value(0.5 * WIDER))
    for old, new in zip(before.starts, after.starts, strict=True):
        assert after.free[0].value(new[0]) == pytest.approx(before.free[0].value(old[0]))
