"""A receptance is solved from the side that has fewer places, and is what the side that is asked for gives.

Joints' extensions belong to the forces: a call that asks for them is solved as it is asked, and is the other here.
Errors are measured by the larger of the receptance and the direct ones at its two places.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from permway import _core
from permway.formats.model_file import model_from_dict
from permway.laws import Hysteretic
from permway.model.place import Place
from permway.model.presets import LINES
from permway.problem.solve import solve
from permway.response.receptance import between, receptance
from strategies import frequencies, lines, paper_line, places, respond

TOLERANCE = {"chain": 1e-12, "receptance": 1e-9}
"""The dense system loses digits of stiff joints under light bodies, whichever side it is solved from."""

FORMULATIONS = ("chain", "receptance")


def named(found, kind):
    return [place.model_copy(update={"name": f"{kind} {i}"}) for i, place in enumerate(found)]


def off(line, frequency, forces, sensors, formulation):
    """The largest difference between the side that is chosen and the side that is asked for."""
    options = {"forces": forces, "sensors": sensors, "formulation": formulation, "threads": 1}
    chosen = receptance(line, frequency, **options)["receptance"]
    asked = receptance(line, frequency, extensions=True, **options)["receptance"]
    assert chosen.dims == asked.dims
    assert chosen.shape == (len(frequency), len(sensors), len(forces))
    everywhere = respond(line, named([*sensors, *forces], "place"), frequency, formulation=formulation)
    direct = np.sqrt(np.abs(np.diagonal(everywhere, axis1=1, axis2=2)))
    size = direct[:, : len(sensors), None] * direct[:, None, len(sensors) :]
    return float((np.abs(chosen - asked).values / np.maximum(np.abs(asked.values), size)).max())


@settings(max_examples=40)
@given(lines(), frequencies(), st.sampled_from(FORMULATIONS), st.data())
def test_both_sides_of_random_lines(line, frequency, formulation, data):
    many, few = (named(data.draw(places(line, count)), kind) for count, kind in ((9, "force"), (2, "sensor")))
    assert off(line, frequency, many, few, formulation) <= TOLERANCE[formulation]


def anywhere(line, count, random):
    """Places on the line's bodies, each on one that is drawn and somewhere on it."""
    found, segments = [], line.segments()
    for index in random.integers(len(segments), size=count):
        start, stop = (np.clip(end, -20.0, 40.0) for end in (segments[index].start, segments[index].stop))
        found.append(Place(body=segments[index].name, x_m=float(random.uniform(start, stop))))
    return found


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("ballasted_b91_60e1", {"sleepers": 31}),
        ("crts_ii_viaduct_32m", {"spans": 1, "approach_bays": 6, "piers": "elastic"}),
        ("slab_track_viaduct_32m", {"spans": 1, "pad": Hysteretic(stiffness=6e7, loss_factor=0.1)}),
        ("zeng2014_nine_spans", {"spans": 1, "approach_bays": 6, "girder": "pinned"}),
    ],
)
def test_both_sides_of_presets(name, options, formulation):
    line, random = LINES[name](**options), np.random.default_rng(48)
    forces, sensors = (named(anywhere(line, n, random), kind) for n, kind in ((11, "force"), (3, "sensor")))
    assert off(line, np.array([2.0, 20.0, 150.0, 900.0]), forces, sensors, formulation) <= 1e-12


HELD = {
    "format": 1,
    "title": "a clamped beam on a spring, a block below",
    "line": {
        "bodies": {
            "beam": {
                "type": "beam",
                "youngs_modulus_Pa": 2.1e11,
                "second_moment_m4": 3e-5,
                "density_kg_per_m3": 7850.0,
                "area_m2": 7.6e-3,
                "intervals_m": [[0.0, 10.0]],
                "ends": ["clamped", "free"],
                "loss_factor": 0.02,
            },
            "block": {"type": "mass", "mass_kg": 300.0},
        },
        "joints": [
            {"between": ["beam", "block"], "law": "pad", "at": [6.0]},
            {"between": ["block", "ground"], "law": "pad", "at": [6.0]},
        ],
        "laws": {"pad": {"type": "hysteretic", "stiffness": 2e7, "loss_factor": 0.2}},
    },
    "frequencies": {"values_Hz": [3.0, 40.0, 300.0]},
    "forces": [{"name": f"p{i}", "body": "beam", "x_m": x} for i, x in enumerate((1.3, 8.0, 4.4, 9.9))]
    + [{"name": "on the block", "body": "block", "x_m": 6.0}],
    "sensors": [{"name": "end", "body": "beam", "x_m": 10.0}, {"name": "near", "body": "beam", "x_m": 2.0}],
}


def test_solve_gives_each_pair_under_its_own_names():
    """Of a clamped beam, which is not alike from both ends; pair by pair there is nothing to choose."""
    model = model_from_dict(HELD)
    found = solve(model, threads=1)
    assert found.sizes == {"frequency": 3, "sensor": 2, "force": 5}
    assert list(found.force.values) == [place.name for place in model.forces]
    for force in model.forces:
        for sensor in model.sensors:
            alone = receptance(model.line, model.frequencies.array(), forces=[force], sensors=[sensor], threads=1)
            pair = found.receptance.sel(force=force.name, sensor=sensor.name).values
            assert (np.abs(pair / alone.receptance.values[:, 0, 0] - 1.0) <= 1e-12).all()


@pytest.mark.parametrize(("forces", "sensors", "pushed"), [(6, 2, 2), (2, 6, 2), (3, 3, 3)])
def test_the_fewer_places_are_pushed(monkeypatch, forces, sensors, pushed):
    """Joints' extensions and an empty list of sensors are for the forces as they are asked for."""
    asked, solve_line = [], _core.solve_line

    def count(**tables):
        asked.append(len(tables["forces"]["x"]))
        return solve_line(**tables)

    monkeypatch.setattr(_core, "solve_line", count)
    line = paper_line()
    many, few = ([Place(body="rail", x_m=float(x)) for x in range(n)] for n in (forces, sensors))
    assert between(line, [10.0], forces=many, sensors=few).receptance.shape == (1, sensors, forces)
    between(line, [10.0], forces=many, sensors=few, extensions=True)
    between(line, [10.0], forces=many, sensors=[])
    assert asked == [pushed, forces, forces]


def test_what_fails_is_nan_on_either_side():
    """At a frequency whose square is no number: marked, not turned into zeros."""
    line = paper_line(pad=Hysteretic(stiffness=6e7, loss_factor=0.0))
    forces = [Place(body="rail", x_m=float(x)) for x in range(4)]
    found = between(line, [1e-170, 10.0], forces=forces, sensors=forces[:1], on_error="mark")
    assert found.receptance.shape == (2, 1, 4)
    assert len(found.failures) == 1
    assert np.isnan(found.receptance[0]).all()
    assert np.isfinite(found.receptance[1]).all()
