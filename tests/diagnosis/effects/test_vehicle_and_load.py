"""Effects of the vehicle and of load and temperature, put into the tool's own model: unit tests, and no proof."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.campaign.predict import predict
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.hypothesis import Entry, Hypothesis, Situation
from permway.diagnosis.recalibrate import recalibrate
from searched import searched
from simulated_train import blank, measured, tables, written

INJECTED: dict[str, tuple[str, tuple[float, float, float], dict[str, float]]] = {
    "wheelset_bending": (
        "wheelsets",
        (0.02, 0.08, 0.3),
        {"contact": 0.8, "frequency_Hz": 80.0, "loss_factor": 0.04},
    ),
    "axlebox_absorber": ("wheelset1", (10.0, 30.0, 100.0), {"frequency_Hz": 50.0, "loss_factor": 0.1}),
    "bogie_modes": ("bogies", (-0.02, -0.06, -0.15), {"frequency_Hz": 40.0, "loss_factor": 0.04}),
    "body_bending": ("body", (-0.05, -0.15, -0.4), {"frequency_Hz": 11.0, "loss_factor": 0.04}),
    "damper_series_stiffness": ("primary dampers", (0.0005, 0.001, 0.003), {}),
    "suspension_friction": ("primary suspension", (30.0, 100.0, 500.0), {"velocity_m_per_s": 0.01}),
    "air_spring": ("secondary springs", (0.5, 1.5, 4.0), {"transition_Hz": 8.0}),
    "pad_preload": ("pad", (1.05, 1.2, 1.6), {"unloaded_factor": 1.0}),
    "pad_amplitude": (
        "pad",
        (0.05, 0.15, 0.4),
        {"relative_amplitude": 1.0, "loss_share": 0.3, "unstrained_factor": 1.0},
    ),
    "pad_temperature": ("pad", (0.002, 0.006, 0.02), {"loss_ratio": 1.0, "reference_factor": 1.0}),
}
"""Where, how strong, and what else an effect is made of."""

RIVALS = (*INJECTED, "pad_frequency", "sensor_gain")


@cache
def entry(name: str) -> Entry:
    return import_module(f"permway.diagnosis.catalogue.{name}")  # type: ignore[return-value]


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Callable[[bool], Fit]:
    """The base where nothing is missing, with a test in the cold or without."""

    @cache
    def made(cold: bool) -> Fit:
        campaign = written(tmp_path_factory.mktemp("sound"), *tables(cold=cold))
        return recalibrate(gather(campaign, measured(campaign, 1), threads=1))

    return made


def of(name: str, fit: Fit) -> list[Hypothesis]:
    return list(entry(name).hypotheses(Situation(fit, ())))


def placed(name: str, fit: Fit) -> Hypothesis:
    """The hypothesis of an entry at the place that is injected."""
    return next(h for h in of(name, fit) if h.locate(centre(h)).what == INJECTED[name][0])


def centre(hypothesis: Hypothesis) -> dict[str, float]:
    return {f.name: f.value(0.0) for f in hypothesis.free}


@pytest.mark.injection
@pytest.mark.parametrize("name", list(INJECTED))
def test_an_effect_is_named_and_sized(name: str, sound: Callable[[bool], Fit]) -> None:
    what, sizes, rest = INJECTED[name]
    base = sound(name == "pad_temperature")
    campaign, hypothesis = base.observations.campaign, placed(name, base)
    family = entry(name).FAMILY
    rivals = [rival for rival in RIVALS if family != entry(rival).FAMILY]
    gains = []
    for size in sizes:
        truth = {hypothesis.size: size, **rest}
        records = measured(campaign, 1, lambda c, truth=truth: hypothesis.amend(c, truth))  # type: ignore[misc]
        found = searched(gather(campaign, records, threads=1), name, *rivals)
        gains.append(found.gain(found.best(name)))
    assert gains[0] > 1.5
    assert gains[0] < gains[1] < gains[2]
    mine = found.best()
    assert mine is not None
    assert mine.names == (name,)
    assert mine.amendments[0].locate(mine.values(0)).what == what
    assert mine.fit.hyper.novel < 0.5
    assert mine.amendments[0].form == hypothesis.form
    sigma = np.sqrt(np.diag(mine.fit.spread))[mine.own(0)]
    values = mine.values(0)
    for free, z, spread in zip(mine.amendments[0].free, mine.fit.z[mine.own(0)], sigma, strict=True):
        # A unit in z is the prior's spread; records that say nothing more leave the prior.
        slope = (free.value(float(z) + 1e-4) - free.value(float(z))) / 1e-4
        # For the same reason narrow intervals are less sure than they state.
        allowed = max(4.0 * spread * abs(slope), 0.01 * abs(truth[free.name]))
        assert abs(values[free.name] - truth[free.name]) < allowed, free.name


def test_pads_that_shift_with_temperature_are_distinguished_from_pads_that_only_stiffen(
    sound: Callable[[bool], Fit],
) -> None:
    """Their springpot, and by how much ten kelvin move it."""
    base = sound(True)
    campaign = base.observations.campaign
    (shifted,) = (h for h in of("pad_temperature", base) if h.variant)
    truth = {"stiffness_factor": 1.0, "order": 0.3, "share": 0.7, "rest": 0.3, "decades_per_10K": 0.8}
    records = measured(campaign, 1, lambda c: shifted.amend(c, truth))
    found = searched(gather(campaign, records, threads=1), "pad_temperature")
    best = found.best()
    assert best is not None
    assert best.amendments[0].variant == "shifted"
    others = [m for m in found.members if m.amendments and m.amendments[0].variant == ""]
    assert all(found.gain(best) > found.gain(other) + 4.5 for other in others)
    values = best.values(0)
    assert values["order"] == pytest.approx(0.3, rel=0.15)
    assert values["decades_per_10K"] == pytest.approx(0.8, rel=0.15)


@pytest.mark.parametrize("name", list(INJECTED))
def test_where_there_is_no_such_part_there_is_no_hypothesis(name: str, tmp_path: Path) -> None:
    class Bare:
        campaign = written(tmp_path, *tables(train=False, cold=False))

    assert list(entry(name).hypotheses(Bare())) == []  # type: ignore[arg-type]


@pytest.mark.injection
@pytest.mark.parametrize("name", list(INJECTED))
def test_none_is_no_effect_and_the_ends_of_the_range_can_be_solved(
    name: str, sound: Callable[[bool], Fit]
) -> None:
    base = sound(name == "pad_temperature")
    campaign: Campaign = base.observations.campaign
    datasets = blank(campaign)
    plain = predict(campaign, datasets, threads=1)
    assert set(entry(name).PARAMETERS) == {f.name for h in of(name, base) for f in h.free}
    for hypothesis in of(name, base):
        assert hypothesis.size in {f.name for f in hypothesis.free}
        assert (hypothesis.entry, hypothesis.domain, hypothesis.family) == (
            name,
            entry(name).DOMAIN,
            entry(name).FAMILY,
        )
        nothing = hypothesis.amend(campaign, {**centre(hypothesis), hypothesis.size: hypothesis.none})
        for mine, other in zip(predict(nothing, datasets, threads=1), plain, strict=True):
            for variable in other:
                np.testing.assert_allclose(mine[variable].values, other[variable].values, rtol=1e-6)
        for end in (0, 1):
            for free in hypothesis.free:
                values = {**centre(hypothesis), free.name: free.value(free.limits[end])}
                assert hypothesis.law(values)
                for found in predict(hypothesis.amend(campaign, values), datasets, threads=1):
                    assert all(np.isfinite(found[variable].values).all() for variable in found)
