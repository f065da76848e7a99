"""The track as a train finds it: equilibrium, Parseval, and supports by a second formulation."""

from __future__ import annotations

import numpy as np
import pytest
from permway.challenge.beams import Complexes, Reals
from permway.challenge.effects.under_load import PADS, ClosingGap, PadFriction, PadPreload, berg
from permway.challenge.mesh import Mesh
from permway.challenge.plan import Plan
from permway.challenge.track import Location, Track
from permway.challenge.under_train import Ridden, Support, Worked
from permway.challenge.vehicle import wheel_load
from permway.errors import SolveError
from scipy.interpolate import CubicSpline
from short_deck import small_plan, small_site

SAMPLES, RATE_HZ = 4096, 1024.0
GRID_HZ = np.concatenate([np.arange(1.0, 60.0, 1.0), np.arange(60.0, 430.0, 5.0)])


def ridden(plan: Plan) -> Ridden:
    wheels: list[Location] = [("rail", x) for x in plan.layout.wheels_m(plan.values["vehicle"])]
    return Ridden(plan.track, wheels, plan.vehicle, wheel_load(plan.values), 20.0)


def profiles(size_m: float) -> tuple[Reals, Complexes]:
    """Lines, and a rough profile under each wheel."""
    frequency = np.fft.rfftfreq(SAMPLES, 1.0 / RATE_HZ)
    kept = (frequency > 1.0) & (frequency < 420.0)
    random = np.random.default_rng(3).standard_normal((2, int(kept.sum()), 4))
    lines = np.asarray(frequency[kept], dtype=np.float64)
    return lines, np.asarray(SAMPLES * size_m * (random[0] + 1j * random[1]) / lines[:, None])


def worked(plan: Plan, supports: list[Support], size_m: float = 1e-5) -> tuple[list[Worked], Complexes]:
    """What supports were shown, and the receptance under the wheels."""
    shown: list[Worked] = []

    def look(_: Track, one: Worked) -> Complexes:
        shown.append(one)
        return np.ones(one.shaken.size, dtype=np.complex128)

    lines, met = profiles(size_m)
    under = ridden(plan).receptance([look, *supports], GRID_HZ, lines_Hz=lines, profiles=met, samples=SAMPLES)
    return shown, under


@pytest.mark.parametrize("exponent", [0.0, 0.7])
def test_fasteners_carry_the_train(exponent: float) -> None:
    plan = small_plan(small_site())
    if exponent:
        PadPreload(exponent).apply(plan)
    shown, _ = worked(plan, plan.supports)
    pads = np.array([link.law in PADS for link in plan.track.links])
    # What the rail's own mass takes at a quarter of a hertz is next to nothing.
    assert shown[-1].carried[pads].sum() == pytest.approx(4.0 * wheel_load(plan.values), rel=2e-3)


def test_mean_squares_are_those_of_the_record() -> None:
    plan = small_plan(small_site())
    shown, under = worked(plan, [])
    lines, met = profiles(1e-5)
    force = plan.vehicle.pressed(lines, CubicSpline(GRID_HZ, under)(lines)) @ met[:, :, None]
    mesh_locations: list[Location] = [("rail", plan.layout.station(12)), ("slab", plan.layout.station(12))]
    one = ridden(plan)
    locations = [*one.wheels, *mesh_locations]
    moved = Mesh(plan.track, locations).receptance(lines, 20.0, mesh_locations, list(one.wheels))
    spectrum = np.zeros(SAMPLES // 2 + 1, dtype=np.complex128)
    bins = np.round(lines * SAMPLES / RATE_HZ).astype(int)
    spectrum[bins] = np.einsum("fw,fw->f", moved[:, 0] - moved[:, 1], force[:, :, 0])
    record = np.fft.irfft(spectrum, n=SAMPLES)
    index = next(
        i
        for i, link in enumerate(plan.track.links)
        if link.law == "pad" and link.locations[0] == mesh_locations[0]
    )
    assert shown[-1].shaken[index] == pytest.approx(float(np.sqrt(np.mean(record**2))), rel=0.02)


def test_a_train_that_changes_nothing_meets_the_hammers_track() -> None:
    plan = small_plan(small_site())
    _, plain = worked(plan, [])
    PadFriction(0.5, 1e-5).apply(plan)
    _, still = worked(plan, plan.supports, size_m=1e-15)
    np.testing.assert_allclose(still, plain, rtol=1e-4)
    _, shaken = worked(plan, plan.supports, size_m=1e-4)
    assert np.abs(shaken[0] / plain[0]).max() > 1.2


def test_bergs_friction_is_that_of_its_loop() -> None:
    """Force from turning point to turning point: F = Fs + (x - xs)(Fmax - Fs) / (x2 (1 - Fs / Fmax) + x - xs)."""
    for amplitude in (0.1, 1.0, 7.0):
        path = amplitude * np.cos(np.linspace(0.0, 400.0 * np.pi, 400_001))
        force = np.zeros(path.size)
        turned_at, turned_force, last = 0.0, 0.0, 0.0
        for i in range(1, path.size):
            way = np.sign(path[i] - path[i - 1])
            if way != last:
                turned_at, turned_force, last = path[i - 1], force[i - 1], way
            gone = way * (path[i] - turned_at)
            force[i] = turned_force + way * gone * (1.0 - way * turned_force) / (1.0 - way * turned_force + gone)
        loop = slice(-2_001, None)
        lost = float(np.sum(0.5 * (force[loop][1:] + force[loop][:-1]) * np.diff(path[loop])))
        stiffness = 0.5 * float(np.ptp(force[loop])) / amplitude
        law = complex(berg(np.array([amplitude]))[0])
        assert law.real == pytest.approx(stiffness, rel=2e-3)
        assert law.imag == pytest.approx(lost / (np.pi * amplitude**2), rel=5e-3)
    assert complex(berg(np.zeros(1))[0]) == pytest.approx(1.0, abs=1e-3)


def test_a_gap_closes_under_a_train_that_stands_on_it_and_no_other() -> None:
    plan = small_plan(small_site())
    wheel = plan.layout.wheels_m(plan.values["vehicle"])[1]
    ClosingGap((wheel - 3.0, wheel + 0.4), 5e-4, 1e-5).apply(plan)
    _, hollow = worked(plan, [])
    _, closed = worked(plan, plan.supports)
    _, plain = worked(small_plan(small_site()), [])
    assert np.abs(hollow[20, 1, 1] / plain[20, 1, 1] - 1.0) > 0.1
    np.testing.assert_allclose(closed[:, 1, 1], plain[:, 1, 1], rtol=2e-2)
    wide = small_plan(small_site())
    ClosingGap((wheel - 3.0, wheel + 0.4), 5e-4, 1.0).apply(wide)
    _, still = worked(wide, wide.supports)
    np.testing.assert_allclose(still, hollow, rtol=1e-9)


def test_supports_that_never_settle_are_reported() -> None:
    plan = small_plan(small_site())
    turns = iter(range(1000))

    def restless(_: Track, one: Worked) -> Complexes:
        return np.full(one.shaken.size, 2.0 - next(turns) % 2, dtype=np.complex128)

    with pytest.raises(SolveError, match="do not settle"):
        worked(plan, [restless])
