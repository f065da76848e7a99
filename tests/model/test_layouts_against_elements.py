"""Random layouts against a finite-element model that shares nothing with the solver but the numbers.

Cubic Hermite Euler elements with consistent mass, point masses and springs, dense numpy; every joint is written
out here by its own loop, so that the grammar is checked with the mechanics. The element's error falls as the
fourth power of its length: halving it must lessen the difference about sixteen times. Rail, a slab and a girder
have other sections over some lengths.
"""

from itertools import pairwise

import numpy as np
import pytest
from permway.laws import Hysteretic, KelvinVoigt
from permway.model.bodies import Beam, BeamChange, Mass
from permway.model.changes import Change, Scatter
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.model.stations import Ends, Spread
from permway.response.receptance import receptance

FREQUENCY_HZ = np.array([4.0, 31.0, 140.0, 420.0])
BAY_M = 0.6
COARSEST_M = 0.2
CAP_M, WITHIN_M = 0.25, 1.2
STEEL = (2.1e11, 3.0e-5, 7850.0, 7.7e-3, 0.01)
SLAB = (3.6e10, 1.7e-3, 2500.0, 0.5, 0.05)
GIRDER = (3.4e10, 0.2, 2500.0, 2.0, 0.1)


class Elements:
    """Beams, masses and springs by name, assembled at a frequency."""

    def __init__(self, beams, masses, springs, points, parts):
        self.beams, self.masses, self.springs, self.points = beams, masses, springs, points
        self.nodes, size = {}, 0
        for name, (start, stop, _, changes) in beams.items():
            touched = [x for change in changes for x in change[:2]]
            touched += [x for spring in springs for body, x in spring[:2] if body == name]
            touched += [x for body, x in points if body == name]
            marks = np.unique(np.round([start, *touched, stop], 9))
            pieces = [(a, b, parts * int(np.ceil((b - a) / COARSEST_M)) + 1) for a, b in pairwise(marks)]
            mesh = np.unique(np.concatenate([np.linspace(*piece) for piece in pieces]))
            self.nodes[name] = (size, mesh)
            size += 2 * mesh.size
        self.mass_rows = {name: size + i for i, name in enumerate(masses)}
        self.size = size + len(masses)

    def row(self, body, x):
        if body in self.mass_rows:
            return self.mass_rows[body]
        first, mesh = self.nodes[body]
        return first + 2 * int(np.abs(mesh - x).argmin())

    def matrix(self, omega):
        d = np.zeros((self.size, self.size), dtype=complex)
        for name, (_, _, (modulus, inertia, density, area, loss), changes) in self.beams.items():
            first, mesh = self.nodes[name]
            for i, h in enumerate(np.diff(mesh)):
                stiff, heavy = 1.0, 1.0
                for start, stop, bending, mass in changes:
                    if start < mesh[i] + 0.5 * h < stop:
                        stiff, heavy = bending, mass
                k = np.array(
                    [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                     [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]]
                )  # fmt: skip
                m = np.array(
                    [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                     [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]]
                )  # fmt: skip
                rows = slice(first + 2 * i, first + 2 * i + 4)
                d[rows, rows] += stiff * modulus * inertia * (1 + 1j * loss) / h**3 * k
                d[rows, rows] -= omega**2 * heavy * density * area * h / 420 * m
        for name, kg in self.masses.items():
            d[self.mass_rows[name], self.mass_rows[name]] -= omega**2 * kg
        for (upper, x), (lower, y), law, factor in self.springs:
            u = np.zeros(self.size)
            u[self.row(upper, x)] = 1.0
            if lower is not None:
                u[self.row(lower, y)] = -1.0
            held = np.flatnonzero(u)
            d[np.ix_(held, held)] += factor * law(omega) * np.outer(u[held], u[held])
        return d

    def receptances(self, frequency):
        rows = [self.row(*point) for point in self.points]
        loads = np.zeros((self.size, len(rows)))
        loads[rows, range(len(rows))] = 1.0
        return np.array([np.linalg.solve(self.matrix(2 * np.pi * f), loads)[rows] for f in frequency])


def beam(properties, intervals, *changes):
    modulus, inertia, density, area, loss = properties
    return Beam(
        youngs_modulus_Pa=modulus,
        second_moment_m4=inertia,
        density_kg_per_m3=density,
        area_m2=area,
        loss_factor=loss,
        intervals_m=intervals,
        changes=[
            BeamChange(from_m=a, to_m=b, bending_factor=bending, mass_factor=mass)
            for a, b, bending, mass in changes
        ],
    )


def layout(seed):
    """Ballast, three spans of different length with gaps on shared piers, a Winkler bed; as line and elements."""
    rng = np.random.default_rng(seed)
    lengths, gaps = rng.uniform(5.0, 8.0, 3).round(2), rng.uniform(0.05, 0.4, 2).round(2)
    starts = np.concatenate([[0.0], np.cumsum(lengths[:2] + gaps)])
    girders = [(float(a), float(a + n)) for a, n in zip(starts, lengths, strict=True)]
    slabs = [part for a, b in girders for part in ((a, 0.5 * (a + b)), (0.5 * (a + b), b))]
    end = girders[-1][1]
    rail = (-6.0, end + 5.0)
    sleepers = [-4.8 + BAY_M * i for i in range(8)]
    per_span = [(a + 0.31, int((b - a - 0.5) / BAY_M)) for a, b in girders]
    fasteners = [[a + BAY_M * i for i in range(n + 1)] for a, n in per_span]
    stretches = tuple(Spread(from_m=f[0], to_m=f[-1], spacing_m=BAY_M) for f in fasteners)
    bed = [end + 0.4 + 0.5 * i for i in range(9)]
    # In the middle of bays: elements of millimetres would cost the dense matrix its digits.
    dampers = sorted((rng.choice(np.concatenate(fasteners), 3, replace=False) + 0.5 * BAY_M).tolist())
    # A corroded foot and a stiff weld of the rail, a thinned slab, a cracked girder.
    weld, middle = round(0.5 * end + 1.13, 3), round(0.5 * sum(girders[2]), 3)
    foot = (-5.2, -1.4, rng.uniform(0.5, 0.9), 0.9)
    changed = {
        "rail": [foot, (weld, weld + 0.1, 1.3, 1.2)],
        "slab": [(slabs[3][0], round(slabs[3][0] + 1.2, 3), rng.uniform(0.3, 0.7), 0.8)],
        "girder": [(middle - 0.2, middle + 0.25, rng.uniform(0.1, 0.6), 1.0)],
    }
    scatter = Scatter(seed=seed, relative_std=0.4)
    lost, graded = girders[0][0] + 2.0, girders[1]
    laws = {
        "pad": KelvinVoigt(stiffness=rng.uniform(4e7, 1e8), damping=3e4),
        "ballast": Hysteretic(stiffness=rng.uniform(2e7, 8e7), loss_factor=0.5),
        "mortar": Hysteretic(stiffness=rng.uniform(5e8, 2e9), loss_factor=0.2),
        "dowel": Hysteretic(stiffness=rng.uniform(5e7, 3e8), loss_factor=0.05),
        "bearing": KelvinVoigt(stiffness=rng.uniform(5e8, 3e9), damping=1e6),
        "soil": KelvinVoigt(stiffness=rng.uniform(3e8, 1e9), damping=2e6),
        "bed": Hysteretic(stiffness=rng.uniform(3e7, 2e8), loss_factor=0.25),
        "rubber": Hysteretic(stiffness=rng.uniform(2e6, 2e7), loss_factor=0.3),
    }
    line = Line(
        bodies={
            "rail": beam(STEEL, [rail], *changed["rail"]),
            "slab": beam(SLAB, slabs, *changed["slab"]),
            "girder": beam(GIRDER, girders, *changed["girder"]),
            "sleeper": Mass(mass_kg=150.0, at=Spread(from_m=-4.8, to_m=-0.6, spacing_m=BAY_M)),
            "cap": Mass(mass_kg=8000.0, at=Ends(of="girder", inset_m=CAP_M, within_m=WITHIN_M)),
            "damper": Mass(mass_kg=25.0, at=dampers),
        },
        joints=(
            Joints(between=("rail", "sleeper"), law="pad", at=Ends(of="sleeper")),
            Joints(between=("sleeper", "ground"), law="ballast", at=Ends(of="sleeper"), scatter=scatter),
            Joints(
                between=("rail", "slab"),
                law="pad",
                at=stretches,
                changes=(
                    Change(from_m=lost, to_m=lost + 1.0, factor=0.0),
                    Change(from_m=graded[0], to_m=graded[1], factor_from=0.5, factor_to=1.5),
                ),
            ),
            Joints(between=("slab", "girder"), law="mortar", at=stretches, stiffness_is="per_metre"),
            Joints(between=("slab", "slab"), law="dowel", at="meetings", scale=2.0),
            Joints(
                between=("girder", "cap"),
                law="bearing",
                at=Ends(of="girder", inset_m=CAP_M, within_m=WITHIN_M),
            ),
            Joints(between=("cap", "ground"), law="soil", at=Ends(of="cap")),
            Joints(
                between=("rail", "ground"),
                law="bed",
                at=Spread(from_m=bed[0], to_m=bed[-1], spacing_m=0.5),
                stiffness_is="per_metre",
                layer_m=(end, end + 5.0),
            ),
            Joints(between=("rail", "damper"), law="rubber", at=Ends(of="damper")),
        ),
        laws=laws,
    )

    springs = []

    def spring(upper, lower, law, x, factor=1.0):
        stiffness = laws[law]
        springs.append(
            ((upper, x), (lower, x), lambda w: stiffness.complex(np.array([w / (2 * np.pi)]), None)[0], factor)
        )

    for i, (x, factor) in enumerate(zip(sleepers, scatter.factors(8), strict=True)):
        spring("rail", f"sleeper{i}", "pad", x)
        spring(f"sleeper{i}", None, "ballast", x, factor)
    for span, places in enumerate(fasteners):
        for i, x in enumerate(places):
            on = 2 * span + int(x > 0.5 * sum(girders[span]))
            kept = 0.0 if lost <= x <= lost + 1.0 else 1.0
            if span == 1:
                kept *= 0.5 + (x - graded[0]) / (graded[1] - graded[0])
            spring("rail", f"slab{on}", "pad", x, kept)
            share = 0.5 if i in (0, len(places) - 1) else 1.0
            spring(f"slab{on}", f"girder{span}", "mortar", x, share * BAY_M)
    for span, (a, b) in enumerate(girders):
        spring(f"slab{2 * span}", f"slab{2 * span + 1}", "dowel", 0.5 * (a + b), 2.0)
        spring(f"girder{span}", f"cap{span}", "bearing", a + CAP_M)
        spring(f"girder{span}", f"cap{span + 1}", "bearing", b - CAP_M)
    for i in range(4):
        spring(f"cap{i}", None, "soil", 0.0)
    for i, x in enumerate(bed):
        spring("rail", None, "bed", x, {0: 0.65, 8: 0.85}.get(i, 0.5))
    for i, x in enumerate(dampers):
        spring("rail", f"damper{i}", "rubber", x)
    masses = {f"sleeper{i}": 150.0 for i in range(8)} | {f"cap{i}": 8000.0 for i in range(4)}
    masses |= {f"damper{i}": 25.0 for i in range(3)}
    beams = {"rail": (*rail, STEEL, changed["rail"])}
    beams |= {f"slab{i}": (*reach, SLAB, changed["slab"] if i == 3 else []) for i, reach in enumerate(slabs)}
    beams |= {
        f"girder{i}": (*reach, GIRDER, changed["girder"] if i == 2 else []) for i, reach in enumerate(girders)
    }
    middle = [0.5 * (a + b) for a, b in girders]
    pier = 0.5 * (girders[0][1] + girders[1][0])
    points = [  # on the line, and on the elements
        (Place(body="rail", x_m=round(middle[1], 3)), ("rail", round(middle[1], 3))),
        (Place(body="rail", x_m=-2.7), ("rail", -2.7)),
        (Place(body="slab[1]", x_m=1.2), ("slab0", 1.2)),
        (Place(body="girder[3]", x_m=middle[2]), ("girder2", middle[2])),
        (Place(body="sleeper[3]", x_m=-3.6), ("sleeper2", -3.6)),
        (Place(body="cap", x_m=pier), ("cap1", pier)),
        (Place(body="damper[1]", x_m=dampers[0]), ("damper0", dampers[0])),
    ]
    return line, [p for p, _ in points], (beams, masses, springs, [p for _, p in points])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_layout_is_the_limit_of_finite_elements(seed):
    """All transfers between seven places; error relative to the two direct receptances."""
    line, places, described = layout(seed)
    found = {
        form: receptance(
            line, FREQUENCY_HZ, forces=places, sensors=places, formulation=form, threads=1
        )["receptance"].values
        for form in ("chain", "receptance")
    }  # fmt: skip
    exact = found["chain"]
    direct = np.abs(np.diagonal(exact, axis1=1, axis2=2))
    size = np.sqrt(direct[:, :, None] * direct[:, None, :])
    assert (np.abs(found["receptance"] - exact) / size).max() < 1e-9
    coarse, fine = (Elements(*described, parts).receptances(FREQUENCY_HZ) for parts in (1, 2))
    away = [(np.abs(values - exact) / size).max() for values in (coarse, fine, (16.0 * fine - coarse) / 15.0)]
    assert away[1] < 3e-5
    assert np.log2(away[0] / away[1]) == pytest.approx(4.0, abs=0.2)
    # What is left is the rounding of the dense matrix, worst where two stations lie centimetres apart.
    assert away[2] < 1e-5
