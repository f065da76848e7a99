"""Hyperparameters: the quasi-Newton descent against a library's, from starts far apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather
from permway.posterior.covariance import Frame
from permway.posterior.estimate import SETTLED, estimated, least_objective
from permway.posterior.fit import Fit, Model
from permway.posterior.fitter import Fitter
from scipy import optimize
from simulated import simulate


@pytest.fixture(scope="module")
def fit(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    campaign = simulate(tmp_path_factory.mktemp("c"), 5).campaign
    fitter = Fitter(Frame.of(gather(campaign, threads=1)))
    model = Model(campaign.with_values, free_parameters(campaign))
    begun = fitter.begin(model, np.zeros(len(model.free)), fitter.frame.first().with_discrepancy(0.2))
    return fitter.settled(fitter.fit(begun, steps=10))


@pytest.mark.parametrize("seed", range(4))
def test_it_comes_to_the_least_that_a_library_finds(fit: Fit, seed: int) -> None:
    objective = least_objective(fit)
    low, high = fit.hyper.bounds()
    random = np.random.default_rng(seed)
    # Discrepancies from that of an idealisation to one in which all is lost.
    moved = fit.hyper.moved(fit.hyper.log + random.uniform(-1.5, 1.5, low.size))
    start = replace(fit, hyper=moved)
    found = estimated(start)
    best = min(
        float(optimize.minimize(objective, log, method="L-BFGS-B", bounds=list(zip(low, high, strict=True))).fun)
        for log in (moved.log, found.hyper.log, fit.frame.first().log)
    )
    assert objective(found.hyper.log) < best + 4.0 * SETTLED
    # From there nothing is left to gain.
    assert objective(estimated(found).hyper.log) == pytest.approx(objective(found.hyper.log), abs=SETTLED)


def test_it_stays_between_the_bounds(fit: Fit) -> None:
    low, high = fit.hyper.bounds()
    for log in (low, high):
        found = estimated(replace(fit, hyper=fit.hyper.moved(log)))
        assert (found.hyper.log >= low).all()
        assert (found.hyper.log <= high).all()
