"""The two formulations give one answer.

Where both are exact (closed forms) they agree to 1e-9 of the receptance, or of the geometric mean of the direct
receptances at its two places if that is larger: |dH_ij| <= 1e-9 max(|H_ij|, sqrt(|H_ii| |H_jj|)). A transfer far
below both, as from a rail to a girder it is hardly tied to, is a small remainder of them in either formulation,
and cannot be better conditioned than they are. Entry by entry 1e-9 holds at about 99.9 % of all frequencies.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from permway.model.place import Place
from strategies import both, magnitude, paper_line, respond, solvable

TOLERANCE = 1e-9


@settings(max_examples=400)
@given(solvable())
def test_random_lines(case):
    chain, dense = both(*case)
    assert (np.abs(chain - dense) <= TOLERANCE * magnitude(dense)).all()


PLACES = [
    Place(body=body, x_m=x)
    for body, x in [
        ("rail", 16.0),
        ("rail", 15.7),
        ("rail", -4.0),
        ("slab", 16.0),
        ("base", 3.0),
        ("girder", 11.0),
    ]
]
BAND = np.geomspace(1.0, 3000.0, 60)


@pytest.mark.parametrize("model", ["half", "full"])
@pytest.mark.parametrize("girder", ["elastic_bearings", "pinned"])
@pytest.mark.parametrize("layer_springs", [None, 40])
def test_line_of_the_paper(model, girder, layer_springs):
    """On its own line the paper's formulation with closed forms, and the chain, agree entry by entry."""
    line = paper_line(model=model, girder=girder, layer_springs=layer_springs)
    chain, dense = both(line, PLACES, BAND)
    assert (np.abs(chain - dense) <= TOLERANCE * np.abs(dense)).all()


def test_line_of_the_paper_over_two_spans():
    line = paper_line(spans=2)
    places = [place for place in PLACES if place.body != "girder"]
    places += [Place(body="girder[1]", x_m=30.0), Place(body="girder[2]", x_m=40.0)]
    chain, dense = both(line, places, BAND[::4])
    assert (np.abs(chain - dense) <= TOLERANCE * np.abs(dense)).all()


@pytest.mark.parametrize("girder", ["elastic_bearings", "pinned"])
def test_modal_sums_tend_to_the_chain(girder):
    """What N modes leave of a beam out is a flexibility 2 L^3 / (3 pi^4 E I N^3) under a point force.

    Against the mortar's 3.7e9 N/m that is 3.4e-3 for 200 modes of the slab, which its resonances up to 1500 Hz
    enlarge by a few times; the rail above hardly feels it.
    """
    frequency = BAND[::6]
    chain = respond(paper_line(girder=girder), PLACES, frequency)
    worst = []
    for modes in (200, 400, 800):
        line = paper_line(girder=girder, modes=modes)
        error = np.abs(respond(line, PLACES, frequency, formulation="receptance") - chain) / magnitude(chain)
        worst.append(error.max())
        assert error[:, 0, 0].max() < 1e-4
    assert worst[0] < 2e-2
    assert np.log2(np.array(worst[:-1]) / worst[1:]) == pytest.approx(3.0, abs=0.2)
