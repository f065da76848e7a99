"""What a named law adds, held against what is known of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from permway.diagnosis.catalogue._change import hung_mass, with_joints
from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather
from permway.diagnosis.locate import scan
from permway.diagnosis.recovered import law_stiffness
from permway.diagnosis.refit import untouched
from permway.diagnosis.spot import Found
from permway.model.joints import GROUND, Joints
from simulated import simulate


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    return untouched(gather(simulate(tmp_path_factory.mktemp("base") / "c", 3).campaign, threads=1))


def at(found: list[Found], kind: str, name: str, x: float) -> Found:
    mine = [f for f in found if f.spot.kind == kind and f.spot.name == name]
    return min(mine, key=lambda f: abs(f.spot.x_m[0] - x))


def test_a_lost_fastener_takes_nearly_all_of_its_own_stiffness(base: Fit) -> None:
    line = base.campaign.model.line
    spot = at(scan(base), "joint", "pad", 7.5)
    amended = replace(base, campaign=weakened(base.campaign, "pad", spot.spot.x_m[0], 0.1, 0.05))
    added = law_stiffness(base, amended, spot)
    joint, table = spot.spot.joints[0], line.joint_table()
    pad = line.stiffness(spot.frequency_Hz, 15.0)[:, table.law[joint]] * table.scale[joint]
    assert added is not None
    np.testing.assert_allclose(added, -0.95 * pad, rtol=1e-9)


def test_a_hung_mass_adds_its_own_stiffness_where_it_hangs(base: Fit) -> None:
    law = hung_mass(500.0, 40.0, 0.1)
    hung = Joints(between=("deck", GROUND), law="hung", at=(4.0,))
    found = scan(base)
    spot = at(found, "body", "deck", 4.0)
    assert spot.spot.x_m[0] == pytest.approx(4.0)
    amended = replace(base, campaign=with_joints(base.campaign, hung, laws={"hung": law}))
    added = law_stiffness(base, amended, spot)
    assert added is not None
    np.testing.assert_allclose(added, law.complex(spot.frequency_Hz, None), rtol=1e-6)


def test_a_fault_of_a_sensor_adds_no_stiffness(base: Fit) -> None:
    assert law_stiffness(base, base, scan(base)[0]) is None
