"""Laplace's evidence against importance sampling, and the priors of hyperparameters."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather
from permway.posterior.covariance import Frame
from permway.posterior.estimate import estimated
from permway.posterior.fit import Model
from permway.posterior.fitter import Fitter
from permway.posterior.hyper import COARSEST, EXACT, Hyper
from scipy import integrate, stats
from simulated import simulate

DRAWS = 400


@pytest.mark.parametrize("seed", [1, 2])
def test_it_is_that_of_importance_sampling(tmp_path: Path, seed: int) -> None:
    """Proposals of the fit's own normal, wider by a tenth; each draw takes a solve."""
    campaign = simulate(tmp_path / "c", seed, noise=0.5).campaign
    fitter = Fitter(Frame.of(gather(campaign, threads=1)))
    model = Model(campaign.with_values, free_parameters(campaign))
    fit = fitter.begin(model, np.zeros(len(model.free)), fitter.frame.first().with_discrepancy(0.2))
    fit = fitter.fit(fit, steps=20)
    fit = fitter.settled(fitter.fit(estimated(fitter.settled(fit)), steps=20))
    random = np.random.default_rng(seed)
    root = 1.1 * np.linalg.cholesky(fit.spread)
    weights = []
    for _ in range(DRAWS):
        unit = random.standard_normal(fit.z.size)
        z = fit.z + root @ unit
        there = fitter.begin(model, z, fit.hyper, fit.jacobian)
        log_density = -0.5 * float(unit @ unit) - float(np.log(np.diag(root)).sum())
        weights.append(-0.5 * there.objective - log_density)
    sampled = float(np.logaddexp.reduce(weights)) - np.log(DRAWS)
    assert fit.log_evidence == pytest.approx(sampled, abs=0.15)


def test_priors_of_hyperparameters_are_densities() -> None:
    hyper = Hyper.first(("sensor",), ("frf",))
    for name, (low, high) in {
        "sensor": (1e-4, 10.0),
        "length": (1e-2, 60.0),
        "discrepancy frf": (1e-5, 2.0),
    }.items():
        index = hyper.names.index(name)

        def density(log: float, at: int = index) -> float:
            moved = hyper.log.copy()
            moved[at] = log
            return float(np.exp(Hyper(hyper.names, moved).log_prior - hyper.log_prior))

        others = np.exp(hyper.log_prior) / density(hyper.log[index])
        points = [np.log(EXACT), np.log(COARSEST)] if "discrepancy" in name else None
        whole, _ = integrate.quad(density, np.log(low), np.log(high), points=points, limit=200)
        own = {"sensor": stats.norm(0, np.log(3.0)).pdf(0.0), "length": stats.norm(0, np.log(2.5)).pdf(0.0)}
        scale = own.get(name)
        if scale is not None:
            assert whole * scale == pytest.approx(1.0, rel=1e-3)
        else:
            at_median = np.exp(Hyper((name,), hyper.log[[index]]).log_prior)
            assert whole * at_median == pytest.approx(1.0, rel=1e-3)
        assert others > 0.0


def test_a_large_discrepancy_is_of_something_that_is_missing() -> None:
    hyper = Hyper.first((), ("frf",))
    assert hyper.novel < 0.03
    assert hyper.with_discrepancy(0.3).novel > 0.98
