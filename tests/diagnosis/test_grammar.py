"""Elements of the grammar by closed forms."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from permway.campaign.campaign import Campaign
from permway.diagnosis import describe
from permway.diagnosis.bases import bases
from permway.diagnosis.catalogue._change import fixed_mass, hung_mass, with_joints, with_law
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.clock import Clock
from permway.diagnosis.diagnose import diagnose
from permway.diagnosis.elements import AT_HZ, ELEMENTS, LEAST, PART, Element, coordinate_of
from permway.diagnosis.gather import gather
from permway.diagnosis.grammar import alike, hypotheses
from permway.diagnosis.grammar_parts import partly_springpot
from permway.diagnosis.grammar_places import bodies, joints
from permway.diagnosis.hypothesis import Situation
from permway.diagnosis.locate import scanned
from permway.diagnosis.search import Finalist, search
from permway.diagnosis.spot import Found, Spot
from permway.laws import Hysteretic
from permway.model.joints import Joints
from permway.model.presets import slab_track_viaduct_32m
from simulated import simulate

ROD = next(e for e in ELEMENTS if e.name == "rod")


@pytest.mark.parametrize("first_Hz", [12.0, 34.0])
def test_a_rod_is_its_wave_equation(first_Hz: float) -> None:
    """Held below and free above: -M w^2 tan(b)/b with b = (pi/2) (f/f1) / sqrt(1 + i eta)."""
    mass, eta = 1.2e4, 0.04
    frequency = np.linspace(0.5, 3.6 * first_Hz, 400)
    law = ROD.law({"mass_kg": mass, "frequency_Hz": first_Hz, "loss_factor": eta})
    angle = 0.5 * np.pi * frequency / first_Hz / np.sqrt(1.0 + 1j * eta)
    exact = -mass * (2.0 * np.pi * frequency) ** 2 * np.tan(angle) / angle
    np.testing.assert_allclose(law.complex(frequency, None), exact, rtol=0.02, atol=0.01 * np.abs(exact).max())


@pytest.mark.parametrize("element", ELEMENTS, ids=lambda e: e.name)
@pytest.mark.parametrize("far", [-4.0, 0.0, 4.0])
def test_no_element_gives_energy(element: Element, far: float) -> None:
    free = element.free(1e8, 20.0)
    for sign in (1.0, -1.0):
        values = {f.name: f.value(float(np.clip(sign * far, *f.limits))) for f in free}
        stiffness = element.law(values).complex(np.geomspace(1.0, 1000.0, 50), None)
        assert (stiffness.imag >= -1e-9 * np.abs(stiffness)).all()


def described(campaign: Campaign) -> Finalist:
    """The element that does best."""
    base, searched = bases(gather(campaign, threads=1), Clock(None))
    result = search(
        searched,
        hypotheses(Situation(searched, scanned(searched))),
        learnt_base=base,
        prefix="1.",
        threshold=lambda _ring, _screened: 10.0,
        progress=lambda *_: None,
    )
    return result.finalists[0]


def beside_four_pads(campaign: Campaign) -> Campaign:
    joints = Joints(between=("rail", "deck"), law="inertia", at=(6.6, 7.2, 7.8, 8.4))
    return with_joints(campaign, joints, laws={"inertia": fixed_mass(6.0)})


def test_inertances_beside_some_pads_are_described_as_such(tmp_path: Path) -> None:
    """No effect of the catalogue; a stretch of elements, with its ends and its size."""
    best = described(simulate(tmp_path / "c", 8, amend=beside_four_pads).campaign)
    assert best.hypothesis.family == "inerter beside each joint of a stretch"
    assert best.values["inertance_kg"] == pytest.approx(6.0, rel=0.1)
    start, stop = best.hypothesis.locate(best.values).x_m or (0.0, 0.0)
    assert start == pytest.approx(6.6, abs=0.4)
    assert stop == pytest.approx(8.4, abs=0.4)


@pytest.mark.parametrize(("start_m", "stop_m", "inertance_kg"), [(7.8, 12.0, 20.0), (1.2, 9.0, 30.0)])
def test_a_long_stretch_is_found_with_its_ends(
    tmp_path: Path, start_m: float, stop_m: float, inertance_kg: float
) -> None:
    """Much that is missing bends the base so far that the most telling place may be beside the stretch."""

    def beside_pads(campaign: Campaign) -> Campaign:
        x = tuple(np.round(np.arange(start_m, stop_m + 0.1, 0.6), 9).tolist())
        joints = Joints(between=("rail", "deck"), law="inertia", at=x)
        return with_joints(campaign, joints, laws={"inertia": fixed_mass(inertance_kg)})

    best = described(simulate(tmp_path / "c", 8, amend=beside_pads).campaign)
    assert best.hypothesis.family == "inerter beside each joint of a stretch"
    assert best.values["inertance_kg"] == pytest.approx(inertance_kg, rel=0.02)
    assert best.hypothesis.locate(best.values).x_m == pytest.approx((start_m, stop_m))


def test_pads_that_keep_a_part_lose_as_much_of_their_damping(tmp_path: Path) -> None:
    """Where a spring that pushes away would leave all of it."""
    case = simulate(tmp_path / "c", 8, amend=lambda campaign: weakened(campaign, "pad", 6.9, 0.6, 0.2))
    best = described(case.campaign)
    assert best.hypothesis.family == "part beside each joint of a stretch"
    assert best.values["share"] == pytest.approx(-0.8, abs=0.05)
    assert best.hypothesis.locate(best.values).x_m == pytest.approx((6.6, 7.2))
    assert "a spring of -0.8" in best.hypothesis.law(best.values)


def test_pads_that_hardly_hold_are_told_by_how_little_is_left(tmp_path: Path) -> None:
    """Where the scan of a bent base leads to rods in their place, which leave a misfit of 2.8."""
    case = simulate(tmp_path / "c", 8, amend=lambda campaign: weakened(campaign, "pad", 7.5, 1.8, 0.003))
    best = described(case.campaign)
    assert best.hypothesis.family == "part beside each joint of a stretch"
    assert 1.0 + best.values["share"] == pytest.approx(0.003, rel=0.15)
    assert best.hypothesis.locate(best.values).x_m == pytest.approx((6.6, 8.4))


def test_a_part_is_counted_by_the_logarithm_of_what_is_there() -> None:
    (share,) = PART.free(1.0, 1.0)
    assert [share.value(z) for z in (0.0, -1.0, 1.0)] == pytest.approx([0.0, -0.5, 1.0])
    assert share.value(coordinate_of(-0.99)) == pytest.approx(-0.99)
    assert share.value(share.limits[0]) == pytest.approx(LEAST - 1.0)


def test_pads_of_which_a_part_relaxes_are_told_by_share_and_order(tmp_path: Path) -> None:
    """Their owner knows how stiff they are; a springpot beside them would have that be half as much."""

    def relaxing(campaign: Campaign) -> Campaign:
        return with_law(campaign, "pad", partly_springpot(campaign.model.line.laws["pad"], 0.5, 0.4))

    best = described(simulate(tmp_path / "c", 8, amend=relaxing).campaign)
    assert best.hypothesis.family == "springpot in place of a part of every joint of the layer"
    assert best.hypothesis.locate(best.values).what == "pad"
    assert best.values == pytest.approx({"share": 0.5, "order": 0.4}, rel=0.05)
    assert "springpot" in best.hypothesis.law(best.values)


def test_a_springpot_in_place_of_a_part_leaves_the_modulus_where_it_is_counted() -> None:
    law, at = Hysteretic(stiffness=6e7, loss_factor=0.0), np.array([AT_HZ])
    assert partly_springpot(law, 1.0, 0.3).complex(at) == pytest.approx(6e7 * np.exp(0.15j * np.pi))
    np.testing.assert_allclose(partly_springpot(law, 0.0, 0.3).complex(at), law.complex(at))


def test_a_bearing_that_keeps_a_part_is_told_by_that_alone(tmp_path: Path) -> None:
    """Its only neighbour is a span away: a stretch about it would hold both."""
    case = simulate(tmp_path / "c", 8, amend=lambda campaign: weakened(campaign, "bearing", 0.0, 0.0, 0.15))
    best = described(case.campaign)
    assert best.hypothesis.family == "part beside one joint"
    assert best.values["share"] == pytest.approx(-0.85, abs=0.05)
    assert best.hypothesis.locate(best.values).x_m == (0.0, 0.0)


def test_joints_of_another_layer_are_tried_where_they_tell_nearly_as_much() -> None:
    def joint(name: str, x: float, gain: float) -> Found:
        one = np.array([1.0])
        return Found(Spot("joint", name, (x, x)), gain, 24, one, one + 0j, one, one, 1e3)

    mortar = joint("mortar", 24.8, 124.0)
    pad, far, weak = joint("pad", 24.2, 110.0), joint("pad", 16.1, 123.0), joint("sliding", 24.8, 60.0)
    assert joints([mortar, far, joint("mortar", 24.2, 120.0), pad, weak]) == [mortar, pad]
    away, farther = joint("mortar", 16.1, 122.0), joint("mortar", 8.0, 121.0)
    assert joints([mortar, away, farther, pad]) == [mortar, pad, away]
    assert joints([]) == []


def on_the_rail_at_every_pad(campaign: Campaign) -> Campaign:
    line = campaign.model.line
    x = tuple(np.unique(line.joint_table().x[line.joint_table().law == list(line.laws).index("pad")]).tolist())
    joints = Joints(between=("rail", "ground"), law="hung", at=x)
    return with_joints(campaign, joints, laws={"hung": hung_mass(4.0, 90.0, 0.1)})


def test_what_hangs_at_every_pad_is_described_as_such(tmp_path: Path) -> None:
    best = described(simulate(tmp_path / "c", 8, amend=on_the_rail_at_every_pad).campaign)
    assert best.hypothesis.family == "resonator on the body at every joint of pad"
    assert best.values["mass_kg"] == pytest.approx(4.0, rel=0.2)
    assert best.values["frequency_Hz"] == pytest.approx(90.0, rel=0.05)
    assert best.hypothesis.locate(best.values).what == "rail"


def test_what_rings_alike_is_tried_where_one_ended() -> None:
    """A rod and a resonator have the same constants; of what hangs at every pad each is begun at the other's."""
    resonator, rod = (next(e for e in ELEMENTS if e.name == name) for name in ("resonator", "rod"))
    assert [f.name for f in resonator.free(1e7, 50.0)] == [f.name for f in rod.free(1e7, 50.0)]
    found = Found(
        spot=Spot("body", "rail", (6.0, 6.0)),
        gain=100.0,
        degrees=4,
        frequency_Hz=np.array([40.0, 50.0]),
        stiffness_N_per_m=np.array([1e7 + 1e6j, 2e7 + 1e6j]),
        sigma_N_per_m=np.array([1e6, 1e6]),
        by_band=np.array([0.5, 0.5]),
        total=1000.0,
    )
    line = slab_track_viaduct_32m()
    situation = cast(
        Situation, SimpleNamespace(found=(found,), campaign=SimpleNamespace(model=SimpleNamespace(line=line)))
    )
    offered = {h.family: h for h in hypotheses(situation)}
    one = offered["rod on the body at every joint of pad"]
    (other,) = alike(situation, None, one, (0.3, -0.2, 0.1))
    assert other.family == "resonator on the body at every joint of pad"
    assert other.starts == ((0.3, -0.2, 0.1),)
    assert not list(alike(situation, None, offered["dashpot on the body"], (0.0, 0.0)))


def test_what_no_name_explains_is_described_and_no_further_names_are_sought(tmp_path: Path) -> None:
    case = simulate(tmp_path / "c", 8, amend=beside_four_pads)
    stages: list[str] = []
    verdict = diagnose(case.campaign, threads=1, progress=lambda stage, *_: stages.append(stage)).verdict
    (effect,) = verdict.effects
    assert (verdict.status, effect.name, effect.place.joint) == ("described", None, "pad")
    assert "an inertance of 6" in effect.law.words
    assert effect.place.x is not None
    assert effect.place.x == pytest.approx((6.6, 8.4), abs=0.4)
    assert "drop" not in stages


SPRING = next(e for e in ELEMENTS if e.name == "spring")


@pytest.mark.parametrize("stiffness", [-1e6, -3e6])
def test_a_weak_pull_has_no_name(tmp_path: Path, stiffness: float) -> None:
    """Masses on springs mimic it; what BIC asks of a free stiffness hides that they do it worse."""

    def pulled(campaign: Campaign) -> Campaign:
        joints = Joints(between=("deck", "ground"), law="pulled", at=(7.0,))
        law = SPRING.law({"stiffness_N_per_m": stiffness, "loss_factor": 0.05})
        return with_joints(campaign, joints, laws={"pulled": law})

    verdict = diagnose(simulate(tmp_path / "c", 8, amend=pulled).campaign, threads=1).verdict
    (effect,) = verdict.effects
    assert (verdict.status, effect.name, effect.place.body) == ("described", None, "deck")
    assert "a spring of -" in effect.law.words


def test_bodies_that_tell_as_much_are_all_looked_at() -> None:
    """Layers of a track move together: slowly, none is told from another."""

    def told(name: str, gain: float) -> Found:
        return cast(Found, SimpleNamespace(spot=Spot("body", name, (6.0, 6.0)), surplus=gain))

    joint = cast(Found, SimpleNamespace(spot=Spot("joint", "pad", (6.0, 6.0)), surplus=85.0))
    found = [told("base", 80.0), joint, told("girder", 78.7), told("base", 78.0), told("rail", 40.0)]
    assert [one.spot.name for one in bodies(found)] == ["base", "girder"]


@pytest.mark.parametrize(
    ("misfit", "gain", "described"),
    [(1.04, 8e3, False), (1.16, 8e3, True), (30.0, 8e3, True), (30.0, 80.0, True)],
)
def test_a_fault_of_the_measurement_that_leaves_a_misfit_may_have_been_something_else(
    misfit: float, gain: float, described: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Resonators of a name that was ruled out were taken for a sensor's delay, at a misfit of 511.

    However little the scan of a base that is missed by far tells. A pad's dashpot was taken for absorbers on two
    axle boxes, at a misfit of 1.16.
    """

    def fit(heat: float, objective: float) -> Any:
        campaign = SimpleNamespace(model=SimpleNamespace(line=SimpleNamespace(laws={})))
        return SimpleNamespace(heat=heat, objective=objective, campaign=campaign)

    base, told = fit(600.0, 9e4), SimpleNamespace(surplus=gain, gain=gain, degrees=24)
    delay = SimpleNamespace(
        fit=fit(misfit, 8e4),
        hypothesis=SimpleNamespace(domain="measurement", entry="sensor_delay", free=()),
        values={"delay_s": 1e-3},
    )
    resonators = SimpleNamespace(
        fit=fit(1.0, 1e3), quick=SimpleNamespace(hypothesis=SimpleNamespace(free=()), gain=1.0)
    )
    elements = SimpleNamespace(finalists=(resonators,), ring=SimpleNamespace(fit=None))
    for name, stand_in in {
        "_searched": lambda *_: elements,
        "left": lambda *_: (),
        "_blind": lambda *_: False,
        "_closes": lambda *_: True,
    }.items():
        monkeypatch.setattr(describe.Description, name, stand_in)
    monkeypatch.setattr(describe, "beyond_belief", lambda _: False)
    monkeypatch.setattr(describe, "penalty", lambda *_: 0.0)
    monkeypatch.setattr(describe.decide, "explained", lambda *_: 0.1)
    description = describe.Description(cast(Any, base), cast(Any, base), cast(Any, (told,)), Clock(None))
    found = description.of(cast(Any, [SimpleNamespace(threshold=10.0)]), cast(Any, [delay]))
    assert (found is elements) is described


def test_what_is_alike_all_along_the_rail_is_tried_wherever_it_tells_most(tmp_path: Path) -> None:
    """Resonators on a rail over three spans told most of one girder, where no element explained them."""
    campaign = simulate(tmp_path / "c", 8).campaign
    _, searched = bases(gather(campaign, threads=1), Clock(None))
    deck = [one for one in scanned(searched) if one.spot.name != "rail"]
    rail = [one for one in scanned(searched) if one.spot.name == "rail"]
    assert rail[0].spot.kind == "body"
    offered = list(hypotheses(Situation(searched, (*deck, *rail))))
    assert any(h.family == "resonator on the body at every joint of pad" for h in offered)
    layers = {h.locate({}).what for h in offered if h.family == "springpot beside every joint of the layer"}
    assert layers == {one.spot.name for one in deck if one.spot.kind == "joint"}
    alone = [h for h in hypotheses(Situation(searched, tuple(rail))) if h.family.endswith("every joint of pad")]
    assert len(alone) == len({h.family for h in alone})


@pytest.mark.parametrize(("left", "instead"), [(1.0, True), (9.0, False)])
def test_a_description_that_does_not_fit_itself_ends_no_search(
    left: float, instead: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An inertance under a crack closed most of the gap that damped pads left, at a misfit of 9."""
    one = SimpleNamespace(fit=SimpleNamespace(heat=left))
    named = SimpleNamespace(fit=SimpleNamespace(heat=22.0), hypothesis=SimpleNamespace(domain="path"))
    monkeypatch.setattr(describe.Description, "of", lambda *_: SimpleNamespace(finalists=(one,)))
    monkeypatch.setattr(describe.Description, "_blind", lambda *_: False)
    monkeypatch.setattr(describe.Description, "_closes", lambda *_: True)
    monkeypatch.setattr(describe, "beyond_belief", lambda _: False)
    nothing = cast(Any, SimpleNamespace())
    description = describe.Description(nothing, nothing, (), Clock(None))
    assert description.instead(cast(Any, SimpleNamespace(finalists=(named,)))) is instead
