"""The covariance of residuals, applied line by line, against a dense one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather, observations_of
from permway.posterior.covariance import Frame
from permway.posterior.fit import Model
from permway.posterior.fitter import Fitter
from permway.posterior.held_out import gains
from permway.posterior.hyper import IDEALISATION, Hyper
from simulated import simulate
from simulated_train import measured, tables, written


@pytest.fixture(scope="module")
def blows(tmp_path_factory: pytest.TempPathFactory) -> Frame:
    return Frame.of(gather(simulate(tmp_path_factory.mktemp("c"), 3).campaign, threads=1))


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Frame:
    campaign = written(tmp_path_factory.mktemp("t"), *tables(cold=False))
    datasets = measured(campaign, 5)
    like = gather(campaign, datasets, threads=1)
    return Frame.of(observations_of(campaign, datasets, like))


def dense(frame: Frame, hyper: Hyper) -> np.ndarray:
    """Noise, discrepancy and what all processes and columns do, as one matrix."""
    weights = frame.covariance(hyper).weights
    whole = np.diag(1.0 / weights)
    whole[np.ix_(frame.spanned, frame.spanned)] += frame.columns @ frame.columns.T
    for chains in frame.chains:
        diagonal, below, _ = chains.nodes.precision(hyper["length"])
        count, states, kinds = chains.nodes.x.size, diagonal.shape[1], len(chains.kinds)
        precision = np.zeros((count, kinds, states, count, kinds, states))
        for index, kind in enumerate(chains.kinds):
            for k in range(count):
                precision[k, index, :, k, index, :] = diagonal[k] / hyper[kind] ** 2
                if k:
                    precision[k, index, :, k - 1, index, :] = below[k - 1] / hyper[kind] ** 2
                    precision[k - 1, index, :, k, index, :] = below[k - 1].T / hyper[kind] ** 2
        design = chains.design.toarray()
        inner = design @ np.linalg.solve(precision.reshape(chains.size, -1), design.T)
        if chains.turn is None:
            whole[np.ix_(chains.rows, chains.rows)] += inner
        else:
            real, imaginary = chains.rows.T
            turned = chains.turn.conj()[:, None] * inner * chains.turn
            whole[np.ix_(real, real)] += turned.real
            whole[np.ix_(imaginary, imaginary)] += turned.real
            whole[np.ix_(real, imaginary)] -= turned.imag
            whole[np.ix_(imaginary, real)] += turned.imag
    return whole


def moved(frame: Frame) -> Hyper:
    """Hyperparameters that are no medians."""
    first = frame.first()
    return first.moved(first.log + np.linspace(-0.4, 0.6, first.log.size))


@pytest.mark.parametrize("name", ["blows", "runs"])
def test_its_inverse_and_determinant_are_those_of_a_dense_one(name: str, request: pytest.FixtureRequest) -> None:
    frame: Frame = request.getfixturevalue(name)
    hyper = moved(frame)
    whole = dense(frame, hyper)
    covariance = frame.covariance(hyper)
    vector = np.random.default_rng(1).standard_normal(frame.sigma.size)
    solved = np.linalg.solve(whole, vector)
    assert covariance.apply(vector[:, None])[:, 0] == pytest.approx(solved, rel=1e-5, abs=1e-8)
    assert covariance.log_determinant == pytest.approx(np.linalg.slogdet(whole)[1], rel=1e-6)


def test_rows_left_out_are_marginalised(blows: Frame) -> None:
    hyper = moved(blows)
    keep = np.random.default_rng(2).random(blows.sigma.size) < 0.7
    half = keep.size // 2
    # A line is left out with its real and its imaginary part.
    keep[half:] = keep[:half]
    whole = dense(blows, hyper)[np.ix_(keep, keep)]
    covariance = blows.covariance(hyper, keep)
    vector = np.random.default_rng(3).standard_normal(keep.size) * keep
    square = vector[keep] @ np.linalg.solve(whole, vector[keep])
    assert covariance.square(vector) == pytest.approx(square, rel=1e-6)
    assert covariance.log_determinant == pytest.approx(np.linalg.slogdet(whole)[1], rel=1e-6)


def test_what_a_fit_gains_of_held_out_rows_is_a_ratio_of_gaussian_densities(tmp_path: Path) -> None:
    campaign = simulate(tmp_path / "c", 4).campaign
    fitter = Fitter(Frame.of(gather(campaign, threads=1)))
    model = Model(campaign.with_values, free_parameters(campaign))
    start = fitter.begin(model, np.zeros(len(model.free)), fitter.frame.first())
    fit = fitter.settled(fitter.fit(start, steps=20))
    found = {f"{g.axis} {g.name}": g.nats for g in gains(start, fit)}

    def conditional(one, out: np.ndarray) -> float:  # type: ignore[no-untyped-def]
        whole = dense(fitter.frame, one.hyper) + one.jacobian @ one.jacobian.T
        mean = one.jacobian @ one.z
        off = one.state.residuals - mean
        gain = np.linalg.solve(whole[np.ix_(~out, ~out)], whole[np.ix_(~out, out)]).T
        left = off[out] - gain @ off[~out]
        inner = whole[np.ix_(out, out)] - gain @ whole[np.ix_(~out, out)]
        return -0.5 * float(
            left @ np.linalg.solve(inner, left) + np.linalg.slogdet(inner)[1] + out.sum() * np.log(2.0 * np.pi)
        )

    out = fitter.frame.observations.rows.sensor == "deck@3"
    assert found["sensor deck@3"] == pytest.approx(conditional(fit, out) - conditional(start, out), rel=1e-4)


@pytest.mark.parametrize("name", ["blows", "runs"])
def test_other_sizes_of_errors_share_what_the_noise_weighs(name: str, request: pytest.FixtureRequest) -> None:
    random = np.random.default_rng(4)
    frame: Frame = request.getfixturevalue(name)
    frame = frame.with_idealisation(random.standard_normal((frame.sigma.size, 3)))
    first = frame.first()
    usual, large = frame.covariance(first), first.moved(first.log + 0.5 * (np.array(first.names) == IDEALISATION))
    columns = random.standard_normal((frame.sigma.size, 4))
    weighted = usual.weighted(columns)
    for hyper in (first, large, *first.smaller()):
        shared, alone = usual.resized(hyper).rooted(weighted), frame.covariance(hyper).roots(columns)
        np.testing.assert_allclose(shared.times(shared), alone.times(alone), rtol=1e-9)
    with pytest.raises(ValueError, match="discrepancy is another"):
        usual.resized(first.with_discrepancy(0.2))


def test_what_lacks_as_much_as_before(runs: Frame) -> None:
    before = runs.first().with_discrepancy(0.5)
    assert before.with_discrepancy(0.46).lacks_as(before)
    assert not before.with_discrepancy(0.4).lacks_as(before)
    complete = runs.first()
    assert not complete.lacks_as(complete)


def test_of_two_kinds_of_record_one_that_is_explained_is_enough() -> None:
    first = Hyper.first((), ("frf", "csd"))
    both = first.with_discrepancy(0.5)
    one = Hyper(both.names, np.where(["frf" in name for name in both.names], first.log, both.log))
    assert not one.lacks_as(both)
    assert one.lacks_as(one)
