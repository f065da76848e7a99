"""The deviance of small campaigns against the whole covariance, written out and inverted."""

from __future__ import annotations

import numpy as np
import pytest
from permway.challenge.beams import Complexes
from permway.challenge.small.errors import root
from permway.challenge.small.strength import SURE, Blows, Ride, Scale

FREQUENCY = np.linspace(10.0, 100.0, 9)
STEP = 1e-3


def normal(random: np.random.Generator, *shape: int) -> Complexes:
    return np.asarray(random.standard_normal(shape) + 1j * random.standard_normal(shape))


def of_blows(blows: Blows, changes: list[Complexes]) -> tuple[np.ndarray, np.ndarray]:
    """Standardised differences, one column each, and their covariance pair by pair."""
    tests, sensors, points, lines = blows.base.shape
    relative = blows.sigma / np.abs(blows.base)
    ratio = [np.asarray(change / blows.base) for change in changes]
    sure = relative < SURE
    off = np.stack([np.where(sure, np.log(r), r - 1.0) / relative for r in ratio], axis=-1)
    rows = np.concatenate([off.real.reshape(-1, len(changes)), off.imag.reshape(-1, len(changes))])
    kernel = blows.functions @ blows.functions.T
    size = tests * sensors * points * lines
    half = np.zeros((size, size))
    for a, (t, s, p, f) in enumerate(np.ndindex(blows.base.shape)):
        for b, (u, q, r, g) in enumerate(np.ndindex(blows.base.shape)):
            shared = blows.sizes[0] ** 2 * (s == q) + blows.sizes[1] ** 2 * (p == r)
            half[a, b] = shared * kernel[f, g] / (relative[t, s, p, f] * relative[u, q, r, g])
    covariance = np.eye(2 * size)
    covariance[:size, :size] += half
    covariance[size:, size:] += half
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


def test_of_a_run_a_gain_within_its_tolerance_costs_next_to_nothing() -> None:
    random = np.random.default_rng(4)
    half = normal(random, FREQUENCY.size, 3, 3)
    base = half @ half.conj().swapaxes(1, 2)
    gain = np.diag([1.0, 1.05, 1.0])
    functions = root(FREQUENCY, 2.0)
    changed = gain @ base @ gain
    loose, tight = (Ride(base, 40.0, functions, size) for size in (0.1, 1e-6))
    one, other = (Scale([ride], [], STEP).deviance([changed]) for ride in (loose, tight))
    # Without smooth errors twice the divergence of Wishart's distribution is its second order.
    ratio = np.linalg.eigvals(np.linalg.solve(base, changed)).real
    divergence = 2.0 * 40.0 * float((ratio - 1.0 - np.log(ratio)).sum())
    assert other == pytest.approx(divergence, rel=0.05)
    assert one < 0.05 * other


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
