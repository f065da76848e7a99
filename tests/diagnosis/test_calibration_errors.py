"""Calibration errors: the functions that span them, the columns of blocks, and taking them out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.campaign.excitation import Dips
from permway.diagnosis.blocks_spectra import LEVEL
from permway.diagnosis.calibration_errors import CalibrationErrors, ErrorSource, PairColumns, PlainColumns
from permway.diagnosis.gaussian_process import SHORTEST, GaussianProcess
from permway.diagnosis.whitener import AllColumns, Whitener

Reals = np.ndarray


def correlation(x: Reals, length: float) -> Reals:
    return np.exp(-0.5 * ((x[:, None] - x[None, :]) / length) ** 2)


@pytest.mark.parametrize("length", [SHORTEST, 1.0, 1.4, 2.0, 2.8, 4.0])
def test_a_calibration_error_has_the_correlation_that_it_states(length: float) -> None:
    """The covariance of the functions' sum is squared-exponential, but for a rough percent."""
    frequency = np.geomspace(2.0, 400.0, 90)
    process = GaussianProcess(2.0, 400.0)
    moved = process.values(frequency) @ process.root(length)
    x = np.log2(frequency)
    expected = correlation(x, length)
    if length != SHORTEST:
        expected = 0.99 * expected + 0.01 * correlation(x, SHORTEST)
    np.testing.assert_allclose(moved @ moved.T, expected, atol=1e-3)


def test_what_wanders_over_an_octave_is_held_to_a_thousandth() -> None:
    frequency = np.geomspace(2.0, 400.0, 400)
    covariance = correlation(np.log2(frequency), 1.0) + 1e-10 * np.eye(frequency.size)
    errors = np.linalg.cholesky(covariance) @ np.random.default_rng(4).standard_normal((frequency.size, 40))
    values = GaussianProcess(2.0, 400.0).values(frequency)
    left = errors - values @ np.linalg.lstsq(values, errors, rcond=None)[0]
    assert left.std() < 1e-3


def pair_columns(random: np.random.Generator, sensors: int, points: int, lines: int, count: int) -> PairColumns:
    phase = np.exp(2j * np.pi * random.random((sensors, points, lines)))
    return PairColumns(random.standard_normal((sensors, points, lines, count)), phase)


def dense(columns: PairColumns) -> Reals:
    """Column by column, from what gains and phases are."""
    sensors, points, lines, count = columns.gains.shape
    found = []
    for chain in range(sensors + points):
        for factor in (1.0, 1j):
            for k in range(count):
                whole = np.zeros((sensors, points, lines), dtype=np.complex128)
                mine = (chain, slice(None)) if chain < sensors else (slice(None), chain - sensors)
                whole[mine] = factor * (columns.gains[..., k] * columns.phase)[mine]
                found.append(np.concatenate([whole.real.reshape(-1), whole.imag.reshape(-1)]))
    return np.stack(found, axis=1)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3), st.integers(1, 4), st.integers(1, 5), st.integers(1, 3))
def test_columns_of_pairs_are_those_of_a_dense_matrix(
    seed: int, sensors: int, points: int, lines: int, count: int
) -> None:
    random = np.random.default_rng(seed)
    columns = pair_columns(random, sensors, points, lines, count)
    matrix = dense(columns)
    values, coefficients = random.standard_normal((matrix.shape[0], 3)), random.standard_normal(matrix.shape[1])
    np.testing.assert_allclose(columns.transposed_times(values), matrix.T @ values, atol=1e-10)
    np.testing.assert_allclose(columns.transposed_times(values[:, 0]), matrix.T @ values[:, 0], atol=1e-10)
    np.testing.assert_allclose(columns.times(coefficients), matrix @ coefficients, atol=1e-10)
    np.testing.assert_allclose(columns.gram(), matrix.T @ matrix, atol=1e-9)


def test_a_whitener_is_the_inverse_of_the_covariance() -> None:
    """Two blocks that share a source, against the dense covariance."""
    random = np.random.default_rng(3)
    process = GaussianProcess(1.0, 8.0)
    one = pair_columns(random, 2, 1, 4, process.count)
    names = [ErrorSource(name, process, 2) for name in ("sensor a", "sensor b", "force c")]
    other = PlainColumns(random.standard_normal((5, 2 * process.count)))
    rows = [2 * 2 * 4, 5]
    columns = AllColumns.of([CalibrationErrors(tuple(names), one), CalibrationErrors((names[1],), other)], rows)
    sizes = {"sensor a": 0.3, "sensor b": 0.1, "force c": 0.7}
    whitener = Whitener.of(columns, sizes, 2.0)
    matrix = np.zeros((sum(rows), columns.gram.shape[0]))
    matrix[: rows[0]] = dense(one)
    matrix[rows[0] :, 2 * process.count : 4 * process.count] = other.matrix
    covariance = np.eye(sum(rows))
    for index, source in enumerate(names):
        root = np.kron(np.eye(2), sizes[source.name] * process.root(2.0))
        mine = matrix[:, index * source.count : (index + 1) * source.count] @ root
        covariance += mine @ mine.T
    values = random.standard_normal(sum(rows))
    assert whitener.square(values) == pytest.approx(values @ np.linalg.solve(covariance, values), rel=1e-9)
    assert whitener.log_determinant == pytest.approx(np.linalg.slogdet(covariance)[1], rel=1e-9)
    # What is explained, taken out, leaves the noise's share: V^-1 times the values.
    left = values - whitener.calibration(whitener.explained(values), values.size)
    np.testing.assert_allclose(left, np.linalg.solve(covariance, values), atol=1e-9)


def test_a_level_takes_up_a_hump_that_its_prior_allows() -> None:
    """Of 1.3 dB over two octaves, as dips of half a metre would make: no reason to name welds."""
    cycles_per_m = np.geomspace(0.02, 10.0, 400)
    power = Dips(depth_m=1.7e-4, length_m=0.47, every_m=20.0).density(2.0 * np.pi * cycles_per_m) * cycles_per_m**3
    hump = 0.5 * np.log(1.0 + 0.36 * power / power.max())
    size, known = 0.115, 0.005
    columns = np.vstack([LEVEL.values(cycles_per_m) * size / known, np.eye(LEVEL.count)])
    wanted = np.concatenate([hump / known, np.zeros(LEVEL.count)])
    left = columns @ np.linalg.lstsq(columns, wanted)[0] - wanted
    assert left @ left < 0.05 * (wanted @ wanted)
    # Corrugation of 4 dB is narrower.
    bump = 0.5 * np.exp(-0.5 * (np.log2(cycles_per_m) / 0.13) ** 2)
    wanted = np.concatenate([bump / known, np.zeros(LEVEL.count)])
    left = columns @ np.linalg.lstsq(columns, wanted)[0] - wanted
    assert left @ left > 0.1 * (wanted @ wanted)
