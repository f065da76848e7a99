"""The deviance of small campaigns against the whole covariance, written out and inverted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.challenge.beams import Complexes
from permway.challenge.small.errors import root
from permway.challenge.small.make import draw_small
from permway.challenge.small.recalibrated import best_deviance
from permway.challenge.small.stated import noise_deviance
from permway.challenge.small.strength import SURE, Blows, Ride, Scale

FREQUENCY = np.linspace(10.0, 100.0, 9)
STEP = 1e-3

FEW = (0, 29, 57)
"""Campaigns of one seed with few pairs and lines, one effect and no run."""


def normal(random: np.random.Generator, *shape: int) -> Complexes:
    return np.asarray(random.standard_normal(shape) + 1j * random.standard_normal(shape))


def of_blows(blows: Blows, changes: list[Complexes]) -> tuple[np.ndarray, np.ndarray]:
    """Standardised differences, one column each, and their covariance pair by pair."""
    relative = blows.sigma / np.abs(blows.base)
    ratio = [np.asarray(change / blows.base) for change in changes]
    off = np.stack([np.where(relative < SURE, np.log(r), r - 1.0) / relative for r in ratio], axis=-1)
    rows = np.concatenate([off.real.reshape(-1, len(changes)), off.imag.reshape(-1, len(changes))])
    _, sensor, point, line = (at.reshape(-1) for at in np.indices(blows.base.shape))
    shared = blows.sizes[0] ** 2 * (sensor[:, None] == sensor) + blows.sizes[1] ** 2 * (point[:, None] == point)
    kernel = blows.functions @ blows.functions.T
    flat = relative.reshape(-1)
    half = shared * kernel[line[:, None], line] / (flat[:, None] * flat)
    covariance = np.eye(2 * flat.size)
    covariance[: flat.size, : flat.size] += half
    covariance[flat.size :, flat.size :] += half
    return rows, covariance


def least(rows: np.ndarray, covariance: np.ndarray) -> float:
    """First column against the best mixture of the others, each of unit variance."""
    slopes = rows[:, 1:]
    whole = covariance + slopes @ slopes.T
    return float(rows[:, 0] @ np.linalg.solve(whole, rows[:, 0]))


@pytest.mark.parametrize(("seed", "length"), [(1, 0.15), (2, 0.6), (3, 2.0)])
def test_of_hammer_tests_it_is_that_of_the_whole_covariance(seed: int, length: float) -> None:
    random = np.random.default_rng(seed)
    shape = (2, 2, 3, FREQUENCY.size)
    base = normal(random, *shape)
    # Some lines below the noise.
    sigma = np.abs(base) * np.exp(random.uniform(np.log(0.01), np.log(2.0), shape))
    blows = Blows(base, sigma, root(FREQUENCY, length), (0.08, 0.06))
    slopes = [base * np.exp(STEP * 0.1 * normal(random, *shape)) for _ in range(3)]
    changed = base * np.exp(0.2 * normal(random, *shape))
    found = Scale([blows], [[s] for s in slopes], STEP).deviance([changed])
    rows, covariance = of_blows(blows, [changed, *slopes])
    rows[:, 1:] /= STEP
    assert found == pytest.approx(least(rows, covariance), rel=1e-6)


@pytest.mark.parametrize("index", FEW)
def test_of_drawn_campaigns_it_is_that_of_the_whole_covariance(tmp_path: Path, index: int) -> None:
    small = draw_small(7, index, tmp_path)
    (blows,) = small.scale.parts
    assert isinstance(blows, Blows)
    (changed,) = small.maker.responses(small.effects)
    rows, covariance = of_blows(blows, [changed, *(slope for (slope,) in small.maker.slopes())])
    rows[:, 1:] /= STEP
    (_, _, linear) = small.chosen[0]
    assert linear == pytest.approx(least(rows, covariance), rel=1e-4)
    # A fit that takes slopes anew, with more error of every line, comes out no higher, but for where it rests.
    assert small.deviances()[0] < 1.1 * linear


def test_a_stiffness_that_moves_a_sharp_resonance_is_taken_up_by_a_fit_alone() -> None:
    def responses(z: float) -> Complexes:
        stiffness = 0.3 * z
        return np.asarray(1.0 / (np.exp(stiffness) * (1.0 + 0.02j) - (FREQUENCY / 50.0) ** 2))[None, None, None]

    base = responses(0.0)
    blows = Blows(base, np.abs(base) * 0.05, root(FREQUENCY, 1.0), (1e-3, 1e-3))
    linear = Scale([blows], [[responses(STEP)]], STEP).deviance([responses(2.0)])
    found = best_deviance([blows], [responses(2.0)], lambda z: [responses(float(z[0]))], 1)
    # Twice the standard deviation of the prior costs 4 and explains everything.
    assert found == pytest.approx(4.0, rel=0.02)
    assert linear > 50.0
    assert best_deviance([blows], [responses(0.0)], lambda z: [responses(float(z[0]))], 1) == pytest.approx(0.0)


def test_of_a_run_a_gain_within_its_tolerance_costs_next_to_nothing() -> None:
    random = np.random.default_rng(4)
    half = normal(random, FREQUENCY.size, 3, 3)
    base = half @ half.conj().swapaxes(1, 2)
    gain = np.diag([1.0, 1.05, 1.0])
    functions = root(FREQUENCY, 2.0)
    changed = gain @ base @ gain
    loose, tight = (Ride(base, 40.0, functions, size) for size in (0.1, 1e-6))
    one, other = (Scale([ride], [], STEP).deviance([changed]) for ride in (loose, tight))
    # Without calibration errors twice the divergence of Wishart's distribution is its second order.
    ratio = np.linalg.eigvals(np.linalg.solve(base, changed)).real
    divergence = 2.0 * 40.0 * float((ratio - 1.0 - np.log(ratio)).sum())
    assert other == pytest.approx(divergence, rel=0.05)
    assert one < 0.05 * other


@pytest.mark.parametrize("noise", [1e-2, 1e-4, 1e-6])
def test_of_coherent_channels_a_gain_within_its_tolerance_costs_what_its_prior_does(noise: float) -> None:
    """However coherent they are: a gain and a phase of one standard deviation each cost one."""
    random = np.random.default_rng(7)
    column = normal(random, FREQUENCY.size, 3, 1)
    base = column @ column.conj().swapaxes(1, 2) + noise * np.eye(3)
    ride = Ride(base, 40.0, np.ones((FREQUENCY.size, 1)), 0.1)
    one, both = (np.diag([1.0, np.exp(error), 1.0]) for error in (0.1, 0.1 + 0.1j))
    costs = [Scale([ride], [], STEP).deviance([gain @ base @ gain.conj().T]) for gain in (one, both)]
    assert 0.5 < costs[0] < 1.0
    assert costs[0] < costs[1] < 2.0


def test_what_a_parameter_can_take_up_is_no_deviance() -> None:
    random = np.random.default_rng(5)
    shape = (1, 2, 2, FREQUENCY.size)
    base = normal(random, *shape)
    along = 0.1 * normal(random, *shape)
    blows = Blows(base, np.abs(base) * 0.01, root(FREQUENCY, 1.0), (0.0, 0.0))
    scale = Scale([blows], [[base * np.exp(STEP * along)]], STEP)
    # A standard deviation of the prior costs one, less what is hardly seen.
    assert scale.deviance([base * np.exp(along)]) == pytest.approx(1.0, abs=0.01)
    assert scale.deviance([base]) == pytest.approx(0.0, abs=1e-12)


def test_noise_of_a_sensor_shows_beside_four_others_at_least() -> None:
    random = np.random.default_rng(6)
    base = normal(random, 1, 6, 3, 40)
    factors = {"s1": 20.0}
    assert noise_deviance(base, factors) == pytest.approx(np.log(20.0) ** 2 / 0.7**2)
    assert noise_deviance(base[:, :4], factors) == 0.0
    # Where sensors differ by far more anyway, it states less.
    uneven = base * np.array([1.0, 10.0, 100.0, 1.0, 10.0, 100.0])[None, :, None, None]
    assert noise_deviance(uneven, factors) < 1.0
