"""Operating deflection shapes: how all bodies move at a frequency while a force acts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from permway.arrays import Complexes, Reals
from permway.errors import InputError, must_be
from permway.model.bodies import Mass
from permway.model.joint_table import JointTable
from permway.model.joints import GROUND
from permway.model.line import Line
from permway.model.place import Place
from permway.model.segments import Integers
from permway.response.everywhere import everywhere
from permway.response.receptance import (
    Formulation,
    check_line,
    check_places,
    check_sweep,
    joint_coordinates,
    receptance,
)

_APART_M = 1e-6
"""Places on one body that are nearer to each other are one."""


def operating_shapes(
    line: Line,
    frequency_Hz: ArrayLike,
    *,
    forces: Sequence[Place],
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
) -> xr.Dataset:
    """How all bodies and joints move under each force, at each frequency.

    Unlike a mode shape it belongs to a frequency and a force: all modes take part, in and out of phase. With much
    damping nothing stands still at nodes: waves run.

    Parameters
    ----------
    line : Line
    frequency_Hz : array_like
        In Hz, ascending.
    forces : sequence of Place
        Where 1 N acts, one after the other.
    temperature_C : float, optional
        Needed if a law of the line depends on it.
    formulation, threads
        As in :func:`permway.receptance`.

    Returns
    -------
    xarray.Dataset
        `shape` (frequency, force, place), complex, m/N, positive down; places lie along all beams, at all masses,
        at the joints and at the forces. `extension` (frequency, force, joint), m/N: of every joint, upper less
        lower; coordinates `joint_body` and `joint_onto` say between which bodies (or "ground"), `joint_x` where.

    Raises
    ------
    InputError
        For frequencies or places that do not fit.
    SolveError
        If the line cannot be solved.
    """
    check_line(line)
    frequency = check_sweep(frequency_Hz)
    check_places(line, forces, "forces")
    if not len(forces):
        raise InputError("must be one at least", where="forces", remedy="as in [Place(body=..., x_m=...)]")
    table = line.joint_table()
    solved = receptance(
        line,
        frequency,
        forces=forces,
        sensors=_places(line, table, float(frequency[-1]), forces),
        temperature_C=temperature_C,
        formulation=formulation,
        extensions=True,
        threads=threads,
    )
    data = solved.rename({"receptance": "shape"} | {f"sensor{end}": f"place{end}" for end in ("", "_body", "_x")})
    data = data.transpose("frequency", "force", "place", "joint").assign_coords(_between(line, table))
    data["shape"].attrs = {"long_name": "displacement under 1 N, positive down", "units": "m/N"}
    return data


def at_phase(shape: xr.DataArray, phase_deg: float) -> xr.DataArray:
    """What is seen at one moment: the real part of shape exp(i phase).

    Parameters
    ----------
    shape : DataArray
        Complex: `shape` or `extension` of :func:`operating_shapes`, or a receptance of :func:`permway.solve`, of
        which a frequency and a force are selected.
    phase_deg : float
        The force is greatest at 0 degrees, and greatest upwards at 180.

    Raises
    ------
    InputError
        If what is given is not complex, or the phase no finite number.
    """
    must_be(shape, xr.DataArray, "shape", remedy='as in at_phase(operating_shapes(...)["shape"], 0.0)')
    if not np.iscomplexobj(shape.values):
        raise InputError("has no phase: it is real", where="shape", value=str(shape.dtype))
    if isinstance(phase_deg, str | bool) or not np.isfinite(phase_deg):
        raise InputError("must be a number", where="phase_deg", value=phase_deg, remedy="in degrees")
    found: xr.DataArray = (shape * np.exp(1j * np.deg2rad(phase_deg))).real
    found.attrs = {**shape.attrs, "phase_deg": float(phase_deg)}
    return found


def greatest_deg(values: Complexes) -> float:
    """The phase at which the place that moves most is farthest down; 0 where nothing moves."""
    most = values.flat[int(np.abs(values).argmax())]
    return float(np.rad2deg(-np.angle(most))) % 360.0


def _places(line: Line, table: JointTable, high_Hz: float, forces: Sequence[Place]) -> list[Place]:
    """All along the bodies; of beams also where joints and forces are, for there shapes bend."""
    wanted: dict[str, list[float]] = {}
    for place in everywhere(line, high_Hz):
        wanted.setdefault(place.body, []).append(place.x_m)
    segments = line.segments()
    where = [*zip(table.upper, table.x, strict=True), *zip(table.lower, table.x, strict=True)]
    columns = check_places(line, forces, "forces")
    where += zip(columns["body"], columns["x"], strict=True)
    for index, x in where:
        if index >= 0 and not isinstance(line.bodies[segments[index].body], Mass):
            wanted.setdefault(segments[index].name, []).append(float(x))
    return [Place(body=body, x_m=float(x)) for body, xs in wanted.items() for x in _apart(np.array(xs))]


def _apart(x: Reals) -> Reals:
    ordered = np.unique(x)
    return np.asarray(ordered[np.concatenate([[True], np.diff(ordered) > _APART_M])], dtype=np.float64)


def _between(line: Line, table: JointTable) -> dict[str, object]:
    names = [*(segment.name for segment in line.segments()), GROUND]

    def of(index: Integers) -> tuple[str, list[str]]:
        return "joint", [names[i] for i in index]

    return {**joint_coordinates(line, table), "joint_body": of(table.upper), "joint_onto": of(table.lower)}
