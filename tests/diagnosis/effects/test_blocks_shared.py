"""Rows of one line that say the same: their correlations, and what takes them apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis.blocks_shared import BELIEVED, apart, covariance
from permway.diagnosis.blocks_spectra import SpectraBlock
from permway.diagnosis.gather import gather
from trains import campaign_in, drawn

LINES = 4000


def correlated(random: np.random.Generator, shared: np.ndarray, lines: int = LINES) -> np.ndarray:
    return np.linalg.cholesky(shared) @ random.standard_normal((len(shared), lines))


def some(random: np.random.Generator, kinds: int) -> np.ndarray:
    """Correlations that are positive definite."""
    factor = random.standard_normal((kinds, kinds + 2))
    covariance = factor @ factor.T
    scale = np.sqrt(np.diag(covariance))
    return np.asarray(covariance / scale / scale[:, None])


def test_what_kinds_share_is_found_beside_smooth_errors_and_a_narrow_effect() -> None:
    random = np.random.default_rng(1)
    shared = np.array([[1.0, 0.7, 0.0], [0.7, 1.0, 0.0], [0.0, 0.0, 1.0]])
    values = correlated(random, shared)
    values += np.cumsum(0.02 * random.standard_normal(values.shape), axis=1)
    # Twenty standard deviations at three lines, in all kinds.
    values[:, 100:103] += 20.0
    values[1, ::7] = np.nan
    found = covariance(values)
    together, apart_, other = np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 0.0, np.sqrt(2.0)]]) / np.sqrt(
        2.0
    )
    assert together @ found @ together == pytest.approx(1.0 + BELIEVED * 0.7, abs=0.06)
    # Never less than if they were independent.
    assert apart_ @ found @ apart_ == pytest.approx(1.0, abs=0.05)
    assert other @ found @ other == pytest.approx(1.0, abs=0.05)
    assert np.linalg.eigvalsh(found)[0] > 1.0 - 1e-9


def test_few_lines_in_common_tell_nothing() -> None:
    values = correlated(np.random.default_rng(2), np.array([[1.0, 0.9], [0.9, 1.0]]), 200)
    values[0, :120], values[1, 140:] = np.nan, np.nan
    assert covariance(values) == pytest.approx(np.eye(2))


@pytest.mark.parametrize("seed", range(8))
def test_what_is_taken_apart_is_independent(seed: int) -> None:
    """W S W' is one, and the determinant is that of S, whichever kinds a line has."""
    random = np.random.default_rng(seed)
    kinds, lines = int(random.integers(1, 7)), 12
    shared, present = some(random, kinds), random.random((kinds, lines)) < 0.6
    present[0, 0] = True
    rows = np.zeros(present.shape, dtype=int)
    rows[present] = random.permutation(int(present.sum()))
    mix, log_determinant = apart(present, rows, shared)
    covariance = np.zeros((int(present.sum()),) * 2)
    for line in range(lines):
        mine = np.flatnonzero(present[:, line])
        covariance[np.ix_(rows[mine, line], rows[mine, line])] = shared[np.ix_(mine, mine)]
    assert mix @ covariance @ mix.T.toarray() == pytest.approx(np.eye(len(covariance)), abs=1e-9)
    assert log_determinant == pytest.approx(float(np.linalg.slogdet(covariance)[1]), abs=1e-9)


def test_a_block_with_correlations_is_the_quadratic_form_by_them(tmp_path: Path) -> None:
    owner = campaign_in(tmp_path)
    evidence = gather(owner, drawn(owner, 5), threads=1)
    index = next(i for i, b in enumerate(evidence.blocks) if isinstance(b, SpectraBlock))
    plain = evidence.blocks[index]
    assert isinstance(plain, SpectraBlock)
    predicted = evidence.predicted(owner).datasets[index]
    kinds = plain._by_kind(np.zeros(plain.rows.channel.size))
    shared = np.full((len(kinds),) * 2, 0.6) + 0.4 * np.eye(len(kinds))
    block = SpectraBlock(
        plain.dataset, predicted, added=plain._added, scatter=plain._scatter, shared=shared, span=plain._span
    )
    assert block.log_determinant < plain.log_determinant
    deviations = plain.deviations(predicted)
    whole = block.deviations(predicted)
    expected = 0.0
    for line in plain._by_kind(deviations).T:
        mine = np.flatnonzero(np.isfinite(line))
        part = np.linalg.inv(shared[np.ix_(mine, mine)])
        expected += float(line[mine] @ part @ line[mine])
    assert whole @ whole == pytest.approx(expected)
    # Levels are told as they were measured.
    assert block.levels_dB(predicted) == pytest.approx(plain.levels_dB(predicted), nan_ok=True)
    # Smooth errors are taken apart as deviations are.
    coefficients = np.random.default_rng(3).standard_normal(sum(o.count for o in plain.smooth.origins))
    moved = plain.smooth.columns.push(coefficients)
    assert block.smooth.columns.push(coefficients) == pytest.approx(block._apart @ moved)
    again = block.of(plain.dataset)
    assert again.deviations(predicted) == pytest.approx(whole)
    assert block.scattered(predicted)._shared is not None
