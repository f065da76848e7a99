"""A beam's end that does not turn freely, against closed forms of beams at rest; and found from a passage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import passages
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.predict import predict
from permway.diagnosis.catalogue import bearing_rotation
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.recalibrate import recalibrate
from permway.model.bodies import Beam
from permway.model.place import Place
from permway.posterior.covariance import Frame
from permway.posterior.fitter import Fitter
from permway.posterior.masses import Masses
from permway.posterior.search import explored
from permway.response.receptance import receptance

LENGTH, BENDING = passages.LENGTH_M, passages.BENDING_NM2
TYPICAL = BENDING / LENGTH


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    """Histories of a beam that lacks nothing; its loss is small, for a beam at rest."""
    random, time = np.random.default_rng(4), passages.time_s()
    columns = {}
    for name in "we":
        values = passages.history(name, time, 0.01)
        columns[name] = values + 1e-3 * np.abs(values).max() * random.standard_normal(time.size)
    folder = tmp_path_factory.mktemp("beam")
    table = passages.campaign("we", high_Hz=10.0)
    table["parameters"] = table["parameters"][:3]
    return read_campaign(passages.write(folder, columns, table=table, loss_factor=0.02))


@pytest.fixture(scope="module")
def base(campaign: Campaign) -> Fit:
    return recalibrate(gather(campaign, threads=1))


@pytest.fixture(scope="module")
def offered(base: Fit) -> dict[str, Hypothesis]:
    return {h.variant: h for h in bearing_rotation.hypotheses(Situation(base, ()))}


def middle(campaign: Campaign) -> float:
    """Deflection of the middle by a unit force there, at rest but for the loss."""
    place = [Place(body="deck", x_m=LENGTH / 2.0)]
    found = receptance(campaign.model.line, [1e-3], forces=place, sensors=place, threads=1)
    return float(found["receptance"].values.ravel()[0].real)


@pytest.mark.parametrize("share", [0.05, 1.0, 30.0])
def test_both_ends_that_turn_against_springs(
    campaign: Campaign, offered: dict[str, Hypothesis], share: float
) -> None:
    stiffness = share * TYPICAL
    # The end turns by L^2/(16 EI) - M L/(2 EI) = M / k, and the middle goes back by M L^2/(8 EI).
    moment = LENGTH**2 / (16.0 * BENDING) / (1.0 / stiffness + LENGTH / (2.0 * BENDING))
    expected = LENGTH**3 / (48.0 * BENDING) - moment * LENGTH**2 / (8.0 * BENDING)
    amended = offered["both ends"].amend(campaign, {"stiffness": stiffness})
    assert middle(amended) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("variant", ["left end", "right end"])
def test_one_end_that_turns_against_a_spring(
    campaign: Campaign, offered: dict[str, Hypothesis], variant: str
) -> None:
    # There the rotation by a moment is L/(3 EI), and the middle goes back by M L^2/(16 EI).
    moment = LENGTH**2 / (16.0 * BENDING) / (1.0 / TYPICAL + LENGTH / (3.0 * BENDING))
    expected = LENGTH**3 / (48.0 * BENDING) - moment * LENGTH**2 / (16.0 * BENDING)
    amended = offered[variant].amend(campaign, {"stiffness": TYPICAL})
    assert middle(amended) == pytest.approx(expected, rel=2e-3)


def test_no_spring_changes_nothing(campaign: Campaign, offered: dict[str, Hypothesis]) -> None:
    assert offered["both ends"].amend(campaign, {"stiffness": 0.0}) is campaign


@pytest.mark.parametrize(
    ("ends", "law", "left"),
    [
        ("free", "", set()),
        ("clamped", "", set()),
        (("pinned", "free"), "", {"left end"}),
        ("pinned", ("", "turn"), {"left end"}),
    ],
)
def test_an_end_that_is_held_or_free_is_not_tried(base: Fit, ends: str, law: str, left: set[str]) -> None:
    model = base.campaign.model
    line = model.line
    body = line.bodies["deck"]
    assert isinstance(body, Beam)
    changed = body.model_copy(update={"ends": ends, "rotation_law": law})
    other = line.model_copy(update={"bodies": {"deck": changed}})
    fit = replace(base, campaign=base.campaign.with_model(model.model_copy(update={"line": other})))
    assert {h.variant for h in bearing_rotation.hypotheses(Situation(fit, ()))} == left


@pytest.mark.injection
def test_a_stuck_bearing_is_found_from_one_passage(campaign: Campaign, offered: dict[str, Hypothesis]) -> None:
    datasets = campaign.load()
    amended = offered["left end"].amend(campaign, {"stiffness": 0.3 * TYPICAL})
    shift = [
        after["spectrum"].values - before["spectrum"].values
        for before, after in zip(
            predict(campaign, datasets, threads=1), predict(amended, datasets, threads=1), strict=True
        )
    ]
    for dataset, change in zip(datasets, shift, strict=True):
        dataset.data["spectrum"] = dataset.data["spectrum"] + change
    masses = Masses.of(explored(Fitter(Frame.of(gather(campaign, datasets, threads=1)))).members)
    assert masses.nothing < 0.05
    assert masses.names(0)[0][0] == "bearing_rotation"
    assert masses.best.values(0)["stiffness"] == pytest.approx(0.3 * TYPICAL, rel=0.3)
