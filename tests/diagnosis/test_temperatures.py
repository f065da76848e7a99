"""Conditions of several temperatures: one solve serves them until a law depends on temperature."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from permway.arrays import ABSOLUTE_ZERO_C
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.predict import request_of
from permway.challenge.small.write import write_tables
from permway.diagnosis.catalogue._change import with_law
from permway.diagnosis.gather import gather
from permway.diagnosis.joint_changes import JointChanges
from permway.diagnosis.nearby import Nearby
from permway.diagnosis.observations import Observations
from permway.laws import TFDV, Arrhenius
from permway.posterior.cells import cells
from permway.posterior.recalibrated import recalibrated
from simulated import CAMPAIGN, MODEL, simulate

TEMPERATURES = {"still": 12.0, "warm": 25.0, "cold": -10.0}


@pytest.fixture(scope="module")
def observations(tmp_path_factory: pytest.TempPathFactory) -> Observations:
    """The same blows, as if struck at three temperatures."""
    folder = simulate(tmp_path_factory.mktemp("t") / "c", 2).path.parent
    record = CAMPAIGN["records"][0]
    conditions = [{"name": name, "kind": "hammer", "temperature_C": t} for name, t in TEMPERATURES.items()]
    records = [{**record, "name": name, "condition": name} for name in TEMPERATURES]
    campaign = {**CAMPAIGN, "conditions": conditions, "records": records}
    write_tables(folder, campaign, MODEL)
    return gather(read_campaign(folder / "campaign.toml"), threads=1)


def stiffer_when_warm(campaign: Campaign, share: float = 1.0) -> Campaign:
    """Pads whose stiffness grows with a share of the relative change of absolute temperature."""
    law = TFDV(
        law=campaign.model.line.laws["pad"],
        shift=Arrhenius(activation_energy_J_per_mol=5e4, reference_temperature_C=12.0),
        reference_temperature_C=12.0,
        volume_expansion_per_K=(1.0 - share) / (12.0 - ABSOLUTE_ZERO_C),
    )
    return with_law(campaign, "pad", law)


def receptances(datasets: list[xr.Dataset]) -> list[np.ndarray]:
    return [data["frf"].values for data in datasets]


def test_one_solve_serves_all(observations: Observations) -> None:
    solved = observations.predicted(observations.campaign)
    assert len(solved.answers) == 1
    first, *others = receptances(solved.datasets)
    assert all(np.array_equal(first, other) for other in others)


def test_a_law_that_depends_on_temperature_asks_for_each(observations: Observations) -> None:
    campaign = stiffer_when_warm(observations.campaign)
    solved = observations.predicted(campaign, observations.predicted(observations.campaign))
    assert {need.temperature_C for need in solved.needs if need is not None} == set(TEMPERATURES.values())
    first, warm, cold = receptances(solved.datasets)
    assert not np.allclose(first, warm, rtol=1e-3)
    assert not np.allclose(first, cold, rtol=1e-3)


def test_derivatives_hold_for_each_temperature(observations: Observations) -> None:
    plain = observations.predicted(observations.campaign)
    # At 25 degrees by 5e-6 of the stiffness.
    campaign = stiffer_when_warm(observations.campaign, 1e-4)
    found = Nearby(observations, plain).predicted(campaign)
    assert found is not None
    assert found.needs == tuple(request_of(campaign, dataset) for dataset in observations.datasets)
    before = receptances(plain.datasets)
    right = receptances(observations.predicted(campaign).datasets)
    moves = []
    for base, new, solved in zip(before, receptances(found.datasets), right, strict=True):
        moves.append(np.linalg.norm(solved - base))
        assert np.linalg.norm(new - solved) <= 1e-3 * moves[-1] + 1e-12 * np.linalg.norm(base)
    assert min(moves[1:]) > 0.0


def test_joints_whose_law_depends_on_temperature_are_solved_anew(observations: Observations) -> None:
    joined = JointChanges(observations, observations.campaign, observations.predicted(observations.campaign))
    assert joined.of(stiffer_when_warm(observations.campaign)) is None


def test_softening_pads_are_tried_though_no_law_depends_on_temperature(observations: Observations) -> None:
    fit = recalibrated(observations)
    (softer, *_) = [c for c in cells(fit) if c.hypothesis.size == "softening_per_K"]
    amended = softer.hypothesis.amend(observations.campaign, {**softer.values, "softening_per_K": 0.01})
    found = receptances(observations.predicted(amended, fit.state.solved).datasets)
    assert len({float(np.abs(values).mean()) for values in found}) == len(TEMPERATURES)
