"""The challenge's finite elements against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from permway.challenge.beams import Section, cable_element, dynamic, element, endless
from permway.challenge.layout import NOMINAL
from permway.challenge.mesh import Mesh
from permway.challenge.track import Beam, Link, Track, grounded

GIRDER = Section(bending=2.0e11, mass=1.2e4, loss=1e-9)
LENGTH = 32.0
RAIL = Section(
    bending=NOMINAL["rail"]["E"] * NOMINAL["rail"]["I"],
    mass=NOMINAL["rail"]["rho"] * NOMINAL["rail"]["A"],
    shear=NOMINAL["rail"]["kappa"] * NOMINAL["rail"]["G"] * NOMINAL["rail"]["A"],
    rotary=NOMINAL["rail"]["rho"] * NOMINAL["rail"]["I"],
    loss=0.01,
)


def girder(*links: Link) -> Track:
    track = Track(beams={"girder": Beam(GIRDER, 0.0, LENGTH)}, step_m=0.5, links=list(links))
    track.laws["stiff"] = grounded(lambda f, _: np.full(f.shape, 1e15 + 0j))
    return track


def test_simply_supported_beam_sags_by_f_l3_over_48_e_i() -> None:
    track = girder(Link((("girder", 0.0),), "stiff"), Link((("girder", LENGTH),), "stiff"))
    middle = ("girder", 0.5 * LENGTH)
    (sag,) = Mesh(track, [middle]).receptance(np.array([1e-3]), 20.0, [middle], [middle]).ravel()
    assert sag.real == pytest.approx(LENGTH**3 / (48.0 * GIRDER.bending), rel=1e-5)


@pytest.mark.parametrize(("mode", "root"), [(1, 4.730040745), (3, 10.99560784), (5, 17.27875966)])
def test_free_beam_resonates_where_cos_cosh_is_one(mode: int, root: float) -> None:
    track = girder(Link((("girder", 0.0),), "nothing"))
    track.laws["nothing"] = grounded(lambda f, _: np.zeros(f.shape, dtype=complex))
    hertz = root**2 / (2.0 * np.pi) * np.sqrt(GIRDER.bending / GIRDER.mass / LENGTH**4)
    middle = ("girder", 0.5 * LENGTH)
    around = hertz * np.array([1.0 - 2e-5, 1.0 + 2e-5])
    below, above = Mesh(track, [middle]).receptance(around, 20.0, [middle], [middle]).real.ravel()
    assert below > 0.0 > above, f"mode {mode}"


def test_string_resonates_at_n_over_2l_root_of_tension_over_mass() -> None:
    mass, tension, bending, length = 10.0, 1e6, 1e-3, 6.0
    track = Track(
        beams={"cable": Beam(Section(bending, mass, loss=1e-9), 0.0, length, tension=tension)},
        step_m=0.1,
        links=[Link((("cable", x),), "stiff") for x in (0.0, length)],
        laws={"stiff": grounded(lambda f, _: np.full(f.shape, 1e12 + 0j))},
    )
    hertz = 0.5 / length * np.sqrt(tension / mass)
    middle = ("cable", 0.5 * length)
    around = hertz * np.array([1.0 - 1e-3, 1.0 + 1e-3])
    below, above = Mesh(track, [middle]).receptance(around, 20.0, [middle], [middle]).real.ravel()
    assert below > 0.0 > above
    assert np.allclose(cable_element(tension, 0.3) @ [1.0, 0.0, 1.0, 0.0], 0.0, atol=1e-6)


def infinite(section: Section, frequency_Hz: np.ndarray) -> np.ndarray:
    """Point receptance of an infinite Timoshenko beam by residues over wavenumber.

    Deflection w and rotation t under a force: (S q2 - m w2) w + i q S t = F, -i q S w + (B q2 + S - J w2) t = 0.
    """
    found = []
    for omega in 2.0 * np.pi * frequency_Hz:
        bending, shear = (x * (1.0 + 1j * section.loss) for x in (section.bending, section.shear))
        lower = shear - section.rotary * omega**2
        inertia = section.mass * omega**2
        squares = np.roots([shear * bending, shear * lower - inertia * bending - shear**2, -inertia * lower])
        total = 0j
        for square in squares:
            q = np.sqrt(square)
            q = q if q.imag < 0.0 else -q
            slope = 4.0 * shear * bending * q**3 + 2.0 * (shear * lower - inertia * bending - shear**2) * q
            total += -1j * (bending * square + lower) / slope
        found.append(total)
    return np.array(found)


def test_endless_rail_moves_as_the_infinite_timoshenko_beam_does() -> None:
    frequency = np.array([0.25, 1.0, 5.0, 30.0, 100.0, 400.0, 1000.0])
    left, right = endless(RAIL, 0.16, frequency)
    point = np.linalg.inv(left + right)[:, 0, 0]
    assert np.allclose(point, infinite(RAIL, frequency), rtol=1e-4, atol=0.0)


def test_piece_of_finer_elements_is_the_sum_of_its_halves() -> None:
    frequency = np.array([3.0, 60.0, 390.0])
    a = dynamic(RAIL, 0.32, frequency)
    b = dynamic(RAIL, 0.16, frequency)
    middle = np.linalg.inv(b[3] + b[0])
    assert np.allclose(a[0], b[0] - b[1] @ middle @ b[2], rtol=1e-9)


@pytest.mark.parametrize("section", [GIRDER, RAIL])
def test_element_neither_resists_rigid_motion_nor_loses_mass(section: Section) -> None:
    stiffness, mass = element(section, 0.4)
    for rigid in ([1.0, 0.0, 1.0, 0.0], [-0.2, 1.0, 0.2, 1.0]):
        assert np.abs(stiffness @ rigid).max() < 1e-9 * np.abs(stiffness).max()
    up = np.array([1.0, 0.0, 1.0, 0.0])
    assert up @ mass @ up == pytest.approx(0.4 * section.mass, rel=1e-12)
