"""Effects of irregularity, contact and measurement, injected into the tool's own model and named again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.campaign.excitation import Dips, Push, RoughBand, TrackLines, WheelLines
from permway.campaign.predict import predict
from permway.diagnosis.catalogue import entries
from permway.diagnosis.catalogue._change import with_chain
from permway.diagnosis.catalogue._excite import chain_with, with_irregularity, with_speed
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.observations import Observations
from permway.diagnosis.recalibrate import recalibrate
from permway.model.contact import GivenContact
from permway.recordings.channel import Mains
from searched import searched
from simulated import simulate
from trains import blank, campaign_in, observations_of, situation_of

MINE = (
    "wheel_polygon",
    "rail_corrugation",
    "dipped_welds",
    "rail_joint",
    "wheel_flat",
    "contact_filter",
    "contact_nonlinear",
    "irregularity_level",
    "parametric_support",
    "moving_load",
    "span_camber",
    "sensor_mounting",
    "sensor_delay",
    "sensor_polarity",
    "noise_floor",
    "mains_lines",
    "speed_error",
    "second_source",
    "sensor_gain",
)


@dataclass(frozen=True)
class Case:
    """An effect at a place, and its values at the strongest.

    Attributes
    ----------
    entry, place : str
        `place` is part of the label of where it is.
    inject : callable
        From the truth without the effect and values to the truth.
    values : mapping
        The size first.
    within : mapping
        How far fitted values may lie off, relatively.
    none : float
        Of the size.
    """

    entry: str
    place: str
    inject: Callable[[Campaign, Mapping[str, float]], Campaign]
    values: Mapping[str, float]
    within: Mapping[str, float]
    none: float = 0.0

    def at(self, strength: float) -> dict[str, float]:
        """Values at a strength between 0 and 1: the size goes from none to its strongest."""
        size, value = next(iter(self.values.items()))
        weaker = value / strength if np.isinf(self.none) else self.none + strength * (value - self.none)
        return {**self.values, size: weaker}


def wheels(**fixed: Any) -> Callable[[Campaign, Mapping[str, float]], Campaign]:
    return lambda c, v: with_irregularity(c, wheels=(WheelLines(**{**fixed, **v}),))


def series(**fixed: Any) -> Callable[[Campaign, Mapping[str, float]], Campaign]:
    return lambda c, v: with_irregularity(c, series=(TrackLines(**{**fixed, **v}),))


def chain(
    name: str, parts: Callable[[Mapping[str, float]], dict[str, Any]]
) -> Callable[[Campaign, Mapping[str, float]], Campaign]:
    return lambda c, v: with_chain(c, name, chain_with(c.sensor(name).chain, **parts(v)))


def softer(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
    train = campaign.model.train
    assert train is not None
    contact = GivenContact(stiffness_N_per_m=values["factor"] * train.contact.wheel_stiffness())
    changed = train.model_copy(update={"contact": contact})
    return campaign.with_model(campaign.model.model_copy(update={"train": changed}))


def crossing(campaign: Campaign, values: Mapping[str, float]) -> Campaign:
    """A beam on two bearings under a constant load that moves: deflection under the load by its closed form."""
    vehicle, length = campaign.model.train.vehicle, 24.0  # type: ignore[union-attr]
    load = 2.0 * 9.80665 / 8.0 * vehicle.share * 2.0
    load *= vehicle.car_body_mass_kg + 2.0 * vehicle.bogie_mass_kg + 4.0 * vehicle.wheelset_mass_kg
    x = np.linspace(0.0, length, 4097)[:-1]
    deflection = values["factor"] * load * x**2 * (length - x) ** 2 / (3.0 * 3.4e10 * 1.2 * length)
    waves = 2.0 * np.abs(np.fft.rfft(deflection)) / x.size
    added = tuple(TrackLines(length_m=length / n, amplitude_m=float(waves[n]), harmonics=1) for n in range(1, 7))
    return with_irregularity(campaign, series=added)


CASES = (
    Case(
        "wheel_polygon",
        "wheelset 2",
        wheels(wheel=2, harmonics=1),
        {"amplitude_m": 6e-6, "order": 4.0},
        {"order": 0.01, "amplitude_m": 0.15},
    ),
    Case(
        "rail_corrugation",
        "rail",
        lambda c, v: with_irregularity(c, bands=(RoughBand(**v),)),
        {"gain_dB": 8.0, "wavelength_m": 0.9, "octaves": 0.1},
        {"wavelength_m": 0.03, "octaves": 0.3, "gain_dB": 0.2},
    ),
    Case(
        "dipped_welds",
        "rail",
        lambda c, v: with_irregularity(c, dips=(Dips(**v),)),
        {"depth_m": 1e-3, "length_m": 0.8},
        {"depth_m": 0.15, "length_m": 0.1},
    ),
    Case(
        "rail_joint",
        "rail",
        series(),
        {"amplitude_m": 6e-5, "length_m": 20.0, "decay": 1.0},
        {"length_m": 0.01, "amplitude_m": 0.3, "decay": 0.2},
    ),
    Case(
        "wheel_flat",
        "wheelset 1",
        wheels(wheel=1),
        {"amplitude_m": 3e-6, "decay": 0.4},
        {"amplitude_m": 0.3, "decay": 0.5},
    ),
    Case(
        "contact_filter",
        "contact",
        lambda c, v: with_irregularity(c, contact_patch_m=v["half_length_m"]),
        {"half_length_m": 0.1},
        {"half_length_m": 0.15},
    ),
    Case("contact_nonlinear", "contact", softer, {"factor": 0.6}, {"factor": 0.15}, none=1.0),
    Case(
        "irregularity_level",
        "fast",
        lambda c, v: with_irregularity(c, level_by_condition_dB={"fast": v["level_dB"]}),
        {"level_dB": 4.0},
        {"level_dB": 0.2},
    ),
    Case(
        "parametric_support",
        "pad",
        series(length_m=0.6, harmonics=4),
        {"amplitude_m": 4e-6, "decay": 2.0},
        {"amplitude_m": 0.2},
    ),
    Case("moving_load", "deck", crossing, {"factor": 6.0}, {"factor": 0.3}),
    Case(
        "span_camber",
        "deck",
        series(length_m=24.0),
        {"amplitude_m": 2e-3, "decay": 2.0},
        {"amplitude_m": 0.3, "decay": 0.2},
    ),
    Case(
        "sensor_mounting",
        "deck@9",
        chain("deck@9", lambda v: {"mount_Hz": v["mount_Hz"]}),
        {"mount_Hz": 500.0},
        {"mount_Hz": 0.1},
        none=np.inf,
    ),
    Case("sensor_delay", "axle3", chain("axle3", dict), {"delay_s": 1.5e-3}, {"delay_s": 0.15}),
    Case("sensor_delay", "axle3", chain("axle3", dict), {"clock_slow": 4e-5}, {"clock_slow": 0.15}),
    Case(
        "noise_floor",
        "floor",
        chain("floor", lambda v: {"noise_floor": 1e-7 * (1.0 + v["extra"])}),
        {"extra": 30.0},
        {"extra": 0.4},
    ),
    Case(
        "mains_lines",
        "floor",
        chain("floor", lambda v: {"mains": Mains(**v)}),
        {"amplitude": 0.003, "frequency_Hz": 50.0},
        {"frequency_Hz": 0.002, "amplitude": 0.3},
    ),
    Case(
        "speed_error",
        "speed of fast",
        lambda c, v: with_speed(c, v["factor"], "fast"),
        {"factor": 1.015},
        {"factor": 0.004},
        none=1.0,
    ),
    Case(
        "second_source",
        "car1.bogie1.bounce",
        lambda c, v: with_irregularity(c, pushes=(Push(degree="car1.bogie1.bounce", **v),)),
        {"density_N2_per_Hz": 3e3, "centre_Hz": 30.0, "octaves": 0.5},
        {"density_N2_per_Hz": 0.4, "centre_Hz": 0.2, "octaves": 0.4},
    ),
    Case(
        "second_source",
        "car1.bogie1.bounce",
        lambda c, v: with_irregularity(c, pushes=(Push(degree="car1.bogie1.bounce", **v),)),
        {"density_N2_per_Hz": 3e3, "centre_Hz": 45.0, "quality": 4.0},
        {"density_N2_per_Hz": 0.4, "centre_Hz": 0.05, "quality": 0.4},
    ),
    Case("sensor_gain", "axle2", chain("axle2", dict), {"gain": 1.25}, {"gain": 0.05}, none=1.0),
)


@pytest.fixture(scope="module")
def nominal_campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    return campaign_in(tmp_path_factory.mktemp("train"))


@pytest.fixture(scope="module")
def quiet(nominal_campaign: Campaign) -> Situation:
    """Nothing is missing."""
    return situation_of(nominal_campaign, 1)


def hypotheses(situation: Situation, entry: str, place: str = "") -> list[Hypothesis]:
    """Of an entry, at a place."""
    every = entries()[entry].hypotheses(situation)
    return [h for h in every if place in h.locate({f.name: f.value(0.0) for f in h.free}).label]


def injected(nominal_campaign: Campaign, case: Case, strength: float) -> Observations:
    """What is measured when the effect is there."""
    return observations_of(nominal_campaign, 11, amend=lambda truth: case.inject(truth, case.at(strength)))


def others(entry: str) -> list[str]:
    """The entries of other families here."""
    return [name for name in MINE if entries()[name].FAMILY != entries()[entry].FAMILY]


DIPS = [
    Case(
        "dipped_welds",
        "rail",
        lambda c, v: with_irregularity(c, dips=(Dips(**v),)),
        {"depth_m": 1e-3, "length_m": length_m},
        {"depth_m": 0.15, "length_m": 0.1},
    )
    for length_m in (0.2, 0.42, 1.15, 2.4)
]
"""What the level takes up lies between one length of dips and another: each is begun with near itself."""

MEASURED = [*CASES, *DIPS]


@pytest.mark.injection
@pytest.mark.parametrize("case", MEASURED, ids=[f"{case.entry}-{[*case.values][-1]}" for case in MEASURED])
def test_the_strongest_is_named_and_measured(nominal_campaign: Campaign, case: Case) -> None:
    found = searched(injected(nominal_campaign, case, 1.0), case.entry, *others(case.entry))
    own = found.best()
    assert own is not None
    assert own.names == (case.entry,)
    values = own.values(0)
    assert case.place in own.amendments[0].locate(values).label
    for name, width in case.within.items():
        assert values[name] == pytest.approx(case.values[name], rel=width), values


@pytest.mark.injection
@pytest.mark.parametrize("case", CASES, ids=[f"{case.entry}-{[*case.values][-1]}" for case in CASES])
def test_more_effect_is_more_gain(nominal_campaign: Campaign, case: Case) -> None:
    gains = []
    for strength in (0.25, 0.6):
        found = searched(injected(nominal_campaign, case, strength), case.entry)
        gains.append(found.gain(found.best()))
    assert gains[1] > gains[0]


def test_a_wrong_polarity_is_named(nominal_campaign: Campaign) -> None:
    turned = chain("bogie", lambda _: {"polarity": -1})
    found = searched(observations_of(nominal_campaign, 12, amend=lambda c: turned(c, {})), *MINE)
    best = found.best()
    assert best is not None
    assert best.names == ("sensor_polarity",)
    assert "bogie" in best.amendments[0].locate(best.values(0)).label


def test_nothing_missing_names_nothing(nominal_campaign: Campaign) -> None:
    """Of all these entries, on one draw of the noise."""
    found = searched(observations_of(nominal_campaign, 1), *MINE)
    assert found.members[0] is found.empty


@pytest.mark.parametrize("entry", [*MINE])
def test_without_the_effect_nothing_changes(quiet: Situation, entry: str) -> None:
    campaign = quiet.campaign
    datasets = blank(campaign)
    plain = predict(campaign, datasets, threads=1)
    for hypothesis in islice(entries()[entry].hypotheses(quiet), 2):
        # Numbers beside the size stand at their most likely; those that are sizes too at nothing.
        values = {f.name: f.value(0.0) for f in hypothesis.free}
        values[hypothesis.size] = hypothesis.none
        same = predict(hypothesis.amend(campaign, values), datasets, threads=1)
        for one, other in zip(plain, same, strict=True):
            name = "frf" if "frf" in one else "csd"
            assert np.abs(one[name].values - other[name].values).max() <= 1e-9 * np.abs(one[name].values).max()


@pytest.mark.injection
@pytest.mark.parametrize("entry", [*MINE])
def test_the_ends_of_all_ranges_can_be_solved(quiet: Situation, entry: str) -> None:
    datasets = blank(quiet.campaign)
    for hypothesis in islice(entries()[entry].hypotheses(quiet), 1):
        for end in (0, 1):
            values = {f.name: f.value(f.limits[end]) for f in hypothesis.free}
            for found in predict(hypothesis.amend(quiet.campaign, values), datasets, threads=1):
                name = "frf" if "frf" in found else "csd"
                assert np.isfinite(found[name].values).all()


def test_a_line_without_a_train_has_none_of_it(tmp_path: Path) -> None:
    made = simulate(tmp_path, 3)
    situation = Situation(recalibrate(gather(made.campaign, threads=1)), ())
    of_sensors = ("sensor_mounting", "sensor_delay", "sensor_polarity", "sensor_gain")
    for entry in MINE:
        count = len(list(entries()[entry].hypotheses(situation)))
        assert count == (2 if entry in of_sensors else 0), entry


def test_every_entry_states_what_it_is() -> None:
    for entry in MINE:
        module = entries()[entry]
        assert entry == module.ID
        assert all((module.SUMMARY, module.SIGNATURE, module.SOURCE, module.CONFUSED_WITH, module.PARAMETERS))
        assert entry not in module.CONFUSED_WITH


def test_hum_is_offered_with_lines_that_fall_and_with_lines_of_their_own(quiet: Situation) -> None:
    offered = hypotheses(quiet, "mains_lines", "floor")
    built = [h.amend(quiet.campaign, {f.name: f.value(0.0) for f in h.free}) for h in offered]
    hums = [campaign.sensor("floor").chain.mains for campaign in built]
    assert {mains.shares is None for mains in hums if mains is not None} == {True, False}
