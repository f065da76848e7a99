"""A train that rolls over its supports: stated in a campaign file, looked for where it shows, and measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.excitation import Rolling
from permway.campaign.predict import predict
from permway.campaign.predictions import rolling as rolling_predicted
from permway.diagnosis.catalogue import entries
from permway.diagnosis.catalogue._excite import with_irregularity, with_speed
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.errors import InputError
from permway.laws.toml import to_toml
from searched import recalibrated_base, searched
from trains import CAMPAIGN, blank, campaign_in, drawn, observations_of, situation_of

SPACING_M = 0.6


def forms(situation: Situation) -> dict[str, Hypothesis]:
    return {h.variant: h for h in entries()["parametric_support"].hypotheses(situation)}


@pytest.fixture(scope="module")
def nominal_campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    return campaign_in(tmp_path_factory.mktemp("rolls"))


def rolling(campaign: Campaign) -> Campaign:
    """As its train rolls over the fasteners."""
    return with_irregularity(campaign, rolling=Rolling(spacing_m=SPACING_M))


@pytest.fixture(scope="module")
def rolls(nominal_campaign: Campaign) -> Situation:
    """What is measured when the train rolls, and the base does not."""
    return situation_of(nominal_campaign, 21, amend=rolling)


@pytest.fixture(scope="module")
def rolling_by_file(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    """A campaign whose file states that its train rolls."""
    folder = tmp_path_factory.mktemp("rolling_by_file")
    campaign_in(folder)
    table = {**CAMPAIGN, "irregularity": {**CAMPAIGN["irregularity"], "rolling": {"spacing_m": SPACING_M}}}
    (folder / "campaign.toml").write_text(to_toml(table))
    return read_campaign(folder / "campaign.toml")


def test_a_campaign_file_lets_its_train_roll(nominal_campaign: Campaign, rolling_by_file: Campaign) -> None:
    """Lines of its weight at V over the spacing, and little else far below."""
    known = rolling_by_file.stated.irregularity.rolling
    assert known is not None
    assert known.model_copy(update={"about": None}) == Rolling(spacing_m=SPACING_M)
    runs = [one for one in blank(nominal_campaign) if one.record.statistic == "csd"]
    for dataset, still, rolling in zip(
        runs, predict(nominal_campaign, runs), predict(rolling_by_file, runs), strict=True
    ):
        passing = dataset.condition.speed_m_per_s / SPACING_M  # type: ignore[operator]
        louder = 10.0 * np.log10(rolling["psd"] / still["psd"]).sel(channel=["axle1", "axle2", "axle3"])
        assert (louder.sel(frequency=passing, method="nearest") > 2.0).all()
        assert np.abs(louder.idxmax("frequency") - passing).max() < 1.0
        assert np.abs(louder.sel(frequency=slice(4.0, 20.0))).max() < 0.5
        shared = rolling["csd"].values[:, :, 40]
        assert np.allclose(shared, shared.conj().T)
        assert np.linalg.eigvalsh(shared).min() > 0.0


@pytest.mark.xfail(
    strict=True, raises=AssertionError, reason="it rolls over the line as stated, whatever the records say of it"
)
def test_a_train_that_is_stated_to_roll_does_so_over_the_line_that_is_found(rolling_by_file: Campaign) -> None:
    right = {"pad.k": 6.9e7, "pad.eta": 0.17, "level": 0.7}
    truth = rolling_by_file.with_values(right)
    observations = gather(rolling_by_file, drawn(truth.rolling_about(truth), 24), threads=1)
    base = recalibrated_base(observations)
    rolling = base.campaign.stated.irregularity.rolling
    assert rolling is not None
    assert rolling.about is not None
    assert rolling.about.line.laws["pad"].stiffness == pytest.approx(6.9e7, rel=0.02)  # type: ignore[union-attr]
    assert base.inflation < 1.1
    values = base.values()
    assert values["pad.k"] == pytest.approx(6.9e7, rel=0.01)
    assert values["level"] == pytest.approx(0.7, abs=0.3)


def test_speeds_and_temperatures_that_differ_little_ask_for_nothing_new(
    rolling_by_file: Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs = [one for one in blank(rolling_by_file) if one.record.statistic == "csd"]
    predict(rolling_by_file, runs)
    made: list[float] = []
    real = rolling_predicted.kernel

    def counted(*args: Any, speed_m_per_s: float, **rest: Any) -> Any:
        made.append(speed_m_per_s)
        return real(*args, speed_m_per_s=speed_m_per_s, **rest)

    monkeypatch.setattr(rolling_predicted, "kernel", counted)
    predict(with_speed(rolling_by_file, 1.03), runs)
    assert made == []
    warmer = tuple(c.model_copy(update={"temperature_C": 17.0}) for c in rolling_by_file.stated.conditions)
    predict(
        replace(rolling_by_file, stated=rolling_by_file.stated.model_copy(update={"conditions": warmer})), runs
    )
    assert made == []
    predict(with_speed(rolling_by_file, 1.08), runs)
    assert made == pytest.approx([54.0, 76.68])


def test_a_line_of_its_own_is_not_for_files(nominal_campaign: Campaign, tmp_path: Path) -> None:
    rolling = {"spacing_m": SPACING_M, "about": {"bodies": {}}}
    campaign_in(tmp_path)
    (tmp_path / "campaign.toml").write_text(
        to_toml({**CAMPAIGN, "irregularity": {**CAMPAIGN["irregularity"], "rolling": rolling}})
    )
    with pytest.raises(InputError, match="about"):
        read_campaign(tmp_path / "campaign.toml")


def test_it_is_looked_for_where_supports_are_seen_to_pass(nominal_campaign: Campaign, rolls: Situation) -> None:
    assert set(forms(situation_of(nominal_campaign, 22))) == {""}
    assert set(forms(rolls)) == {"", "rolling"}


def test_its_share_is_measured_and_lines_alone_state_less(nominal_campaign: Campaign) -> None:
    found = searched(observations_of(nominal_campaign, 21, amend=rolling), "parametric_support")
    best = found.best()
    assert best is not None
    assert best.amendments[0].variant == "rolling"
    assert best.values(0)["share"] == pytest.approx(1.0, abs=0.1)
    assert best.fit.hyper.novel < 0.5


def test_every_share_of_its_range_can_be(rolls: Situation) -> None:
    rolling = forms(rolls)["rolling"]
    for free in rolling.free:
        for z in free.limits:
            amended = rolling.amend(rolls.campaign, {"share": 1.0, free.name: free.value(z)})
            assert amended.stated.irregularity.rolling is not None


def test_a_profile_that_is_not_as_stated_is_reported_beside_it(nominal_campaign: Campaign) -> None:
    """Which shifts power between frequencies as it rolls: no other effect has to."""
    shape = ((0.4, 1.0), (0.8, -1.0), (1.6, 1.0), (3.2, -1.0))

    def amend(campaign: Campaign) -> Campaign:
        return with_irregularity(campaign, rolling=Rolling(spacing_m=SPACING_M), shape_dB=shape)

    best = searched(observations_of(nominal_campaign, 23, amend=amend), "parametric_support").best()
    assert best is not None
    found = best.fit.values()
    assert found["1.share"] == pytest.approx(1.0, abs=0.1)
    for wavelength, true in shape:
        assert found[f"1.shape_{wavelength:g}_m_dB"] == pytest.approx(true, abs=0.7)


def test_what_is_stated_of_a_profile_stays(rolls: Situation, nominal_campaign: Campaign) -> None:
    """A shape is added to his own, and differs from a spectrum that he knows by next to nothing."""
    rolling = forms(rolls)["rolling"]
    his = with_irregularity(nominal_campaign, shape_dB=((0.3, 2.0), (0.5, -1.0)))
    shaped = rolling.amend(his, {"share": 1.0, "shape_0.4_m_dB": 0.5}).stated.irregularity
    at_m = np.array([0.1, 0.3, 0.4, 0.5, 0.8, 20.0])
    between = np.interp(np.log(0.4), np.log([0.3, 0.5]), [2.0, -1.0])
    own = 0.5 * np.interp(np.log(at_m), np.log([0.2, 0.4, 0.8]), [0.0, 1.0, 0.0])
    assert shaped.shape_at(at_m) == pytest.approx(own + np.array([2.0, 2.0, between, -1.0, -1.0, -1.0]))
    sizes = {}
    for knowledge in ("known", "within", "unknown"):
        within = 2.0 if knowledge == "within" else None
        known = with_irregularity(rolls.campaign, knowledge=knowledge, within_dB=within)
        free = forms(replace(rolls, fit=replace(rolls.fit, campaign=known)))["rolling"].free[1]
        sizes[knowledge] = free.value(1.0) - free.value(0.0)
    assert sizes["known"] < 0.05
    assert sizes["within"] == pytest.approx(1.0, abs=1e-3)
    assert sizes["unknown"] > 4.0
