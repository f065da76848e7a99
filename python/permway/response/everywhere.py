"""Places on all bodies of a line, as near to each other as its waves ask for."""

from __future__ import annotations

import math

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.bodies import AnyBody, Mass
from permway.model.line import Line
from permway.model.place import Place
from permway.model.segments import Segment

A_WAVE = 12
"""Places on a wavelength of the free beam; those of a beam on supports are longer."""

FEWEST, MOST = 40, 400
"""Steps on a beam, and on all beams of one body."""

FEWEST_IN_A_ROW = 6
"""Steps on each beam of a long row."""


def everywhere(line: Line, high_Hz: float) -> list[Place]:
    """Places along all beams and shafts, and at all masses.

    Parameters
    ----------
    line : Line
    high_Hz : float
        Frequency up to which shapes are wanted.

    Returns
    -------
    list of Place
        Along every beam at equal steps, both ends among them: 12 on a bending wavelength, 40 at least, 400 at most
        on all beams of a row. A beam without ends has them between the first and the last joint.
    """
    segments = line.segments()
    places = []
    for name, body in line.bodies.items():
        mine = [(i, segment) for i, segment in enumerate(segments) if segment.body == name]
        for index, segment in mine:
            places += [
                Place(body=segment.name, x_m=float(x))
                for x in _along(line, body, segment, index, len(mine), high_Hz)
            ]
    return places


def _along(line: Line, body: AnyBody, segment: Segment, index: int, row: int, high_Hz: float) -> Reals:
    start, stop = segment.start, segment.stop
    if not math.isfinite(start):
        start, stop = _held(line, segment, index)
    if isinstance(body, Mass):
        return np.array([0.5 * (start + stop)])
    omega = 2.0 * np.pi * high_Hz
    if abs(body.bending_Nm2) > 0.0:
        wavelength = 2.0 * np.pi * (abs(body.bending_Nm2) / (body.mass_kg_per_m * omega**2)) ** 0.25
    else:
        wavelength = 2.0 * np.pi * (abs(body.shear_N) / body.mass_kg_per_m) ** 0.5 / omega
    steps = math.ceil(A_WAVE * (stop - start) / wavelength)
    return np.linspace(start, stop, max(min(max(steps, FEWEST), MOST // row), FEWEST_IN_A_ROW) + 1)


def _held(line: Line, segment: Segment, index: int) -> tuple[float, float]:
    """First and last joint of a body without ends."""
    table = line.joint_table()
    at = table.x[(table.upper == index) | (table.lower == index)]
    if not at.size:
        raise InputError(
            "has no ends and no joints, so that no place on it is one to look at",
            where=f"bodies.{segment.body}",
            remedy="give places",
        )
    return float(at.min()), float(at.max())
