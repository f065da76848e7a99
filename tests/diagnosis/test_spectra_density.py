"""Density of a run's cross spectra: right in mean and scatter for few averages, and no gain favoured."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.errors import InputError

LINES = np.arange(2.0, 602.0)


def csd(values: np.ndarray, averages: float) -> xr.Dataset:
    names = ["a", "b"]
    coordinates = {"channel": names, "channel2": names, "frequency": LINES}
    return xr.Dataset({"csd": (("channel", "channel2", "frequency"), values)}, coordinates, {"averages": averages})


def truth(gain: float = 1.0, coherence: float = 0.5) -> np.ndarray:
    """Of two channels, the second `gain` times a tenth of the first and its own."""
    shared = np.sqrt(coherence) * np.exp(0.7j)
    one = np.array([[1.0, 0.1 * gain * np.conj(shared)], [0.1 * gain * shared, (0.1 * gain) ** 2]])
    return np.repeat(one[:, :, None], LINES.size, axis=2)


def measured(averages: int, seed: int, coherence: float = 0.5) -> np.ndarray:
    """Estimates of it, complex Wishart."""
    root = np.linalg.cholesky(truth(coherence=coherence)[:, :, 0])
    parts = np.random.default_rng(seed).standard_normal((2, LINES.size, 2, averages)) / np.sqrt(2.0)
    seen = root @ (parts[0] + 1j * parts[1])
    return np.moveaxis(seen @ np.conj(np.swapaxes(seen, 1, 2)) / averages, 0, 2)


def block(averages: int, seed: int, coherence: float = 0.5) -> SpectraBlock:
    dataset = SimpleNamespace(
        data=csd(measured(averages, seed, coherence), averages),
        record=SimpleNamespace(name="run", segment_s=2.0),
        condition=SimpleNamespace(speed_m_per_s=None),
    )
    expected = csd(truth(coherence=coherence), averages)
    return SpectraBlock(cast(Any, dataset), expected, added=np.zeros((2, 2, LINES.size)), floor=0.0)


def test_lines_within_the_window_s_reach_of_zero_are_not_used() -> None:
    """In segments of 2 s it reaches over 2 Hz: so does the line at 2 Hz to zero, and is the first that is used."""
    one = block(14, 3)
    assert one.frequency.tolist() == LINES[::2].tolist()
    first = one.dataset.data.isel(frequency=slice(0, 1)).assign_coords(frequency=[1.5])
    near = SimpleNamespace(data=first.assign_attrs(averages=14.0), record=one.dataset.record)
    with pytest.raises(InputError, match=r"run: has no line .*got 'up to 1.5 Hz.*; give a longer segment_s"):
        SpectraBlock(cast(Any, near), first, added=np.zeros((2, 2, 1)))


@pytest.mark.parametrize("averages", [4, 14, 120])
def test_deviations_from_the_truth_have_mean_zero_and_unit_variance(averages: int) -> None:
    found = [block(averages, seed) for seed in range(20)]
    residuals = np.array([one.residuals(one._expected) for one in found])
    # Every second line, of which there are three hundred: power, transfer twice, rest.
    for part in np.split(residuals, 4, axis=1):
        assert part.mean() == pytest.approx(0.0, abs=0.06)
        assert np.sqrt(np.mean(part**2)) == pytest.approx(1.0, abs=0.1)


def test_where_noise_is_large_no_gain_is_better_than_the_right_one() -> None:
    """A model that says more does not scatter more: the sum of squares is least at the truth."""
    for coherence in (0.15, 0.5):
        best = []
        gains = np.linspace(0.7, 1.5, 81)
        for seed in range(10):
            one = block(14, seed, coherence)
            squares = [np.sum(one.residuals(csd(truth(gain, coherence), 14)) ** 2) for gain in gains]
            best.append(gains[int(np.argmin(squares))])
        assert np.mean(best) == pytest.approx(1.0, abs=0.02)


def test_chains_errors_act_on_what_moves_and_not_on_hum() -> None:
    """What a calibration error does to a line is as much as of its power moves: half of it, then none."""
    plain, moving = block(14, 3), truth()
    hum = np.zeros_like(moving.real)
    hum[:, :, 20], hum[:, :, 40] = moving[0, 0, 20].real * np.ones((2, 2)), 1e9 * np.ones((2, 2))
    expected = csd(moving + hum, 14)
    hummed = SpectraBlock(plain.dataset, expected, added=hum, floor=0.0)
    # The root's power comes first in the rows, and the first channel's gain in the columns.
    before, after = (one.calibration.columns.matrix[: one.frequency.size] for one in (plain, hummed))
    share = np.abs(after).max(axis=1) / np.abs(before).max(axis=1)
    expected_share = np.ones(plain.frequency.size)
    expected_share[10], expected_share[20] = 0.5, 0.0
    np.testing.assert_allclose(share, expected_share, atol=1e-3)


def test_too_few_averages_are_refused() -> None:
    with pytest.raises(InputError, match=r"run: has fewer than 3 averages.*segment_s"):
        block(2, 1)
