"""Beams whose loss is viscous: by one damping ratio in all modes, or as Rayleigh's, against sums over modes."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from permway.challenge.assembly import lossy
from permway.challenge.beams import Section
from permway.challenge.mesh import Mesh
from permway.challenge.track import Beam as Meshed
from permway.challenge.track import Link, Track, grounded
from permway.errors import InputError
from permway.laws import Hysteretic
from permway.model.bodies import Beam
from permway.model.joints import GROUND, Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.response.core import Formulation
from permway.response.receptance import receptance
from permway.response.rolling.bays import bays

LENGTH, BENDING, MASS = 12.0, 210e9 * 1e-3, 7850.0 * 0.05
FREQUENCY = np.linspace(1.0, 150.0, 40)
OMEGA = 2.0 * np.pi * FREQUENCY
FORCE, SENSOR = 3.1, 7.7
KINDS = {
    "ratio": {"damping_ratio": 0.02},
    "mass": {"mass_damping_per_s": 3.0},
    "stiffness": {"stiffness_damping_s": 2e-4},
    "all": {"damping_ratio": 0.01, "mass_damping_per_s": 1.0, "stiffness_damping_s": 1e-4, "loss_factor": 0.01},
}


def deck(**fields: object) -> Beam:
    given = {"youngs_modulus_Pa": 210e9, "second_moment_m4": 1e-3, "density_kg_per_m3": 7850.0, "area_m2": 0.05}
    return Beam(**{**given, "intervals_m": [(0.0, LENGTH)], "ends": "pinned", **fields})


def response(
    beam: Beam, formulation: Formulation = "chain", *, force_m: float = FORCE, sensor_m: float = SENSOR
) -> NDArray[np.complex128]:
    places = [Place(body="deck", x_m=force_m)], [Place(body="deck", x_m=sensor_m)]
    line = Line(bodies={"deck": beam}, joints=[], laws={})
    found = receptance(line, FREQUENCY, forces=places[0], sensors=places[1], formulation=formulation)
    return np.asarray(found["receptance"].values[:, 0, 0])


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_pinned_beam_is_the_sum_of_its_modes(kind: str, formulation: Formulation) -> None:
    """Each mode has a damping ratio of its own, 2 zeta_n omega_n = alpha + beta omega_n^2 + 2 zeta omega_n."""
    beam = deck(**KINDS[kind])
    n = np.arange(1, 4001)[:, None]
    natural = (n * np.pi / LENGTH) ** 2 * np.sqrt(BENDING / MASS)
    damped = beam.mass_damping_per_s + beam.stiffness_damping_s * natural**2 + 2.0 * beam.damping_ratio * natural
    shapes = np.sin(n * np.pi * FORCE / LENGTH) * np.sin(n * np.pi * SENSOR / LENGTH)
    stiff = natural**2 * (1.0 + 1j * beam.loss_factor)
    modes = 2.0 / (MASS * LENGTH) * shapes / (stiff - OMEGA**2 + 1j * OMEGA * damped)
    found = response(beam, formulation)
    np.testing.assert_allclose(found, modes.sum(axis=0), rtol=0.0, atol=1e-11 * np.abs(found).max())


@pytest.mark.parametrize("timoshenko", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_both_formulations_agree_on_free_beams_that_change(kind: str, timoshenko: bool) -> None:
    shear = {"theory": "timoshenko", "shear_modulus_Pa": 81e9, "shear_coefficient": 0.4} if timoshenko else {}
    change = {"from_m": 4.0, "to_m": 5.0, "bending_factor": 0.5, "mass_factor": 0.8}
    beam = deck(ends="free", changes=[change], **shear, **KINDS[kind])
    chain, other = response(beam), response(beam, "receptance")
    np.testing.assert_allclose(chain, other, rtol=0.0, atol=1e-9 * np.abs(chain).max())
    # The loss shows, and takes power from what pushes.
    assert np.abs(chain / response(deck(ends="free", changes=[change], **shear)) - 1.0).max() > 1e-3
    assert (response(beam, sensor_m=FORCE).imag < 0.0).all()


@pytest.mark.parametrize("kind", ["ratio", "mass", "stiffness"])
def test_finite_elements_lose_as_much(kind: str) -> None:
    """On springs, by the challenge's own elements, which share no code with the solver."""
    beam = deck(ends="free", **KINDS[kind])
    joints = [Joints(between=("deck", GROUND), law="bearing", at=(0.0, LENGTH))]
    line = Line(bodies={"deck": beam}, joints=joints, laws={"bearing": Hysteretic(stiffness=5e7, loss_factor=0.1)})
    places = [Place(body="deck", x_m=FORCE)], [Place(body="deck", x_m=SENSOR)]
    found = receptance(line, FREQUENCY, forces=places[0], sensors=places[1])["receptance"].values[:, 0, 0]
    turning = 2.0 * beam.damping_ratio * np.sqrt(BENDING * MASS)
    viscous = beam.mass_damping_per_s, beam.stiffness_damping_s, float(turning)
    track = Track({"girder": Meshed(Section(BENDING, MASS), 0.0, LENGTH, viscous=viscous)}, 0.1)
    track.laws["bearing"] = grounded(lossy(5e7, 0.1))
    track.links = [Link((("girder", x),), "bearing") for x in (0.0, LENGTH)]
    rows, columns = [("girder", FORCE)], [("girder", SENSOR)]
    other = Mesh(track, [*rows, *columns]).receptance(FREQUENCY, 20.0, rows, columns)[:, 0, 0]
    np.testing.assert_allclose(found, other, rtol=0.0, atol=1e-5 * np.abs(found).max())


def test_what_cannot_have_a_viscous_loss_is_refused() -> None:
    with pytest.raises(ValueError, match="constant loss factor"):
        deck(damping_ratio=0.02, modes=20)
    with pytest.raises(ValueError, match="less than 1"):
        deck(damping_ratio=2.0)
    line = Line(bodies={"deck": deck(damping_ratio=0.02)}, joints=[], laws={})
    with pytest.raises(InputError, match="constant loss factor"):
        bays(line, "deck", 1.0, 11.0)
