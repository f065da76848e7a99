"""Additions to the vehicle: passive, reciprocal, right in closed cases, refused where they cannot be honoured."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.errors import InputError
from permway.formats.model_file import model_from_dict, read_model
from permway.laws.toml import to_toml
from permway.model.vehicle import Vehicle
from permway.model.vehicle_additions import AirSpring, DamperSeries, FlexibleMode, Resonator
from permway.model.vehicle_presets import crh380a
from permway.response.passby.sprung import stepper

PARTS = ("wheelsets", "wheelset1", "wheelset4", "bogies", "bogie1", "bogie2", "body")
BAND = np.geomspace(0.2, 400.0, 60)


def log_floats(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(np.log(low), np.log(high)).map(lambda x: float(np.exp(x)))


resonant = {"frequency_Hz": log_floats(0.5, 300.0), "loss_factor": log_floats(1e-3, 3.0)}
resonators = st.builds(Resonator, on=st.sampled_from(PARTS), mass_kg=log_floats(0.1, 5e4), **resonant)
modes = st.one_of(
    st.builds(
        FlexibleMode,
        on=st.sampled_from(PARTS),
        modal_mass_kg=log_floats(10.0, 1e6),
        shape=st.floats(-3.0, 3.0),
        **resonant,
    ),
)
laws = st.tuples(
    *(
        st.builds(DamperSeries, suspension=st.just(name), stiffness_N_per_m=log_floats(1e3, 1e9))
        for name in ("primary", "secondary")
    ),
    st.builds(AirSpring, rise=st.floats(0.0, 10.0), transition_Hz=log_floats(0.1, 50.0)),
)


def added(*additions: object, **changes: float) -> Vehicle:
    return Vehicle(**{**crh380a().model_dump(), **changes, "additions": additions})


@settings(max_examples=60, deadline=None)
@given(st.lists(st.one_of(resonators, modes), max_size=4), st.one_of(st.just(()), laws), st.integers(1, 2))
def test_whatever_is_added_is_passive_and_reciprocal(parts: list, suspension: tuple, cars: int) -> None:
    car = added(*parts, *suspension, cars=cars)
    for matrix in (*car.dynamic_stiffness(BAND), *-car.wheel_receptance(BAND)):
        size = np.sqrt(np.outer(np.abs(np.diag(matrix)), np.abs(np.diag(matrix)))).max()
        assert np.abs(matrix - matrix.T).max() <= 1e-9 * size
        assert np.linalg.eigvalsh(matrix.imag + matrix.imag.T).min() >= -1e-9 * size


def test_nothing_added_is_the_rigid_car() -> None:
    car = crh380a(share=0.5)
    mass, damping, stiffness = car.matrices()
    omega = 2.0 * np.pi * BAND[:, None, None]
    assert np.array_equal(car.dynamic_stiffness(BAND), stiffness + 1j * omega * damping - omega**2 * mass)
    # What vanishes in its limit leaves the same.
    limits = added(
        DamperSeries(suspension="primary", stiffness_N_per_m=1e18),
        AirSpring(rise=0.0, transition_Hz=1.0),
        FlexibleMode(on="body", modal_mass_kg=1e18, frequency_Hz=10.0, loss_factor=0.1, shape=-0.5),
        FlexibleMode(on="bogies", modal_mass_kg=1e18, frequency_Hz=40.0, loss_factor=0.1, shape=1.0),
        share=0.5,
    )
    receptance = limits.wheel_receptance(BAND)
    assert receptance == pytest.approx(car.wheel_receptance(BAND), rel=1e-6)


def test_a_resonator_is_a_mass_on_a_spring() -> None:
    attached = Resonator(on="wheelset2", mass_kg=80.0, frequency_Hz=50.0, loss_factor=0.1)
    more = added(attached).dynamic_stiffness(BAND) - crh380a().dynamic_stiffness(BAND)
    omega = 2.0 * np.pi * BAND
    spring = 80.0 * (2.0 * np.pi * 50.0) ** 2 * (1.0 + 0.1j)
    inertia = -80.0 * omega**2
    expected = np.zeros_like(more)
    expected[:, 7, 7] = spring * inertia / (spring + inertia)
    scale = np.abs(crh380a().dynamic_stiffness(BAND)).max(axis=(1, 2))
    assert (np.abs(more - expected).max(axis=(1, 2)) <= 1e-12 * scale).all()
    assert added(attached).static_wheel_load_N == pytest.approx(crh380a().static_wheel_load_N + 10.0 * 9.80665)


def test_a_bending_wheelset_is_two_masses_and_a_spring() -> None:
    """Free, its receptance is that of the whole mass and of the mode; held apart it is two masses."""
    mass, ratio, free_Hz, eta = 1780.0, 0.4, 90.0, 0.05
    mode = FlexibleMode(on="wheelsets", modal_mass_kg=mass / ratio, frequency_Hz=free_Hz, loss_factor=eta)
    loose = {"primary_stiffness_N_per_m": 1e-6, "primary_damping_Ns_per_m": 0.0}
    found = np.einsum("fii->fi", added(mode, **loose).wheel_receptance(BAND))[:, 2]
    near, far = mass / (1.0 + ratio), mass * ratio / (1.0 + ratio)
    omega = 2.0 * np.pi * BAND
    spring = (2.0 * np.pi * free_Hz) ** 2 * (1.0 + 1j * eta) * near * far / mass
    driven = -(omega**2) * near + spring * -(omega**2) * far / (spring - omega**2 * far)
    assert found == pytest.approx(1.0 / driven, rel=1e-6)


def test_boxes_on_springs_to_the_wheels_against_their_own_equations() -> None:
    """Fourteen masses: wheels in contact, boxes that are read and sprung, a spring between each two."""
    mass, share, free_Hz, eta = 1780.0, 0.35, 120.0, 0.02
    boxes, wheels = share * mass, (1.0 - share) * mass
    mode = FlexibleMode(
        on="wheelsets",
        modal_mass_kg=boxes * mass / wheels,
        frequency_Hz=free_Hz,
        loss_factor=eta,
        shape=-boxes / wheels,
    )
    car = crh380a()
    _, damping, stiffness = car.matrices()
    omega = 2.0 * np.pi * BAND[:, None, None]
    rigid, _, _ = added(wheelset_mass_kg=boxes).matrices()
    whole = np.zeros((BAND.size, 14, 14), dtype=complex)
    whole[:, :10, :10] = stiffness + 1j * omega * damping - omega**2 * rigid
    joint = (2.0 * np.pi * free_Hz) ** 2 * (1.0 + 1j * eta) * boxes * wheels / mass
    for wheel in range(4):
        tie = np.zeros(14)
        tie[[6 + wheel, 10 + wheel]] = 1.0, -1.0
        whole += joint * np.outer(tie, tie)
        whole[:, 10 + wheel, 10 + wheel] -= omega[:, 0, 0] ** 2 * wheels
    push = np.vstack([np.zeros((10, 4)), np.eye(4)])
    moved = np.linalg.solve(whole, np.broadcast_to(push, (BAND.size, 14, 4)))
    degrees, contacts = added(mode, wheelset_mass_kg=mass).per_wheel_force(BAND)
    assert degrees == pytest.approx(moved[:, :10], rel=1e-7, abs=1e-7 * np.abs(moved).max())
    assert contacts == pytest.approx(moved[:, 10:], rel=1e-7, abs=1e-7 * np.abs(moved).max())


def test_a_bending_body_against_its_own_equations() -> None:
    """Eleven coordinates, the mode kept, against the ten that are read; the middle moves by bounce and mode."""
    modal, shape, f0, eta = 3.0e4, -0.5, 9.0, 0.03
    car = crh380a()
    mode = FlexibleMode(on="body", modal_mass_kg=modal, frequency_Hz=f0, loss_factor=eta, shape=shape)
    mass, damping, stiffness = car.matrices()
    whole = np.zeros((BAND.size, 11, 11), dtype=complex)
    omega = 2.0 * np.pi * BAND
    rigid = stiffness + 1j * omega[:, None, None] * damping - omega[:, None, None] ** 2 * mass
    whole[:, :10, :10] = rigid
    # The mode moves the body at both secondary suspensions alike, as bounce does, by its shape.
    law = car.secondary_stiffness_N_per_m + 1j * omega * car.secondary_damping_Ns_per_m
    tie = np.zeros(10)
    tie[[0, 2, 4]] = 2.0, -1.0, -1.0
    whole[:, :10, 10] = whole[:, 10, :10] = shape * law[:, None] * tie
    own = modal * ((2.0 * np.pi * f0) ** 2 * (1.0 + 1j * eta) - omega**2)
    whole[:, 10, 10] = own + 2.0 * shape**2 * law
    push = np.zeros((11, 4))
    push[6:10] = np.eye(4)
    moved = np.linalg.solve(whole, np.broadcast_to(push, (BAND.size, 11, 4)))
    read = moved[:, :10].copy()
    read[:, 0] += moved[:, 10]
    force = np.ones((BAND.size, 4), dtype=complex) * np.array([1.0, 0.5, -0.2, 0.1])
    found = added(mode).response_to_wheel_force(BAND, force)
    assert found == pytest.approx(np.einsum("fij,fj->fi", read, force), rel=1e-7)


def test_dampers_and_air_springs_by_their_limits() -> None:
    car = crh380a()
    slow, fast = np.array([1e-3]), np.array([5e3])
    air = added(AirSpring(rise=1.5, transition_Hz=3.0), secondary_damping_Ns_per_m=0.0)
    bare = car.model_copy(update={"secondary_damping_Ns_per_m": 0.0})
    stiffened = bare.model_copy(update={"secondary_stiffness_N_per_m": 2.5 * car.secondary_stiffness_N_per_m})
    for frequency, like in ((slow, bare), (fast, stiffened)):
        mine, other = (v.dynamic_stiffness(frequency)[0, 0, 2] for v in (air, like))
        assert mine.real == pytest.approx(other.real, rel=1e-3)
    soft = added(DamperSeries(suspension="primary", stiffness_N_per_m=4e6))
    tie = soft.dynamic_stiffness(fast)[0, 2, 6]
    assert tie.real == pytest.approx(-(car.primary_stiffness_N_per_m + 4e6), rel=1e-3)


def test_what_needs_matrices_refuses_additions() -> None:
    car = added(AirSpring(rise=1.0, transition_Hz=2.0))
    for call in (
        car.matrices,
        car.natural_frequencies_Hz,
        car.damped_poles,
        lambda: stepper(car, 1.3e9, 1e-4),
    ):
        with pytest.raises(InputError, match="no mass, damping and stiffness matrix holds") as caught:
            call()
        assert caught.value.where == "vehicle.additions"


@pytest.mark.parametrize(
    ("addition", "where"),
    [
        ({"type": "resonator", "on": "roof", "mass_kg": 1.0, "frequency_Hz": 1.0, "loss_factor": 0.1}, "on"),
        ({"type": "resonator", "on": "body", "mass_kg": -1.0, "frequency_Hz": 1.0, "loss_factor": 0.1}, "mass_kg"),
        (
            {"type": "resonator", "on": "body", "mass_kg": 1.0, "frequency_Hz": 1.0, "loss_factor": 0.0},
            "loss_factor",
        ),
        ({"type": "air_spring", "rise": -0.1, "transition_Hz": 1.0}, "rise"),
        ({"type": "damper_series", "suspension": "tertiary", "stiffness_N_per_m": 1.0}, "suspension"),
    ],
)
def test_bad_additions_name_their_place(addition: dict, where: str) -> None:
    with pytest.raises(InputError) as caught:
        added(addition)
    assert caught.value.where.endswith(f"additions[0].{where}")


def test_a_suspension_is_described_once() -> None:
    twice = [AirSpring(rise=1.0, transition_Hz=2.0), AirSpring(rise=2.0, transition_Hz=2.0)]
    with pytest.raises(InputError, match="described twice") as caught:
        added(*twice)
    assert caught.value.where.endswith("additions[1]")


def test_the_model_file_states_additions(tmp_path) -> None:
    table = {
        "format": 1,
        "frequencies": {"from_Hz": 5.0, "to_Hz": 20.0, "step_Hz": 5.0},
        "line": {"preset": "slab_track_viaduct_32m"},
        "temperature_C": 20.0,
        "train": {
            "centre_m": 16.0,
            "speed_m_per_s": 50.0,
            "vehicle": {
                "preset": "crh380a",
                "additions": [
                    {"type": "air_spring", "rise": 0.5, "transition_Hz": 3.0},
                    {
                        "type": "flexible_mode",
                        "on": "body",
                        "modal_mass_kg": 29000.0,
                        "frequency_Hz": 9.5,
                        "loss_factor": 0.03,
                        "shape": -0.5,
                    },
                ],
            },
        },
        "irregularity": {"type": "german_low"},
    }
    (tmp_path / "model.toml").write_text(to_toml(table))
    model = read_model(tmp_path / "model.toml")
    assert model.train is not None
    assert [a.type for a in model.train.vehicle.additions] == ["air_spring", "flexible_mode"]
    again = model_from_dict(model.model_dump(by_alias=True))
    assert again == model
    table["train"]["vehicle"]["additions"][1]["loss_factor"] = "much"
    with pytest.raises(InputError) as caught:
        model_from_dict(table)
    assert caught.value.where == "train.vehicle.additions[1].loss_factor"
