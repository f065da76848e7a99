"""Modal sums, equations (6), (8) and (10) of the paper, against the closed form they converge to."""

import numpy as np
import pytest
from permway.errors import InputError
from permway.model.bodies import Beam
from permway.model.line import Line
from permway.model.place import Place
from permway.response.receptance import receptance


def alone(ends, modes):
    beam = Beam(
        youngs_modulus_Pa=3e10,
        second_moment_m4=1e-3,
        density_kg_per_m3=2500.0,
        area_m2=0.256,
        loss_factor=0.1,
        intervals_m=((0.0, 8.0),),
        ends=ends,
        modes=modes,
    )
    return Line(bodies={"beam": beam}, joints=(), laws={})


def at_two_metres(line, formulation):
    place = [Place(body="beam", x_m=2.0)]
    return receptance(line, [120.0], forces=place, sensors=place, formulation=formulation)[
        "receptance"
    ].values.item()


@pytest.mark.parametrize("ends", ["pinned", "free", ("pinned", "free")])
def test_modal_sum_converges_to_the_closed_form(ends):
    """What N modes leave out at a point is a sum over 1/n^4: it falls as N^-3."""
    exact = at_two_metres(alone(ends, None), "receptance")
    sums = np.array([at_two_metres(alone(ends, modes), "receptance") for modes in (20, 40, 80, 160)])
    errors = np.abs(sums / exact - 1.0)
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(3.0, abs=0.15)


def test_chain_refuses_modes():
    with pytest.raises(InputError, match="modes are for the receptance formulation"):
        at_two_metres(alone("free", 20), "chain")
