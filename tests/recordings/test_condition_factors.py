"""Numbers of the model that are others under one condition."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from campaigns import tables, write
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.factors import campaign_under
from permway.campaign.predict import plan, predict, request_of
from permway.diagnosis.observations import Observations
from permway.errors import InputError
from test_campaign_predict import FREQUENCY, blows, run

PAD, MASS = "line.laws.pad.stiffness", "train.vehicle.wheelset_mass_kg"


def with_factors(folder: Path, **by_condition: dict[str, float]) -> Campaign:
    campaign, _ = tables()
    for condition in campaign["conditions"]:
        condition["factors"] = by_condition.get(condition["name"], {})
    folder.mkdir(exist_ok=True)
    return read_campaign(write(folder, campaign))


def values(campaign: Campaign) -> list[np.ndarray]:
    found = predict(campaign, [blows(campaign), run(campaign)], threads=1)
    return [found[0]["frf"].values, found[1]["csd"].values]


def test_a_factor_acts_under_its_condition_only(tmp_path: Path) -> None:
    plain, changed = with_factors(tmp_path / "a"), with_factors(tmp_path / "b", fast={PAD: 1.5, MASS: 0.9})
    stiff = plain.with_model(campaign_under(changed, changed.condition("fast")).model)
    assert stiff.model.line.laws["pad"].stiffness == pytest.approx(9e7)
    assert stiff.model.train is not None
    before, after, whole = values(plain), values(changed), values(stiff)
    # Of a solve with other sensors, so not bit by bit.
    assert after[0] == pytest.approx(before[0], rel=1e-9, abs=1e-30)
    assert after[1] == pytest.approx(whole[1], rel=1e-9, abs=1e-30)
    assert np.abs(after[1] / before[1] - 1.0).max() > 0.05


def test_only_factors_on_the_line_ask_for_a_solve_of_their_own(tmp_path: Path) -> None:
    for factors, count in (({}, 1), ({PAD: 1.0}, 1), ({MASS: 0.9}, 1), ({PAD: 1.2}, 2)):
        campaign = with_factors(tmp_path / "c", fast=factors)
        needs = [request_of(campaign, dataset) for dataset in (blows(campaign), run(campaign))]
        # At other lines a run is solved by itself.
        alike = [replace(need, frequency_Hz=FREQUENCY) for need in needs if need is not None]
        assert len(plan(alike)) == count


class Datasets:
    """As much of a block as predictions need."""

    def __init__(self, dataset: object) -> None:
        self.dataset = dataset


def test_what_was_solved_is_used_again_where_nothing_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = with_factors(tmp_path / "a")
    observations = Observations(plain, tuple(Datasets(d) for d in (blows(plain), run(plain))), {}, 1)  # type: ignore[misc]
    solved = observations.predicted(plain)
    from permway.diagnosis import observations as module

    calls = []
    original = module.solve

    def counted(sweep: object, *arguments: object, **options: object) -> object:
        calls.append(sweep)
        return original(sweep, *arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "solve", counted)
    changed = with_factors(tmp_path / "b", fast={PAD: 1.5})
    again = observations.predicted(replace(plain, stated=changed.stated), solved)
    assert len(calls) == 1
    fresh = observations.predicted(changed)
    for mine, other in zip(again.datasets, fresh.datasets, strict=True):
        for name in mine:
            assert mine[name].values == pytest.approx(other[name].values, rel=1e-9, abs=1e-30)


@pytest.mark.parametrize(
    ("factors", "what", "where"),
    [
        ({"line.laws.pad.hardness": 2.0}, "leads to no number", 'factors["line.laws.pad.hardness"]'),
        ({"line laws": 2.0}, "is no path", 'factors["line laws"]'),
        ({"campaign.irregularity.level_dB": 2.0}, "does not differ", 'factors["campaign.irregularity.level_dB"]'),
        ({PAD: 0.0}, "greater than 0", f"factors.{PAD}"),
        ({PAD: "more"}, "must be a number", f"factors.{PAD}"),
        ({"line.laws.pad.loss_factor": -0.1}, "greater than 0", "factors.line.laws.pad.loss_factor"),
    ],
)
def test_bad_factors_name_their_place(tmp_path: Path, factors: dict, what: str, where: str) -> None:
    with pytest.raises(InputError, match=what) as caught:
        with_factors(tmp_path / "a", fast=factors)
    assert caught.value.where.endswith(f"conditions[1].{where}")
