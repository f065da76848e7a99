"""What holds of every line of passive bodies and joints, by either formulation.

Errors are measured by `magnitude`, and 1e-9 of it is what the two formulations are held to.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway.laws import Hysteretic
from permway.model.bodies import Beam, Mass
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.response.receptance import receptance
from strategies import (
    SOFT_PAD,
    STIFF_PAD,
    decades,
    frequencies,
    lines,
    magnitude,
    paper_line,
    places,
    respond,
    solvable,
)

TOLERANCE = 1e-9
FORMULATIONS = st.sampled_from(["chain", "receptance"])

cases = settings(max_examples=100)


def assert_same(values, expected, tolerance=TOLERANCE):
    assert (np.abs(values - expected) <= tolerance * magnitude(expected)).all()


@cases
@given(solvable(), FORMULATIONS)
def test_reciprocity(case, formulation):
    values = respond(*case, formulation=formulation)
    assert_same(values, values.transpose(0, 2, 1))


@cases
@given(solvable(), FORMULATIONS)
def test_passivity(case, formulation):
    """No forces draw power from the line: -Im H, scaled to its direct receptances, has no negative eigenvalue."""
    values = respond(*case, formulation=formulation)
    size = np.sqrt(np.abs(np.diagonal(values, axis1=1, axis2=2)))
    dissipation = -values.imag / (size[:, :, None] * size[:, None, :])
    least = np.linalg.eigvalsh(0.5 * (dissipation + dissipation.transpose(0, 2, 1))).min()
    assert least >= -TOLERANCE * values.shape[1]


@cases
@given(solvable(), FORMULATIONS)
def test_superposition(case, formulation):
    """Forces solved for together answer as each alone; sensors do not disturb."""
    line, found, frequency = case
    together = respond(line, found, frequency, formulation=formulation)
    alone = [respond(line, [place], frequency, formulation=formulation)[:, 0, 0] for place in found]
    assert (np.abs(np.stack(alone, axis=1) / np.diagonal(together, axis1=1, axis2=2) - 1.0) <= TOLERANCE).all()


def moved(line, place):
    """The line with every x replaced by place(x); a map that turns left to right turns beams about too."""
    turned = place(1.0) < place(0.0)

    def move(body):
        if isinstance(body, Mass):
            return body
        changes = []
        for change in body.changes:
            start, stop = sorted((place(change.from_m), place(change.to_m)))
            changes.append(change.model_copy(update={"from_m": start, "to_m": stop}))
        if body.intervals_m is None:
            return body.model_copy(update={"changes": tuple(changes)})
        ends = body.ends[::-1] if turned else body.ends
        intervals = tuple(tuple(sorted(map(place, interval))) for interval in body.intervals_m)
        return body.model_copy(
            update={"intervals_m": tuple(sorted(intervals)), "ends": ends, "changes": tuple(changes)}
        )

    bodies = {name: move(body) for name, body in line.bodies.items()}
    joints = tuple(j.model_copy(update={"at": tuple(sorted(map(place, j.at)))}) for j in line.joints)
    return Line(bodies=bodies, joints=joints, laws=line.laws)


def moved_places(found, place):
    return [p.model_copy(update={"x_m": place(p.x_m)}) for p in found]


@cases
@given(solvable(), FORMULATIONS, st.integers(-200, 200))
def test_translation_changes_nothing(case, formulation, metres):
    line, found, frequency = case
    before = respond(*case, formulation=formulation)
    after = respond(
        moved(line, lambda x: x + metres),
        moved_places(found, lambda x: x + metres),
        frequency,
        formulation=formulation,
    )
    assert_same(after, before)


@cases
@given(solvable(), FORMULATIONS)
def test_a_mirrored_line_answers_alike(case, formulation):
    line, found, frequency = case
    before = respond(*case, formulation=formulation)
    after = respond(
        moved(line, lambda x: -x), moved_places(found, lambda x: -x), frequency, formulation=formulation
    )
    assert_same(after, before)


@cases
@given(solvable(), FORMULATIONS, st.randoms(use_true_random=False))
def test_order_does_not_matter(case, formulation, random):
    line, found, frequency = case
    bodies, joints = list(line.bodies.items()), list(line.joints)
    random.shuffle(bodies)
    random.shuffle(joints)
    shuffled = Line(bodies=dict(bodies), joints=tuple(joints), laws=line.laws)
    before = respond(*case, formulation=formulation)
    assert_same(respond(shuffled, found, frequency, formulation=formulation), before)


@cases
@given(solvable(), FORMULATIONS, st.floats(0.0, 1.0))
def test_joints_in_two_parts_are_as_stiff(case, formulation, share):
    """A joint split in two at one station, a half of which may be nothing."""
    line, found, frequency = case
    parts = tuple(
        layer.model_copy(update={"scale": layer.scale * part})
        for layer in line.joints
        for part in (share, 1.0 - share)
    )
    split = Line(bodies=line.bodies, joints=parts, laws=line.laws)
    before = respond(*case, formulation=formulation)
    assert_same(respond(split, found, frequency, formulation=formulation), before)


@cases
@given(solvable(), FORMULATIONS, st.data())
def test_stations_that_carry_nothing_change_nothing(case, formulation, data):
    """Joints of no stiffness cut beams into more pieces."""
    line, found, frequency = case
    cuts = data.draw(places(line))
    lost = tuple(
        Joints(between=(cut.body, "ground"), law=next(iter(line.laws)), at=(cut.x_m,), scale=0.0) for cut in cuts
    )
    cut_up = Line(bodies=line.bodies, joints=(*line.joints, *lost), laws=line.laws)
    before = respond(*case, formulation=formulation)
    assert_same(respond(cut_up, found, frequency, formulation=formulation), before)


def solve(line, found, frequency, formulation):
    """Receptances (F, P, P) and joint extensions (F, J, P)."""
    data = receptance(
        line, frequency, forces=found, sensors=found, formulation=formulation, extensions=True, threads=1
    )
    return data["receptance"].values, data["extension"].values


@cases
@given(lines(finite=True, lossless=True), FORMULATIONS, frequencies(), st.data())
def test_power_that_enters_is_dissipated_in_the_joints(line, formulation, frequency, data):
    """Beams with ends and without loss: -Im(f^H H f) = sum of Im(k_j) |d_j|^2, twice the power over omega.

    Measured by |f|^T |H| |f|, since the power may be a small part of what is only lent and given back; powers of
    forces so small that they have no normal number are none.
    """
    found = data.draw(places(line))
    part = st.floats(-1.0, 1.0)
    force = np.array([complex(data.draw(part), data.draw(part)) for _ in found])
    values, extension = solve(line, found, frequency, formulation)
    table = line.joint_table()
    loss = line.stiffness(frequency).imag[:, table.law] * table.scale
    enters = -np.einsum("s,fst,t->f", force.conj(), values, force).imag
    dissipated = (loss * np.abs(extension @ force) ** 2).sum(axis=1)
    lent = np.einsum("s,fst,t->f", np.abs(force), np.abs(values), np.abs(force))
    assert (np.abs(enters - dissipated) <= TOLERANCE * lent + np.finfo(np.float64).tiny).all()


@cases
@given(solvable(), FORMULATIONS, st.floats(-1.0, 3.0), st.data())
def test_one_joint_changed_is_a_change_of_rank_one(case, formulation, share, data):
    """Sherman and Morrison: H' = H - D e e^T / (1 + D g), D the change of stiffness, e the joint's extensions.

    g is its extension per pair of forces on its ends. Where 1 + D g is small the change enlarges errors by as
    much: a lost joint (D = -k) that held nearly everything leaves nearly nothing known of what it held.
    """
    line, found, frequency = case
    if not line.joints:
        return
    index = data.draw(st.integers(0, len(line.joints) - 1))
    layer = line.joints[index]
    number = data.draw(st.integers(0, len(layer.at) - 1))
    x = layer.at[number]
    ends = [Place(body=body, x_m=x, name=f"end{i}") for i, body in enumerate(layer.between) if body != "ground"]
    values, extension = solve(line, [*found, *ends], frequency, formulation)
    table = line.joint_table()
    row = np.flatnonzero((table.layer == index) & (table.x == x))[0]
    e = extension[:, row, : len(found)]
    pair = extension[:, row, len(found) :] @ np.array([1.0, -1.0])[: len(ends)]
    change = share * line.stiffness(frequency)[:, table.law[row]] * table.scale[row]
    predicted = values[:, : len(found), : len(found)] - (change / (1.0 + change * pair))[:, None, None] * (
        e[:, :, None] * e[:, None, :]
    )
    rest = tuple(station for station in layer.at if station != x)
    changed = [layer.model_copy(update={"at": (x,), "scale": layer.scale * (1.0 + share)})]
    changed += [layer.model_copy(update={"at": rest})] if rest else []
    joints = (*line.joints[:index], *changed, *line.joints[index + 1 :])
    solved = respond(
        Line(bodies=line.bodies, joints=joints, laws=line.laws), found, frequency, formulation=formulation
    )
    enlarged = np.maximum(1.0, 1.0 / np.abs(1.0 + change * pair))[:, None, None]
    largest = np.maximum(magnitude(solved), magnitude(values[:, : len(found), : len(found)]))
    assert (np.abs(solved - predicted) <= TOLERANCE * enlarged * largest).all()


@st.composite
def elastic_lines(draw):
    """Simply supported uniform beams without loss over each other, on elastic joints: they have a rest."""
    line = draw(lines(finite=True, lossless=True, uniform=True))
    bodies = {
        name: body.model_copy(update={"ends": "pinned"})
        for name, body in line.bodies.items()
        if isinstance(body, Beam)
    }
    joints = tuple(j for j in line.joints if {*j.between} <= {*bodies, "ground"})
    stiffness = {name: Hysteretic(stiffness=draw(decades(1e6, 3e9))) for name in line.laws}
    return Line(bodies=bodies, joints=joints, laws=stiffness)


def static_flexibility(beam, x, y):
    """Deflection at x by a unit force at y of a simply supported beam, bending and shear (Timoshenko)."""
    start, stop = beam.intervals_m[0]
    length, low, high = stop - start, min(x, y) - start, stop - max(x, y)
    bent = low * high * (length**2 - low**2 - high**2) / (6.0 * length * beam.bending_Nm2.real)
    return bent + (low * high / (length * beam.shear_N.real) if beam.shear_N else 0.0)


@cases
@given(elastic_lines(), FORMULATIONS, st.data())
def test_static_limit(line, formulation, data):
    """At 2e-5 Hz beams and springs are at rest to 1e-8: no beam here resonates below 0.2 Hz."""
    found = data.draw(places(line))
    beams = [line.bodies[segment.body] for segment in line.segments()]
    table = line.joint_table()

    def flexibility(i, x, j, y):
        return static_flexibility(beams[i], x, y) if i == j and i >= 0 else 0.0

    ends = list(zip(table.upper, table.lower, table.x, strict=True))
    loads = [(line.locate(p.body, p.x_m, where="places"), p.x_m) for p in found]
    by_load = np.array(
        [[flexibility(a, x, i, y) - flexibility(b, x, i, y) for i, y in loads] for a, b, x in ends]
    ).reshape(len(ends), len(loads))
    by_joint = np.array(
        [
            [
                sum(
                    sign * other * flexibility(p, x, q, y)
                    for p, sign in ((a, 1), (b, -1))
                    for q, other in ((c, 1), (d, -1))
                )
                for c, d, y in ends
            ]
            for a, b, x in ends
        ]
    ).reshape(len(ends), len(ends))
    stiffness = line.stiffness([1.0]).real[0, table.law] * table.scale
    tension = np.linalg.solve(np.eye(len(ends)) + stiffness[:, None] * by_joint, stiffness[:, None] * by_load)
    static = np.array([[flexibility(i, x, j, y) for j, y in loads] for i, x in loads]) - by_load.T @ tension
    values = respond(line, found, [2e-5], formulation=formulation)
    assert_same(values, static[None].astype(complex), 1e-7)


PLACES = [
    Place(body=body, x_m=x)
    for body, x in [("rail", 16.0), ("rail", 9.1), ("slab", 16.0), ("base", 3.0), ("girder", 11.0)]
]


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
@pytest.mark.parametrize("girder", ["elastic_bearings", "pinned"])
@pytest.mark.parametrize("pad", [SOFT_PAD, STIFF_PAD], ids=["soft", "stiff"])
def test_full_model_is_the_half_model_twice(formulation, girder, pad):
    """A force shared by two rails moves the whole half as much as it moves the half."""
    frequency = np.geomspace(1.0, 3000.0, 12)
    half, full = (
        respond(
            paper_line(model=model, girder=girder, pad=pad),
            PLACES,
            frequency,
            formulation=formulation,
        )
        for model in ("half", "full")
    )
    assert_same(2.0 * full, half, 1e-12)


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
def test_the_paper_s_line_is_symmetric_about_midspan(formulation):
    line = paper_line()
    frequency = np.geomspace(1.0, 3000.0, 12)
    left = respond(line, PLACES, frequency, formulation=formulation)
    right = respond(line, moved_places(PLACES, lambda x: 32.0 - x), frequency, formulation=formulation)
    assert_same(right, left)
