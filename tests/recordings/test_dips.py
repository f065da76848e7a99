"""Dips of the rail at places that do not repeat: their density against a rail that was laid."""

from __future__ import annotations

import numpy as np
import pytest
from permway.campaign.excitation import Dips
from scipy.signal import welch

WELDS = Dips(depth_m=6e-4, length_m=0.5, every_m=18.0)


def test_a_rail_with_dips_at_random_has_their_density() -> None:
    step, length = 0.02, 60_000.0
    x = np.arange(0.0, length, step)
    profile = np.zeros(x.size)
    shape_at = np.arange(-0.25, 0.25 + 1e-9, step)
    shape = 0.5 * WELDS.depth_m * (1.0 + np.cos(2.0 * np.pi * shape_at / WELDS.length_m))
    random = np.random.default_rng(4)
    for weld in random.integers(0, x.size - shape.size, round(length / WELDS.every_m)):
        profile[weld : weld + shape.size] += shape
    turns, measured = welch(profile, 1.0 / step, nperseg=2048, detrend="constant")
    known = WELDS.density(2.0 * np.pi * turns) * 2.0 * np.pi
    for low, high in ((0.1, 0.5), (0.5, 1.5), (1.5, 3.0)):
        band = (turns >= low) & (turns < high)
        assert measured[band].mean() == pytest.approx(known[band].mean(), rel=0.05)


def test_the_density_holds_the_dips_power_and_nothing_at_half_their_length() -> None:
    wavenumber = np.linspace(0.0, 400.0, 400_001)
    power = np.trapezoid(WELDS.density(wavenumber), wavenumber)
    # The square of (1 + cos) / 2 over one period has the mean 3/8.
    assert power == pytest.approx(0.375 * WELDS.depth_m**2 * WELDS.length_m / WELDS.every_m, rel=1e-6)
    level, none = WELDS.density(np.array([0.0, 4.0 * np.pi / WELDS.length_m]))
    assert level == pytest.approx((0.5 * WELDS.depth_m * WELDS.length_m) ** 2 / (np.pi * WELDS.every_m))
    assert none < 1e-25 * level
