"""All modes of a line, by default places on all bodies, against closed forms and eigenvalues of finite elements.

Closed forms: a pinned beam has f_n = (n pi / L)^2 sqrt(E I / m) / (2 pi), shape sin(n pi x / L) and modal mass
m L / 2 (Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table 8-1); a free one m L / 4 for a largest
displacement of 1 at its ends (ibid.). N equal masses, each on a spring k and tied to the next by t, have omega_j^2
= (k + 4 t sin^2(pi j / (2 N))) / m and shapes cos(pi j (i - 1/2) / N).
"""

from __future__ import annotations

import numpy as np
import permway
import pytest
from permway.errors import InputError
from permway.laws import Hysteretic, KelvinVoigt
from permway.model.bodies import Beam, Mass
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.shafts import Shaft
from permway.response.everywhere import everywhere
from permway.response.modes import modes

LENGTH_M, ETA = 24.0, 0.03
BENDING, MASS = 3.4e10 * 1.2, 1.0e4


def beam(ends: str = "pinned", eta: float = ETA, intervals=((0.0, LENGTH_M),)) -> Beam:
    return Beam(
        youngs_modulus_Pa=3.4e10,
        second_moment_m4=1.2,
        density_kg_per_m3=2500.0,
        area_m2=4.0,
        loss_factor=eta,
        intervals_m=intervals,
        ends=ends,
    )


def pinned(n: np.ndarray) -> np.ndarray:
    return (n * np.pi / LENGTH_M) ** 2 * np.sqrt(BENDING * (1.0 + 1j * ETA) / MASS)


def test_a_pinned_beam_over_three_decades() -> None:
    n = np.arange(1, 19)
    omega = pinned(n)
    data = modes(Line(bodies={"beam": beam()}), 2.0, 1800.0)
    assert data.natural_frequency.values == pytest.approx(np.abs(omega) / (2.0 * np.pi), rel=1e-8)
    assert data.damping_ratio.values == pytest.approx(omega.imag / np.abs(omega), abs=1e-7)
    shape = np.sin(n[:, None] * np.pi * data.place_x.values / LENGTH_M)
    top = np.abs(data["shape"].values).argmax(axis=1)
    scale = shape[range(n.size), top]
    assert data["shape"].values == pytest.approx(shape / scale[:, None], abs=1e-6)
    # Where no place stands on the largest displacement, the mass is that of what does.
    assert data.modal_mass.values == pytest.approx(0.5 * MASS * LENGTH_M / scale**2, rel=1e-5)
    assert data.attrs["unsettled_Hz"] == []


def test_a_free_beam_s_modal_mass() -> None:
    data = modes(Line(bodies={"beam": beam("free")}), 2.0, 100.0)
    assert data.modal_mass.values == pytest.approx(0.25 * MASS * LENGTH_M, rel=1e-5)


@pytest.mark.parametrize("zeta", [1e-3, 0.1])
def test_a_mass_on_a_spring(zeta: float) -> None:
    spring, mass = 2.7e4, 3.0
    law = KelvinVoigt(stiffness=spring, damping=2.0 * zeta * np.sqrt(spring * mass))
    line = Line(
        bodies={"m": Mass(mass_kg=mass)},
        joints=(Joints(between=("m", "ground"), law="s", at=(4.0,)),),
        laws={"s": law},
    )
    data = modes(line, 5.0, 50.0)
    assert data.sizes["mode"] == 1
    assert data.natural_frequency.item() == pytest.approx(np.sqrt(spring / mass) / (2.0 * np.pi), rel=1e-9)
    assert data.damping_ratio.item() == pytest.approx(zeta, rel=1e-8)
    # (omega - p1) (omega - p2) m with p1 - p2 = 2 omega_0 sqrt(1 - zeta^2): what the residue weighs.
    assert data.modal_mass.item() == pytest.approx(mass * np.sqrt(1.0 - zeta**2), rel=1e-8)
    assert (data.place_body.item(), data.place_x.item()) == ("m", 4.0)


def test_many_equal_masses_whose_damping_hides_all_but_one_peak() -> None:
    """Poles 1e-4 apart under damping of 5 %: one peak, nine modes."""
    count, mass, spring, tie = 9, 10.0, 4.0e4, 12.0
    laws = {"s": Hysteretic(stiffness=spring, loss_factor=0.1), "t": Hysteretic(stiffness=tie, loss_factor=0.1)}
    bodies = {f"m{i}": Mass(mass_kg=mass) for i in range(count)}
    joints = tuple(Joints(between=(f"m{i}", "ground"), law="s", at=(float(i),)) for i in range(count)) + tuple(
        Joints(between=(f"m{i}", f"m{i + 1}"), law="t", at=(i + 0.5,)) for i in range(count - 1)
    )
    data = modes(Line(bodies=bodies, joints=joints, laws=laws), 5.0, 20.0)
    j = np.arange(count)
    omega = np.sqrt((spring + 4.0 * tie * np.sin(0.5 * np.pi * j / count) ** 2) * (1.0 + 0.1j) / mass)
    assert np.diff(np.abs(omega)).min() < 2e-5 * abs(omega[0])
    assert data.natural_frequency.values == pytest.approx(np.abs(omega) / (2.0 * np.pi), rel=1e-8)
    expected = np.cos(np.pi * j[:, None] * (j + 0.5) / count)
    found = data["shape"].values
    mac = np.abs((found * expected).sum(axis=1)) ** 2 / ((np.abs(found) ** 2).sum(1) * (expected**2).sum(1))
    assert mac == pytest.approx(1.0, abs=1e-6)


def test_modes_that_share_a_frequency_have_no_modal_mass_of_their_own() -> None:
    two = beam(intervals=((0.0, LENGTH_M), (30.0, 30.0 + LENGTH_M)))
    data = modes(Line(bodies={"beam": two}), 2.0, 30.0)
    first = np.abs(pinned(np.array([1, 1, 2, 2]))) / (2.0 * np.pi)
    assert data.natural_frequency.values == pytest.approx(first, rel=1e-8)
    # Both shapes of the first frequency span those of the two beams.
    assert np.isnan(data.modal_mass.values).all()
    both = np.linalg.svd(data["shape"].values[:2], compute_uv=False)
    assert both[1] > 0.1 * both[0]


def test_a_light_mass_does_not_hide_the_beam_that_bears_it() -> None:
    """A modal mass of 120 t beside one of 2 kg: six thousand times heavier in each of both directions."""
    line = Line(
        bodies={"beam": beam(), "tick": Mass(mass_kg=2.0)},
        joints=(Joints(between=("tick", "beam"), law="s", at=(9.0,)),),
        laws={"s": KelvinVoigt(stiffness=2.0 * (2.0 * np.pi * 40.0) ** 2, damping=10.0)},
    )
    data = modes(line, 3.0, 60.0)
    assert data.sizes["mode"] == 4
    assert data.natural_frequency.values[[0, 1, 3]] == pytest.approx(
        np.abs(pinned(np.array([1, 2, 3]))) / (2.0 * np.pi), rel=1e-3
    )
    assert data.natural_frequency.values[2] == pytest.approx(40.0, rel=1e-3)
    assert data.modal_mass.values[2] == pytest.approx(2.0, rel=0.02)


def test_the_pinned_girder_of_the_paper_s_viaduct() -> None:
    """Tables 2 and 3: a girder alone has pi / (2 L^2) sqrt(E I / m); track adds mass and some stiffness."""
    data = modes(permway.slab_track_viaduct_32m(girder="pinned"), 3.0, 6.0, temperature_C=20.0)
    alone = np.pi / (2.0 * 32.0**2) * np.sqrt(3.6e10 * 11.056 / (2650.0 * 9.089))
    heavier = alone * np.sqrt(2650.0 * 9.089 / (2650.0 * 9.089 + 2500.0 * (0.51 + 0.975) + 121.3))
    (first,) = data.natural_frequency.values
    assert heavier < first < alone


def test_an_endless_rail_on_supports_radiates() -> None:
    """Modes of the track overlap, and those distinguished are damped, also by what runs off along the rail."""
    data = modes(permway.ballasted_b91_60e1(sleepers=31), 40.0, 200.0)
    assert data.sizes["mode"] > 5
    assert (data.damping_ratio.values > 0.0).all()


def test_places_are_on_all_bodies_and_near_enough() -> None:
    line = permway.slab_track_viaduct_32m()
    places = everywhere(line, 200.0)
    assert {p.body for p in places} == {"rail", "slab", "base", "girder"}
    girder = [p.x_m for p in places if p.body == "girder"]
    assert (girder[0], girder[-1], len(girder)) == (0.0, 32.0, 41)
    rail = np.array([p.x_m for p in places if p.body == "rail"])
    body = line.bodies["rail"]
    wavelength = 2.0 * np.pi * (abs(body.bending_Nm2) / (body.mass_kg_per_m * (2.0 * np.pi * 200.0) ** 2)) ** 0.25
    assert wavelength / 13.0 < np.diff(rail).max() <= wavelength / 12.0


def test_given_places_give_shapes_there() -> None:
    at = [Place(body="beam", x_m=x) for x in (5.0, 11.0)]
    data = modes(Line(bodies={"beam": beam()}), 2.0, 50.0, places=at)
    assert list(data.place.values) == ["beam@5", "beam@11"]
    assert data.natural_frequency.values == pytest.approx(
        np.abs(pinned(np.arange(1, 4))) / (2.0 * np.pi), rel=1e-8
    )


@pytest.mark.parametrize(
    ("act", "message"),
    [
        (lambda: modes(Line(bodies={"beam": beam()}), 5.0, 5.0), "from low to high"),
        (lambda: modes(Line(bodies={"beam": beam()}), "low", 5.0), "from low to high"),
        (lambda: modes(Line(bodies={"beam": beam()}), 1.0, 5.0, places=[]), "no place"),
        (lambda: modes("model.toml", 1.0, 5.0), "must be a Line"),
        (lambda: modes(Line(bodies={"beam": beam("free", intervals=None)}), 1.0, 5.0), "give places"),
    ],
)
def test_what_is_asked_wrongly_is_refused(act, message: str) -> None:
    with pytest.raises(InputError, match=message):
        act()


def test_an_endless_rail_against_its_characteristic_equation() -> None:
    """A rail that radiates, a mass at 0 and a support at 5 m: det(1 + G K) = 0 at complex frequencies.

    Under exp(+i omega t) the endless beam has G(x) = (-i exp(-i k x) - exp(-k x)) / (4 E I k^3), k^4 = m omega^2 /
    (E I) (Graff, Wave Motion in Elastic Solids, 1975, 3.2); the mass on its spring is a stiffness
    -s m omega^2 / (s - m omega^2) to the ground.
    """
    rail = Beam(youngs_modulus_Pa=2.1e11, second_moment_m4=3e-5, density_kg_per_m3=7850.0, area_m2=7.7e-3)
    attached = 200.0
    joints = (
        Joints(between=("rail", "mass"), law="s", at=(0.0,)),
        Joints(between=("rail", "ground"), law="s", at=(5.0,)),
    )
    line = Line(
        bodies={"rail": rail, "mass": Mass(mass_kg=attached)},
        joints=joints,
        laws={"s": KelvinVoigt(stiffness=2e7, damping=1e4)},
    )
    data = modes(line, 5.0, 500.0)
    omega = 2.0 * np.pi * data.natural_frequency.values * np.exp(1j * np.arcsin(data.damping_ratio.values))

    def determinant(w: complex) -> complex:
        k = (7850.0 * 7.7e-3 * w**2 / (2.1e11 * 3e-5)) ** 0.25
        near, far = (
            (-1j * np.exp(-1j * k * x) - np.exp(-k * x)) / (4.0 * 2.1e11 * 3e-5 * k**3) for x in (0.0, 5.0)
        )
        s = 2e7 + 1j * w * 1e4
        stiff = np.array([-s * attached * w**2 / (s - attached * w**2), s])
        return complex(np.linalg.det(np.eye(2) + np.array([[near, far], [far, near]]) * stiff))

    assert omega.size == 5
    for w in omega:
        # One step of Newton's method from the pole that was found ends where it began.
        step = 1e-6 * w
        slope = (determinant(w + step) - determinant(w - step)) / (2.0 * step)
        assert abs(determinant(w) / slope) < 1e-7 * abs(w)


def test_a_shaft_without_loss() -> None:
    """Pinned at both ends: f_n = n / (2 L) sqrt(G J / (rho I_p)), modal mass rho I_p L / (2 arm^2)."""
    shaft = Shaft(
        shear_modulus_Pa=1.4e10,
        torsion_constant_m4=0.5,
        density_kg_per_m3=2500.0,
        polar_moment_m4=2.0,
        arm_m=0.5,
        intervals_m=((0.0, 30.0),),
        ends="pinned",
    )
    data = modes(Line(bodies={"deck": shaft}), 5.0, 70.0)
    expected = np.arange(1, 4) / 60.0 * np.sqrt(1.4e10 * 0.5 / (2500.0 * 2.0))
    assert data.natural_frequency.values == pytest.approx(expected, rel=1e-10)
    assert data.damping_ratio.values == pytest.approx(0.0, abs=1e-9)
    assert data.modal_mass.values == pytest.approx(2500.0 * 2.0 * 30.0 / 2.0 / 0.5**2, rel=0.01)
