"""Lone beams with clamped ends and rotational springs, against the closed forms of Euler and Bernoulli."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from permway.errors import InputError, SolveError
from permway.formats.model_file import model_from_dict
from permway.laws import Hysteretic
from permway.model.bodies import Beam
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.response.receptance import receptance
from permway.response.sensitivity import sensitivity
from scipy.optimize import brentq

E, I, RHO, A, L = 2.1e11, 3.0e-5, 7850.0, 7.6e-3, 10.0  # noqa: E741
EI, M = E * I, RHO * A


def beam(**options: object) -> Beam:
    section = {"youngs_modulus_Pa": E, "second_moment_m4": I, "density_kg_per_m3": RHO, "area_m2": A}
    return Beam.model_validate({**section, "intervals_m": ((0.0, L),), **options})


def line(body: Beam, rotation_Nm: complex = 0.0) -> Line:
    loss = rotation_Nm.imag / rotation_Nm.real if rotation_Nm else 0.0
    laws = {"turn": Hysteretic(stiffness=rotation_Nm.real, loss_factor=loss)} if rotation_Nm else {}
    return Line(bodies={"beam": body}, laws=laws)


def answer(of: Line, frequency_Hz: np.ndarray | list[float], x_m: float) -> np.ndarray:
    place = [Place(body="beam", x_m=x_m)]
    data = receptance(of, frequency_Hz, forces=place, sensors=place, threads=1)
    return np.asarray(data.receptance.values[:, 0, 0])


def frequency(z: float) -> float:
    return float((z / L) ** 2 * np.sqrt(EI / M) / (2.0 * np.pi))


def resonance(of: Line, z: float, x_m: float) -> float:
    """Where the driving-point stiffness passes zero near a wanted beta L; as beta L."""
    low, high = frequency(0.99 * z), frequency(1.01 * z)

    def stiffness(f: float) -> float:
        try:
            return float(1.0 / answer(of, [f], x_m)[0].real)
        except SolveError:
            # On the resonance of a beam without loss nothing resists.
            return 0.0

    root = brentq(stiffness, low, high, xtol=1e-12 * high, rtol=1e-13)
    return float(np.sqrt(2.0 * np.pi * root * np.sqrt(M / EI)) * L)


def roots(characteristic: Callable[[float], float], guesses: tuple[float, ...]) -> list[float]:
    return [float(brentq(characteristic, g - 0.05, g + 0.05, xtol=1e-14)) for g in guesses]


CLAMPED_FREE = roots(lambda z: np.cosh(z) * np.cos(z) + 1.0, (1.8751, 4.6941, 7.8548, 10.9955))
CLAMPED_CLAMPED = roots(lambda z: np.cosh(z) * np.cos(z) - 1.0, (4.7300, 7.8532, 10.9956))
CLAMPED_PINNED = roots(lambda z: np.tan(z) - np.tanh(z), (3.9266, 7.0686, 10.2102))


@pytest.mark.parametrize(
    ("ends", "wanted", "x_m"),
    [
        (("clamped", "free"), CLAMPED_FREE, L),
        (("free", "clamped"), CLAMPED_FREE, 0.0),
        ("clamped", CLAMPED_CLAMPED, 0.23 * L),
        (("clamped", "pinned"), CLAMPED_PINNED, 0.23 * L),
        ("pinned", [np.pi, 2.0 * np.pi], 0.37 * L),
        ("free", CLAMPED_CLAMPED, 0.0),
    ],
)
def test_natural_frequencies_of_lone_beams(ends: object, wanted: list[float], x_m: float) -> None:
    for z in wanted:
        assert resonance(line(beam(ends=ends)), z, x_m) == pytest.approx(z, rel=1e-9)


def test_receptance_of_a_cantilever_at_its_tip() -> None:
    f = np.array([0.05, 0.9, 3.0, 17.0, 60.0, 400.0])
    b = np.sqrt(2.0 * np.pi * f * np.sqrt(M / EI))
    z = b * L
    exact = (np.cosh(z) * np.sin(z) - np.sinh(z) * np.cos(z)) / (EI * b**3 * (1.0 + np.cosh(z) * np.cos(z)))
    np.testing.assert_allclose(answer(line(beam(ends=("clamped", "free"))), f, L), exact, rtol=1e-9)


def test_static_deflections() -> None:
    low = [1e-3]
    assert answer(line(beam(ends=("clamped", "free"))), low, L)[0] == pytest.approx(L**3 / (3.0 * EI), rel=1e-6)
    assert answer(line(beam(ends="clamped")), low, L / 2)[0] == pytest.approx(L**3 / (192.0 * EI), rel=1e-6)
    half = answer(line(beam(ends=("pinned", "clamped"))), low, L / 2)[0]
    assert half == pytest.approx(7.0 * L**3 / (768.0 * EI), rel=1e-6)


@pytest.mark.parametrize("ratio", [0.1, 3.0, 50.0])
def test_a_pinned_end_turns_against_its_spring(ratio: float) -> None:
    """The end's own rotation per moment is L (coth z - cot z) / (2 E I z) (Euler and Bernoulli)."""
    spring = ratio * EI / L
    one = line(beam(ends="pinned", rotation_law=("turn", "")), spring)

    def characteristic(z: float) -> float:
        return float(2.0 * z + ratio * (1.0 / np.tanh(z) - 1.0 / np.tan(z)))

    for low in (np.pi, 2.0 * np.pi):
        z = brentq(characteristic, low + 1e-6, low + np.pi - 1e-6, xtol=1e-14)
        assert resonance(one, z, 0.37 * L) == pytest.approx(z, rel=1e-9)
    # Both ends alike and a load in the middle: the end moment M = k theta takes M L^2 / (8 E I) off.
    both = line(beam(ends="pinned", rotation_law="turn"), complex(spring, 0.2 * spring))
    k = complex(spring, 0.2 * spring)
    moment = k * L**2 / (16.0 * EI) / (1.0 + k * L / (2.0 * EI))
    static = L**3 / (48.0 * EI) - moment * L**2 / (8.0 * EI)
    np.testing.assert_allclose(answer(both, [1e-3], L / 2)[0], static, rtol=1e-6)


def test_a_stiff_spring_is_a_clamp_and_none_a_pin() -> None:
    f = [0.7, 3.0, 20.0]
    clamped = answer(line(beam(ends=("clamped", "pinned"))), f, 0.37 * L)
    stiff = answer(line(beam(ends="pinned", rotation_law=("turn", "")), 1e7 * EI / L), f, 0.37 * L)
    np.testing.assert_allclose(stiff, clamped, rtol=1e-5)
    soft = answer(line(beam(ends="pinned", rotation_law="turn"), 1e-9 * EI / L), f, 0.37 * L)
    np.testing.assert_allclose(soft, answer(line(beam(ends="pinned")), f, 0.37 * L), rtol=1e-6)


def test_a_timoshenko_cantilever_bends_and_shears() -> None:
    shear = {"theory": "timoshenko", "shear_modulus_Pa": 8e10, "shear_coefficient": 0.4}
    thick = beam(ends=("clamped", "free"), **shear)
    static = L**3 / (3.0 * EI) + L / (0.4 * 8e10 * A)
    assert answer(line(thick), [1e-3], L)[0] == pytest.approx(static, rel=1e-6)


def test_rows_sections_and_joints_go_with_clamped_ends() -> None:
    """Two clamped spans side by side are each their own; a joint in the span acts as by Sherman and Morrison."""
    row = Line(bodies={"beam": beam(intervals_m=((0.0, L), (L, 2.0 * L)), ends="clamped")})
    f = [3.0, 11.0]
    places = [Place(body="beam", x_m=0.3 * L), Place(body="beam", x_m=1.3 * L)]
    both = receptance(row, f, forces=places, sensors=places, threads=1).receptance.values
    single = answer(line(beam(ends="clamped")), f, 0.3 * L)
    np.testing.assert_allclose(both[:, 0, 0], single, rtol=1e-9)
    np.testing.assert_allclose(both[:, 1, 1], single, rtol=1e-9)
    np.testing.assert_array_equal(both[:, 0, 1], 0.0)
    held = Line(
        bodies={"beam": beam(ends="clamped")},
        joints=(Joints(between=("beam", "ground"), law="k", at=(0.3 * L,)),),
        laws={"k": Hysteretic(stiffness=2e6, loss_factor=0.1)},
    )
    k = 2e6 * (1.0 + 0.1j)
    np.testing.assert_allclose(answer(held, f, 0.3 * L), single / (1.0 + k * single), rtol=1e-9)
    place = [Place(body="beam", x_m=0.3 * L)]
    data = receptance(held, f, forces=place, sensors=place, extensions=True, threads=1)
    # The joints that hold the ends are none of the model's.
    assert data.sizes["joint"] == 1


def test_derivatives_by_the_law_of_a_rotational_spring() -> None:
    spring, place = 3.0 * EI / L, [Place(body="beam", x_m=0.37 * L)]

    def at(k: float) -> np.ndarray:
        return answer(line(beam(ends="pinned", rotation_law="turn"), k), [3.0], 0.37 * L)

    one = line(beam(ends="pinned", rotation_law="turn"), spring)
    data = sensitivity(one, [3.0], forces=place, sensors=place, places=True, threads=1)
    step = 1e-4 * spring
    slope = (at(spring + step) - at(spring - step)) / (2.0 * step)
    np.testing.assert_allclose(data["by_law"].values[:, 0, 0, 0], slope, rtol=1e-5)
    assert data.sizes["joint"] == 0


def test_a_model_file_of_a_lone_beam() -> None:
    model = model_from_dict(
        {
            "frequencies": {"values_Hz": [1.0, 2.0]},
            "line": {"bodies": {"beam": {**beam(ends="clamped").model_dump(), "ends": ["clamped", "free"]}}},
            "forces": [{"body": "beam", "x_m": L}],
            "sensors": [{"body": "beam", "x_m": L}],
        }
    )
    assert model.line.joints == ()
    assert model.line.laws == {}
    np.testing.assert_allclose(
        answer(model.line, [1.0, 2.0], L), answer(line(beam(ends=("clamped", "free"))), [1.0, 2.0], L)
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"ends": "clamp"}, '"clamped"'),
        ({"ends": "clamped", "intervals_m": None}, "give intervals_m"),
        ({"ends": "free", "rotation_law": "turn"}, "goes with a pinned end"),
        ({"ends": "clamped", "rotation_law": "turn"}, "goes with a pinned end"),
        ({"ends": "clamped", "modes": 5}, "modes are for free and pinned ends"),
    ],
)
def test_ends_that_cannot_be(options: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        beam(**options)


def test_ends_that_the_line_or_the_formulation_cannot_hold() -> None:
    with pytest.raises(ValueError, match="there is no law 'turn'"):
        line(beam(ends="pinned", rotation_law="turn"))
    place = [Place(body="beam", x_m=1.0)]
    with pytest.raises(InputError, match="chain"):
        receptance(line(beam(ends="clamped")), [1.0], forces=place, sensors=place, formulation="receptance")
