"""Every preset line, shortened: two formulations, reciprocity, statics, and what its options do."""

import re

import numpy as np
import pytest
from permway.errors import InputError
from permway.laws import Hysteretic
from permway.model.bodies import Mass
from permway.model.lines_ballasted import BallastedTrack
from permway.model.lines_crts import CrtsII, CrtsIII
from permway.model.lines_zeng2014 import ZengLine
from permway.model.place import Place
from permway.model.presets import LINES, SlabTrackViaduct
from permway.response.receptance import receptance

SHORT = {
    "ballasted_b91_60e1": [{"sleepers": 41}, {"sleepers": 41, "model": "full"}],
    "crts_ii_viaduct_32m": [
        {"spans": 2, "approach_bays": 10},
        {"spans": 2, "approach_bays": 10, "piers": "elastic", "model": "full"},
    ],
    "crts_iii_viaduct_32m": [
        {"spans": 2, "approach_bays": 10},
        {"spans": 2, "approach_bays": 10, "piers": "elastic", "model": "full"},
    ],
    "slab_track_viaduct_32m": [{"spans": 2, "pad": Hysteretic(stiffness=6e7, loss_factor=0.1)}],
    "zeng2014_nine_spans": [
        {"spans": 2, "approach_bays": 10},
        {"spans": 2, "approach_bays": 10, "girder": "pinned"},
    ],
}
CASES = [(name, options) for name, several in SHORT.items() for options in several]
OPTIONS = {
    "ballasted_b91_60e1": BallastedTrack,
    "crts_ii_viaduct_32m": CrtsII,
    "crts_iii_viaduct_32m": CrtsIII,
    "slab_track_viaduct_32m": SlabTrackViaduct,
    "zeng2014_nine_spans": ZengLine,
}
FREQUENCY_HZ = np.array([1.0, 5.0, 30.0, 200.0, 900.0])


def places(line):
    """Two on the rail, and one in the middle of the middle one of every other row."""
    found = [Place(body="rail", x_m=16.3), Place(body="rail", x_m=3.0)]
    for name in [body for body in line.bodies if body != "rail"]:
        row = [s for s in line.segments() if s.body == name]
        middle = row[len(row) // 2]
        found.append(Place(body=middle.name, x_m=0.5 * (middle.start + middle.stop)))
    return found


def respond(line, at, frequency=FREQUENCY_HZ, formulation="chain"):
    data = receptance(line, frequency, forces=at, sensors=at, formulation=formulation, threads=1)
    return data["receptance"].values


def test_every_preset_is_here():
    assert set(SHORT) == set(OPTIONS) == set(LINES)


@pytest.mark.parametrize(("name", "options"), CASES, ids=[f"{n}-{i}" for i, (n, _) in enumerate(CASES)])
def test_formulations_agree_and_are_reciprocal(name, options):
    line = LINES[name](**options)
    at = places(line)
    chain, dense = respond(line, at), respond(line, at, formulation="receptance")
    direct = np.abs(np.diagonal(chain, axis1=1, axis2=2))
    size = np.maximum(np.abs(chain), np.sqrt(direct[:, :, None] * direct[:, None, :]))
    assert (np.abs(chain - dense) / size).max() < 1e-9
    assert (np.abs(chain - chain.transpose(0, 2, 1)) / size).max() < 1e-9
    # Passive: the force never takes energy out.
    assert (np.diagonal(chain, axis1=1, axis2=2).imag <= 0.0).all()


@pytest.mark.parametrize("name", SHORT)
def test_a_preset_as_it_comes_compiles_and_solves(name):
    line = LINES[name]()
    x = 16.3
    data = receptance(
        line,
        FREQUENCY_HZ,
        forces=[Place(body="rail", x_m=x)],
        sensors=[Place(body="rail", x_m=x)],
        temperature_C=20.0,
        threads=1,
    )
    assert np.isfinite(data["receptance"].values).all()


@pytest.mark.parametrize("name", ["crts_ii_viaduct_32m", "crts_iii_viaduct_32m"])
def test_a_viaduct_has_ten_spans(name):
    assert len(LINES[name]().bodies["girder"].intervals_m) == 10


def test_nine_spans_of_zeng_with_five_slabs_each():
    bodies = LINES["zeng2014_nine_spans"]().bodies
    assert len(bodies["girder"].intervals_m) == 9
    assert len(bodies["slab"].intervals_m) == 45
    assert bodies["slab"].intervals_m[7] == pytest.approx((45.525, 51.975))
    assert bodies["rail"].mass_kg_per_m == pytest.approx(2 * 60.64)
    assert bodies["girder"].mass_kg_per_m == pytest.approx(29720.0)


@pytest.mark.parametrize(("model", "rails"), [("half", 1.0), ("full", 2.0)])
def test_ballasted_track_bears_statically_as_a_beam_on_an_elastic_bed(model, rails):
    """The Timoshenko beam on a bed s of pad and ballast in series per metre; 1 Hz, loss kept.

    1/(2 pi) times the integral over k of (1 + E I k^2 / K) / (E I k^4 + E I s k^2 / K + s), K the shear stiffness.
    """
    line = LINES["ballasted_b91_60e1"](model=model)
    pad, ballast = 225e6 * (1 + 0.25j), 20e6 * (1 + 1j)
    bed = rails * pad * ballast / (pad + ballast) / 0.6
    bending, shear = (line.bodies["rail"].bending_Nm2, line.bodies["rail"].shear_N)
    expected = (
        (1 / np.sqrt(bed) + np.sqrt(bending) / shear)
        / np.sqrt(bending * bed / shear + 2 * np.sqrt(bending * bed))
        / 2
    )
    found = respond(line, [Place(body="rail", x_m=30.0)], [1.0])[0, 0, 0]
    assert found == pytest.approx(expected, rel=0.01)


STATICS = [  # preset, options, bending E I, span between bearings, stiffness under each end, share
    ("crts_ii_viaduct_32m", {"spans": 3}, 3.6e10 * 11.056, 31.5, 6e9, 0.5),
    ("crts_iii_viaduct_32m", {"spans": 3}, 3.6e10 * 11.056, 31.5, 6e9, 0.5),
    (
        "crts_iii_viaduct_32m",
        {"spans": 3, "piers": "elastic"},
        3.6e10 * 11.056,
        31.5,
        1 / (1 / 6e9 + 1 / 8.7e9),
        0.5,
    ),
    ("zeng2014_nine_spans", {"spans": 3}, 3.45e10 * 12.744, 32.5, 6e9, 1.0),
    ("zeng2014_nine_spans", {"spans": 3, "girder": "pinned"}, 3.45e10 * 12.744, 32.5, np.inf, 1.0),
]


@pytest.mark.parametrize(("name", "options", "bending", "span", "below", "share"), STATICS)
def test_a_girder_bears_statically_as_a_simple_beam(name, options, bending, span, below, share):
    """L^3 / (48 E I) and half of one support's give, at 0.5 Hz; the track adds a few per cent of stiffness."""
    line = LINES[name](**options)
    start, stop = line.bodies["girder"].intervals_m[1]
    found = abs(respond(line, [Place(body="girder[2]", x_m=0.5 * (start + stop))], [0.5])[0, 0, 0])
    expected = (span**3 / (48.0 * bending) + 0.5 / below) / share
    assert found == pytest.approx(expected, rel=0.05)


def test_piers_are_shared():
    """Three spans stand on four caps, the inner ones in the middle of the gap."""
    line = LINES["crts_ii_viaduct_32m"](spans=3, piers="elastic")
    caps = [s for s in line.segments() if s.body == "cap"]
    assert [c.start for c in caps] == pytest.approx([0.6, 32.7, 65.4, 97.5])
    assert isinstance(line.bodies["cap"], Mass)


def test_fasteners_of_crts_iii_go_on_evenly_from_slab_to_slab():
    """0.63 m over every joint of two 5.6 m slabs; 52 fasteners on a span."""
    line = LINES["crts_iii_viaduct_32m"](spans=1, approach_bays=0)
    x = line.joint_table().x[:52]
    assert line.joints[0].at == tuple(x)
    assert np.diff(x[8:44]) == pytest.approx(0.63)
    lengths = [b - a for a, b in line.bodies["slab"].intervals_m]
    assert lengths == pytest.approx([4.925, 5.6, 5.6, 5.6, 5.6, 4.925])


@pytest.mark.parametrize("bays", [0, 1, 2])
@pytest.mark.parametrize("name", ["crts_ii_viaduct_32m", "crts_iii_viaduct_32m", "zeng2014_nine_spans"])
def test_short_approaches(name, bays):
    line = LINES[name](spans=1, approach_bays=bays)
    assert np.isfinite(respond(line, [Place(body="rail", x_m=16.3)])).all()


WRONG = [
    ({"spans": 0}, "spans", "greater than or equal to 1"),
    ({"spans": "2"}, "spans", "integer"),
    ({"approach_bays": -1}, "approach_bays", "greater than or equal to 0"),
    ({"piers": "soft"}, "piers", "'rigid' or 'elastic'"),
    ({"lanes": 2}, "lanes", "unknown key"),
]


@pytest.mark.parametrize(("options", "place", "words"), WRONG)
def test_wrong_option_of_a_viaduct(options, place, words):
    with pytest.raises(InputError, match=re.escape(words)) as caught:
        LINES["crts_iii_viaduct_32m"](**options)
    assert caught.value.where == place


@pytest.mark.parametrize("name", SHORT)
def test_every_option_stands_in_its_docstring(name):
    record = OPTIONS[name]
    text = "\n".join(base.__doc__ or "" for base in record.__mro__)
    assert all(re.search(rf"^    [\w, ]*\b{key}\b[\w, ]* : ", text, re.MULTILINE) for key in record.model_fields)
