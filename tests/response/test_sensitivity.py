"""Derivatives against differences of whole models, and one joint's finite change against the changed model."""

import numpy as np
import permway
import pytest
from permway.errors import InputError
from permway.laws import law_from_dict
from permway.model.place import Place
from permway.response.core import run
from permway.response.receptance import check_places, receptance
from permway.response.sensitivity import by_joint, change_joint, sensitivity

FREQUENCY = np.array([1.7, 4.1, 23.0, 61.0, 180.0, 700.0, 1900.0])
SENSORS = [Place(body="rail", x_m=11.3), Place(body="slab", x_m=16.0), Place(body="girder", x_m=9.0)]
FORCES = [Place(body="rail", x_m=16.0), Place(body="rail", x_m=11.3)]


@pytest.fixture(scope="module")
def line():
    return permway.slab_track_viaduct_32m(girder="elastic_bearings")


@pytest.fixture(scope="module")
def data(line):
    return sensitivity(line, FREQUENCY, forces=FORCES, sensors=SENSORS, temperature_C=20.0, places=True)


def changed(line, **parts):
    return receptance(
        line.model_copy(update=parts), FREQUENCY, forces=FORCES, sensors=SENSORS, temperature_C=20.0
    )["receptance"].values


def difference(line, part):
    """Sixth order, by a parameter that `part(step)` moves by that share of itself."""
    h = 1e-3
    at = {n: changed(line, **part(n * h)) for n in (-3, -2, -1, 1, 2, 3)}
    return (at[3] - at[-3] + 9.0 * (at[-2] - at[2]) + 45.0 * (at[1] - at[-1])) / (60.0 * h)


def assert_near(exact, found, response):
    scale = np.abs(exact).max(axis=(1, 2)) + 1e-3 * np.abs(response).max(axis=(1, 2))
    worst = np.abs(exact - found) / scale[:, None, None]
    assert worst.max() < 1e-6, worst.max(axis=(1, 2))


def test_receptance_is_the_solvers(line, data):
    np.testing.assert_allclose(data["receptance"], changed(line), rtol=1e-11)


@pytest.mark.parametrize("name", ["pad", "mortar", "sliding", "bearing"])
def test_by_law(line, data, name):
    law = line.laws[name].complex(FREQUENCY, 20.0)

    def part(step):
        table = {"frequency_Hz": FREQUENCY, "storage": law.real * (1.0 + step), "loss_factor": law.imag / law.real}
        return {"laws": {**line.laws, name: law_from_dict({"type": "tabulated", **table})}}

    exact = data["by_law"].sel(law=name).values * law[:, None, None]
    assert_near(exact, difference(line, part), data["receptance"].values)


@pytest.mark.parametrize("body", ["rail", "slab", "base", "girder"])
@pytest.mark.parametrize("field", ["youngs_modulus_Pa", "density_kg_per_m3", "shear_modulus_Pa"])
def test_by_beam(line, data, body, field):
    beam = line.bodies[body]
    size = getattr(beam, field)
    if size is None:
        pytest.skip("an Euler-Bernoulli beam has no shear modulus")

    def part(step):
        return {"bodies": {**line.bodies, body: beam.model_copy(update={field: size * (1.0 + step)})}}

    of = data["by_beam"].sel(beam=body)
    # A stiffness goes with its loss, a density with the rotary inertia.
    exact = {
        "youngs_modulus_Pa": of.sel(property="bending_Nm2").values * beam.bending_Nm2,
        "shear_modulus_Pa": of.sel(property="shear_N").values * beam.shear_N,
        "density_kg_per_m3": of.sel(property="mass_kg_per_m").values * beam.mass_kg_per_m
        + np.nan_to_num(of.sel(property="rotary_kg_m").values) * beam.rotary_kg_m,
    }[field]
    assert_near(exact, difference(line, part), data["receptance"].values)


def test_sums_over_joints_are_by_law(line, data):
    table = line.joint_table()
    each = sensitivity(
        line, FREQUENCY, forces=FORCES, sensors=SENSORS, temperature_C=20.0, by="joint", bodies=False
    )
    for index, name in enumerate(line.laws):
        mine = table.law == index
        total = np.einsum("fjse,j->fse", each["by_joint"].values[:, mine], table.scale[mine])
        expected = data["by_law"].sel(law=name).values
        assert np.abs(total - expected).max() <= 1e-10 * np.abs(expected).max()
    for joint in (0, 40, 120):
        expected = each["by_joint"].values[:, joint]
        found = by_joint(data, joint).values
        assert np.abs(found - expected).max() <= 1e-10 * np.abs(expected).max()


def test_groups_add_up(line, data):
    table = line.joint_table()
    groups = np.where(table.x < 16.0, 0, 1)
    groups[0] = -1
    grouped = sensitivity(
        line, FREQUENCY, forces=FORCES, sensors=SENSORS, temperature_C=20.0, by=groups, bodies=False
    )
    expected = sum(by_joint(data, int(j)).values for j in np.flatnonzero(groups == 1))
    assert grouped.sizes["group"] == 2
    assert np.abs(grouped["by_group"].values[:, 1] - expected).max() <= 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("joint", [3, 25, 60, 130, 154])
def test_finite_change_is_that_of_the_changed_line(line, data, joint):
    table = line.joint_table()
    stiffness = line.stiffness(FREQUENCY, 20.0)[:, table.law[joint]] * table.scale[joint]
    found = change_joint(data, joint, -stiffness).values
    scale = table.scale.copy()
    scale[joint] = 0.0
    lost = type(table)(**{**vars(table), "scale": scale})
    points = {"forces": check_places(line, FORCES, "forces"), "sensors": check_places(line, SENSORS, "sensors")}
    expected = run(line, FREQUENCY, points, temperature_C=20.0, joints=lost).receptance
    for at in range(FREQUENCY.size):
        assert np.abs(found[at] - expected[at]).max() <= 1e-9 * np.abs(expected[at]).max()


def test_bad_arguments(line, data):
    ask = {"forces": FORCES, "sensors": SENSORS, "temperature_C": 20.0}
    for by in ("layer", [0, 1], np.full(len(line.joint_table().x), 0.5), np.full(len(line.joint_table().x), -2)):
        with pytest.raises(InputError, match=r"^by(\[0\])?: "):
            sensitivity(line, FREQUENCY, by=by, **ask)
    many = len(line.joint_table().x)
    for beyond in (many, 10**12, 2**64 - 1):
        by = np.zeros(many, dtype=np.uint64)
        by[1] = beyond
        with pytest.raises(InputError, match=rf"^by\[1\]: a group of {many} joints is .* \(got {beyond}\)"):
            sensitivity(line, FREQUENCY, by=by, **ask)
    for joint in (100000, -1, 1.5, True):
        with pytest.raises(InputError, match=rf"there is no such joint \(got {joint}\)"):
            by_joint(data, joint)
    with pytest.raises(InputError, match="places=True"):
        by_joint(sensitivity(line, FREQUENCY, **ask), 0)
    own = data["own_extension"].values[:, 3]
    with pytest.raises(InputError, match=r"singular at 1\.7 Hz"):
        change_joint(data, 3, -1.0 / own)


def test_no_frequency_and_one(line):
    one = sensitivity(line, FREQUENCY[:1], forces=FORCES, sensors=SENSORS, temperature_C=20.0)
    assert one["by_law"].shape == (1, len(line.laws), 3, 2)
    with pytest.raises(InputError, match="frequency_Hz: none given"):
        sensitivity(line, [], forces=FORCES, sensors=SENSORS, temperature_C=20.0)
