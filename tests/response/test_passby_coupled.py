"""Vehicles coupled to the line in time: limits, the frequency domain, and the vehicle's own equations."""

import numpy as np
import pytest
from lines import supported, uic60
from permway.laws import KelvinVoigt
from permway.model.bodies import Beam
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.vehicle_presets import crh380a
from permway.response.passby import Axles, MassOnSpring, SprungMass, couple, passby
from permway.response.passby.kernel import kernels
from permway.response.passby.path import path_of
from permway.response.passby.sprung import stepper
from permway.response.pseudo import wheel_rail_forces
from permway.response.receptance import receptance
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

PAD = KelvinVoigt(stiffness=8e7, damping=6e4)
G = 9.80665


def girder(damping=6e5):
    """Without loss, on three dashpots that no low mode's nodes meet: a causal line."""
    beam = Beam(
        youngs_modulus_Pa=3e10,
        second_moment_m4=2.0,
        density_kg_per_m3=2500.0,
        area_m2=4.0,
        intervals_m=((0.0, 20.0),),
        ends="pinned",
    )
    dashpots = Joints(between=("girder", "ground"), law="dashpot", at=(3.1, 8.3, 14.9))
    return Line(
        bodies={"girder": beam},
        joints=(dashpots,),
        laws={"dashpot": KelvinVoigt(stiffness=1.0, damping=damping)},
    )


SPOT = [Place(body="girder", x_m=7.0)]
TRACK = supported(uic60(loss_factor=0.02), count=41, spacing_m=0.6, pad=PAD)


def test_a_light_mass_is_a_moving_force():
    """A kilogram on 200 t of girder: its force is its weight, its answer that of a force, as the step shrinks."""
    line = girder()
    force = passby(
        line,
        Axles(lags_m=(0.0,), loads_N=(G,), speed_m_per_s=25.0, body="girder"),
        sensors=SPOT,
        highest_Hz=100.0,
        quantity="displacement",
        window_s=8.0,
    )
    wanted = CubicSpline(force["time"], force["history"][0, 0])
    errors = []
    for step in (0.02, 0.01, 0.005):
        data = couple(
            line,
            MassOnSpring(mass_kg=1.0),
            speed_m_per_s=25.0,
            contact_N_per_m=400.0,
            step_s=step,
            sensors=SPOT,
            body="girder",
            window_s=8.0,
        )
        assert np.abs(data["contact_force"] - G).max() < 1e-4 * G
        history = data["displacement"][0]
        inside = (history["time"] > 0.1).values
        errors.append(np.abs(history - wanted(history["time"]))[inside].max() / np.abs(history).max())
    assert errors[2] < 2e-4
    # Of second order; the last meets what the force's answer lacks above 100 Hz.
    assert errors[0] > 3.0 * errors[1]


@pytest.mark.parametrize(
    "vehicle",
    [
        SprungMass(mass_kg=4e3, stiffness_N_per_m=1e6, damping_Ns_per_m=2e4, wheel_mass_kg=600.0),
        crh380a(share=0.5),
    ],
)
def test_a_step_of_the_vehicle_is_exact_for_a_linear_force(vehicle):
    step = 1e-3
    parts = stepper(vehicle, 1e8, step)
    mass, damping, stiffness = vehicle.matrices()
    n, wheels = mass.shape[0], parts.wheels
    vertical = np.array([not name.endswith("pitch") for name in vehicle.degrees])
    start, stop = np.linspace(1e3, 4e3, wheels.size), np.linspace(-2e3, 5e3, wheels.size)
    load = np.zeros(n)

    def equation(time, y):
        load[:] = G * vertical * np.diag(mass)
        load[wheels] -= start + (stop - start) * time / step
        return np.concatenate([y[n:], np.linalg.solve(mass, load - damping @ y[n:] - stiffness @ y[:n])])

    state = np.linspace(0.0, 1e-3, 2 * n)
    exact = solve_ivp(equation, (0.0, step), state, rtol=1e-11, atol=1e-14).y[:, -1]
    ours = parts.state @ state + parts.weight + parts.before @ start + parts.after @ stop
    assert ours == pytest.approx(exact, rel=1e-8, abs=1e-12)
    # At rest on the ground it stays, under its own weight.
    weight = 1e8 * parts.rest[wheels]
    still = parts.state @ parts.rest + parts.weight + (parts.before + parts.after) @ weight
    assert still == pytest.approx(parts.rest, rel=1e-9, abs=1e-12)
    assert weight.sum() == pytest.approx(G * (vertical * np.diag(mass)).sum())


def test_kernels_add_up_to_the_response_at_rest():
    """A force that stays is a sum of triangles one step apart: the sum of the kernel is the static receptance."""
    path = path_of(TRACK, "rail", from_m=-1.2, to_m=1.2, ramp_m=0.0, highest_Hz=500.0, order=4)
    between, _, level = kernels(
        TRACK,
        path,
        [],
        step_s=1e-3,
        steps=400,
        window_s=1.0,
        temperature_C=None,
        formulation="chain",
        threads=1,
        progress=None,
    )
    places = path.places()
    still = receptance(TRACK, [1e-2], forces=places, sensors=places)["receptance"].values[0].real
    assert np.abs(between.sum(axis=1) - still).max() < 1e-4 * still.max()
    assert np.abs(between - between.transpose(2, 1, 0)).max() < 1e-9 * between.max()
    assert level < 1e-2


def test_a_wavy_surface_gives_the_force_of_the_frequency_domain():
    """Sine of 1 m at 30 m/s: 30 Hz. Against P = -(B_wheel + B_track + B_contact)^-1 R, the wheel standing.

    The support stiffness that the wheel passes (bays of 0.6 m, 50 Hz) and the ends are left out of that: 3 %.
    """
    vehicle = SprungMass(mass_kg=5e3, stiffness_N_per_m=8e5, damping_Ns_per_m=2e4, wheel_mass_kg=700.0)
    contact, speed, depth = 3e8, 30.0, 1e-4
    x = np.linspace(-12.0, 12.0, 4801)
    wave = depth * np.sin(2 * np.pi * x)
    options = {"speed_m_per_s": speed, "contact_N_per_m": contact, "step_s": 8e-4, "from_m": -6.0, "to_m": 6.0}
    rough = couple(TRACK, vehicle, profile=(x, wave), ramp_m=2.0, threads=1, **options)
    smooth = couple(TRACK, vehicle, ramp_m=2.0, threads=1, **options)
    force = (rough["contact_force"] - smooth["contact_force"])[0].values
    place = rough["wheel_x"][0].values
    inside = (place > -0.5) & (place < 3.5)
    amplitude = 2 * np.mean(force[inside] * np.exp(-2j * np.pi * place[inside]))
    frequency = np.array([30.0])
    mass, damping, stiffness = vehicle.matrices()
    omega = 2 * np.pi * 30.0
    wheel = np.linalg.inv(stiffness + 1j * omega * damping - omega**2 * mass)[1, 1]
    bay = [Place(body="rail", x_m=v) for v in (0.0, 0.15, 0.3)]
    track = np.diag(receptance(TRACK, frequency, forces=bay, sensors=bay)["receptance"].values[0]) @ [
        0.25,
        0.5,
        0.25,
    ]
    # The profile is the imaginary part of depth exp(i omega t): -i depth.
    expected = wheel_rail_forces([[[wheel]]], [[[track]]], 1 / contact, [[-1j * depth]])[0, 0]
    assert abs(amplitude - expected) < 0.03 * abs(expected)


def test_supports_shake_a_wheel_on_a_smooth_rail():
    """Parametric excitation: the contact force varies with the bay, 0.6 m, and its mean is the weight.

    The stiffness of the track must differ within the bay, so pads are stiff.
    """
    track = supported(
        uic60(loss_factor=0.02), count=41, spacing_m=0.6, pad=KelvinVoigt(stiffness=4e8, damping=1e5)
    )
    vehicle = SprungMass(mass_kg=5e3, stiffness_N_per_m=8e5, damping_Ns_per_m=2e4, wheel_mass_kg=700.0)
    data = couple(
        track,
        vehicle,
        speed_m_per_s=36.0,
        contact_N_per_m=3e8,
        step_s=8e-4,
        from_m=-7.2,
        to_m=7.2,
        ramp_m=2.4,
        threads=1,
    )
    place, force = data["wheel_x"][0].values, data["contact_force"][0].values
    inside = (place >= -1.8) & (place < 4.2 - 1e-9)
    weight = 5700.0 * G
    lines = np.abs(
        np.array(
            [np.mean((force[inside] - weight) * np.exp(-2j * np.pi * k / 6.0 * place[inside])) for k in range(40)]
        )
    )
    # Six metres are ten bays.
    assert lines[1:].argmax() + 1 == 10
    assert abs(force[inside].mean() - weight) < 0.01 * weight
    under = data["line_displacement"][0].values[inside]
    bays = np.array([np.mean(under * np.exp(-2j * np.pi * k / 6.0 * place[inside])) for k in (10,)])
    # Softer in the middle of a bay (0.3 m) than over a support.
    assert (bays[0] * np.exp(2j * np.pi * 0.3 / 0.6)).real > 0.0


def test_a_car_over_a_bridge():
    """Ten degrees of freedom: its weight before and behind, never far from it; the bridge as under forces."""
    car = crh380a()
    line = girder()
    data = couple(
        line,
        car,
        speed_m_per_s=60.0,
        contact_N_per_m=4e8,
        step_s=1e-3,
        sensors=SPOT,
        body="girder",
        after_s=0.1,
        window_s=4.0,
        order=5,
        threads=1,
    )
    weight = G * (42934.0 + 2 * 3300.0 + 4 * 1780.0)
    total = data["contact_force"].sum("wheel").values
    assert total[0] == pytest.approx(weight, rel=1e-12)
    assert np.abs(data["contact_force"].values - weight / 4).max() < 0.1 * weight / 4
    forces = Axles(lags_m=tuple(car.lags_m()), loads_N=(weight / 4,) * 4, speed_m_per_s=60.0, body="girder")
    alone = passby(line, forces, sensors=SPOT, highest_Hz=100.0, quantity="displacement", window_s=8.0)
    history = CubicSpline(alone["time"], alone["history"][0, 0])(data["time"])
    assert np.abs(data["displacement"][0] - history).max() < 0.05 * np.abs(history).max()


def test_progress_is_reported_and_may_stop_the_march():
    calls = []
    options = {"speed_m_per_s": 25.0, "contact_N_per_m": 1e6, "step_s": 5e-3, "body": "girder", "window_s": 4.0}
    couple(
        girder(), MassOnSpring(mass_kg=1e3), progress=lambda done, total: calls.append((done, total)), **options
    )
    assert len(calls) > 5
    assert all(0 <= done <= total for done, total in calls)

    def stop(done, total):
        if total > 150 and done > 40:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        couple(girder(), MassOnSpring(mass_kg=1e3), progress=stop, **options)
