"""Concealed effects: each changes what it should and nothing else, and none creates energy."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from permway.challenge.case import _kinds
from permway.challenge.effects import (
    CATALOGUE,
    NEAR_DEGENERATE,
    NONLINEAR,
    OUTSIDE,
    STRENGTHS,
    Effect,
    above_wheels,
    recorders,
    under_load,
)
from permway.challenge.mesh import Mesh
from permway.challenge.plan import Plan
from permway.diagnosis.catalogue import entries
from short_deck import TWO_SPANS, small_plan, small_site

FREQUENCY = np.array([3.0, 11.0, 33.0, 90.0, 170.0, 290.0, 395.0])
EVERY = CATALOGUE + OUTSIDE + NONLINEAR
ONLY_UNDER_TRAIN = (under_load.PadPreload, under_load.PadFriction)


def drawn(kind: type[Effect], strength: str = "strong", seed: int = 1) -> Effect:
    return kind.draw(np.random.default_rng(seed), strength, small_site())  # type: ignore[arg-type]


def receptance(plan: Plan, temperature_C: float = -15.0) -> np.ndarray:
    locations = list(dict.fromkeys([*plan.tests.sensors, ("rail", 1.28), ("girder", 4.8)]))
    return Mesh(plan.track, locations).receptance(FREQUENCY, temperature_C, locations, locations)


@pytest.fixture(scope="module")
def base() -> np.ndarray:
    return receptance(small_plan(small_site()))


@pytest.mark.parametrize("kind", [kind for kind in EVERY if kind.DOMAIN == "path"], ids=lambda kind: kind.KIND)
def test_path_effect_is_reciprocal_passive_and_seen(kind: type[Effect], base: np.ndarray) -> None:
    plan = small_plan(small_site())
    drawn(kind).apply(plan)
    moved = receptance(plan)
    scale = np.abs(moved).max(axis=(1, 2), keepdims=True)
    assert np.allclose(moved / scale, np.swapaxes(moved, 1, 2) / scale, atol=1e-8)
    loss = -(moved - np.conj(np.swapaxes(moved, 1, 2))) / 2j
    assert np.linalg.eigvalsh(loss / scale).min() > -1e-9
    # A hammer does not feel what pads are under a train.
    assert np.array_equal(moved, base) or np.abs(np.log(np.abs(moved / base))).max() > 0.02
    assert np.array_equal(moved, base) == (kind in ONLY_UNDER_TRAIN)
    assert [plan.line_gain, plan.shapes, plan.wheel_profiles, plan.channel_gain] == [{}, [], [], {}]


@pytest.mark.parametrize("kind", [kind for kind in EVERY if kind.DOMAIN != "path"], ids=lambda kind: kind.KIND)
def test_other_effects_leave_the_track_alone(kind: type[Effect], base: np.ndarray) -> None:
    plan = small_plan(small_site())
    drawn(kind).apply(plan)
    assert np.array_equal(receptance(plan), base)


FELT = [kind for kind in EVERY if kind.DOMAIN == "vehicle" and kind is not above_wheels.SecondSource]


@pytest.mark.parametrize("kind", FELT, ids=lambda kind: kind.KIND)
def test_vehicle_effect_is_seen_on_board(kind: type[Effect]) -> None:
    changed, plain = small_plan(small_site()), small_plan(small_site())
    drawn(kind).apply(changed)
    track = np.broadcast_to(np.eye(4) * (1e-8 - 2e-9j), (FREQUENCY.size, 4, 4)).copy()
    before, after = (plan.vehicle.influence(FREQUENCY, track) for plan in (plain, changed))
    assert np.abs(np.log(np.abs(after / before))).max() > 0.05
    low = np.array([0.05])
    still = changed.vehicle.influence(low, track[:1])[0, -1].sum()
    assert still == pytest.approx(1.0, abs=0.05), "slowly, the body follows the rail"


@pytest.mark.parametrize("kind", EVERY, ids=lambda kind: kind.KIND)
def test_truth_of_an_effect_states_what_where_and_how_much(kind: type[Effect]) -> None:
    truth = json.loads(json.dumps(drawn(kind).truth()))
    assert {"id", "kind", "family", "domain", "place", "parameters", "mechanical", "alternatives", "words"} == set(
        truth
    )
    # What screening finds has a name of its own.
    named = {*entries(), *(("clipping",) if kind is recorders.Clipping else ())}
    assert truth["id"] in named if kind in CATALOGUE else truth["id"] in (None, *named)
    assert (truth["id"] is None) == (kind in OUTSIDE)
    assert truth["place"]
    assert truth["mechanical"]


@pytest.mark.parametrize(
    "kind", [k for k in EVERY if k.DOMAIN == "path" and k not in ONLY_UNDER_TRAIN], ids=lambda kind: kind.KIND
)
def test_strength_orders_what_is_seen(kind: type[Effect], base: np.ndarray) -> None:
    change = []
    for strength in STRENGTHS:
        plan = small_plan(small_site())
        drawn(kind, strength).apply(plan)
        change.append(np.sqrt(np.mean(np.abs(np.log(np.abs(receptance(plan) / base))) ** 2)))
    assert change[0] < change[2]


@pytest.mark.parametrize("kind", EVERY, ids=lambda kind: kind.KIND)
def test_every_effect_finds_a_place_on_two_spans(kind: type[Effect]) -> None:
    site = replace(small_site(), layout=TWO_SPANS)
    for seed in range(20):
        place = kind.draw(np.random.default_rng(seed), "strong", site).place.get("x_m") or [0.0]
        assert 0.0 <= min(place) <= max(place) <= TWO_SPANS.length_m


def test_several_effects_are_of_several_families() -> None:
    for seed in range(50):
        kinds = _kinds(np.random.default_rng(seed), "multiple")
        assert len({kind.FAMILY for kind in kinds}) == len(kinds)
        assert len(kinds) in (2, 3)
    assert all(kind.ALTERNATIVES for kind in NEAR_DEGENERATE)
