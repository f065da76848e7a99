"""Two rails on what carries both: the two halves together against models of the whole cross-section.

The whole is solved here on its own: two rails, and slabs that move up and down and roll, their joints one by one
at their places across the track.
"""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.errors import InputError
from permway.laws import Hysteretic
from permway.model.bodies import Beam, BeamChange, Mass, Shaft
from permway.model.joints import GROUND, Ends, Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.presets import LINES
from permway.model.roll import Lever, Roll, Rolling, Twisting, antisymmetric
from permway.model.shafts import ShaftChange
from permway.response.rails import both_rails

FREQUENCY_HZ = np.array([3.0, 25.0, 90.0, 310.0])
GAUGE_M = 1.5
ARM_M = 0.5 * GAUGE_M
PAD, BED, LOSS = 6e7 * (1 + 0.2j), 4e7 * (1 + 0.5j), 0.02
RAIL = (2.1e11, 3.0e-5, 7850.0, 7.7e-3)


def law(value):
    return Hysteretic(stiffness=value.real, loss_factor=value.imag / value.real)


def rail(interval=None):
    modulus, inertia, density, area = RAIL
    return Beam(
        youngs_modulus_Pa=modulus,
        second_moment_m4=inertia,
        density_kg_per_m3=density,
        area_m2=area,
        loss_factor=LOSS,
        intervals_m=interval,
    )


def along(line, roll, places, **options):
    data = both_rails(line, roll, FREQUENCY_HZ, forces=places, sensors=places, threads=1, **options)
    return data["receptance"].values, data["receptance_other_side"].values


SLEEPERS = (0.0, 0.6, 1.1, 1.8, 2.4)
SLEEPER_KG, GYRATION_M, BALLAST_M = 300.0, 0.8, 2.2
SLEEPER_ROLL = Roll(
    gauge_m=GAUGE_M,
    bodies={"sleeper": Rolling(radius_m=GYRATION_M)},
    laws={"bed": Lever(width_m=BALLAST_M)},
)


def sleepers():
    """Half model: one endless rail, half sleepers of different spacing, half of the bed."""
    return Line(
        bodies={"rail": rail(), "sleeper": Mass(mass_kg=0.5 * SLEEPER_KG, at=SLEEPERS)},
        joints=(
            Joints(between=("rail", "sleeper"), law="pad", at=Ends(of="sleeper")),
            Joints(between=("sleeper", GROUND), law="bed", at=Ends(of="sleeper"), scale=0.5),
        ),
        laws={"pad": law(PAD), "bed": law(BED)},
    )


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
def test_rigid_sleepers_that_heave_and_roll(formulation):
    """Two infinite rails by their closed form, sleepers of two degrees of freedom, in one dense system."""
    places = [Place(body="rail", x_m=0.3), Place(body="rail", x_m=1.1), Place(body="sleeper", x_m=1.8)]
    same, other = along(sleepers(), SLEEPER_ROLL, places, formulation=formulation)
    modulus, inertia, density, area = RAIL
    bending, n = modulus * inertia * (1 + 1j * LOSS), len(SLEEPERS)
    rails = np.array([0.3, 1.1])
    at = np.concatenate([rails, SLEEPERS])
    for number, frequency in enumerate(FREQUENCY_HZ):
        omega = 2 * np.pi * frequency
        k = (density * area * omega**2 / bending) ** 0.25
        far = np.abs(at[:, None] - at[None, :])
        green = -(1j * np.exp(-1j * k * far) + np.exp(-k * far)) / (4 * bending * k**3)
        # Unknowns: forces of the pads on the left and the right rail; heave and roll of the sleepers.
        seats = slice(2, None)
        unit = np.eye(n)
        system = np.block(
            [
                [green[seats, seats] + unit / PAD, 0 * unit, unit, ARM_M * unit],
                [0 * unit, green[seats, seats] + unit / PAD, unit, -ARM_M * unit],
                [-unit, -unit, (BED - omega**2 * SLEEPER_KG) * unit, 0 * unit],
                [
                    -ARM_M * unit,
                    ARM_M * unit,
                    0 * unit,
                    (BED * BALLAST_M**2 / 12 - omega**2 * SLEEPER_KG * GYRATION_M**2) * unit,
                ],
            ]
        )
        loads = np.zeros((4 * n, 3), dtype=complex)
        # On the left rail at its two places, and on the fourth sleeper under the left rail.
        loads[:n, :2] = green[seats, :2]
        loads[2 * n + 3, 2], loads[3 * n + 3, 2] = 1.0, ARM_M
        found = np.linalg.solve(system, loads)
        direct = np.zeros((2, 3), dtype=complex)
        direct[:, :2] = green[:2, :2]
        left = np.vstack([direct - green[:2, seats] @ found[:n], found[2 * n + 3] + ARM_M * found[3 * n + 3]])
        right = np.vstack([-green[:2, seats] @ found[n : 2 * n], found[2 * n + 3] - ARM_M * found[3 * n + 3]])
        assert np.abs(same[number] / left - 1).max() < 1e-9
        assert np.abs(other[number] / right - 1).max() < 1e-8


# Slabs that bend and twist

SLAB_M = ((0.0, 4.8), (4.8, 9.0))
SLAB = (3.6e10, 2.5 * 0.3**3 / 12, 2500.0, 2.5 * 0.3)
WIDTH_M, MORTAR, DOWEL = 2.4, 1.5e8 * (1 + 0.1j), 3e8 * (1 + 0.05j)
SHEAR_PA, TORSION_M4 = 1.5e10, 2.5 * 0.3**3 / 3 * 0.92
POLAR_M4 = 2.5 * 0.3 * (2.5**2 + 0.3**2) / 12
SEATS = tuple(np.round(0.3 + 0.6 * np.arange(15), 3).tolist())
RAIL_M = (-1.0, 10.0)
THINNED = (1.0, 2.2)
SLAB_ROLL = Roll(
    gauge_m=GAUGE_M,
    bodies={
        "slab": Twisting(
            shear_modulus_Pa=SHEAR_PA,
            torsion_constant_m4=TORSION_M4,
            polar_moment_m4=POLAR_M4,
            changes=(ShaftChange(from_m=THINNED[0], to_m=THINNED[1], torsion_factor=0.5, mass_factor=0.8),),
        )
    },
    laws={"mortar": Lever(width_m=WIDTH_M), "dowel": Lever(arm_m=1.0)},
)


def slabs():
    modulus, inertia, density, area = SLAB
    thinned = BeamChange(from_m=THINNED[0], to_m=THINNED[1], bending_factor=0.4, mass_factor=0.8)
    return Line(
        bodies={
            "rail": rail((RAIL_M,)),
            "slab": Beam(
                youngs_modulus_Pa=modulus,
                second_moment_m4=inertia,
                density_kg_per_m3=density,
                area_m2=area,
                loss_factor=LOSS,
                intervals_m=SLAB_M,
                share=0.5,
                changes=(thinned,),
            ),
        },
        joints=(
            Joints(between=("rail", "slab"), law="pad", at=SEATS),
            Joints(between=("slab", GROUND), law="mortar", at=SEATS, scale=0.5),
            Joints(between=("slab", "slab"), law="dowel", at="meetings", scale=0.5),
        ),
        laws={"pad": law(PAD), "mortar": law(MORTAR), "dowel": law(DOWEL)},
    )


class Whole:
    """Both rails and the whole slabs by finite elements: cubic in bending, quadratic in twist."""

    def __init__(self, parts):
        self.rows, self.size, self.mesh = {}, 0, {}
        marks = {"left": (*RAIL_M, *SEATS, 4.5), "right": (*RAIL_M, *SEATS, 4.5)}
        for i, reach in enumerate(SLAB_M):
            inside = [x for x in (*SEATS, *THINNED, 4.5, 6.0) if reach[0] <= x <= reach[1]]
            marks[f"slab{i}"] = (*reach, *inside)
        for name, places in marks.items():
            pieces = [
                np.linspace(a, b, parts * int(np.ceil((b - a) / 0.2)) + 1)
                for a, b in pairwise(np.unique(np.round(places, 9)))
            ]
            self.mesh[name] = np.unique(np.round(np.concatenate(pieces), 9))
            self.rows[name] = self.size
            self.size += 2 * self.mesh[name].size
            if name.startswith("slab"):
                self.rows[name + "twist"] = self.size
                self.size += 2 * self.mesh[name].size - 1

    def at(self, name, x, z):
        """Displacement at x, z to the left of the middle, as a row over all unknowns."""
        node = int(np.abs(self.mesh[name] - x).argmin())
        row = np.zeros(self.size)
        row[self.rows[name] + 2 * node] = 1.0
        if name.startswith("slab"):
            row[self.rows[name + "twist"] + 2 * node] = z
        return row

    def matrix(self, omega):
        d = np.zeros((self.size, self.size), dtype=complex)
        loss = 1 + 1j * LOSS
        for name, mesh in self.mesh.items():
            modulus, inertia, density, area = SLAB if name.startswith("slab") else RAIL
            for i, h in enumerate(np.diff(mesh)):
                weak = name == "slab0" and THINNED[0] < mesh[i] + h / 2 < THINNED[1]
                stiff, heavy, twist = (0.4, 0.8, 0.5) if weak else (1.0, 1.0, 1.0)
                k = np.array(
                    [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                     [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]]
                )  # fmt: skip
                m = np.array(
                    [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                     [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]]
                )  # fmt: skip
                rows = slice(self.rows[name] + 2 * i, self.rows[name] + 2 * i + 4)
                d[rows, rows] += stiff * modulus * inertia * loss / h**3 * k
                d[rows, rows] -= heavy * omega**2 * density * area * h / 420 * m
                if name.startswith("slab"):
                    first = self.rows[name + "twist"] + 2 * i
                    rows = slice(first, first + 3)
                    k = np.array([[7, -8, 1], [-8, 16, -8], [1, -8, 7]]) / (3 * h)
                    m = np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]]) * h / 30
                    d[rows, rows] += twist * SHEAR_PA * TORSION_M4 * loss * k
                    d[rows, rows] -= heavy * omega**2 * density * POLAR_M4 * m

        def spring(stiffness, upper, lower=0.0):
            u = upper - lower
            held = np.flatnonzero(u)
            d[np.ix_(held, held)] += stiffness * np.outer(u[held], u[held])

        for x in SEATS:
            on = f"slab{int(x > SLAB_M[0][1])}"
            spring(PAD, self.at("left", x, 0.0), self.at(on, x, ARM_M))
            spring(PAD, self.at("right", x, 0.0), self.at(on, x, -ARM_M))
            # Four strips' middles and the rest of Gauss-Legendre: exact for a mortar that is the same across.
            across, weights = np.polynomial.legendre.leggauss(4)
            for z, weight in zip(0.5 * WIDTH_M * across, 0.5 * weights, strict=True):
                spring(weight * MORTAR, self.at(on, x, z))
        for z in (1.0, -1.0):
            spring(0.5 * DOWEL, self.at("slab0", SLAB_M[0][1], z), self.at("slab1", SLAB_M[0][1], z))
        return d

    def receptances(self, places, z):
        """On the left, and across on the right, by forces on the left."""
        sides = []
        for side, name in ((1.0, "left"), (-1.0, "right")):
            sides.append([self.at(name if body == "rail" else body, x, side * z) for body, x in places])
        left, right = (np.array(rows) for rows in sides)
        found = [np.linalg.solve(self.matrix(2 * np.pi * f), left.T) for f in FREQUENCY_HZ]
        return np.array([left @ w for w in found]), np.array([right @ w for w in found])


def test_slabs_that_bend_and_twist():
    """With a thinned length, dowels and mortar across the width, as the limit of elements."""
    places = [
        Place(body="rail", x_m=4.5),
        Place(body="rail", x_m=0.9),
        Place(body="slab[1]", x_m=1.0),
        Place(body="slab[2]", x_m=6.0),
    ]
    exact = along(slabs(), SLAB_ROLL, places)
    dense = along(slabs(), SLAB_ROLL, places, formulation="receptance")
    direct = np.abs(np.diagonal(exact[0], axis1=1, axis2=2))
    size = np.sqrt(direct[:, :, None] * direct[:, None, :])
    described = [("rail", 4.5), ("rail", 0.9), ("slab0", 1.0), ("slab1", 6.0)]
    coarse, fine = (Whole(parts).receptances(described, ARM_M) for parts in (1, 2))
    for side in (0, 1):
        assert (np.abs(dense[side] - exact[side]) / size).max() < 1e-9
        limit = (16.0 * fine[side] - coarse[side]) / 15.0
        away = [(np.abs(values - exact[side]) / size).max() for values in (coarse[side], fine[side], limit)]
        assert np.log2(away[0] / away[1]) == pytest.approx(4.0, abs=0.2)
        assert away[2] < 1e-5
    # Not alike: the slab rolls.
    assert (np.abs(exact[1][:, 0, 0]) < 0.9 * np.abs(exact[0][:, 0, 0])).all()


def assert_mechanical(same, other):
    """Reciprocal on either side and across, and passive for forces on both rails at once."""
    whole = np.block([[same, other], [other, same]])
    size = np.sqrt(np.abs(np.diagonal(whole, axis1=1, axis2=2)))
    scaled = whole / (size[:, :, None] * size[:, None, :])
    assert np.abs(scaled - scaled.transpose(0, 2, 1)).max() < 1e-9
    assert np.linalg.eigvalsh(-0.5 * (scaled.imag + scaled.imag.transpose(0, 2, 1))).min() > -1e-9


@settings(max_examples=25, deadline=None)
@given(
    st.floats(1.0, 1.6),
    st.floats(0.05, 1.0),
    st.floats(0.1, 3.0),
    st.floats(0.1, 2.0),
    st.sampled_from(["chain", "receptance"]),
)
def test_reciprocal_and_passive(gauge, hollow, width, arm, formulation):
    roll = Roll(
        gauge_m=gauge,
        bodies={
            "slab": Twisting(
                shear_modulus_Pa=SHEAR_PA,
                torsion_constant_m4=hollow * TORSION_M4,
                polar_moment_m4=POLAR_M4,
                changes=SLAB_ROLL.bodies["slab"].changes,
            )
        },
        laws={"mortar": Lever(width_m=width), "dowel": Lever(arm_m=arm)},
    )
    places = [Place(body="rail", x_m=4.5), Place(body="slab[1]", x_m=1.7), Place(body="slab[2]", x_m=9.0)]
    assert_mechanical(*along(slabs(), roll, places, formulation=formulation))


def test_rails_that_share_nothing_do_not_hear_each_other():
    """A mass that rolls as it heaves, y / sqrt(1) from its axis, on a bed at the rails: two halves cut apart."""
    apart = Roll(gauge_m=GAUGE_M, bodies={"sleeper": Rolling(radius_m=ARM_M)}, laws={"bed": Lever(arm_m=ARM_M)})
    places = [Place(body="rail", x_m=0.3), Place(body="sleeper", x_m=1.8)]
    same, other = along(sleepers(), apart, places)
    assert np.abs(other).max() < 1e-12 * np.abs(same).max()


def test_the_antisymmetric_half_states_what_it_is():
    odd = antisymmetric(slabs(), SLAB_ROLL)
    slab = odd.bodies["slab"]
    assert isinstance(slab, Shaft)
    assert odd.bodies["rail"] == slabs().bodies["rail"]
    assert slab.shear_N == pytest.approx(0.5 * SHEAR_PA * TORSION_M4 / ARM_M**2 * (1 + 1j * LOSS))
    assert slab.mass_kg_per_m == pytest.approx(0.5 * 2500.0 * POLAR_M4 / ARM_M**2)
    scales = [layer.scale for layer in odd.joints]
    assert scales == pytest.approx([1.0, 0.5 * WIDTH_M**2 / 12 / ARM_M**2, 0.5 / ARM_M**2])


def test_a_preset_on_two_rails():
    """CRTS III with girders that roll too, on bearings 2 m to either side."""
    line = LINES["crts_iii_viaduct_32m"](spans=1, approach_bays=10)
    box = {"shear_modulus_Pa": 1.5e10, "torsion_constant_m4": 20.0, "polar_moment_m4": 70.0}
    plate = {"shear_modulus_Pa": 1.4e10, "torsion_constant_m4": 0.007, "polar_moment_m4": 0.4}
    roll = Roll(
        gauge_m=1.5,
        bodies={
            "slab": Twisting(shear_modulus_Pa=1.5e10, torsion_constant_m4=0.018, polar_moment_m4=0.38),
            "base": Twisting(**plate),
            "girder": Twisting(**box),
        },
        laws={"isolation": Lever(width_m=2.5), "bond": Lever(width_m=2.9), "bearing": Lever(arm_m=2.0)},
    )
    places = [Place(body="rail", x_m=16.0), Place(body="slab[3]", x_m=14.0), Place(body="girder", x_m=16.0)]
    found = along(line, roll, places)
    dense = along(line, roll, places, formulation="receptance")
    for one, two in zip(found, dense, strict=True):
        assert np.abs(one / two - 1).max() < 1e-8
    assert_mechanical(*found)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"bodies": {"slap": SLAB_ROLL.bodies["slab"]}}, r"bodies.slap: the line has no such name; use one of"),
        ({"laws": {"mortal": Lever(arm_m=1.0)}}, r"laws.mortal: the line has no such name"),
        ({"laws": {}}, r"laws.mortar: joints\[1\] tie slab to ground, .*no lever; give width_m or arm_m"),
        ({"bodies": {"slab": Rolling(radius_m=1.0)}}, r"bodies.slab.type: is a beam on the line \(got 'mass'\)"),
        (
            {"bodies": {"slab": SLAB_ROLL.bodies["slab"].model_copy(update={"changes": ()})}},
            r"bodies.slab.changes: the beam's section changes",
        ),
    ],
)
def test_a_roll_that_does_not_fit(changed, message):
    roll = SLAB_ROLL.model_copy(update=changed)
    with pytest.raises(InputError, match=message):
        antisymmetric(slabs(), roll)


def test_both_rails_refuse_extensions_and_places_of_one_half_only():
    place = [Place(body="rail", x_m=0.3)]
    with pytest.raises(InputError, match="extensions: is not for both rails"):
        along(sleepers(), SLEEPER_ROLL, place, extensions=True)
    with pytest.raises(InputError, match=r"forces\[0\]: there is no such body"):
        along(sleepers(), slabs(), [Place(body="sleeper", x_m=0.6)])
    with pytest.raises(InputError, match="give width_m or arm_m"):
        Lever(width_m=1.0, arm_m=1.0)
