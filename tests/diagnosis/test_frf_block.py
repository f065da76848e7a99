"""Deviations of frequency responses whose noise is known: they scatter as they should, about nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.gather import gather
from simulated import simulate

NOISE = 0.4
"""Of a blow, over the median response of a pair: a seventh of the estimate."""

CAMPAIGNS = 60

NO_ERROR = 1e-9
"""Of pairs and of the floor: these records have noise alone."""

Lines = tuple[np.ndarray, np.ndarray]
"""Of lines that count by their logarithm: deviations over the measured response, and their weights."""


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> Lines:
    """Of campaigns that are what their true models predict, and noise."""
    folder = tmp_path_factory.mktemp("noisy")
    found = [_noisy(folder / str(seed), seed) for seed in range(CAMPAIGNS)]
    off, weight = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return off, weight


def _noisy(folder: Path, seed: int) -> Lines:
    made = simulate(folder, seed, noise=NOISE, smooth=0.0)
    evidence = gather(made.campaign.with_values(made.truth), threads=1)
    solved = evidence.predicted(evidence.campaign)
    block = evidence.reweighed(solved).blocks[0]
    assert isinstance(block, FrfBlock)
    block = block.with_pair(NO_ERROR).with_floor(NO_ERROR)
    # Which lines are noisy is told by the prediction: by the measured ones noise would choose for itself.
    relative = block.sigma / np.abs(solved.datasets[0]["frf"].values)
    taken = (relative > 0.02) & (relative < 0.15)
    measured = block.measured[taken]
    return block.off(solved.datasets[0])[taken] / measured, block.weight[taken] * np.abs(measured)


def test_deviations_scatter_as_the_noise_does(lines: Lines) -> None:
    off, weight = lines
    squares = 0.5 * np.abs(off * weight) ** 2
    # What weighs is smoothed over five lines, which differ: a few percent more than their number tells.
    assert squares.mean() == pytest.approx(1.0, abs=0.08)


def test_noise_lifts_no_gain(lines: Lines) -> None:
    """A gain common to all lines, found by least squares, is 1 within its standard error."""
    off, weight = lines
    certain = np.sum(weight**2)
    gain = np.sum(weight**2 * off.real) / certain
    assert abs(gain) * np.sqrt(certain) < 3.0
