"""A step between limits does no worse than any other between them."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from permway.diagnosis.bounded import bounded_step


@given(st.integers(0, 2**32 - 1), st.integers(1, 6))
def test_no_point_between_the_limits_is_much_better(seed: int, size: int) -> None:
    random = np.random.default_rng(seed)
    root = random.standard_normal((size, size + 2))
    normal = root @ root.T + 0.1 * np.eye(size)
    slope = 3.0 * random.standard_normal(size)
    low, high = -np.abs(random.standard_normal(size)), np.abs(random.standard_normal(size))
    z = np.where(random.random(size) < 0.3, low, np.where(random.random(size) < 0.3, high, 0.0))

    def value(shift: np.ndarray) -> float:
        return float(2.0 * slope @ shift + shift @ normal @ shift)

    shift = bounded_step(normal, slope, z, low, high, 0.0)
    assert np.all(z + shift >= low - 1e-12)
    assert np.all(z + shift <= high + 1e-12)
    assert value(shift) <= 1e-9
    gradient, room = slope + normal @ shift, 1e-9
    small = 1e-7 * (1.0 + np.abs(slope).max() + np.abs(normal).max())
    # It falls no further within the limits: Karush's conditions.
    assert np.all(gradient[z + shift > low + room] < small)
    assert np.all(gradient[z + shift < high - room] > -small)


def test_a_parameter_at_its_limit_does_not_stop_the_others() -> None:
    """Two that do the same, of which one is at its limit: the other does it all."""
    normal = np.array([[10.0, 9.9], [9.9, 10.0]]) + 0.01 * np.eye(2)
    slope = np.array([-5.0, -5.0])
    shift = bounded_step(normal, slope, np.array([2.0, 0.0]), -np.full(2, 9.0), np.array([2.0, 9.0]), 0.0)
    assert abs(shift[0]) < 1e-12
    assert abs(shift[1] - 5.0 / 10.01) < 1e-12


def test_without_limits_it_is_newtons() -> None:
    random = np.random.default_rng(3)
    root = random.standard_normal((5, 9))
    normal, slope = root @ root.T, random.standard_normal(5)
    shift = bounded_step(normal, slope, np.zeros(5), -np.full(5, 1e9), np.full(5, 1e9), 1e-3)
    assert np.allclose((normal + 1e-3 * np.diag(np.diag(normal))) @ shift, -slope)
