"""A train on a line: what scales, and where the power goes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.model.contact import GivenContact
from permway.model.irregularity import DensityTable
from permway.model.line import Line
from permway.model.place import Place
from permway.model.train import Train
from permway.model.vehicle_presets import VEHICLES
from permway.response.pseudo import pseudo_excitation
from permway.response.receptance import receptance
from permway.response.train import train_response
from strategies import decades, frequencies, paper_line

FORMULATIONS = st.sampled_from(["chain", "receptance"])


def lossless_line(girder):
    """The paper's line with loss in its joints alone, the rail with ends so that no wave leaves."""
    line = paper_line(girder=girder)
    bodies = {name: body.model_copy(update={"loss_factor": 0.0}) for name, body in line.bodies.items()}
    bodies["rail"] = bodies["rail"].model_copy(update={"intervals_m": ((-7.3, 41.1),), "ends": ("free", "pinned")})
    return Line(bodies=bodies, joints=line.joints, laws=line.laws)


LINES = {girder: lossless_line(girder) for girder in ("elastic_bearings", "pinned")}


@st.composite
def trains(draw):
    vehicle = VEHICLES[draw(st.sampled_from(sorted(VEHICLES)))].model_copy(update={"share": 0.5})
    stiffness = draw(decades(5e8, 5e9))
    return Train(
        vehicle=vehicle,
        contact=GivenContact(stiffness_N_per_m=stiffness),
        centre_m=draw(st.floats(6.0, 26.0)),
        speed_m_per_s=draw(st.floats(20.0, 110.0)),
    )


def irregularity(level):
    """A straight line from 1e-3 to 1e4 rad/m, which no speed and frequency here leaves."""
    wavenumber = (1e-3, 1e4)
    return DensityTable(
        wavenumber_rad_per_m=wavenumber, density_m2_per_rad_per_m=tuple(level * w**-3.0 for w in wavenumber)
    )


@settings(max_examples=40)
@given(trains(), st.sampled_from(sorted(LINES)), FORMULATIONS, frequencies())
def test_power_of_the_irregularity_is_dissipated_in_suspensions_and_joints(train, girder, formulation, frequency):
    """Im(P^H R) omega / 2 = omega^2/2 u^H C u + omega/2 sum of Im(k_j) |d_j|^2.

    P is the compressive force, R the profile, so the power it gives is -Re(P^H i omega R) / 2: a dip falls away
    under a force. Beams and contact have no loss. Measured by what the profile lends, |P|^T |R|.
    """
    line = LINES[girder]
    data = train_response(line, train, irregularity(1e-8), frequency, formulation=formulation, threads=1)
    force = data["wheel_rail_force"].values
    lags = train.vehicle.lags_m() / train.speed_m_per_s
    omega = 2 * np.pi * np.array(frequency)
    profile = np.sqrt(data["irregularity_psd"].values)[:, None] * np.exp(-1j * omega[:, None] * lags)
    enters = 0.5 * omega * (force.conj() * profile).imag.sum(axis=1)

    damping = train.vehicle.matrices()[1]
    moved = train.vehicle.response_to_wheel_force(frequency, -force)
    suspension = 0.5 * omega**2 * np.einsum("fi,ij,fj->f", moved.conj(), damping, moved).real
    places = train.wheels()
    extension = receptance(
        line, frequency, forces=places, sensors=places, formulation=formulation, extensions=True, threads=1
    )["extension"].values
    table = line.joint_table()
    loss = line.stiffness(frequency).imag[:, table.law] * table.scale
    stretch = np.einsum("fjw,fw->fj", extension, force)
    joints = 0.5 * omega * (loss * np.abs(stretch) ** 2).sum(axis=1)
    lent = 0.5 * omega * (np.abs(force) * np.abs(profile)).sum(axis=1)
    assert (suspension > 0.0).all()
    assert (joints > 0.0).all()
    assert (np.abs(enters - suspension - joints) <= 1e-9 * lent).all()


@settings(max_examples=20)
@given(trains(), FORMULATIONS, frequencies(), decades(1e-3, 1e3))
def test_every_density_scales_with_the_irregularity(train, formulation, frequency, factor):
    """Amplitudes add, so densities grow as the irregularity's."""
    line, sensors = paper_line(), [Place(body="girder", x_m=11.0)]
    small, large = (
        train_response(
            line, train, irregularity(level), frequency, sensors=sensors, formulation=formulation, threads=1
        )
        for level in (1e-8, 1e-8 * factor)
    )
    for name in small:
        expected = factor if str(name).endswith("_psd") else np.sqrt(factor) if name == "wheel_rail_force" else 1.0
        assert large[name].values == pytest.approx(expected * small[name].values, rel=1e-12)


@settings(max_examples=20)
@given(trains(), FORMULATIONS, frequencies())
def test_wheels_ride_the_profile_on_the_deflected_rail(train, formulation, frequency):
    """At every contact the wheel moves by rail, profile and the spring's compression: w = u + R + P / k_c.

    Downwards; the rail under the train is what all four forces make of it together.
    """
    data = train_response(paper_line(), train, irregularity(1e-8), frequency, formulation=formulation)
    force = data["wheel_rail_force"].values
    rail = np.einsum("fij,fj->fi", data["track_receptance"].values, force)
    wheel = -np.einsum("fij,fj->fi", data["wheel_receptance"].values, force)
    density = data["irregularity_psd"].values
    profile = pseudo_excitation(frequency, density, train.vehicle.lags_m(), train.speed_m_per_s)
    pressed = force * float(data["contact_receptance"])
    size = np.abs(wheel) + np.abs(rail) + np.abs(profile) + np.abs(pressed)
    assert (np.abs(wheel - rail - profile - pressed) <= 1e-12 * size).all()
