"""Recorders' faults, blows and what shakes a vehicle, by closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from permway.challenge.effects.above_wheels import AirSpring, BogieBending, SecondSource
from permway.challenge.effects.blows import POINTS, RailJoints, WheelFlat, series
from permway.challenge.effects.recorders import Clipping, ClockDrift
from permway.challenge.layout import WHEEL_RADIUS_M
from short_deck import small_plan, small_site

RATE_HZ, COUNT = 1024.0, 8192
TIMES = np.arange(COUNT) / RATE_HZ


def test_a_slow_clock_lags_ever_more() -> None:
    plan = small_plan(small_site())
    ClockDrift("axlebox2", 6e-5).apply(plan)
    turn = 2.0 * np.pi * 300.0
    read = plan.recorders[0]("axlebox2", np.sin(turn * TIMES))
    # Its record states t where (1 - e) t has passed.
    np.testing.assert_allclose(read, np.sin(turn * (1.0 - 6e-5) * TIMES), atol=2e-4)
    assert np.array_equal(plan.recorders[0]("axlebox1", TIMES), TIMES)


def test_a_range_cuts_off_what_is_beyond() -> None:
    plan = small_plan(small_site())
    Clipping("axlebox1", 1.0).apply(plan)
    values = np.sin(2.0 * np.pi * 3.0 * TIMES)
    read = plan.recorders[0]("axlebox1", values)
    assert np.abs(read).max() == pytest.approx(np.sqrt(0.5))
    inside = np.abs(values) < 0.7
    assert np.array_equal(read[inside], values[inside])


def test_a_series_is_its_shape_without_what_is_short() -> None:
    along = np.arange(POINTS) / POINTS
    shape = np.exp(np.cos(2.0 * np.pi * along))
    np.testing.assert_allclose(series(shape, along, 30), shape, atol=1e-12)
    np.testing.assert_allclose(series(shape, along + 2.0, 0), np.full(POINTS, shape.mean()))
    assert np.abs(np.fft.rfft(series(shape, along, 3))[4:]).max() < 1e-9


@pytest.mark.parametrize("speed", [55.0, 86.0])
def test_flats_and_joints_come_back_after_their_length(speed: float) -> None:
    plan = small_plan(small_site())
    WheelFlat(2, 1e-4, 0.04, 0.3).apply(plan)
    RailJoints(25.0, 2e-4, 0.6, 0.1).apply(plan)
    flat, joints = (each(TIMES, speed) for each in plan.wheel_profiles)
    turn_s = 2.0 * np.pi * WHEEL_RADIUS_M / speed
    assert not flat[[0, 2, 3]].any()
    np.testing.assert_allclose(plan.wheel_profiles[0](TIMES + turn_s, speed), flat, atol=1e-12)
    # Shorter waves than the recorder takes are left out, not what the dip is in the mean.
    assert flat[1].max() < 1e-4
    turn = np.linspace(0.0, turn_s, 4000, endpoint=False)
    mean = plan.wheel_profiles[0](turn, speed)[1].mean()
    assert mean == pytest.approx(0.5 * 1e-4 * 0.04 / (2.0 * np.pi * WHEEL_RADIUS_M), rel=1e-3)
    np.testing.assert_allclose(plan.wheel_profiles[1](TIMES + 25.0 / speed, speed), joints, atol=1e-12)
    wheels = plan.layout.wheels_m(plan.values["vehicle"])
    late = (wheels[0] - wheels[3]) / speed
    np.testing.assert_allclose(plan.wheel_profiles[1](TIMES + late, speed)[3], joints[0], atol=1e-12)


def test_an_air_spring_is_as_it_is_at_rest_and_gives_no_energy() -> None:
    plan, plain = small_plan(small_site()), small_plan(small_site())
    AirSpring(1.5, 2.0, 12.0).apply(plan)
    frequency = np.geomspace(1e-4, 400.0, 400)
    law, before = (one.vehicle.laws["secondary"](frequency) for one in (plan, plain))
    ks = plan.values["vehicle"]["ks"]
    assert law[0] == pytest.approx(ks, rel=2e-3)
    assert (law - before)[-1].real == pytest.approx(1.5 * ks, rel=2e-2)
    assert ((law - before).imag > -1e-6 * ks).all()


def test_a_bent_frame_takes_no_force_from_a_slow_ride() -> None:
    plan, plain = small_plan(small_site()), small_plan(small_site())
    BogieBending(40.0, 0.03).apply(plan)
    frequency = np.array([0.3, 42.0])
    track = np.broadcast_to(np.eye(4) * (1e-8 - 2e-9j), (2, 4, 4)).copy()
    after, before = (one.vehicle.influence(frequency, track) for one in (plan, plain))
    np.testing.assert_allclose(after[0].sum(axis=1), before[0].sum(axis=1), rtol=2e-2)
    bogie = list(plan.vehicle.channels).index("bogie1")
    assert np.abs(np.log(np.abs(after[1, bogie].sum() / before[1, bogie].sum()))) > 0.2


def test_a_source_shakes_with_its_force_and_dies_away_from_it() -> None:
    plan = small_plan(small_site())
    SecondSource("carbody", 200.0, 30.0, 4.0, 5).apply(plan)
    frequency = np.fft.rfftfreq(COUNT, 1.0 / RATE_HZ)[1:]
    (force,) = plan.vehicle.forces
    drawn = force.spectrum(frequency)
    assert np.sqrt(2.0 * np.sum(np.abs(drawn) ** 2)) == pytest.approx(200.0, rel=0.1)
    bins = np.arange(1, frequency.size + 1)
    track = np.broadcast_to(np.eye(4) * (1e-8 - 2e-9j), (frequency.size, 4, 4)).copy()
    moved = plan.vehicle.respond(frequency, track, np.zeros((frequency.size, 4)), bins=bins, samples=COUNT)
    # Far above its suspension the body is a mass.
    mass = plan.values["vehicle"]["half"] * plan.values["vehicle"]["Mc"]
    body = np.sum(
        np.abs(moved[:, list(plan.vehicle.channels).index("carbody")]) ** 2 * (2 * np.pi * frequency) ** 4
    )
    assert np.sqrt(2.0 * body) / COUNT == pytest.approx(200.0 / mass, rel=0.15)
