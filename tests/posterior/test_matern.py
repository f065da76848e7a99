"""Matern's process of order 5/2 by its states at nodes, against its covariance function."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from permway.posterior import matern
from permway.posterior.matern import CLOSEST, STATES, Nodes


def kernel(x: np.ndarray, length: float) -> np.ndarray:
    """Rasmussen and Williams (2006), equation 4.17, for order 5/2."""
    u = np.sqrt(5.0) * np.abs(x[:, None] - x) / length
    return (1.0 + u + u**2 / 3.0) * np.exp(-u)


def precision(nodes: Nodes, length: float) -> tuple[np.ndarray, float]:
    diagonal, below, log_determinant = nodes.precision(length)
    count = nodes.x.size
    whole = np.zeros((count, STATES, count, STATES))
    for k in range(count):
        whole[k, :, k, :] = diagonal[k]
        if k:
            whole[k, :, k - 1, :] = below[k - 1]
            whole[k - 1, :, k, :] = below[k - 1].T
    return whole.reshape(STATES * count, -1), log_determinant


@given(st.floats(0.15, 4.0), st.lists(st.floats(0.05, 3.0), min_size=1, max_size=12))
def test_states_have_the_covariance_of_the_process(length: float, lengths: list[float]) -> None:
    """Steps in lengths: nearer nodes make the inverse taken here round, and have a test of their own below."""
    nodes = Nodes(np.concatenate([[3.0], 3.0 + length * np.cumsum(lengths)]))
    matrix, log_determinant = precision(nodes, length)
    values = np.linalg.inv(matrix)[::STATES, ::STATES]
    assert values == pytest.approx(kernel(nodes.x, length), abs=2e-6)
    assert log_determinant == pytest.approx(np.linalg.slogdet(matrix)[1], rel=1e-6, abs=1e-3)


@pytest.mark.parametrize("length", [0.15, 1.0, 4.0])
def test_states_at_the_closest_nodes_round_by_little(length: float) -> None:
    """A precision whose neighbours hardly differ: double precision holds it to some millionths of the variance."""
    nodes = Nodes(3.0 + CLOSEST * np.arange(12))
    matrix, _ = precision(nodes, length)
    assert np.linalg.inv(matrix)[::STATES, ::STATES] == pytest.approx(kernel(nodes.x, length), abs=1e-5)


@pytest.mark.parametrize("length", [0.15, 1.0, 4.0])
def test_what_it_gains_over_a_step_is_no_difference_that_rounds(length: float) -> None:
    """Between near nodes: the variance of the value given the node before, against a series of the kernel."""
    step = np.array([0.05, 0.2])
    u = (np.sqrt(5.0) / length * step)[:, None, None]
    found = matern._gained(u)[:, 0, 0]
    s = np.linspace(0.0, 1.0, 20001)
    for value, one in zip(found, u[:, 0, 0], strict=True):
        # The value answers white noise by s^2 exp(-s) / 2.
        answer = 0.25 * (s * one) ** 4 * np.exp(-2.0 * s * one)
        assert value == pytest.approx(16.0 / 3.0 * one * np.trapezoid(answer, s), rel=1e-6)


@pytest.mark.parametrize(("length", "lost"), [(0.15, 1e-4), (0.3, 1e-5), (1.0, 1e-6)])
def test_lines_between_nodes_lose_little_of_the_variance(length: float, lost: float) -> None:
    nodes = Nodes(np.arange(0.0, 1.0, CLOSEST))
    x = nodes.x[:-1] + 0.5 * CLOSEST
    before, value, _ = nodes.at(x)
    design = np.zeros((x.size, nodes.x.size * STATES))
    for row, (k, weights) in enumerate(zip(before, value, strict=True)):
        design[row, STATES * k : STATES * (k + 2)] = weights
    matrix, _ = precision(nodes, length)
    variance = np.diag(design @ np.linalg.inv(matrix) @ design.T)
    assert variance == pytest.approx(np.ones(x.size), abs=lost)


def test_nodes_are_lines_and_none_is_too_close() -> None:
    lines = np.log2(np.arange(8.0, 200.0, 2.0))
    nodes = Nodes.of(lines)
    assert set(nodes.x) <= set(lines)
    assert np.diff(nodes.x)[:-1].min() >= CLOSEST
    assert nodes.x[-1] == lines[-1]


def test_slopes_of_lines_are_those_of_a_polynomial() -> None:
    nodes = Nodes(np.array([0.0, 0.3, 0.7]))
    coefficients = np.array([0.2, -1.0, 0.5, 2.0, -0.4, 0.1])
    curve = np.polynomial.Polynomial(coefficients)
    states = np.stack([curve(nodes.x), curve.deriv()(nodes.x), curve.deriv(2)(nodes.x)], axis=1)
    x = np.array([0.1, 0.45, 0.65])
    before, value, slope = nodes.at(x)
    beside = np.stack([np.concatenate([states[k], states[k + 1]]) for k in before])
    assert np.einsum("fk,fk->f", value, beside) == pytest.approx(curve(x), rel=1e-12)
    assert np.einsum("fk,fk->f", slope, beside) == pytest.approx(curve.deriv()(x), rel=1e-12)
