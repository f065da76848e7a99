"""Wrong arguments of the Python API and of the core itself: one clear error each, never a panic."""

import numpy as np
import pytest
from permway import _core
from permway.errors import InputError, SolveError
from permway.laws import Hysteretic, KelvinVoigt, Maxwell
from permway.model.bodies import Beam, Mass
from permway.model.irregularity import GermanLow, Sato
from permway.model.joints import Ends, Joints, Spread
from permway.model.line import Line
from permway.model.place import Place
from permway.model.presets import slab_track_viaduct_32m, wj7b_constant
from permway.model.train import Train
from permway.model.vehicle_presets import crh380a
from permway.problem.solve import write_dataset
from permway.response.decay import decay_rate
from permway.response.operating import operating_shapes
from permway.response.receptance import receptance
from permway.response.sensitivity import sensitivity
from permway.response.train import train_response

RAIL = Beam(
    theory="timoshenko",
    youngs_modulus_Pa=2.1e11,
    second_moment_m4=3.038e-5,
    density_kg_per_m3=7850.0,
    area_m2=7.67e-3,
    shear_modulus_Pa=8.1e10,
    shear_coefficient=0.4,
    loss_factor=0.01,
)
PAD = Hysteretic(stiffness=1e8, loss_factor=0.1)
TRACK = Line(
    bodies={"rail": RAIL},
    joints=(Joints(between=("rail", "ground"), law="spring", at=(0.0, 0.6, 1.2)),),
    laws={"spring": PAD},
)
HAMMER = Place(body="rail", x_m=0.3)
TRAIN = Train(vehicle=crh380a(share=0.5), centre_m=0.0, speed_m_per_s=60.0)


def solved(line=TRACK, frequency=(100.0,), forces=(HAMMER,), sensors=(HAMMER,), **options):
    return receptance(line, frequency, forces=forces, sensors=sensors, **options)


def with_law(law):
    return Line(bodies=TRACK.bodies, joints=TRACK.joints, laws={"spring": law})


def joined(at, between=("rail", "ground")):
    return Joints(between=between, law="spring", at=at)


@pytest.mark.parametrize(
    ("act", "where", "message"),
    [
        (lambda: decay_rate([1.0], [0.5], 0.0), "distance_m", "must be positive (got 0.0)"),
        (lambda: decay_rate([1.0], [0.5], -1.0), "distance_m", "got -1.0"),
        (lambda: decay_rate([1.0], [0.5], np.nan), "distance_m", "got nan"),
        (lambda: decay_rate([1.0], [0.5], "6 m"), "distance_m", "got '6 m'"),
        (lambda: decay_rate([1.0], [0.0], 1.0), "far", "finite and not zero"),
        (lambda: decay_rate([np.inf], [0.5], 1.0), "near", "finite and not zero"),
        (lambda: decay_rate([1.0, 2.0], [0.5], 1.0), "far", "shape"),
        (lambda: decay_rate("loud", [0.5], 1.0), "near", "not numbers"),
        (lambda: solved(frequency=[100.0, -5.0]), "frequency_Hz[1]", "got -5.0"),
        (lambda: solved(frequency=[np.nan]), "frequency_Hz[0]", "got nan"),
        (lambda: solved(frequency=[[1.0, 2.0]]), "frequency_Hz", "must be a list (got (1, 2))"),
        (lambda: solved(frequency=["low"]), "frequency_Hz", "not a number or an array of numbers"),
        (lambda: solved(frequency="100"), "frequency_Hz", "not a number or an array of numbers"),
        (lambda: solved(frequency=["100", "200"]), "frequency_Hz", "without quotation marks"),
        (lambda: solved(frequency=[100.0, "200"]), "frequency_Hz", "not a number or an array of numbers"),
        (lambda: solved(frequency=[]), "frequency_Hz", "none given"),
        (lambda: solved(forces=[]), "forces", "none given"),
        (lambda: solved(sensors=[]), "sensors", "none given"),
        (lambda: sensitivity(TRACK, [10.0], forces=[], sensors=[HAMMER]), "forces", "none given"),
        (lambda: sensitivity(TRACK, [], forces=[HAMMER], sensors=[HAMMER]), "frequency_Hz", "none given"),
        (lambda: operating_shapes(TRACK, [], forces=[HAMMER]), "frequency_Hz", "none given"),
        (lambda: solved(temperature_C=293), "temperature_C", "degrees Celsius, not kelvin"),
        (lambda: solved(temperature_C=-120.0), "temperature_C", "is no temperature of a track"),
        (lambda: Place(body="rail", x_m="0.3"), "Place.x_m", "valid number"),
        (lambda: solved(frequency=[1.0 + 2.0j]), "frequency_Hz", "must be real, not complex"),
        (lambda: solved(frequency=[20.0, 10.0]), "frequency_Hz[1]", "sort them"),
        (lambda: solved(frequency=[1e18]), "frequency_Hz", "too short"),
        (lambda: solved(frequency=[1e200]), "frequency_Hz", "too short"),
        (lambda: solved(formulation="fem"), "formulation", "['chain', 'receptance']"),
        (lambda: solved(on_error="ignore"), "on_error", "['raise', 'mark']"),
        (lambda: solved(threads=0), "threads", "got 0"),
        (lambda: solved(threads=-3), "threads", "got -3"),
        (lambda: solved(threads=10**9), "threads", "at most 1024"),
        (lambda: solved(threads=1.5), "threads", "got 1.5"),
        (lambda: solved(forces=[HAMMER, HAMMER]), "forces[1]", "stands twice (got 'rail@0.3')"),
        (lambda: solved(sensors=[Place(body="slab", x_m=0.0)]), "sensors[0]", "no such body (got 'slab')"),
        (lambda: solved(sensors=[("rail", 0.0)]), "sensors[0]", "must be a Place"),
        (lambda: Place(body="rail", x_m=np.nan), "Place.x_m", "finite"),
        (lambda: Place(body="rail", x_m=1e9), "Place.x_m", "1000000"),
        (
            lambda: solved(frequency=np.linspace(1.0, 2.0, 10**6), sensors=[Place(body="rail", x_m=0.01 * i)
                for i in range(60)], forces=[Place(body="rail", x_m=0.01 * i) for i in range(60)]),
            "frequencies, sensors and forces", "GiB",
        ),
        (lambda: with_law(Hysteretic(stiffness=-1.0)), "Line.laws.spring.stiffness", "negative"),
        (
            lambda: solved(with_law(KelvinVoigt(stiffness=1e8, damping=-1e4))),
            "laws.spring", "creates energy at 100 Hz",
        ),
        (lambda: solved(with_law(Maxwell(stiffness=1e308, damping=1e308))), "laws.spring", "not finite at 100 Hz"),
        (lambda: joined((0.0,), ("ground", "rail")), "Joints.between", "only be the lower"),
        (lambda: joined("everywhere"), "Joints.at", "list of stations"),
        (lambda: Spread(from_m=0.0, to_m=1.0, spacing_m=0.3), "Spread.to_m", "3.33333 spacings"),
        (lambda: Spread(from_m=0.0, to_m=1.0, spacing_m=5e-324), "Spread.spacing_m", "stations"),
        (lambda: joined((0.0,), ("rail", "rail")), "Joints.between", "a joint ties two"),
        (
            lambda: Line(bodies={"rail": RAIL}, joints=(joined(Ends(of="rail")),), laws={"spring": PAD}),
            "Line.joints[0].at.of", "rail has no ends",
        ),
        (lambda: Line(bodies={}, joints=(), laws={}), "Line.bodies", "at least one body"),
        (lambda: Mass(mass_kg=0.0), "mass.mass_kg", "greater than 0"),
        (lambda: slab_track_viaduct_32m(spans=0), "spans", "greater than or equal to 1 (got 0)"),
        (lambda: slab_track_viaduct_32m(fasteners=90), "fasteners", "do not fit on 32 m"),
        (lambda: slab_track_viaduct_32m(rails=2), "rails", "unknown key"),
        (lambda: wj7b_constant(5), "temperature_C", "got 5"),
        (lambda: wj7b_constant([20]), "temperature_C", "got [20]"),
        (lambda: Train(vehicle=crh380a(), centre_m=0.0, speed_m_per_s=350.0), "Train.speed_m_per_s", "97.22 m/s"),
        (lambda: Train(vehicle=crh380a(), centre_m=0.0, speed_m_per_s=0.0), "Train.speed_m_per_s", "above 0"),
        (
            lambda: train_response(TRACK, TRAIN, GermanLow(), [10.0], conversion="per_metre"),
            "conversion", '"per_hertz"',
        ),
        (
            lambda: train_response(
                TRACK, TRAIN, GermanLow(), [10.0], sensors=[Place(body="rail", x_m=0.0, name="wheel1")]
            ),
            "sensors[4]", "stands twice (got 'wheel1')",
        ),
        (
            lambda: train_response(TRACK, TRAIN, Sato(amplitude=1e300, scale=1e300), [100.0]),
            "density", "not finite",
        ),
        (lambda: write_dataset(solved(), "/nowhere/at/all.nc"), "/nowhere/at/all.nc", "No such file"),
    ],
)  # fmt: skip
def test_wrong_argument(act, where, message):
    with pytest.raises(InputError) as caught:
        act()
    assert caught.value.where.startswith(where), caught.value
    assert message in str(caught.value)


def test_dense_system_too_large_is_refused_before_it_is_made():
    line = Line(
        bodies={"rail": RAIL},
        joints=(joined(Spread(from_m=0.0, to_m=600.0, spacing_m=0.1)),),
        laws={"spring": PAD},
    )
    with pytest.raises(InputError, match=r"formulation: .* at most 5000 joints \(got '6001 joints'\)"):
        solved(line, formulation="receptance")
    assert np.isfinite(solved(line)["receptance"].values).all()


def test_train_that_overflows_is_an_error_with_its_frequency():
    with pytest.raises(SolveError, match="wheel_rail_force_psd is not finite at 100 Hz"):
        train_response(TRACK, TRAIN, Sato(scale=1e308), [100.0])


def tables(**changes):
    """A rail, a mass and two joints for the core, tables changed by name: beams_mass, joints_x, ..."""
    found = {
        "formulation": "chain",
        "frequencies": np.array([10.0, 100.0]),
        "names": ["rail", "block"],
        "beams": {
            "bending": np.array([6.4e6 + 6.4e4j]),
            "shear": np.array([2.5e8 + 2.5e6j]),
            "mass": np.array([60.2]),
            "rotary": np.array([0.24]),
            "dashpots": np.zeros((1, 4)),
            "interval": np.array([[-np.inf, np.inf]]),
            "pinned": np.array([[False, False]]),
            "modes": np.array([0]),
            "stretches": {
                "body": np.zeros(0, dtype=np.int64),
                "bending": np.zeros(0, dtype=np.complex128),
                "shear": np.zeros(0, dtype=np.complex128),
                "mass": np.zeros(0),
                "rotary": np.zeros(0),
                "dashpots": np.zeros((0, 4)),
                "interval": np.zeros((0, 2)),
            },
        },
        "masses": np.array([150.0]),
        "joints": {
            "x": np.array([0.0, 0.0]),
            "upper": np.array([0, 1]),
            "lower": np.array([1, -1]),
            "law": np.array([0, 1]),
            "scale": np.array([1.0, 1.0]),
        },
        "laws": np.array([[1e8 + 1e7j, 5e7 + 5e6j]] * 2),
        "forces": {"body": np.array([0]), "x": np.array([0.0])},
        "sensors": {"body": np.array([0, 1]), "x": np.array([0.0, 0.0])},
        "extensions": True,
        "threads": 1,
        "progress": None,
    }
    for name, value in changes.items():
        table, _, column = name.partition("_")
        if column:
            found[table] = {**found[table], column: np.asarray(value)}
        else:
            found[name] = value
    return found


def test_tables_are_good():
    values, extension, _, _, failures = _core.solve_line(**tables())
    assert values.shape == (2, 2, 1)
    assert extension.shape == (2, 2, 1)
    assert failures == []
    assert np.isfinite(values).all()


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"beams_mass": [60.0, 60.0]}, "beams: the columns have different lengths"),
        ({"joints_x": [0.0]}, "joints: the columns have different lengths"),
        ({"forces_x": [0.0, 1.0]}, "forces: the columns have different lengths"),
        ({"beams_interval": [[0.0, 1.0, 2.0]]}, "two columns"),
        ({"beams_interval": [[1.0, 0.0]]}, "rail: the interval must have a positive length"),
        ({"beams_interval": [[np.nan, 1.0]]}, "rail: the interval"),
        ({"beams_bending": [-6.4e6 + 0j]}, "rail: bending stiffness"),
        ({"beams_bending": [complex(np.inf, 0.0)]}, "rail: bending stiffness"),
        ({"beams_shear": [complex(np.nan, 0.0)]}, "rail: shear stiffness"),
        ({"beams_shear": [0j]}, "rail: rotary inertia needs a shear stiffness"),
        ({"beams_mass": [0.0]}, "rail: mass per length"),
        ({"beams_rotary": [-1.0]}, "rail: rotary inertia"),
        ({"beams_dashpots": [[0.0, 0.0, -1.0, 0.0]]}, "rail: viscous losses"),
        ({"beams_dashpots": [[0.0, 0.0, 1.0]]}, "dashpots four"),
        ({"beams_modes": [5]}, "rail: modes are for finite"),
        ({"beams_modes": [-5]}, "number of modes must be 0 to 100000"),
        ({"masses": np.array([np.nan])}, "block: mass must be positive"),
        ({"masses": np.array([-1.0])}, "block: mass must be positive"),
        ({"joints_upper": [0, 2]}, "joint 1 at x = 0 m: there is no body 2"),
        ({"joints_upper": [0, -1]}, "must not be negative"),
        ({"joints_lower": [0, -1]}, "joint 0 at x = 0 m: it joins a body to itself"),
        ({"joints_lower": [1, -2]}, "joints: lower body -2 must not be negative; -1 alone stands for the ground"),
        ({"joints_lower": [1, -7]}, "joints: lower body -7 must not be negative"),
        ({"joints_lower": [1, -(2**63)]}, "joints: lower body -9223372036854775808 must not be negative"),
        ({"joints_lower": [2, -1]}, "joint 0 at x = 0 m: there is no body 2"),
        ({"joints_law": [0, 2]}, "joint 1 at x = 0 m: its law is not in the table"),
        ({"joints_law": [0, -1]}, "must not be negative"),
        ({"joints_law": [0, 2**62]}, "its law is not in the table"),
        ({"joints_scale": [1.0, np.inf]}, "its scale is not finite"),
        ({"joints_x": [np.nan, 0.0]}, "place is not finite"),
        ({"sensors_body": [0, 7]}, "sensor 1 at x = 0 m: there is no body 7"),
        ({"sensors_body": [0, -7]}, "must not be negative"),
        ({"sensors_x": [np.inf, 0.0]}, "sensor 0 at x = inf m: the place is not finite"),
        ({"frequencies": np.array([10.0, 0.0])}, "frequency 1 is 0 Hz"),
        ({"frequencies": np.array([10.0, np.nan])}, "frequency 1 is NaN Hz"),
        ({"frequencies": np.array([10.0])}, "laws: 2 rows for 1 frequencies"),
        ({"laws": np.zeros((4, 1), dtype=complex)}, "laws: 4 rows for 2 frequencies"),
        ({"threads": 0}, "threads 0: use 1 to 1024"),
        ({"threads": 10**6}, "threads 1000000: use 1 to 1024"),
    ],
)
def test_tables_that_do_not_fit(changes, message, formulation):
    with pytest.raises(_core.TablesError) as caught:
        _core.solve_line(**tables(formulation=formulation, **changes))
    assert message in str(caught.value)


DERIVED = {
    "groups": np.array([0, -1]),
    "weights": np.ones(2),
    "n_groups": 1,
    "bodies": True,
    "sensors": np.array([0]),
    "forces": np.array([0]),
    "own": True,
}


def test_a_group_of_minus_one_is_none():
    one, none = (
        _core.solve_line(
            **tables(derived={**DERIVED, "groups": np.array([0, second])}, sensors=tables()["forces"])
        )
        for second in (0, -1)
    )
    assert np.isfinite(none[2]).all()
    assert not np.allclose(one[2][:, 0], none[2][:, 0], rtol=1e-3, atol=0.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"groups": np.array([0, -2])}, "derived: group -2 must not be negative; -1 alone stands for no group"),
        ({"groups": np.array([0, -7])}, "derived: group -7 must not be negative"),
        ({"groups": np.array([0, 1])}, "joint 1 is in a group that is none of the 1"),
        ({"groups": np.array([0])}, "1 groups and 2 weights for 2 joints"),
        ({"sensors": np.array([-1])}, "derived: sensor -1 must not be negative"),
        ({"forces": np.array([-1])}, "derived: force -1 must not be negative"),
        ({"forces": np.array([1])}, "there is no force 1"),
        ({"n_groups": 10_000_001}, "derived: 10000001 groups are more than 10000000"),
        ({"n_groups": 2**63}, "more than 10000000"),
        ({"n_groups": 2**64 - 1}, "more than 10000000"),
        ({"n_groups": 10**7, "sensors": np.zeros(10**6, dtype=np.int64)}, "no room for an answer of shape"),
    ],
)
def test_what_cannot_be_derived(change, message):
    with pytest.raises(_core.TablesError) as caught:
        _core.solve_line(**tables(derived={**DERIVED, **change}))
    assert message in str(caught.value)


def test_an_answer_too_large_is_refused_by_the_core():
    """Shapes that no memory holds, and whose number of values does not fit 64 bits: an error, no panic."""
    many = {"body": np.zeros(10**6, dtype=np.int64), "x": np.zeros(10**6)}
    for count in (10**3, 2 * 10**6):
        line = tables(
            forces=many, sensors=many, frequencies=np.ones(count), laws=np.ones((count, 2), dtype=complex)
        )
        with pytest.raises(_core.TablesError, match="no room for an answer of shape"):
            _core.solve_line(**line)


@pytest.mark.parametrize(
    "changes",
    [
        {"frequencies": np.array([10.0 + 1.0j, 100.0])},
        {"joints_x": [0j, 0j]},
        {"forces_x": [1j]},
        {"joints_lower": np.array([1, 2**64 - 1], dtype=np.uint64)},
        {"joints_lower": np.array([1, -1], dtype=np.int32)},
        {"threads": -1},
        {"threads": 2**64},
        {"frequencies": [10.0, 100.0]},
        {"frequencies": np.array([10, 100])},
        {"frequencies": np.array([[10.0, 100.0]])},
        {"masses": np.array([150.0 + 0j])},
        {"laws": np.ones(2, dtype=complex)},
        {"beams_pinned": [[0, 0]]},
        {"joints_upper": [0.0, 1.0]},
        {"names": "rail"},
        {"threads": 1.5},
    ],
)
def test_tables_of_a_wrong_type(changes):
    with pytest.raises((TypeError, OverflowError)) as caught:
        _core.solve_line(**tables(**changes))
    # What is at fault stands in the message or in a note below it.
    reported = [str(caught.value), *getattr(caught.value, "__notes__", [])]
    assert any(next(iter(changes)).partition("_")[0] in text for text in reported)


def test_missing_column():
    changed = tables()
    del changed["beams"]["rotary"]
    with pytest.raises((KeyError, TypeError), match="rotary"):
        _core.solve_line(**changed)


def test_unknown_formulation():
    with pytest.raises(_core.TablesError, match='formulation "fem": use "chain" or "receptance"'):
        _core.solve_line(**tables(formulation="fem"))


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
@pytest.mark.parametrize("bad", [complex(np.nan, 0.0), complex(np.inf, 0.0), complex(1e308, 1e308) * 10])
def test_a_law_not_finite_spoils_its_frequency_only(bad, formulation):
    laws = tables()["laws"].copy()
    laws[0, 1] = bad
    values, _, _, _, failures = _core.solve_line(**tables(formulation=formulation, laws=laws))
    assert [(index, kind) for index, kind, _ in failures] == [(0, "not finite")]
    assert "10 Hz: stiffness of joint 1" in failures[0][2]
    assert np.isnan(values[0]).all()
    assert np.isfinite(values[1]).all()


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
def test_a_negative_stiffness_is_solved_by_the_core(formulation):
    """The core judges no law; the model does."""
    values, _, _, _, failures = _core.solve_line(**tables(formulation=formulation, laws=-tables()["laws"]))
    assert failures == []
    assert np.isfinite(values).all()


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
def test_empty_tables_give_empty_arrays(formulation):
    empty = tables(formulation=formulation, frequencies=np.zeros(0), laws=np.zeros((0, 2), dtype=complex))
    assert _core.solve_line(**empty)[0].shape == (0, 2, 1)
    nowhere = tables(formulation=formulation, forces_body=np.zeros(0, dtype=np.int64), forces_x=np.zeros(0))
    assert _core.solve_line(**nowhere)[0].shape == (2, 2, 0)
    deaf = tables(formulation=formulation, sensors_body=np.zeros(0, dtype=np.int64), sensors_x=np.zeros(0))
    assert _core.solve_line(**deaf)[0].shape == (2, 0, 1)
