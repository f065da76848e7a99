"""Deviations of frequency responses whose noise is known: they scatter as they should, about nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.gather import gather
from permway.recordings.channel import Chain
from simulated import simulate

NOISE = 0.4
"""Of a blow, over the median response of a pair: a seventh of the estimate."""

CAMPAIGNS = 60

NO_ERROR = 1e-9
"""Of pairs and of the floor: these records have noise alone."""

Lines = tuple[np.ndarray, np.ndarray]
"""Of lines that count by their logarithm: residuals over the measured response, and their weights."""


@pytest.fixture(scope="module")
def lines(tmp_path_factory: pytest.TempPathFactory) -> Lines:
    """Of campaigns that are what their true models predict, and noise."""
    folder = tmp_path_factory.mktemp("noisy")
    found = [_noisy(folder / str(seed), seed) for seed in range(CAMPAIGNS)]
    off, weight = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return off, weight


def _noisy(folder: Path, seed: int) -> Lines:
    made = simulate(folder, seed, noise=NOISE, smooth=0.0)
    observations = gather(made.campaign.with_values(made.truth), threads=1)
    solved = observations.predicted(observations.campaign)
    block = observations.blocks[0]
    assert isinstance(block, FrfBlock)
    block = block.with_reference(solved.datasets[0], np.zeros(block.measured.shape, dtype=np.complex128))
    block = block.with_pair(NO_ERROR).with_floor(NO_ERROR)
    # Which lines are noisy is decided by the prediction: by the measured ones noise would choose for itself.
    relative = block.sigma / np.abs(solved.datasets[0]["frf"].values)
    taken = (relative > 0.02) & (relative < 0.15)
    measured = block.measured[taken]
    return block.off(solved.datasets[0])[taken] / measured, block.weight[taken] * np.abs(measured)


def test_deviations_scatter_as_the_noise_does(lines: Lines) -> None:
    off, weight = lines
    squares = 0.5 * np.abs(off * weight) ** 2
    # What weighs is smoothed over five lines, which differ: a few percent more than their number gives.
    assert squares.mean() == pytest.approx(1.0, abs=0.08)


def test_noise_lifts_no_gain(lines: Lines) -> None:
    """A gain common to all lines, found by least squares, is 1 within its standard error."""
    off, weight = lines
    certain = np.sum(weight**2)
    gain = np.sum(weight**2 * off.real) / certain
    assert abs(gain) * np.sqrt(certain) < 3.0


def test_a_large_error_of_a_chain_is_the_same_where_noise_hides_the_response(tmp_path: Path) -> None:
    """A gain of 0.6: a logarithm of -0.51, and a difference of -0.4."""
    gain, errors = 0.6, np.zeros((2, 3, 1), dtype=np.complex128)
    errors[1] = np.log(gain)

    def weak(campaign: Campaign) -> Campaign:
        return with_chain(campaign, "deck@3", Chain(gain=gain))

    pulls = []
    for seed in range(40):
        made = simulate(tmp_path / str(seed), seed, noise=3.0, smooth=0.0, amend=weak)
        observations = gather(made.campaign.with_values(made.truth), threads=1)
        solved = observations.predicted(observations.campaign)
        plain = observations.blocks[0]
        assert isinstance(plain, FrfBlock)
        model = solved.datasets[0]["frf"].values[1]
        hidden = plain.sigma[1] > 0.4 * np.abs(model)
        for block in (plain, plain.with_reference(solved.datasets[0], errors)):
            # The error by least squares over the lines that noise hides, over its standard error.
            weight = block.weight[1][hidden]
            there = model[hidden] * np.exp(errors[1, 0, 0] if block is not plain else 0.0)
            certain = np.sum((weight * np.abs(there)) ** 2)
            off = block.off(solved.datasets[0])[1][hidden]
            found = np.sum(weight**2 * (off * there.conj()).real) / certain
            pulls.append((found - np.log(gain)) * np.sqrt(certain))
    by_difference, about = np.array(pulls).reshape(-1, 2).T
    assert abs(np.mean(about)) * np.sqrt(about.size) < 3.0
    assert np.mean(by_difference) * np.sqrt(about.size) > 6.0


@pytest.mark.parametrize("off", [0.15, -0.2, 0.2j, -0.15 + 0.15j])
def test_what_smooth_errors_undo_leaves_nothing_where_noise_hides_the_response(
    tmp_path: Path, off: complex
) -> None:
    """A delay, or a gain, that errors of a chain take back, beside an error of a chain of 2.4 dB and 0.1 rad."""
    made = simulate(tmp_path, 3, noise=3.0, smooth=0.0)
    observations = gather(made.campaign.with_values(made.truth), threads=1)
    solved = observations.predicted(observations.campaign).datasets[0]
    errors = np.full((2, 3, 1), 0.276 + 0.1j)
    block = observations.blocks[0].with_reference(solved, errors)
    assert isinstance(block, FrfBlock)
    hidden = block._hidden
    assert hidden.mean() > 0.3
    both = {name: solved[name].values * np.exp(off) for name in ("frf", "chain")}
    turned = solved.copy(data={"noise_factor": solved["noise_factor"].values, **both})
    undone = block.off(turned)[hidden] + off * block._there[hidden]
    # To the second order; by the third is left what the fits' next reference takes.
    left = np.abs(undone - block.off(solved)[hidden]) / np.abs(block._there[hidden])
    assert left.max() < 0.4 * abs(off) ** 2
    assert left.max() < 0.012
