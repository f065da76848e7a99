"""What hangs on a body or stands under it: masses, resonators, dampers in every bay, measured impedances.

A structure that joins a body at x with the dynamic stiffness D takes H(y, x) D / (1 + H(x, x) D) H(x, z) off
H(y, z), whatever it is (Sherman and Morrison); several at once solve as a small system.
"""

import numpy as np
import pytest
from lines import hysteretic, uic60
from permway.errors import InputError
from permway.formats.model_file import model_from_dict, read_model
from permway.laws import Given, Hysteretic, KelvinVoigt, Measured
from permway.model.bodies import Beam, Mass, Shaft
from permway.model.joints import GROUND, Ends, Joints, Spread
from permway.model.line import Line
from permway.model.place import Place
from permway.problem.solve import solve
from permway.response.receptance import receptance

FREQUENCY_HZ = np.array([4.0, 60.0, 330.0, 1100.0])
OMEGA = 2 * np.pi * FREQUENCY_HZ
AT = {"rail": 0.9, "slab": 3.0, "axle": 2.2, "sleeper": 0.6}


def bare():
    """A rail on a slab and two sleepers, and a shaft on the ground: a body of each kind."""
    slab = Beam(
        youngs_modulus_Pa=3.4e10,
        second_moment_m4=2e-3,
        density_kg_per_m3=2500.0,
        area_m2=0.5,
        loss_factor=0.05,
        intervals_m=[(2.0, 8.0)],
    )
    axle = Shaft(
        shear_modulus_Pa=1.5e10,
        torsion_constant_m4=0.02,
        density_kg_per_m3=2500.0,
        polar_moment_m4=0.4,
        arm_m=0.75,
        loss_factor=0.05,
        intervals_m=[(0.0, 6.0)],
    )
    return Line(
        bodies={
            "rail": uic60(loss_factor=0.02),
            "slab": slab,
            "axle": axle,
            "sleeper": Mass(mass_kg=150.0, at=[0.0, 0.6]),
        },
        joints=(
            Joints(between=("rail", "slab"), law="pad", at=Spread(from_m=2.3, to_m=7.7, spacing_m=0.6)),
            Joints(between=("rail", "sleeper"), law="pad", at=Ends(of="sleeper")),
            Joints(between=("sleeper", GROUND), law="bed", at=Ends(of="sleeper")),
            Joints(between=("slab", GROUND), law="bed", at=(2.5, 4.0, 5.5, 7.0)),
            Joints(between=("axle", GROUND), law="bed", at=(1.0, 5.0)),
        ),
        laws={"pad": hysteretic(8e7 * (1 + 0.2j)), "bed": hysteretic(5e7 * (1 + 0.3j))},
    )


def with_it(*joints, bodies=None, **laws):
    line = bare()
    return Line(
        bodies={**line.bodies, **(bodies or {})}, joints=(*line.joints, *joints), laws={**line.laws, **laws}
    )


def respond(line, places, formulation="chain"):
    data = receptance(line, FREQUENCY_HZ, forces=places, sensors=places, formulation=formulation, threads=1)
    return data["receptance"].values


def predicted(before, stiffness):
    """Of the first place, where it hangs on, and the second."""
    h = before[:, 0, 0]
    return before[:, 1, 1] - before[:, 1, 0] * stiffness / (1 + h * stiffness) * before[:, 0, 1]


SPRING, KG = 3e7 * (1 + 0.1j), 40.0
TABLE_HZ = np.geomspace(1.0, 2000.0, 400)


def soil(frequency):
    """A foundation with a mass of its own: its dynamic stiffness passes zero at 80 Hz."""
    omega = 2 * np.pi * np.asarray(frequency)
    return 2e8 + 4e5j * omega - 800.0 * omega**2


def table(quantity):
    order = ["dynamic_stiffness", "impedance", "apparent_mass"].index(quantity)
    values = soil(TABLE_HZ) / (2j * np.pi * TABLE_HZ) ** order
    return Measured(quantity=quantity, frequency_Hz=TABLE_HZ, real=values.real, imaginary=values.imag)


@pytest.mark.parametrize("formulation", ["chain", "receptance"])
@pytest.mark.parametrize("body", AT)
def test_anything_hangs_on_any_body(body, formulation):
    x = AT[body]
    # Where it hangs on, and another place of the same body or, for a sleeper, of the rail.
    other = Place(body="rail" if body == "sleeper" else body, x_m=x + 1.3, name="other")
    places = [Place(body=body, x_m=x, name="here"), other]
    before = respond(bare(), places, formulation)
    inertia = -(OMEGA**2) * KG
    attached = Mass(mass_kg=KG)
    cases = {
        "resonator": (
            with_it(
                Joints(between=(body, "block"), law="spring", at=(x,)),
                bodies={"block": attached},
                spring=hysteretic(SPRING),
            ),
            SPRING * inertia / (SPRING + inertia),
        ),
        # A mass is held by a spring; this one is a thousand times what its inertia asks at 1100 Hz.
        "mass": (
            with_it(
                Joints(between=(body, "block"), law="rigid", at=(x,)),
                bodies={"block": attached},
                rigid=hysteretic(2e12 + 0j),
            ),
            2e12 * inertia / (2e12 + inertia),
        ),
        "mass as a law": (
            with_it(Joints(between=(body, GROUND), law="inertia", at=(x,)), inertia=apparent_mass(KG)),
            inertia,
        ),
        "dashpot": (
            with_it(
                Joints(between=(body, GROUND), law="dashpot", at=(x,)),
                dashpot=KelvinVoigt(stiffness=0.0, damping=2e5),
            ),
            2e5j * OMEGA,
        ),
        "given": (
            with_it(Joints(between=(body, GROUND), law="soil", at=(x,)), soil=Given(function=soil)),
            soil(FREQUENCY_HZ),
        ),
    }
    for name, (line, stiffness) in cases.items():
        found = respond(line, places, formulation)[:, 1, 1]
        assert np.abs(found / predicted(before, stiffness) - 1).max() < 1e-8, name


def apparent_mass(kg):
    return Measured(quantity="apparent_mass", frequency_Hz=(1.0, 2000.0), real=(kg, kg), imaginary=(0.0, 0.0))


@pytest.mark.parametrize("quantity", ["dynamic_stiffness", "impedance", "apparent_mass"])
def test_table_of_a_foundation(quantity):
    """A fine table is the function it was taken from, to the square of its step."""
    place = [Place(body="slab", x_m=3.0)]
    joint = Joints(between=("slab", GROUND), law="soil", at=(3.0,))
    function = respond(with_it(joint, soil=Given(function=soil)), place)
    assert respond(with_it(joint, soil=table(quantity)), place) == pytest.approx(function, rel=2e-3)
    # Between the points the quantity itself is linear, so that a constant mass stays one.
    law = apparent_mass(KG)
    assert law.complex(FREQUENCY_HZ) == pytest.approx(-KG * OMEGA**2 + 0j, rel=1e-12)


def test_a_function_may_be_of_any_quantity():
    stiffness = Given(function=soil)
    for order, quantity in enumerate(["dynamic_stiffness", "impedance", "apparent_mass"]):
        same = Given(function=lambda f, n=order: soil(f) / (2j * np.pi * f) ** n, quantity=quantity)
        assert same.complex(FREQUENCY_HZ) == pytest.approx(stiffness.complex(FREQUENCY_HZ), rel=1e-12)


def test_tuned_dampers_in_every_bay():
    """Nine at once: their dynamic stiffness in every bay takes its part by a small system."""
    bays = Spread(from_m=2.6, to_m=7.4, spacing_m=0.6)
    dampers = with_it(
        Joints(between=("rail", "damper"), law="rubber", at=Ends(of="damper")),
        bodies={"damper": Mass(mass_kg=12.0, at=bays)},
        rubber=hysteretic(4e7 * (1 + 0.35j)),
    )
    at = [Place(body="rail", x_m=x, name=f"bay{i}") for i, x in enumerate(bays.stations())]
    place = Place(body="rail", x_m=5.1, name="here")
    before = respond(bare(), [*at, place])
    inertia = -(OMEGA**2) * 12.0
    rubber = 4e7 * (1 + 0.35j)
    each = rubber * inertia / (rubber + inertia)
    h, to = before[:, :-1, :-1], before[:, :-1, -1:]
    taken = to.transpose(0, 2, 1) @ np.linalg.solve(h + np.eye(len(at)) / each[:, None, None], to)
    found = respond(dampers, [place])[:, 0, 0]
    assert np.abs(found / (before[:, -1, -1] - taken[:, 0, 0]) - 1).max() < 1e-9


MODEL = """
[frequencies]
values_Hz = [5.0, 50.0]

[line.bodies.block]
type = "mass"
mass_kg = 100.0

[line.laws.soil]
type = "measured"
quantity = "impedance"
file = "soil.csv"

[[line.joints]]
between = ["block", "ground"]
law = "soil"
at = [0.0]

[[forces]]
body = "block"
x_m = 0.0

[[sensors]]
body = "block"
x_m = 0.0
"""
ROWS = "# measured\nfrequency_Hz,real,imaginary,coherence\n1.0,2e5,-3e7,0.9\n100.0,2e5,-3e5,1.0\n"


def write(folder, model=MODEL, rows=ROWS):
    (folder / "model.toml").write_text(model, encoding="utf-8")
    (folder / "soil.csv").write_text(rows, encoding="utf-8")
    return folder / "model.toml"


def test_impedance_from_a_file_beside_the_model(tmp_path):
    data = solve(read_model(write(tmp_path)), threads=1)
    omega = 2 * np.pi * np.array([5.0, 50.0])
    share = np.log([5.0, 50.0]) / np.log(100.0)
    impedance = 2e5 + 1j * (-3e7 + share * (3e7 - 3e5))
    closed = 1.0 / (1j * omega * impedance - omega**2 * 100.0)
    assert data["receptance"].values[:, 0, 0] == pytest.approx(closed, rel=1e-12)
    # The dataset holds the model with the table in it.
    again = Measured.model_validate(
        {"quantity": "impedance", "frequency_Hz": [1.0, 100.0], "real": [2e5, 2e5], "imaginary": [-3e7, -3e5]}
    )
    assert again.model_dump_json() in data.attrs["model"]


@pytest.mark.parametrize(
    ("model", "rows", "message"),
    [
        (MODEL, ROWS.replace("real", "re"), r"laws.soil.file: .*soil.csv, line 2: no column real"),
        (MODEL, ROWS.replace("2e5,-3e5", "2e5,"), r"line 4, column imaginary: the cell is empty"),
        (MODEL, ROWS.replace("100.0,2e5", "nan,2e5"), r"line 4, column frequency_Hz: not a finite number"),
        (MODEL, ROWS.replace(",1.0\n", "\n"), r"line 4: 3 cells under 4 columns"),
        (MODEL, ROWS.replace("100.0,2e5", "0.5,2e5"), r"frequency_Hz\[1\] = 0.5 must rise strictly"),
        (MODEL, ROWS.replace("100.0,", "10.0,"), r"laws.soil: frequency_Hz: outside the table.*got 50.0"),
        (MODEL, ROWS.replace("2e5", "-2e5"), r"laws.soil: the law creates energy at 5 Hz"),
        (MODEL, "", r"soil.csv: the file is empty"),
        (MODEL.replace('"impedance"', '"mobility"'), ROWS, r"laws.soil.quantity: unknown \(got 'mobility'\)"),
        (MODEL.replace("soil.csv", "../soil.csv"), ROWS, r"laws.soil.file: lies outside the model's folder"),
        (MODEL.replace("soil.csv", "rock.csv"), ROWS, r"rock.csv: cannot be read"),
        (MODEL.replace('"soil.csv"', '"soil.csv"\nscale = 2.0'), ROWS, r"laws.soil.scale: does not go"),
        (
            MODEL.replace('type = "measured"\nquantity = "impedance"\nfile = "soil.csv"', 'type = "given"'),
            ROWS,
            r"laws.soil.function: missing",
        ),
    ],
)  # fmt: skip
def test_wrong_tables(model, rows, message, tmp_path):
    with pytest.raises(InputError, match=message) as caught:
        read_model(write(tmp_path, model, rows))
    assert str(caught.value).startswith(str(tmp_path))


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda f: 1e8, r"function: the given function must return one number for each frequency \(got \(\)\)"),
        (lambda f: "stiff", r"function: the given function fails"),
        (lambda f: np.full(f.shape, np.nan), r"laws.soil: the stiffness is not finite at 4 Hz"),
        (lambda f: np.full(f.shape, 1e8 - 1e7j), r"laws.soil: the law creates energy at 4 Hz"),
    ],
)
def test_wrong_functions(function, message):
    line = with_it(Joints(between=("slab", GROUND), law="soil", at=(3.0,)), soil=Given(function=function))
    with pytest.raises(InputError, match=message):
        respond(line, [Place(body="slab", x_m=3.0)])


def test_a_model_with_a_function_is_solved_and_reported_without_it():
    model = model_from_dict(
        {
            "frequencies": {"values_Hz": [5.0]},
            "line": Line(
                bodies={"block": Mass(mass_kg=1.0)},
                joints=(Joints(between=("block", GROUND), law="soil", at=(0.0,)),),
                laws={"soil": Given(function=soil), "unused": Hysteretic(stiffness=1.0)},
            ).model_dump(by_alias=True)
            | {"laws": {"soil": {"type": "given", "function": soil}}},
            "forces": [{"body": "block", "x_m": 0.0}],
            "sensors": [{"body": "block", "x_m": 0.0}],
        }
    )
    data = solve(model, threads=1)
    assert data["receptance"].values[0, 0, 0] == pytest.approx(1 / (soil(5.0) - (10 * np.pi) ** 2), rel=1e-12)
    assert '"type":"given"' in data.attrs["model"]
