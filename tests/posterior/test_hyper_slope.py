"""Slopes by hyperparameters against differences, and what they are made of against dense matrices."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather, observations_of
from permway.posterior.covariance import Frame
from permway.posterior.estimate import least_objective
from permway.posterior.fit import Fit, Model
from permway.posterior.fitter import Fitter
from permway.posterior.hyper_slope import hyper_slope
from permway.posterior.tridiagonal import Tridiagonal
from simulated import simulate
from simulated_train import measured, tables, written


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_factor_by_blocks_is_that_of_the_whole_matrix(seed: int) -> None:
    random = np.random.default_rng(seed)
    count, width = 5, 4
    root = np.tril(random.standard_normal((count, width, width))) + 3.0 * np.eye(width)
    side = random.standard_normal((count - 1, width, width))
    lower = np.zeros((count, width, count, width))
    for k in range(count):
        lower[k, :, k] = root[k]
        if k:
            lower[k, :, k - 1] = side[k - 1]
    whole = lower.reshape(count * width, -1) @ lower.reshape(count * width, -1).T
    blocks = whole.reshape(count, width, count, width)
    each = np.arange(count)
    factor = Tridiagonal.of(blocks[each, :, each], blocks[each[1:], :, each[:-1]])
    values = random.standard_normal((count * width, 3))
    assert factor.backward(factor.forward(values)) == pytest.approx(np.linalg.solve(whole, values), rel=1e-9)
    assert factor.log_determinant == pytest.approx(np.linalg.slogdet(whole)[1])
    inverse = np.linalg.inv(whole).reshape(count, width, count, width)
    on, below = factor.inverse_blocks()
    assert on == pytest.approx(inverse[each, :, each], rel=1e-9)
    assert below == pytest.approx(inverse[each[1:], :, each[:-1]], rel=1e-9)


def of_blows(folder: Path) -> Fit:
    return begun(Frame.of(gather(simulate(folder, 3).campaign, threads=1)))


def of_runs(folder: Path) -> Fit:
    campaign = written(folder, *tables(cold=False))
    datasets = measured(campaign, 5)
    like = gather(campaign, datasets, threads=1)
    return begun(Frame.of(observations_of(campaign, datasets, like)))


def begun(frame: Frame) -> Fit:
    """At some parameters, with some errors of the idealisation."""
    campaign = frame.observations.campaign
    model = Model(campaign.with_values, free_parameters(campaign))
    z = np.random.default_rng(2).standard_normal(len(model.free))
    fit = Fitter(frame).begin(model, z, frame.first())
    columns = fit.jacobian[:, :2] * np.random.default_rng(3).standard_normal((fit.jacobian.shape[0], 1))
    return replace(fit, frame=frame.with_idealisation(columns))


@pytest.mark.parametrize("of", [of_blows, of_runs])
@pytest.mark.parametrize("seed", [4, 5])
def test_slopes_by_hyperparameters_are_those_of_differences(of: object, seed: int, tmp_path: Path) -> None:
    assert callable(of)
    fit = of(tmp_path)
    objective = least_objective(fit)
    moved = fit.hyper.log + 0.5 * np.random.default_rng(seed).standard_normal(fit.hyper.log.size)
    x = fit.hyper.moved(moved).log
    step = 1e-4 * np.eye(x.size)
    differences = [(objective(x + one) - objective(x - one)) / 2e-4 for one in step]
    found = hyper_slope(fit, fit.frame.covariance(fit.hyper.moved(x)))
    assert found == pytest.approx(np.array(differences), rel=1e-3, abs=1e-3 * np.abs(differences).max())
    assert np.abs(differences).min() > 0.0
