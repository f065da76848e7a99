"""What named effects add at the place where a free stiffness was recovered: the two may be held side by side."""

from __future__ import annotations

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.factors import campaign_under
from permway.campaign.predict.hammer import temperature
from permway.diagnosis.blocks_frf import FrfBlock
from permway.diagnosis.fit import Fit
from permway.diagnosis.spot import Found, Spot
from permway.model.line import Line
from permway.model.place import Place
from permway.response.receptance import receptance


def law_stiffness(base: Fit, amended: Fit, found: Found) -> Complexes | None:
    """Dynamic stiffness that effects add at a spot, N/m, shape (F,).

    At a joint it is the change of the joint's own stiffness; on a body that of the inverse of the receptance,
    which is what was added if it was added there alone.

    Parameters
    ----------
    base, amended : Fit
        Without and with the effects; the base's parameters have the amended fit's values on both sides.
    found : Found
        Spot and frequencies.

    Returns
    -------
    ndarray of complex128, or None
        None without a hammer test, or if no effect is one of the line.
    """
    block = next((b for b in amended.evidence.blocks if isinstance(b, FrfBlock)), None)
    if block is None:
        return None
    condition = amended.campaign.condition(block.dataset.condition.name)
    values = amended.values()
    plain = base.build({f.name: values[f.name] for f in base.free})
    before, after = (campaign_under(c, condition).model.line for c in (plain, amended.campaign))
    if before == after:
        return None
    degrees = temperature(amended.campaign, condition)
    frequency, x = found.frequency_Hz, found.spot.x_m[0]
    if found.spot.kind == "body":
        sides = [_point(line, found.spot.name, x, frequency, degrees) for line in (before, after)]
        return np.asarray(1.0 / sides[1] - 1.0 / sides[0])
    index = found.spot.joints[0]
    between = _between(before, index)
    sides = [_joints(line, between, x, frequency, degrees) for line in (before, after)]
    return np.asarray(sides[1] - sides[0])


def same_place(before: Line, one: Spot, after: Line, other: Spot) -> bool:
    """Whether two spots are one place of two lines, whatever the laws there are called."""
    if one.kind != other.kind or not np.allclose(one.x_m, other.x_m, rtol=0.0, atol=1e-6):
        return False
    if one.kind == "body":
        return one.name == other.name
    return _between(before, one.joints[0]) == _between(after, other.joints[0])


def _point(line: Line, body: str, x: float, frequency: Reals, temperature_C: float | None) -> Complexes:
    place = Place(body=body, x_m=x)
    data = receptance(line, frequency, forces=[place], sensors=[place], temperature_C=temperature_C)
    return np.asarray(data["receptance"].values[:, 0, 0])


def _names(line: Line) -> list[str]:
    """Of each segment's body; the last one is the ground, which has the index -1."""
    return [*(segment.body for segment in line.segments()), ""]


def _between(line: Line, joint: int) -> tuple[str, str]:
    table, names = line.joint_table(), _names(line)
    return names[table.upper[joint]], names[table.lower[joint]]


def _joints(
    line: Line, between: tuple[str, str], x: float, frequency: Reals, temperature_C: float | None
) -> Complexes:
    """Stiffness of all joints between two bodies at a station."""
    table, names = line.joint_table(), _names(line)
    there = np.flatnonzero(np.isclose(table.x, x, rtol=0.0, atol=1e-6))
    mine = [j for j in there if (names[table.upper[j]], names[table.lower[j]]) == between]
    each = line.stiffness(frequency, temperature_C)
    return np.asarray((each[:, table.law[mine]] * table.scale[mine]).sum(axis=1))
