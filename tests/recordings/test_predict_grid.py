"""From the lines that are solved to the grid that the window smears: by cubics, or as straight as a record was."""

from __future__ import annotations

import numpy as np
from permway.recordings.predict.grid import cubic_weights, grid_of, halved, solved_lines

ESTIMATE_HZ = np.arange(5.0, 200.0)


def resonance(frequency_Hz: np.ndarray) -> np.ndarray:
    """A wheel on its track: 4 Hz wide, between two lines."""
    return np.asarray(1.0 / (1.0 - (frequency_Hz / 57.5) ** 2 + 0.07j * frequency_Hz / 57.5))[:, None]


def test_cubics_are_met_exactly_on_uneven_lines() -> None:
    lines = np.array([1.0, 1.25, 1.5, 2.0, 3.0, 4.0, 7.0])
    at = np.linspace(1.0, 7.0, 97)
    for power in range(4):
        np.testing.assert_allclose(cubic_weights(lines, at) @ lines**power, at**power, rtol=1e-12)
    np.testing.assert_array_equal((cubic_weights(lines, lines).toarray()).round(12), np.eye(lines.size))
    # Of fewer lines the polynomial through all.
    np.testing.assert_allclose(cubic_weights(lines[:2], at[:3]) @ lines[:2], at[:3])


def test_a_resonance_of_a_wheel_on_its_track_keeps_its_peak() -> None:
    """By cubics, from lines at which it is solved on the track between those at which the track was."""
    lines = solved_lines(ESTIMATE_HZ, 1.0, None)
    stiffness = 1.0 / resonance(lines)
    halves, track = halved(lines, stiffness[:, :, None], 1.0)
    assert np.isin(lines, halves).all()
    assert np.diff(halves[halves < 128.0]).max() == 0.5
    assert np.diff(halves).max() == 1.0
    grid, coarse = grid_of(halves, ESTIMATE_HZ, 1.0), grid_of(lines, ESTIMATE_HZ, 1.0)
    exact = resonance(grid.frequency_Hz)
    assert np.abs(grid.spread(1.0 / track[:, :, 0], straight=False) - exact).max() < 0.004 * np.abs(exact).max()
    # What straight lines made of it.
    assert np.abs(coarse.spread(resonance(lines), straight=True) - exact).max() > 0.05 * np.abs(exact).max()


def test_a_record_that_was_straight_between_lines_is_met_exactly() -> None:
    lines = np.arange(1.0, 205.0, 3.0)
    grid = grid_of(lines, ESTIMATE_HZ, 1.0)
    parts = [
        np.interp(grid.frequency_Hz, lines, part[:, 0]) for part in (resonance(lines).real, resonance(lines).imag)
    ]
    found = grid.spread(resonance(lines), straight=True)
    np.testing.assert_allclose(found[:, 0], parts[0] + 1j * parts[1], atol=1e-12)
    np.testing.assert_allclose(
        grid.expected(found, np.ones(grid.frequency_Hz.size)),
        grid.expected_between([resonance(lines)], np.ones(grid.frequency_Hz.size)),
        rtol=1e-9,
    )
