"""Tables of modes under comparison and diagnosis."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tables_of_modes as tables
from permway.campaign.campaign import read_campaign
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.tangent import Problem
from permway.errors import InputError
from permway.posterior.compare import compare
from permway.posterior.covariance import Frame
from permway.posterior.fit import Model
from permway.posterior.fitter import Fitter


def stiffer(model: dict) -> None:
    model["line"]["bodies"]["deck"]["youngs_modulus_Pa"] *= 1.08
    model["line"]["bodies"]["deck"]["loss_factor"] = 0.05


def with_absorber(model: dict) -> None:
    line = model["line"]
    line["bodies"]["absorber"] = {"type": "mass", "mass_kg": 9000.0}
    line["laws"]["tuned"] = {"type": "hysteretic", "stiffness": 1.1e7, "loss_factor": 0.15}
    line["joints"].append({"between": ["absorber", "deck"], "law": "tuned", "at": [11.0]})


def test_residuals_are_logarithms_over_their_standard_deviations(tmp_path: Path) -> None:
    campaign = read_campaign(tables.write(tmp_path, tables.rows_of(tables.changed(stiffer))))
    observations = gather(campaign)
    (block,) = observations.blocks
    measured = block.dataset.data["modes"].values
    (predicted,) = observations.predicted(campaign).datasets
    expected = np.log(measured / predicted["modes"].values) / [[tables.SD], [tables.SD_DAMPING]]
    assert block.residuals(predicted) == pytest.approx(expected.reshape(-1), rel=1e-6)
    assert block.levels_dB(predicted) == pytest.approx(block.residuals(predicted) * block.rows.scale_dB)


def test_recalibration_finds_the_parameters(tmp_path: Path) -> None:
    campaign = read_campaign(tables.write(tmp_path, tables.rows_of(tables.changed(stiffer), seed=4)))
    fit = recalibrate(gather(campaign))
    values = {f.name: f.value(float(z)) for f, z in zip(fit.free, fit.z, strict=True)}
    sigma = dict(zip(values, np.sqrt(np.diag(fit.covariance)), strict=True))
    true = {"E": 1.08 * 3.4e10, "eta": 0.05, "k": 1.5e9}
    for name, value in true.items():
        known = campaign.parameters.known[name]
        assert abs(known.z(values[name]) - known.z(value)) < 3.0 * sigma[name], name
    assert sigma["E"] < 0.2
    assert values["E"] == pytest.approx(true["E"], rel=0.01)


def test_both_methods_have_the_same_slopes_of_modes(tmp_path: Path) -> None:
    """Derivatives of receptances would give double poles; what is used agrees with solves far apart."""
    campaign = read_campaign(tables.write(tmp_path, tables.rows_of(tables.changed(stiffer))))
    observations = gather(campaign)
    problem = Problem(observations, campaign.with_values, free_parameters(campaign))
    state = problem.at(np.zeros(3))
    assert state is not None
    found = problem.jacobian(state)
    step = 1e-2
    for index in range(3):
        ends = []
        for side in (-1.0, 1.0):
            z = np.zeros(3)
            z[index] = side * step
            ends.append(problem.at(z).residuals)
        assert found[:, index] == pytest.approx((ends[1] - ends[0]) / (2.0 * step), rel=1e-2, abs=1e-2)


def test_the_posterior_of_one_table_has_no_chains(tmp_path: Path) -> None:
    campaign = read_campaign(tables.write(tmp_path, tables.rows_of(tables.changed(stiffer), seed=4)))
    frame = Frame.of(gather(campaign))
    hyper = frame.first()
    assert frame.chains == ()
    assert hyper.names == ("discrepancy modes", "idealisation")
    free = free_parameters(campaign)
    fitter = Fitter(frame)
    fit = fitter.fit(fitter.begin(Model(campaign.with_values, free), np.zeros(3), hyper), steps=20)
    residuals, sigma = fit.state.residuals, frame.sigma
    variance = 1.0 + (hyper["discrepancy modes"] / sigma) ** 2
    assert fit.covariance.square(residuals) == pytest.approx(float((residuals**2 / variance).sum()))
    assert fit.values()["E"] == pytest.approx(1.08 * 3.4e10, rel=0.02)


def test_a_missed_mode_is_reported_and_costs(tmp_path: Path) -> None:
    campaign = read_campaign(tables.write(tmp_path, tables.rows_of(tables.changed(with_absorber))))
    result = compare(campaign, raw_only=True)
    (missed,) = result.summary()["missed"]
    assert "no mode within a factor of 1.5 of 6.24515" in missed
    observations = gather(campaign)
    solved = observations.predicted(campaign)
    off = observations.residuals(solved.datasets)
    assert np.isfinite(off).all()
    assert off.max() == pytest.approx(np.log(1.5) / tables.SD, rel=1e-6)


def test_without_a_missed_mode_nothing_is_reported(tmp_path: Path) -> None:
    campaign = read_campaign(tables.write(tmp_path, tables.rows_of(tables.changed(stiffer))))
    assert "missed" not in compare(campaign, raw_only=True).summary()


def test_damping_needs_a_damped_model(tmp_path: Path) -> None:
    rows = tables.rows_of(tables.MODEL)

    def undamped(model: dict) -> None:
        model["line"]["bodies"]["deck"]["loss_factor"] = 0.0
        model["line"]["laws"]["bearing"]["loss_factor"] = 0.0

    path = tables.write(tmp_path / "a", rows, model=tables.changed(undamped), free=False)
    with pytest.raises(InputError, match="has no damping"):
        gather(read_campaign(path))
    bare = [",".join(row.split(",")[:2]) for row in rows]
    observations = gather(
        read_campaign(tables.write(tmp_path / "b", bare, model=tables.changed(undamped), free=False))
    )
    (block,) = observations.blocks
    assert block.rows.channel.tolist() == ["natural frequency"] * (len(rows) - 1)
