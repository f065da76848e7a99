"""Vehicle, contact and pseudo-excitation: structure, reciprocity, passivity, power, errors."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.errors import InputError, SolveError
from permway.model.contact import ContactStiffness, GivenContact, HertzContact
from permway.model.vehicle import Vehicle
from permway.model.vehicle_presets import crh380a, vehicle
from permway.response.pseudo import power_spectrum, pseudo_excitation, wheel_rail_forces
from pydantic import TypeAdapter


def positive(low, high):
    return st.floats(low, high, allow_nan=False)


vehicles = st.builds(
    Vehicle,
    car_body_mass_kg=positive(1e4, 6e4),
    bogie_mass_kg=positive(1e3, 6e3),
    wheelset_mass_kg=positive(8e2, 3e3),
    car_body_inertia_kg_m2=positive(5e5, 4e6),
    bogie_inertia_kg_m2=positive(8e2, 1e4),
    primary_stiffness_N_per_m=positive(4e5, 6e6),
    primary_damping_Ns_per_m=positive(1e3, 1e5),
    secondary_stiffness_N_per_m=positive(1e5, 3e6),
    secondary_damping_Ns_per_m=positive(1e3, 1e5),
    bogie_distance_m=positive(9.0, 19.0),
    wheelbase_m=positive(1.8, 3.0),
    car_length_m=st.just(26.0),
    cars=st.integers(1, 3),
    share=st.sampled_from([0.5, 1.0]),
)
frequencies = st.lists(positive(0.1, 500.0), min_size=1, max_size=4).map(np.array)
slow = settings(max_examples=40, deadline=None)


@slow
@given(vehicles)
def test_matrices_are_symmetric_and_of_the_right_rank(train):
    n = train.cars
    mass, damping, stiffness = train.matrices()
    for matrix in (mass, damping, stiffness):
        assert matrix.shape == (10 * n, 10 * n) == (len(train.degrees),) * 2
        assert np.array_equal(matrix, matrix.T)
    assert np.linalg.eigvalsh(mass).min() > 0
    # six suspensions a car
    for matrix in (damping, stiffness):
        scale = np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
        assert np.linalg.matrix_rank(matrix / scale, tol=1e-9) == 6 * n


@slow
@given(vehicles)
def test_rigid_motion_of_a_car_stretches_nothing(train):
    _, damping, stiffness = train.matrices()
    wheels = train.wheel_positions_m()[:4]
    wheels = wheels - wheels.mean()
    bogies = np.array([wheels[:2].mean(), wheels[2:].mean()])
    bounce = np.array([1, 0, 1, 0, 1, 0, 1, 1, 1, 1.0])
    pitch = np.array([0, 1, bogies[0], 1, bogies[1], 1, *wheels])
    for motion in (bounce, pitch):
        for matrix in (damping, stiffness):
            force = matrix[:10, :10] @ motion
            assert np.abs(force).max() <= 1e-12 * np.abs(matrix).max() * np.abs(motion).max()


@slow
@given(vehicles)
def test_natural_frequencies_free_on_springs_and_held(train):
    n = train.cars
    free = train.natural_frequencies_Hz()
    assert free.shape == (10 * n,)
    # bounce and pitch of the whole car, and each bogie turning with its wheelsets
    assert np.count_nonzero(free == 0.0) == 4 * n
    soft, stiff = (train.natural_frequencies_Hz(on_contact=k) for k in (1e8, 1e12))
    assert np.all(soft > 0)
    assert np.all(stiff >= soft * (1 - 1e-9))
    held = train.natural_frequencies_Hz(on_contact=np.inf)
    assert held.shape == (6 * n,)
    assert stiff[: 6 * n] == pytest.approx(held, rel=1e-4)


@slow
@given(vehicles)
def test_poles_are_stable_and_undamped_ones_are_the_natural_frequencies(train):
    poles = train.damped_poles(on_contact=1e9)
    assert poles.shape == (20 * train.cars,)
    assert poles.real.max() < 0
    undamped = train.model_copy(update={"primary_damping_Ns_per_m": 0.0, "secondary_damping_Ns_per_m": 0.0})
    ringing = np.sort(np.abs(undamped.damped_poles(on_contact=1e9)))[::2] / (2 * np.pi)
    assert ringing == pytest.approx(train.natural_frequencies_Hz(on_contact=1e9), rel=1e-6)


@slow
@given(vehicles, frequencies)
def test_wheel_receptance_is_reciprocal_and_passive(train, frequency):
    receptance = train.wheel_receptance(frequency)
    n = 4 * train.cars
    assert receptance.shape == (frequency.size, n, n)
    for matrix in receptance:
        size = np.abs(matrix).max()
        assert np.abs(matrix - matrix.T).max() <= 1e-10 * size
        # power in, omega/2 F^H (-Im B) F, cannot be negative
        assert np.linalg.eigvalsh(-0.5 * (matrix.imag + matrix.imag.T)).min() >= -1e-12 * size
        for car in range(train.cars):
            own = slice(4 * car, 4 * car + 4)
            assert np.array_equal(matrix[own, own], matrix[:4, :4])
            assert not matrix[own, : 4 * car].any()


@slow
@given(vehicles, frequencies, st.integers(0, 2**31))
def test_power_in_is_power_dissipated_in_the_dampers(train, frequency, seed):
    rng = np.random.default_rng(seed)
    force = rng.normal(size=(frequency.size, 4 * train.cars, 2)) @ np.array([1, 1j])
    response = train.response_to_wheel_force(frequency, force)
    omega = 2 * np.pi * frequency
    at_wheels = response[:, train.wheel_indices]
    power_in = 0.5 * np.real(np.sum(force.conj() * 1j * omega[:, None] * at_wheels, axis=1))
    _, damping, _ = train.matrices()
    lost = 0.5 * omega**2 * np.real(np.einsum("fi,ij,fj->f", response.conj(), damping, response))
    # the active part is a small share of the apparent power, which sets the rounding error
    apparent = 0.5 * omega * np.sum(np.abs(force * at_wheels), axis=1)
    assert np.all(np.abs(power_in - lost) <= 1e-10 * apparent)


@slow
@given(vehicles, frequencies, st.integers(0, 2**31))
def test_response_solves_the_equation_of_motion(train, frequency, seed):
    rng = np.random.default_rng(seed)
    force = rng.normal(size=(frequency.size, 4 * train.cars)).astype(complex)
    response = train.response_to_wheel_force(frequency, force)
    load = np.zeros_like(response)
    load[:, train.wheel_indices] = force
    back = np.einsum("fij,fj->fi", train.dynamic_stiffness(frequency), response)
    size = np.abs(train.dynamic_stiffness(frequency)).max() * np.abs(response).max()
    assert np.abs(back - load).max() <= 1e-12 * size
    receptance = train.wheel_receptance(frequency)
    direct = np.einsum("fij,fj->fi", receptance, force)
    assert response[:, train.wheel_indices] == pytest.approx(direct, rel=1e-12, abs=1e-25)


@slow
@given(vehicles, frequencies)
def test_half_the_model_is_twice_as_flexible(train, frequency):
    whole, half = (train.model_copy(update={"share": share}) for share in (1.0, 0.5))
    assert half.wheel_receptance(frequency) == pytest.approx(2 * whole.wheel_receptance(frequency), rel=1e-12)


def test_wheel_receptance_at_high_frequency_is_the_wheelset_alone():
    train = crh380a()
    frequency = np.array([2000.0])
    receptance = train.wheel_receptance(frequency)[0]
    alone = -1 / ((2 * np.pi * 2000.0) ** 2 * train.wheelset_mass_kg)
    assert np.diag(receptance).real == pytest.approx(np.full(4, alone), rel=1e-4)


def test_static_limit_is_the_rigid_train():
    train = crh380a()
    frequency = np.array([1e-3])
    force = np.ones((1, 4), dtype=complex)
    bounce = train.response_to_wheel_force(frequency, force)[0, 0]
    total = np.trace(train.matrices()[0]) - 1.712e6 - 2 * 1807.0
    assert bounce == pytest.approx(-4 / ((2 * np.pi * 1e-3) ** 2 * total), rel=1e-4)


def test_positions_and_lags():
    train = crh380a(cars=2)
    lags = train.lags_m()
    assert lags == pytest.approx([0, 2.5, 17.5, 20, 25, 27.5, 42.5, 45])
    positions = train.wheel_positions_m()
    assert positions[0] - positions == pytest.approx(lags)
    assert positions[0] == pytest.approx(-positions[-1])
    assert train.degrees[0] == "car1.body.bounce"
    assert train.degrees[3] == "car1.bogie1.pitch"
    assert [train.degrees[i] for i in train.wheel_indices[3:5]] == ["car1.wheelset4", "car2.wheelset1"]


def test_leading_end_goes_down_with_positive_pitch():
    train = crh380a()
    response = train.response_to_wheel_force([0.05], [[1, 1, 0, 0]])[0]
    # far below resonance a rigid free body accelerates with the force, so it moves against it
    assert response[1].real < 0
    assert abs(response[6]) > abs(response[9])


GOOD = crh380a().model_dump()


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"car_body_mass_kg": -1.0}, "car_body_mass_kg"),
        ({"bogie_mass_kg": 0.0}, "bogie_mass_kg"),
        ({"wheelset_mass_kg": float("nan")}, "wheelset_mass_kg"),
        ({"primary_stiffness_N_per_m": "soft"}, "primary_stiffness_N_per_m"),
        ({"secondary_damping_Ns_per_m": -2.0}, "secondary_damping_Ns_per_m"),
        ({"cars": 0}, "cars"),
        ({"share": 1.5}, "share"),
        ({"colour": "red"}, "colour"),
        ({"wheelbase_m": 18.0}, "wheelbase_m"),
        ({"cars": 2, "car_length_m": 19.0}, "car_length_m"),
    ],
)
def test_wrong_vehicles_are_refused_with_the_place(change, where):
    with pytest.raises(InputError, match=where):
        Vehicle(**{**GOOD, **change})


@pytest.mark.parametrize("frequency", [[0.0], [-1.0], [np.nan], [np.inf], ["fast"], [[1.0, 2.0]]])
def test_wrong_frequencies_are_refused(frequency):
    with pytest.raises(InputError, match="frequency_Hz"):
        crh380a().wheel_receptance(frequency)


def test_wrong_forces_contacts_and_names_are_refused():
    train = crh380a()
    with pytest.raises(InputError, match="force_N"):
        train.response_to_wheel_force([1.0, 2.0], np.ones((1, 4)))
    with pytest.raises(InputError, match="force_N"):
        train.response_to_wheel_force([1.0], np.full((1, 4), np.nan))
    for bad in (0.0, -1.0, float("nan")):
        with pytest.raises(InputError, match="on_contact"):
            train.natural_frequencies_Hz(on_contact=bad)
    with pytest.raises(InputError, match="crh380a"):
        vehicle("tgv")
    assert vehicle("crh380a") == train


def test_hertz_contact_is_the_slope_of_the_power_law():
    contact = HertzContact(static_load_N=crh380a().static_wheel_load_N, wheel_radius_m=0.43)

    def load(approach):
        return (approach / contact.contact_constant) ** 1.5

    approach = contact.contact_constant * contact.static_load_N ** (2 / 3)
    step = 1e-6 * approach
    slope = (load(approach + step) - load(approach - step)) / (2 * step)
    assert contact.wheel_stiffness() == pytest.approx(slope, rel=1e-8)
    assert contact.contact_constant == pytest.approx(3.86e-8 * 0.43**-0.115)
    assert 1.2e9 < contact.wheel_stiffness() < 1.6e9
    conical = contact.model_copy(update={"profile": "conical"})
    assert conical.contact_constant == pytest.approx(4.57e-8 * 0.43**-0.149)


def test_contact_by_type_and_share():
    contact = TypeAdapter(ContactStiffness).validate_python({"type": "given", "stiffness_N_per_m": 1.3e9})
    assert isinstance(contact, GivenContact)
    assert contact.wheelset_stiffness(0.5) == 1.3e9
    assert contact.wheelset_stiffness() == 2.6e9
    assert contact.receptance(0.5) == pytest.approx(1 / 1.3e9)
    with pytest.raises(InputError, match="share"):
        contact.wheelset_stiffness(0.0)
    with pytest.raises(InputError, match="stiffness_N_per_m"):
        GivenContact(stiffness_N_per_m=-1.0)


SPEED = 80.0


def wheels_on_springs(frequency, share=0.5):
    train = crh380a(share=share)
    wheel = train.wheel_receptance(frequency)
    track = np.broadcast_to(np.eye(4) / (8e7 * (1 + 0.1j)), wheel.shape)
    return train, wheel, track


def test_half_and_whole_model_move_alike_and_share_the_force():
    frequency = np.linspace(0.5, 200.0, 50)
    contact = GivenContact(stiffness_N_per_m=1.3e9)
    motion, force = [], []
    for share in (0.5, 1.0):
        train, wheel, track = wheels_on_springs(frequency, share)
        profile = pseudo_excitation(frequency, np.full(50, 1e-8), train.lags_m(), SPEED)
        p = wheel_rail_forces(wheel, track * 0.5 / share, contact.receptance(share), profile)
        force.append(p)
        motion.append(train.response_to_wheel_force(frequency, -p))
    assert force[1] == pytest.approx(2 * force[0], rel=1e-9)
    assert motion[1] == pytest.approx(motion[0], rel=1e-9)


def test_wheel_rail_forces_keep_the_contact_closed():
    frequency = np.linspace(0.5, 300.0, 60)
    train, wheel, track = wheels_on_springs(frequency)
    profile = pseudo_excitation(frequency, np.full(60, 1e-8), train.lags_m(), SPEED)
    compliance = 1 / 1.3e9
    force = wheel_rail_forces(wheel, track, compliance, profile)
    down = -np.einsum("fij,fj->fi", wheel, force)
    rail = np.einsum("fij,fj->fi", track, force)
    assert down - rail - profile == pytest.approx(compliance * force, rel=1e-9)


def test_pseudo_excitation_carries_the_cross_spectrum():
    """|H r|^2 equals the diagonal of H S H^H with S_jk = S exp(-i omega (l_j - l_k)/V)."""
    frequency = np.array([0.7, 3.0, 40.0])
    density = np.array([1e-5, 1e-7, 1e-10])
    train, wheel, track = wheels_on_springs(frequency)
    lags = train.lags_m()
    profile = pseudo_excitation(frequency, density, lags, SPEED)
    pseudo = power_spectrum(wheel_rail_forces(wheel, track, 1 / 1.3e9, profile))
    for index, f in enumerate(frequency):
        transfer = np.linalg.inv(wheel[index] + track[index] + np.eye(4) / 1.3e9)
        lag = lags[:, None] - lags[None, :]
        cross = density[index] * np.exp(-2j * np.pi * f * lag / SPEED)
        direct = np.diag(transfer @ cross @ transfer.conj().T).real
        assert pseudo[index] == pytest.approx(direct, rel=1e-8)


def test_pseudo_excitation_against_sample_paths():
    """Monte Carlo: the mean periodogram of simulated axle motions is the pseudo-excitation's density.

    White profile, periodic record; each wheel meets it lag/V later. 400 records give a scatter of 5 % a line
    and 0.4 % for the mean over 150 lines.
    """
    rng = np.random.default_rng(20)
    count, step, records, level = 512, 0.004, 400, 1e-8
    frequency = np.fft.rfftfreq(count, step)[1:151]
    train, wheel, track = wheels_on_springs(frequency)
    flexibility = wheel + track + np.eye(4) / 1.3e9
    profile = rng.normal(size=(records, count)) * np.sqrt(level / (2 * step))
    lines = np.fft.rfft(profile, axis=1)[:, 1:151]
    delay = np.exp(-2j * np.pi * frequency[:, None] * train.lags_m() / SPEED)
    force = -np.linalg.solve(flexibility[None], (lines[:, :, None] * delay)[..., None])[..., 0]
    body = np.stack([train.response_to_wheel_force(frequency, -one)[:, 0] for one in force])
    excitation = pseudo_excitation(frequency, np.full(150, level), train.lags_m(), SPEED)
    pseudo = wheel_rail_forces(wheel, track, 1 / 1.3e9, excitation)
    predicted_body = power_spectrum(train.response_to_wheel_force(frequency, -pseudo)[:, 0])
    for sampled, predicted in ((force[..., 2], power_spectrum(pseudo[:, 2])), (body, predicted_body)):
        estimate = np.mean(np.abs(sampled) ** 2, axis=0) * 2 * step / count
        ratio = estimate / predicted
        assert abs(ratio.mean() - 1) < 0.02
        assert np.abs(ratio - 1).max() < 0.3


def test_power_spectrum_derivatives_and_errors():
    frequency = np.array([1.0, 10.0])
    response = np.array([[1 + 1j], [2.0]])
    omega = 2 * np.pi * frequency[:, None]
    assert power_spectrum(response) == pytest.approx(np.array([[2.0], [4.0]]))
    assert power_spectrum(response, frequency, derivatives=1) == pytest.approx(omega**2 * [[2.0], [4.0]])
    assert power_spectrum(response, frequency, derivatives=2) == pytest.approx(omega**4 * [[2.0], [4.0]])
    with pytest.raises(InputError, match="derivatives"):
        power_spectrum(response, frequency, derivatives=3)
    with pytest.raises(InputError, match="frequency_Hz"):
        power_spectrum(response, derivatives=2)
    with pytest.raises(InputError, match="frequency_Hz"):
        power_spectrum(response, [1.0], derivatives=2)


def test_wrong_excitations_are_refused():
    with pytest.raises(InputError, match=r"density\[1\].*2 Hz"):
        pseudo_excitation([1.0, 2.0], [1.0, -1.0], [0.0], SPEED)
    with pytest.raises(InputError, match="density"):
        pseudo_excitation([1.0, 2.0], [1.0], [0.0], SPEED)
    with pytest.raises(InputError, match=r"lags_m\[1\]"):
        pseudo_excitation([1.0], [1.0], [0.0, np.inf], SPEED)
    with pytest.raises(InputError, match="km/h"):
        pseudo_excitation([1.0], [1.0], [0.0], 350.0)


def test_unsolvable_contacts_name_the_frequency():
    frequency = np.array([10.0, 20.0])
    wheel = np.tile(np.eye(4, dtype=complex), (2, 1, 1))
    excitation = np.ones((2, 4))
    singular = np.stack([np.zeros((4, 4)), -np.eye(4)])
    with pytest.raises(SolveError, match="20 Hz"):
        wheel_rail_forces(wheel, singular, 0.0, excitation, frequency_Hz=frequency)
    nearly = np.stack([np.zeros((4, 4)), np.diag([0, 0, 0, -1 + 1e-15])])
    with pytest.raises(SolveError, match=r"condition number.*20 Hz"):
        wheel_rail_forces(wheel, nearly, 0.0, excitation, frequency_Hz=frequency)
    broken = np.stack([np.full((4, 4), np.nan), np.zeros((4, 4))])
    with pytest.raises(SolveError, match="index 0"):
        wheel_rail_forces(wheel, broken, 0.0, excitation)
    with pytest.raises(InputError, match="track_receptance"):
        wheel_rail_forces(wheel, np.eye(4), 0.0, excitation)
    with pytest.raises(InputError, match="wheel_receptance"):
        wheel_rail_forces(np.eye(4), np.eye(4), 0.0, excitation)
    with pytest.raises(InputError, match="frequency_Hz"):
        wheel_rail_forces(wheel, singular, 0.0, excitation, frequency_Hz=[1.0])
