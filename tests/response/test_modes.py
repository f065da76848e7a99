"""Modes of a line against closed forms and against eigenvalues of finite elements.

Closed forms: Blevins, Formulas for Natural Frequency and Mode Shape (1979), table 8-1, whose beta L are roots of
the frequency equations below, found here to rounding; a hysteretic beam has omega^2 (1 + i eta) for omega^2.
A Kelvin-Voigt oscillator has omega_0 = sqrt(k/m) and zeta = c / (2 sqrt(k m)); a hysteretic one the modulus
omega_0 (1 + eta^2)^(1/4). The tool's clamped end gives way by a relative 1e-8 or so.
"""

from __future__ import annotations

import time

import numpy as np
import pytest
from permway.challenge.beams import Section, element
from permway.errors import InputError, SolveError
from permway.laws import Hysteretic, KelvinVoigt
from permway.model.bodies import Beam, Mass
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.response.modes import poles_between
from permway.response.poles import lines_for, poles_of
from scipy.optimize import brentq

LENGTH_M, ETA = 24.0, 0.03
BENDING, MASS = 3.4e10 * 1.2, 1.0e4


def beam(ends: str | tuple[str, str], eta: float = ETA) -> Line:
    body = Beam(
        youngs_modulus_Pa=3.4e10,
        second_moment_m4=1.2,
        density_kg_per_m3=2500.0,
        area_m2=4.0,
        loss_factor=eta,
        intervals_m=((0.0, LENGTH_M),),
        ends=ends,
    )
    return Line(bodies={"beam": body}, joints=(), laws={})


def on(body: str, *x_m: float) -> list[Place]:
    return [Place(body=body, x_m=x) for x in x_m]


def roots(equation: object, first: list[float]) -> np.ndarray:
    return np.array([brentq(equation, b - 0.4, b + 0.4, xtol=1e-15) for b in first])


CASES = {
    "pinned": ("pinned", np.pi * np.arange(1, 5)),
    "free": ("free", roots(lambda b: np.cos(b) - 1.0 / np.cosh(b), [4.73, 7.853, 10.996, 14.137])),
    "clamped": ("clamped", roots(lambda b: np.cos(b) - 1.0 / np.cosh(b), [4.73, 7.853, 10.996, 14.137])),
    "cantilever": (
        ("clamped", "free"),
        roots(lambda b: np.cos(b) + 1.0 / np.cosh(b), [1.875, 4.694, 7.855, 10.996]),
    ),
    "propped": (("clamped", "pinned"), roots(lambda b: np.tan(b) - np.tanh(b), [3.927, 7.069, 10.21, 13.352])),
}


@pytest.mark.parametrize("eta", [0.0, ETA, 0.3])
@pytest.mark.parametrize("name", CASES)
def test_beams(name: str, eta: float) -> None:
    ends, beta = CASES[name]
    omega = (beta / LENGTH_M) ** 2 * np.sqrt(BENDING * (1.0 + 1j * eta) / MASS)
    expected = np.abs(omega) / (2.0 * np.pi)
    found = poles_between(
        beam(ends, eta), 0.7 * expected[0], 1.3 * expected[-1], places=on("beam", 5.3, 11.0, 24.0 - 1.1)
    )
    assert found.frequency_Hz == pytest.approx(expected, rel=3e-8)
    assert found.damping == pytest.approx(omega.imag / np.abs(omega), abs=1e-8)


def test_shapes_of_a_supported_beam() -> None:
    x = np.array([3.0, 9.5, 17.0])
    found = poles_between(beam("pinned"), 3.0, 100.0, places=on("beam", *x))
    for number, shape in enumerate(found.shape, start=1):
        expected = np.sin(number * np.pi * x / LENGTH_M)
        expected = expected / expected[np.argmax(np.abs(expected))]
        assert shape == pytest.approx(expected, abs=1e-7)


def test_a_mode_that_no_place_sees_is_none() -> None:
    found = poles_between(beam("pinned"), 3.0, 100.0, places=on("beam", 12.0))
    first = np.pi / 2.0 * np.sqrt(BENDING * abs(1.0 + 1j * ETA) / MASS) / LENGTH_M**2
    assert found.frequency_Hz == pytest.approx([first, 9.0 * first], rel=1e-9)


def mass_on(law: KelvinVoigt | Hysteretic) -> Line:
    joint = Joints(between=("m", "ground"), law="spring", at=(0.0,))
    return Line(bodies={"m": Mass(mass_kg=3.0)}, joints=(joint,), laws={"spring": law})


@pytest.mark.parametrize("zeta", [1e-4, 0.02, 0.3, 0.6])
def test_a_mass_on_spring_and_dashpot(zeta: float) -> None:
    law = KelvinVoigt(stiffness=2.7e4, damping=2.0 * zeta * np.sqrt(2.7e4 * 3.0))
    found = poles_between(mass_on(law), 5.0, 50.0, places=on("m", 0.0))
    assert found.frequency_Hz == pytest.approx([np.sqrt(9.0e3) / (2.0 * np.pi)], rel=1e-10)
    assert found.damping == pytest.approx([zeta], rel=1e-9)


def test_a_mass_on_a_hysteretic_spring() -> None:
    found = poles_between(mass_on(Hysteretic(stiffness=2.7e4, loss_factor=0.4)), 5.0, 50.0, places=on("m", 0.0))
    pole = np.sqrt(9.0e3 * (1.0 + 0.4j))
    assert found.frequency_Hz == pytest.approx([abs(pole) / (2.0 * np.pi)], rel=1e-10)
    assert found.damping == pytest.approx([pole.imag / abs(pole)], rel=1e-9)


@pytest.mark.parametrize("apart", [0.1, 1e-2, 1e-3])
def test_close_modes_stay_apart(apart: float) -> None:
    """Two equal masses, weakly tied: one peak, for damping is larger than their distance, and two poles."""
    spring, tie = 4.0e4, 4.0e4 * apart
    laws = {
        "spring": KelvinVoigt(stiffness=spring, damping=2.0 * 0.05 * np.sqrt(spring * 10.0)),
        "tie": KelvinVoigt(stiffness=tie, damping=0.0),
        "second": KelvinVoigt(stiffness=spring, damping=2.0 * 0.05 * np.sqrt(spring * 10.0)),
    }
    joints = (
        Joints(between=("a", "ground"), law="spring", at=(0.0,)),
        Joints(between=("b", "ground"), law="second", at=(1.0,)),
        Joints(between=("a", "b"), law="tie", at=(0.5,)),
    )
    line = Line(bodies={"a": Mass(mass_kg=10.0), "b": Mass(mass_kg=10.0)}, joints=joints, laws=laws)
    found = poles_between(line, 5.0, 20.0, places=on("a", 0.0))
    expected = np.sqrt([spring / 10.0, (spring + 2.0 * tie) / 10.0]) / (2.0 * np.pi)
    assert found.frequency_Hz == pytest.approx(expected, rel=1e-8)
    assert found.damping * expected == pytest.approx(0.05 * expected[0], rel=1e-6)


def quadratic(parts: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness, damping and mass of the two-span line below by Hermite elements of equal length, dense."""
    h = LENGTH_M / parts
    stiff, mass = element(Section(bending=BENDING, mass=MASS), h)
    size = 2 * (parts + 1) + 1
    k, c, m = (np.zeros((size, size), dtype=np.complex128) for _ in range(3))
    for i in range(parts):
        rows = slice(2 * i, 2 * i + 4)
        k[rows, rows] += stiff * (1.0 + 1j * ETA)
        m[rows, rows] += mass
    for node, (spring, dashpot) in {
        0: (3.0e8, 2.0e5),
        parts // 2: (2.0e8, 4.0e5),
        parts: (3.0e8, 2.0e5),
    }.items():
        k[2 * node, 2 * node] += spring
        c[2 * node, 2 * node] += dashpot
    # A tuned mass at a quarter.
    pair = np.ix_([2 * (parts // 4), size - 1], [2 * (parts // 4), size - 1])
    tie = np.array([[1.0, -1.0], [-1.0, 1.0]])
    k[pair] += 4.0e6 * tie
    c[pair] += 3.0e4 * tie
    m[-1, -1] = 6000.0
    return k, c, m


def test_a_line_on_springs_and_dashpots_against_elements() -> None:
    laws = {
        "end": KelvinVoigt(stiffness=3.0e8, damping=2.0e5),
        "middle": KelvinVoigt(stiffness=2.0e8, damping=4.0e5),
        "tuned": KelvinVoigt(stiffness=4.0e6, damping=3.0e4),
    }
    joints = (
        Joints(between=("beam", "ground"), law="end", at=(0.0, LENGTH_M)),
        Joints(between=("beam", "ground"), law="middle", at=(LENGTH_M / 2.0,)),
        Joints(between=("absorber", "beam"), law="tuned", at=(LENGTH_M / 4.0,)),
    )
    line = Line(bodies={**beam("free").bodies, "absorber": Mass(mass_kg=6000.0)}, joints=joints, laws=laws)
    found = poles_between(line, 2.0, 60.0, places=on("beam", 1.0, 7.0, 15.0))
    k, c, m = quadratic(96)
    size = k.shape[0]
    # (-omega^2 M + i omega C + K) u = 0 as a first-order problem.
    inverse = np.linalg.inv(m)
    state = np.block([[np.zeros((size, size)), np.eye(size)], [inverse @ k, 1j * inverse @ c]])
    omega = np.linalg.eigvals(state)
    omega = omega[(omega.real > 0.0) & (np.abs(omega) > 2.0 * 2.0 * np.pi) & (np.abs(omega) < 60.0 * 2.0 * np.pi)]
    omega = omega[np.argsort(np.abs(omega))]
    assert omega.size >= 5
    assert found.omega == pytest.approx(omega, rel=2e-6)


def test_what_is_asked_wrongly_is_refused() -> None:
    with pytest.raises(InputError, match="from low to high"):
        poles_between(beam("pinned"), 5.0, 5.0, places=on("beam", 3.0))
    with pytest.raises(InputError, match="no place"):
        poles_between(beam("pinned"), 5.0, 6.0, places=[])


def test_a_response_that_has_no_few_poles_is_refused() -> None:
    frequency = lines_for(1.0, 20.0)
    noise = np.random.default_rng(3).standard_normal((frequency.size, 1, 1))
    with pytest.raises(SolveError, match="is not that of"):
        poles_of(frequency, noise.astype(np.complex128))


def test_it_takes_milliseconds() -> None:
    places = on("beam", 3.0, 7.0, 15.0)
    poles_between(beam("free"), 3.0, 60.0, places=places)
    start = time.process_time()
    poles_between(beam("free"), 3.0, 60.0, places=places)
    assert time.process_time() - start < 0.5
