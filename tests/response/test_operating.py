"""Operating deflection shapes against closed forms.

A simply supported beam struck in the middle moves at its first resonance in a half sine, a quarter of a period
after the force; a mass on a spring far above its resonance moves against the force. Source: Blevins, Formulas for
Natural Frequency and Mode Shape (1979), table 8-1.
"""

from __future__ import annotations

import numpy as np
import permway
import pytest
from permway.errors import InputError
from permway.laws import KelvinVoigt
from permway.model.bodies import Beam, Mass
from permway.model.joints import Joints
from permway.model.line import Line
from permway.model.place import Place
from permway.response.operating import at_phase, greatest_deg, operating_shapes

LENGTH_M, BENDING, MASS, ETA = 24.0, 3.4e10 * 1.2, 1.0e4, 0.01
FIRST_HZ = (np.pi / LENGTH_M) ** 2 * (BENDING / MASS) ** 0.5 / (2.0 * np.pi)

BEAM = Beam(
    youngs_modulus_Pa=3.4e10,
    second_moment_m4=1.2,
    density_kg_per_m3=2500.0,
    area_m2=4.0,
    loss_factor=ETA,
    intervals_m=((0.0, LENGTH_M),),
    ends="pinned",
)
STACK = Line(
    bodies={"deck": BEAM, "block": Mass(mass_kg=500.0)},
    joints=(Joints(between=("block", "deck"), law="pad", at=(7.3,)),),
    laws={"pad": KelvinVoigt(stiffness=2.0e7, damping=1.0e4)},
)


def middle(line: Line, frequency_Hz: float, x_m: float = 12.0, body: str = "deck"):
    data = operating_shapes(line, [frequency_Hz], forces=[Place(body=body, x_m=x_m)], temperature_C=20.0)
    return data.isel(frequency=0, force=0)


def test_a_beam_at_its_first_resonance_is_a_half_sine() -> None:
    data = middle(Line(bodies={"deck": BEAM}, joints=(), laws={}), FIRST_HZ)
    phase = greatest_deg(data["shape"].values)
    assert phase == pytest.approx(90.0, abs=0.5)
    seen = at_phase(data["shape"], phase)
    half_sine = np.sin(np.pi * seen["place_x"].values / LENGTH_M)
    assert seen.values / seen.values.max() == pytest.approx(half_sine, abs=0.01)
    # Modal mass is half the beam's: 2 / (m L omega^2 eta).
    assert seen.values.max() == pytest.approx(
        2.0 / (MASS * LENGTH_M * (2 * np.pi * FIRST_HZ) ** 2 * ETA), rel=0.01
    )
    # A quarter of a period earlier nothing but the other modes is seen.
    assert np.abs(at_phase(data["shape"], phase - 90.0).values).max() < 0.01 * seen.values.max()


def test_a_joint_moves_by_the_difference_of_what_it_joins() -> None:
    data = middle(STACK, 20.0)
    shape = data["shape"]
    block = shape.values[data["place_body"].values == "block"]
    under = shape.values[(data["place_body"].values == "deck") & (data["place_x"].values == 7.3)]
    assert (block.size, under.size, data.sizes["joint"]) == (1, 1, 1)
    assert data["extension"].values == pytest.approx(block - under, rel=1e-9)
    assert (data["joint_body"].item(), data["joint_onto"].item(), data["joint_x"].item()) == ("block", "deck", 7.3)


def test_it_is_what_the_response_states_of_the_same_places() -> None:
    data = middle(permway.slab_track_viaduct_32m(), 80.0, 16.1, "rail")
    bodies, x = data["place_body"].values, data["place_x"].values
    assert np.isclose(x[bodies == "rail"], 16.1).any()
    picked = [int(i) for i in np.random.default_rng(47).choice(bodies.size, 12, replace=False)]
    sensors = [Place(body=str(bodies[i]), x_m=float(x[i])) for i in picked]
    force = [Place(body="rail", x_m=16.1)]
    line = permway.slab_track_viaduct_32m()
    straight = permway.receptance(line, [80.0], forces=force, sensors=sensors, temperature_C=20.0)
    assert data["shape"].values[picked] == pytest.approx(straight["receptance"].values[0, :, 0], rel=1e-9)
    assert len(set(zip(bodies, x, strict=True))) == bodies.size


def test_joints_to_the_ground_and_what_cannot_be_drawn() -> None:
    line = Line(
        bodies={"m": Mass(mass_kg=10.0)},
        joints=(Joints(between=("m", "ground"), law="k", at=(1.0,)),),
        laws={"k": KelvinVoigt(stiffness=4.0e4, damping=20.0)},
    )
    data = middle(line, 100.0, 1.0, "m")
    assert data["joint_onto"].item() == "ground"
    assert data["extension"].item() == pytest.approx(data["shape"].values[0])
    # Far above its resonance it is up when the force is down.
    assert greatest_deg(data["shape"].values) == pytest.approx(180.0, abs=1.0)
    with pytest.raises(InputError, match="must be one at least"):
        operating_shapes(line, [100.0], forces=[])
    with pytest.raises(InputError, match="has no phase"):
        at_phase(abs(data["shape"]), 0.0)
    with pytest.raises(InputError, match="phase_deg"):
        at_phase(data["shape"], float("nan"))
