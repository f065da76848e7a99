"""Errors of chains that are not the same all over a line's window: what channels share of it falls."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.campaign.predictions.grid import grid_of
from permway.diagnosis.blocks_spectra import TORN, SpectraBlock
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.gather import gather
from searched import weighed_by
from trains import campaign_in, drawn

DELAY_S = 1e-5


def test_a_spectrum_that_turns_is_off_its_line_by_the_slope_of_the_windows_correlation() -> None:
    """Of exp((a - i t) x) about a line, by a second way: the derivative of what the window makes of it."""
    grid = grid_of(np.arange(0.25, 30.25, 0.25), np.arange(6.0, 20.0), 1.0)
    away = grid.frequency_Hz[None, :] - grid.estimate_Hz[:, None]

    def seen(exponent: complex) -> np.ndarray:
        return np.asarray((grid.smear.toarray() * np.exp(exponent * away)).sum(axis=1))

    for exponent in (0.3 + 0.0j, -0.2 - 1.3j, 0.05 + 2.4j):
        slope = (seen(exponent + 1e-5) - seen(exponent - 1e-5)) / 2e-5
        found = (grid.away.smear @ np.exp(exponent * grid.frequency_Hz)) / np.exp(exponent * grid.estimate_Hz)
        np.testing.assert_allclose(found, slope, rtol=1e-6)


@pytest.mark.parametrize("channel", ["axle2", "axle3", "floor"])
def test_a_chain_that_is_late_alters_what_channels_share_as_its_slope_states(tmp_path: Path, channel: str) -> None:
    """A delay's phase grows from line to line. Predicted anew with it, parts change as their answers to it say."""
    nominal_campaign = campaign_in(tmp_path)
    observations = gather(nominal_campaign, drawn(nominal_campaign, 5), threads=1)
    observations = weighed_by(observations, nominal_campaign)
    late = observations.predicted(
        with_chain(
            nominal_campaign,
            channel,
            nominal_campaign.sensor(channel).chain.model_copy(update={"delay_s": DELAY_S}),
        )
    )
    before = observations.predicted(nominal_campaign)
    seen = 0
    for block, old, new in zip(observations.blocks, before.datasets, late.datasets, strict=True):
        if not isinstance(block, SpectraBlock):
            continue
        moved = block.moved
        changed = [
            after - now
            for now, after in zip(
                *(moved.logarithms(one["csd"].values[:, :, block._lines]) for one in (old, new)), strict=True
            )
        ]
        names = [str(name) for name in block.dataset.data["channel"].values]
        turned = -2j * np.pi * DELAY_S * np.eye(len(names), dtype=np.complex128)[names.index(channel)]
        itself, more = moved.answers(turned, 0.0 * turned), moved.answers(0.0 * turned, turned)
        for (what, c, o, at, _), value, rate, true in zip(block._parts, itself, more, changed, strict=True):
            expected = value * block.frequency[at] + rate / block.dataset.record.segment_s
            if what == "rest" and channel in (names[c], names[o]) and np.abs(true).max() > 1e-5:
                # Phases alone change nothing here; how they grow does.
                assert np.abs(value).max() * block.frequency.max() < 0.01 * np.abs(true).max()
                np.testing.assert_allclose(expected.real, true.real, atol=0.02 * np.abs(true).max())
                seen += 1
            elif what == "transfer":
                np.testing.assert_allclose(expected.imag, true.imag, atol=0.02 * np.abs(true).max() + 1e-9)
    assert seen > 1


def test_what_is_torn_is_what_smooth_errors_of_one_and_a_half_decibels_tear_in_the_mean() -> None:
    """Two channels' errors of an octave's length, drawn within Hann's window: the variance of their difference."""
    random, size = np.random.default_rng(1), 1.5 / 8.686
    away = np.arange(-3.9, 4.0, 1.0 / 16.0)
    window = (np.sinc(away) + 0.5 * (np.sinc(away - 1.0) + np.sinc(away + 1.0))) ** 2
    window = window[:, None] / window.sum()
    for line in (6.0, 12.0, 24.0):
        octaves = np.log2(line + away)
        correlation = np.exp(-0.5 * (octaves[:, None] - octaves) ** 2) + 1e-9 * np.eye(away.size)
        root = size * np.linalg.cholesky(correlation)
        normal = random.standard_normal((4, away.size, 4000))
        # Level and phase of either.
        difference = root @ (normal[0] - normal[1]) + 1j * (root @ (normal[2] - normal[3]))
        torn = (window * np.abs(difference - (window * difference).sum(axis=0)) ** 2).sum(axis=0)
        assert torn.mean() * line**2 == pytest.approx(TORN, rel=0.1)
