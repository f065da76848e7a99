"""Predictions by exact derivatives against predictions by solves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from effects.trains import campaign_in, drawn
from permway.campaign.campaign import Campaign
from permway.campaign.parameters import Parameter
from permway.campaign.values import ParameterSet
from permway.diagnosis.blocks import Basis
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.gather import gather
from permway.diagnosis.nearby import Nearby
from permway.diagnosis.observations import Observations
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.tangent import STEP, Problem
from simulated import simulate


def _problem(observations: Observations) -> Problem:
    campaign = observations.campaign
    return Problem(observations, campaign.with_values, free_parameters(campaign))


@pytest.mark.parametrize("kind", ["hammer", "train"])
def test_slopes_are_those_of_solves(tmp_path: Path, kind: str) -> None:
    """Every parameter of laws and bodies, at random values: to what a forward difference leaves."""
    if kind == "hammer":
        campaign = simulate(tmp_path / "c", 5).campaign
        observations = gather(campaign, threads=1)
    else:
        campaign = campaign_in(tmp_path)
        observations = gather(campaign, drawn(campaign, 3), threads=1)
    problem = _problem(observations)
    z = np.random.default_rng(8).uniform(-0.5, 0.5, len(problem.free))
    state = problem.at(z)
    assert state is not None
    nearby, not_solved = Nearby(observations, state.solved), 0
    for index, free in enumerate(problem.free):
        moved = z.copy()
        moved[index] += STEP
        values = {f.name: f.value(float(v)) for f, v in zip(problem.free, moved, strict=True)}
        found = nearby.predicted(campaign.with_values(values))
        if found is None:
            continue
        not_solved += 1
        slope = (observations.residuals(found.datasets) - state.residuals) / STEP
        solved = (problem.residuals(moved)[0] - state.residuals) / STEP
        assert np.linalg.norm(slope - solved) < 5e-3 * np.linalg.norm(solved), free.name
    assert not_solved >= len(problem.free) // 2


def test_a_line_of_another_shape_is_solved(tmp_path: Path) -> None:
    campaign: Campaign = simulate(tmp_path / "c", 1).campaign
    observations = gather(campaign, threads=1)
    solved = observations.predicted(campaign)
    model = campaign.model
    joints = (*model.line.joints, model.line.joints[-1].model_copy(update={"scale": 0.5}))
    other = model.model_copy(update={"line": model.line.model_copy(update={"joints": joints})})
    assert Nearby(observations, solved).predicted(campaign.with_model(other)) is None


@pytest.mark.parametrize("per_octave", [1.0, 2.0, 3.0])
def test_splines_hold_straight_lines(per_octave: float) -> None:
    basis = Basis(2.0, 400.0, per_octave)
    frequency = np.geomspace(2.0, 400.0, 301)
    values = basis.values(frequency)
    np.testing.assert_allclose(values.sum(axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(values @ basis.knots, np.log(frequency), atol=1e-12)


def test_a_speed_noted_wrongly_is_found(tmp_path: Path) -> None:
    """0.4 % off, with phases between wheelsets turned by more than a quarter: slopes alone would not get there."""
    nominal_campaign = campaign_in(tmp_path)
    speed = Parameter(
        name="speed.fast",
        unit="m/s",
        paths=["campaign.conditions.fast.speed_m_per_s"],
        acts="scales",
        tolerance_2sigma=0.005,
    )
    stated = nominal_campaign.stated.model_copy(
        update={"parameters": (*nominal_campaign.stated.parameters, speed)}
    )
    parameters = ParameterSet(stated.parameters, nominal_campaign.model, {}, stated, nominal_campaign.folder)
    nominal_campaign = Campaign(stated, nominal_campaign.model, nominal_campaign.folder, parameters)
    noted = nominal_campaign.condition("fast").speed_m_per_s
    assert noted is not None
    observations = gather(
        nominal_campaign, drawn(nominal_campaign.with_values({"speed.fast": 0.996 * noted}), 6), threads=1
    )
    fit = recalibrate(observations)
    low, high = fit.intervals()["speed.fast"]
    assert fit.values()["speed.fast"] == pytest.approx(0.996 * noted, rel=5e-4)
    assert 0.5 * (high - low) < 5e-4 * noted


def test_a_share_at_all_frequencies_is_a_parameter_moved(tmp_path: Path) -> None:
    campaign: Campaign = simulate(tmp_path / "c", 3).campaign
    observations = gather(campaign, threads=1)
    plain = observations.predicted(campaign)
    nearby, values = Nearby(observations, plain), campaign.parameters.nominal()
    for name, part, index in (("pad.k", "law", 0), ("bearing.k", "law", 1), ("deck.E", "bending", 1)):
        bent = nearby.perturbed(part, [index], lambda frequency: np.full(frequency.size, 1e-5))  # type: ignore[arg-type]
        assert bent is not None
        solved = observations.predicted(campaign.with_values({**values, name: values[name] * (1.0 + 1e-5)}))
        found, right = (s.datasets[0]["frf"].values - plain.datasets[0]["frf"].values for s in (bent, solved))
        assert np.linalg.norm(found - right) < 1e-3 * np.linalg.norm(right), name
