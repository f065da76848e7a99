"""Loss of a beam that goes the other way over frequency: the same at a resonance, another elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from permway.diagnosis.catalogue.beam_damping import Kind, exchanged, first_Hz
from permway.model.bodies import Beam
from permway.model.line import Line
from permway.model.place import Place
from permway.response.receptance import receptance

PLACE = [Place(body="deck", x_m=5.0)]


def deck(**fields: object) -> Beam:
    given = {"youngs_modulus_Pa": 3.4e10, "second_moment_m4": 0.6, "density_kg_per_m3": 2500.0, "area_m2": 4.8}
    return Beam(**{**given, "intervals_m": [(0.0, 20.0)], "ends": "pinned", **fields})


def response(beam: Beam, frequency_Hz: list[float]) -> NDArray[np.complex128]:
    line = Line(bodies={"deck": beam}, joints=[], laws={})
    found = receptance(line, frequency_Hz, forces=PLACE, sensors=PLACE)
    return np.asarray(found["receptance"].values[:, 0, 0])


@pytest.mark.parametrize(
    ("kind", "loss"),
    [
        ("ratio", {"loss_factor": 0.04}),
        ("mass", {"loss_factor": 0.04}),
        ("stiffness", {"loss_factor": 0.04}),
        ("hysteretic", {"damping_ratio": 0.02}),
    ],
)
def test_all_of_the_loss_is_exchanged_for_as_much_at_the_first_resonance(
    kind: Kind, loss: dict[str, float]
) -> None:
    beam = deck(**loss)
    first = first_Hz(beam)
    other = beam.model_validate({**dict(beam), **exchanged(beam, kind, 1.0, first)})
    assert other.is_viscous != beam.is_viscous
    assert other.loss_factor * beam.loss_factor == 0.0
    stated, found = (response(one, [0.2 * first, first]) for one in (beam, other))
    # At the resonance all of the response is loss; far below a viscous one has nearly gone.
    assert found[1] == pytest.approx(stated[1], rel=2e-3)
    viscous, hysteretic = (stated, found) if beam.is_viscous else (found, stated)
    assert abs(viscous[0].imag) < 0.5 * abs(hysteretic[0].imag)
