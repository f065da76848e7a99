"""From the lines that are solved to the grid that the window smears: by cubics, or as straight as a record was."""

from __future__ import annotations

import numpy as np
from permway.campaign.predictions.grid import HANN, grid_of, halved, hann, interpolating, solved_lines

ESTIMATE_HZ = np.arange(5.0, 200.0)


def resonance(frequency_Hz: np.ndarray) -> np.ndarray:
    """A wheel on its track: 4 Hz wide, between two lines."""
    return np.asarray(1.0 / (1.0 - (frequency_Hz / 57.5) ** 2 + 0.07j * frequency_Hz / 57.5))[:, None]


def test_cubics_are_met_exactly_on_uneven_lines() -> None:
    lines = np.array([1.0, 1.25, 1.5, 2.0, 3.0, 4.0, 7.0])
    at = np.linspace(1.0, 7.0, 97)
    for power in range(4):
        np.testing.assert_allclose(interpolating(lines, at) @ lines**power, at**power, rtol=1e-12)
    np.testing.assert_array_equal((interpolating(lines, lines).toarray()).round(12), np.eye(lines.size))
    # Of fewer lines the polynomial through all.
    np.testing.assert_allclose(interpolating(lines[:2], at[:3]) @ lines[:2], at[:3])


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


def test_what_wheels_do_late_is_summed_on_the_grid_and_smeared_pair_by_pair() -> None:
    """Both loops of the core, against products of whole arrays."""
    random = np.random.default_rng(3)
    lines = solved_lines(ESTIMATE_HZ, 1.0, None)
    grid = grid_of(lines, ESTIMATE_HZ, 1.0)
    channels, wheels = 5, 4
    parts = random.standard_normal((2, lines.size, channels, wheels))
    late = np.exp(2j * np.pi * random.random((grid.frequency_Hz.size, wheels)))
    values = parts[0] + 1j * parts[1]
    fine = grid.spread(values, late, straight=False)
    there = np.tensordot(grid.cubic.toarray(), values, axes=1)
    np.testing.assert_allclose(fine, np.einsum("ncw,nw->nc", there, late), atol=1e-12)
    density = 1.0 + random.random(grid.frequency_Hz.size)
    rows, columns = np.triu_indices(channels)
    pairs = density[:, None] * fine[:, rows] * fine[:, columns].conj()
    np.testing.assert_allclose(grid.expected(fine, density), grid.smear @ pairs, atol=1e-11)


def delayed(frequency_Hz: np.ndarray) -> np.ndarray:
    """What two channels read of one source: the second later by half a segment, both with a resonance."""
    shape = resonance(frequency_Hz)
    return np.hstack([shape, shape * np.exp(-1j * np.pi * frequency_Hz)[:, None]])


def test_four_points_a_line_are_enough_of_what_dies_out_within_three_segments() -> None:
    lines = solved_lines(ESTIMATE_HZ, 1.0, None)
    few, many = (grid_of(lines, ESTIMATE_HZ, 1.0, narrow=narrow) for narrow in (False, True))
    assert few.step_Hz == 4.0 * many.step_Hz
    found, expected = (g.expected(delayed(g.frequency_Hz), np.ones(g.frequency_Hz.size)) for g in (few, many))
    error = np.abs(found - expected) / np.sqrt(np.abs(expected[:, :1] * expected[:, 2:]))
    assert error[1:].max() < 1e-4
    assert error[0].max() < 2e-3


def test_a_source_at_one_frequency_is_met_exactly() -> None:
    """As a bell of the same power that gets ever narrower, on a grid fine enough for it."""
    lines = solved_lines(ESTIMATE_HZ, 1.0, None)
    grid = grid_of(lines, ESTIMATE_HZ, 1.0)
    amplitudes = np.array([2.0, 1.0 - 1.0j])
    x = 57.3 + np.linspace(-0.05, 0.05, 101)
    bell = np.exp(-0.5 * ((x - 57.3) / 0.01) ** 2)
    window = np.array([np.sum(bell * hann(x - f)) / bell.sum() for f in ESTIMATE_HZ]) / HANN
    near = np.abs(ESTIMATE_HZ - 57.3) < 3.9
    found = grid.of_line(57.3, amplitudes)
    expected = window[:, None] * np.array([4.0, 2.0 + 2.0j, 2.0])
    np.testing.assert_allclose(found[near], expected[near], atol=2e-3)
    assert not found[np.abs(ESTIMATE_HZ - 57.3) > 4.1].any()
    # All of its power is found again, if lines of a window's noise bandwidth are taken for one.
    assert abs(found[:, 0].sum().real / 4.0 - 1.0) < 1e-4
    away = grid.away.of_line(57.3, amplitudes)
    np.testing.assert_allclose(away, found * (57.3 - ESTIMATE_HZ)[:, None], atol=1e-12)
