"""Beams whose section changes, and shafts, against closed forms.

Natural frequencies of stepped Euler beams from the determinant of cos, sin, cosh and sinh in every part (as in
Jang and Bert, J. Sound Vib. 130, 1989, who tabulate such beams); a crack as a massless hinge of stiffness B / l
(Rizos, Aspragathos and Dimarogonas, J. Sound Vib. 138, 1990); deflection at rest by Mohr's integral; a bar between
two infinite halves by its transmitted wave (Graff, Wave Motion in Elastic Solids, 1975, section 2.3, as a shaft).
Signs: exp(+i omega t), displacement along the force.
"""

import numpy as np
import pytest
from permway.laws import Hysteretic
from permway.model.bodies import Beam, BeamChange
from permway.model.joints import GROUND, Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.shafts import Shaft, ShaftChange
from permway.response.receptance import receptance
from scipy.optimize import brentq

pytestmark = pytest.mark.parametrize("formulation", ["chain", "receptance"])

BENDING, MASS, LENGTH = 3.0e9, 4000.0, 12.0


def beam(*changes, ends="free", loss_factor=0.0, interval=((0.0, LENGTH),)):
    return Beam(
        youngs_modulus_Pa=3e10,
        second_moment_m4=BENDING / 3e10,
        density_kg_per_m3=2500.0,
        area_m2=MASS / 2500.0,
        intervals_m=interval,
        ends=ends,
        loss_factor=loss_factor,
        changes=changes,
    )


def shaft(*changes, interval=None, loss_factor=0.0, ends="free"):
    """S = 2e9 N, 800 kg/m."""
    return Shaft(
        shear_modulus_Pa=1e10,
        torsion_constant_m4=0.2 * 0.75**2,
        density_kg_per_m3=2000.0,
        polar_moment_m4=0.4 * 0.75**2,
        arm_m=0.75,
        intervals_m=interval,
        loss_factor=loss_factor,
        changes=changes,
        ends=ends,
    )


def respond(body, frequency, force, *sensors, formulation, joints=(), laws=None):
    line = Line(bodies={"body": body}, joints=joints, laws=laws or {})
    places = [Place(body="body", x_m=x) for x in (sensors or (force,))]
    data = receptance(
        line, frequency, forces=[Place(body="body", x_m=force)], sensors=places, formulation=formulation
    )
    return data["receptance"].values[:, :, 0]


def solutions(k, bending, x):
    """Displacement, slope, moment and force of cos, sin, cosh and sinh of k x; columns are solutions."""
    c, s, ch, sh = np.cos(k * x), np.sin(k * x), np.cosh(k * x), np.sinh(k * x)
    return np.array(
        [
            [c, s, ch, sh],
            [-k * s, k * c, k * sh, k * ch],
            bending * k**2 * np.array([-c, -s, ch, sh]),
            bending * k**3 * np.array([s, -c, sh, ch]),
        ]
    )


def determinant(frequency, parts, ends, hinge=None):
    """Of the conditions at both ends and between the parts (length, bending, mass); a hinge gives by M / hinge."""
    omega, n = 2.0 * np.pi * frequency, len(parts)
    matrix = np.zeros((4 * n, 4 * n))
    held = {"free": [2, 3], "pinned": [0, 2]}[ends]
    k = [(mass * omega**2 / bending) ** 0.25 for _, bending, mass in parts]
    matrix[:2, :4] = solutions(k[0], parts[0][1], 0.0)[held]
    for i, (length, bending, _) in enumerate(parts):
        end = solutions(k[i], bending, length)
        rows, columns = slice(2 + 4 * i, 6 + 4 * i), slice(4 * i, 4 * i + 4)
        if i + 1 == n:
            matrix[-2:, columns] = end[held]
            break
        if hinge is not None:
            end[1] += end[2] / hinge
        matrix[rows, columns] = end
        matrix[rows, 4 * i + 4 : 4 * i + 8] = -solutions(k[i + 1], parts[i + 1][1], 0.0)
    matrix /= np.abs(matrix).max(axis=1)[:, None]
    return np.linalg.det(matrix / np.abs(matrix).max(axis=0))


def roots(function, low, high, count):
    grid = np.geomspace(low, high, 2000)
    values = np.array([function(f) for f in grid])
    change = np.flatnonzero(values[:-1] * values[1:] < 0.0)[:count]
    assert change.size == count
    return [brentq(function, grid[i], grid[i + 1], xtol=1e-13, rtol=1e-14) for i in change]


def assert_resonates(body, expected, x, formulation):
    """Nearly without loss the stiffness at x vanishes at the natural frequencies."""

    def stiffness(frequency):
        return (1.0 / respond(body, [frequency], x, formulation=formulation)[0, 0]).real

    for f in expected:
        assert brentq(stiffness, f * 0.999, f * 1.001, rtol=1e-12) == pytest.approx(f, rel=1e-9)


STEPS = [
    # Half of the beam weaker; a thicker middle; two cuts of a section each.
    [(6.0, 1.0, 1.0), (6.0, 0.4, 0.7)],
    [(4.0, 1.0, 1.0), (3.0, 2.5, 1.4), (5.0, 1.0, 1.0)],
    [(2.0, 1.0, 1.0), (1.5, 0.3, 0.8), (4.5, 1.0, 1.0), (0.4, 0.15, 0.6), (3.6, 1.0, 1.0)],
]


@pytest.mark.parametrize("ends", ["free", "pinned"])
@pytest.mark.parametrize("steps", STEPS, ids=["half", "middle", "two"])
def test_frequencies_of_a_stepped_beam(steps, ends, formulation):
    parts = [(length, BENDING * b, MASS * m) for length, b, m in steps]
    found, x = [], 0.0
    for length, b, m in steps:
        if (b, m) != (1.0, 1.0):
            found.append(BeamChange(from_m=x, to_m=x + length, bending_factor=b, mass_factor=m))
        x += length
    expected = roots(lambda f: determinant(f, parts, ends), 1.0, 300.0, 4)
    # A free beam of one section would resonate elsewhere.
    uniform = roots(lambda f: determinant(f, [(LENGTH, BENDING, MASS)], ends), 1.0, 300.0, 4)
    assert np.abs(np.array(expected) / uniform - 1.0).max() > 0.01
    # The point of no symmetric mode's node.
    assert_resonates(beam(*found, ends=ends, loss_factor=1e-6), expected, 1.37, formulation)


@pytest.mark.parametrize("width", [0.02, 0.002])
def test_a_narrow_crack_is_a_hinge(width, formulation):
    """Bending factor q over a width l turns as a spring q E I / l; what is left is of the order of l."""
    factor = 0.05 * width
    hinge = factor * BENDING / width
    parts = [(5.0, BENDING, MASS), (7.0, BENDING, MASS)]
    expected = roots(lambda f: determinant(f, parts, "pinned", hinge), 1.0, 300.0, 3)
    crack = BeamChange(from_m=5.0 - width / 2, to_m=5.0 + width / 2, bending_factor=factor)
    cracked = beam(crack, ends="pinned", loss_factor=1e-6)

    def stiffness(frequency):
        return (1.0 / respond(cracked, [frequency], 1.37, formulation=formulation)[0, 0]).real

    for f in expected:
        assert brentq(stiffness, f * 0.99, f * 1.01, rtol=1e-12) == pytest.approx(f, rel=0.3 * width)


def test_deflection_at_rest_by_mohr(formulation):
    """A pinned beam with a stiffer middle half, and a shaft with a weaker third, at 1e-3 Hz."""
    middle = BeamChange(from_m=3.0, to_m=9.0, bending_factor=2.0)
    value = respond(beam(middle, ends="pinned"), [1e-3], 6.0, formulation=formulation)[0, 0]
    closed = (3.0**3 / BENDING + (6.0**3 - 3.0**3) / (2.0 * BENDING)) / 6.0
    assert value == pytest.approx(closed, rel=1e-7)
    weak = ShaftChange(from_m=4.0, to_m=8.0, torsion_factor=0.5)
    held = shaft(weak, interval=((0.0, 12.0),), ends=("pinned", "free"))
    value = respond(held, [1e-3], 12.0, formulation=formulation)[0, 0]
    assert value == pytest.approx((4.0 + 8.0 + 4.0) / 2e9, rel=1e-7)


@pytest.mark.parametrize("frequency", [1.0, 55.0, 1000.0])
def test_infinite_shaft(frequency, formulation):
    """w = exp(-i k |x|) / (2 i k S)."""
    body, distance = shaft(loss_factor=0.02), np.array([0.0, 0.4, 11.0])
    value = respond(body, [frequency], 0.0, *distance, formulation=formulation)[0]
    k = np.sqrt(800.0 * (2 * np.pi * frequency) ** 2 / (2e9 * (1 + 0.02j)))
    assert np.abs(value / (np.exp(-1j * k * distance) / (2j * k * 2e9 * (1 + 0.02j))) - 1).max() < 1e-11


@pytest.mark.parametrize(("ends", "waves"), [("free", [0.5, 1.0, 1.5]), (("pinned", "free"), [0.25, 0.75, 1.25])])
def test_frequencies_of_a_shaft(ends, waves, formulation):
    """n / 2L sqrt(S/m) with free ends, (2 n - 1) / 4L sqrt(S/m) with one held."""
    body = shaft(interval=((0.0, 12.0),), ends=ends, loss_factor=1e-6)
    expected = np.array(waves) / 12.0 * np.sqrt(2e9 / 800.0)
    assert_resonates(body, expected, 10.7, formulation)


@pytest.mark.parametrize("frequency", [20.0, 300.0])
def test_a_length_of_other_shaft_lets_a_wave_through_by_its_impedance(frequency, formulation):
    """T = 1 / (cos k l + i/2 (z + 1/z) sin k l) of what comes, z the ratio of impedances."""
    stiff, heavy, length = 3.0, 0.5, 2.0
    body = shaft(ShaftChange(from_m=5.0, to_m=7.0, torsion_factor=stiff, mass_factor=heavy))
    through, alone = (
        respond(each, [frequency], 0.0, 9.0, formulation=formulation)[0, 0] for each in (body, shaft())
    )
    omega = 2 * np.pi * frequency
    outer, inner = omega * np.sqrt(800.0 / 2e9), omega * np.sqrt(800.0 * heavy / (2e9 * stiff))
    z = np.sqrt(stiff * heavy)
    share = 1.0 / (np.cos(inner * length) + 0.5j * (z + 1 / z) * np.sin(inner * length))
    # The direct wave has gone that length with its own wavenumber.
    assert through / alone == pytest.approx(share * np.exp(1j * outer * length), rel=1e-10)


def test_shaft_on_a_bed_of_springs(formulation):
    """1 / (2 sqrt(S s)) at rest, s per metre, sampled every 0.05 m."""
    at = tuple(np.round(np.arange(-800, 801) * 0.05, 3).tolist())
    joints = (Joints(between=("body", GROUND), law="bed", at=at),)
    value = respond(
        shaft(),
        [1e-2],
        0.025,
        formulation=formulation,
        joints=joints,
        laws={"bed": Hysteretic(stiffness=1e9 * 0.05)},
    )[0, 0]
    assert value == pytest.approx(1.0 / (2.0 * np.sqrt(2e9 * 1e9)), rel=1e-3)
