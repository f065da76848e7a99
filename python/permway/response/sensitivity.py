"""Derivatives of receptances by joints, laws, beams and masses; and what one changed joint does, exactly.

The motion by a unit force at the sensor and the motion by the force itself give every derivative,
`dH = -u_s' dK u_f`: one more solve per sensor, whatever the number of parameters. A joint's stiffness enters as
`k e e'`, so that its finite change is of rank one (Sherman and Morrison 1950).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from permway import _core
from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.model.joint_table import JointTable
from permway.model.line import Line
from permway.model.place import Place
from permway.response.core import Progress, Solved, run
from permway.response.limits import check_answer
from permway.response.receptance import (
    CONVENTION,
    check_given,
    check_line,
    check_places,
    check_sweep,
    frequency_coordinate,
    joint_coordinates,
    place_coordinates,
)

PROPERTIES = ("bending_Nm2", "shear_N", "mass_kg_per_m", "rotary_kg_m")
"""Of a beam, in the order of the core."""

By = Literal["law", "joint"]


def sensitivity(
    line: Line,
    frequency_Hz: ArrayLike,
    *,
    forces: Sequence[Place],
    sensors: Sequence[Place],
    by: By | ArrayLike = "law",
    bodies: bool = True,
    places: bool = False,
    temperature_C: float | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Receptances and their derivatives, by the chain formulation.

    Parameters
    ----------
    line : Line
    frequency_Hz : array_like, shape (F,)
        Ascending, positive.
    forces, sensors : sequence of Place
    by : "law", "joint", or array_like of int, shape (J,)
        How derivatives by the joints' stiffness are summed: over the joints of each law (by the law's stiffness,
        each joint with its scale), not at all, or over groups of joints numbered from 0 (by a stiffness added to
        every joint of the group; -1 is none).
    bodies : bool
        Whether by the stiffness and mass of beams and masses, too.
    places : bool
        Whether the extensions of all joints are returned, from which :func:`by_joint` and :func:`change_joint`
        give what every single joint does: far smaller than all derivatives by place.
    temperature_C, threads, progress
        As in :func:`permway.response.receptance.receptance`.

    Returns
    -------
    xarray.Dataset
        `receptance` (frequency, sensor, force) in m/N and its derivatives, complex: `by_law`, `by_joint` or
        `by_group` (frequency, law or joint or group, sensor, force) per N/m; `by_beam` (frequency, beam,
        property, sensor, force) per N m2, N, kg/m and kg m, NaN where an Euler-Bernoulli beam has no such
        property; `by_mass` (frequency, mass, sensor, force) per kg. Stiffnesses are complex, E I (1 + i eta): a
        change of the loss factor is a change of i E I. With `places`: `sensor_extension` (frequency, joint,
        sensor) and `force_extension` (frequency, joint, force), of a unit force at each, and `own_extension`
        (frequency, joint) of a unit tension in the joint itself.

    Raises
    ------
    InputError
        For frequencies, places, groups or laws that do not fit.
    SolveError
        If a frequency cannot be solved.
    """
    check_line(line)
    frequency = check_sweep(frequency_Hz)
    check_given(forces, "forces")
    check_given(sensors, "sensors")
    wanted = {"forces": check_places(line, forces, "forces"), "sensors": check_places(line, sensors, "sensors")}
    ports, sensor_port, force_port = _ports(wanted)
    table = line.joint_table()
    name, labels, groups, weights = _groups(line, table, by)
    rows = len(labels) + (4 * len(line.beams()) + len(line.masses_kg()) if bodies else 0)
    check_answer(frequency.size, rows, max(1, len(sensors)), max(1, len(forces)))
    solved = run(
        line,
        frequency,
        {"forces": ports, "sensors": ports},
        temperature_C=temperature_C,
        extensions=places,
        threads=threads,
        progress=progress,
        joints=table,
        derived={
            "groups": groups,
            "weights": weights,
            "n_groups": len(labels),
            "bodies": bodies,
            "sensors": sensor_port,
            "forces": force_port,
            "own": places,
            "by_law": name == "law",
        },
    )
    data = xr.Dataset(
        {"receptance": (("frequency", "sensor", "force"), solved.receptance[:, sensor_port][:, :, force_port])},
        coords={
            "frequency": frequency_coordinate(frequency),
            **place_coordinates("sensor", sensors),
            **place_coordinates("force", forces),
            **({name: labels} if name != "joint" else {}),
        },
        attrs={"convention": CONVENTION, "formulation": "chain", "permway_version": _core.__version__},
    )
    data["receptance"].attrs = {"long_name": "receptance", "units": "m/N"}
    if temperature_C is not None:
        data.attrs["temperature_C"] = temperature_C
    data = _with_derivatives(data, line, solved, name, len(labels), bodies=bodies)
    if places and solved.extension is not None:
        data["sensor_extension"] = (("frequency", "joint", "sensor"), solved.extension[:, :, sensor_port])
        data["force_extension"] = (("frequency", "joint", "force"), solved.extension[:, :, force_port])
        data["own_extension"] = (("frequency", "joint"), solved.own)
        for kind in ("sensor", "force", "own"):
            data[f"{kind}_extension"].attrs = {"long_name": f"joint extension, {kind}", "units": "m/N"}
    if places or name == "joint":
        data = data.assign_coords(joint_coordinates(line, table))
    return data


def by_joint(data: xr.Dataset, joint: int) -> xr.DataArray:
    """Derivative of the receptances by the stiffness of one joint.

    Parameters
    ----------
    data : Dataset
        From :func:`sensitivity` with `places`.
    joint : int
        Index of the joint.

    Returns
    -------
    DataArray (frequency, sensor, force)
        (m/N) per (N/m).
    """
    sensor, force, _ = _extensions(data, joint)
    result = -(sensor * force).transpose("frequency", "sensor", "force").rename("by_joint")
    result.attrs = {"long_name": f"derivative by the stiffness of joint {joint}", "units": "m2/N2"}
    return result


def change_joint(data: xr.Dataset, joint: int, change_N_per_m: ArrayLike) -> xr.DataArray:
    """Receptances of the line with one joint changed by a finite stiffness, exactly.

    Parameters
    ----------
    data : Dataset
        From :func:`sensitivity` with `places`.
    joint : int
        Index of the joint.
    change_N_per_m : array_like, scalar or shape (F,)
        Complex stiffness added; minus the joint's own takes it out.

    Returns
    -------
    DataArray (frequency, sensor, force)
        m/N.

    Raises
    ------
    InputError
        If the changed line is singular at a frequency.
    """
    sensor, force, own = _extensions(data, joint)
    change = np.broadcast_to(np.asarray(change_N_per_m, dtype=np.complex128), own.shape)
    denominator = 1.0 + change * own.values
    bad = np.flatnonzero(np.abs(denominator) < 1e-12 * (1.0 + np.abs(change * own.values)))
    if bad.size:
        at = float(data["frequency"][bad[0]])
        raise InputError(
            f"the changed line is singular at {at:g} Hz",
            where=f"joint {joint}",
            value=complex(change[bad[0]]),
            remedy="change it by a little less, or with loss",
        )
    factor = xr.DataArray(change / denominator, dims="frequency", coords={"frequency": data["frequency"]})
    result = (data["receptance"] - sensor * force * factor).transpose("frequency", "sensor", "force")
    result.attrs = dict(data["receptance"].attrs)
    return result.rename("receptance")


def _extensions(data: xr.Dataset, joint: int) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
    if "own_extension" not in data:
        raise InputError("has no joint extensions", where="data", remedy="call sensitivity with places=True")
    count = data.sizes["joint"]
    if isinstance(joint, bool) or not isinstance(joint, int | np.integer) or not 0 <= joint < count:
        raise InputError("there is no such joint", where="joint", value=joint, remedy=f"use 0 to {count - 1}")
    at = data.isel(joint=joint).reset_coords(["joint_x", "joint_law"], drop=True)
    return at["sensor_extension"], at["force_extension"], at["own_extension"]


def _ports(wanted: dict[str, dict[str, np.ndarray]]) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
    """Every place once, and where among them the sensors and the forces are."""
    seen: dict[tuple[int, float], int] = {}
    index = {
        kind: np.array(
            [seen.setdefault((int(b), float(x)), len(seen)) for b, x in zip(p["body"], p["x"], strict=True)],
            dtype=np.int64,
        )
        for kind, p in wanted.items()
    }
    ports = {
        "body": np.array([body for body, _ in seen], dtype=np.int64),
        "x": np.array([x for _, x in seen], dtype=np.float64),
    }
    return ports, index["sensors"], index["forces"]


def _groups(line: Line, table: JointTable, by: By | ArrayLike) -> tuple[str, list[str], np.ndarray, Reals]:
    """Name of the dimension, its labels, the group of each joint and its weight there."""
    count = table.x.size
    if isinstance(by, str):
        if by == "law":
            return "law", list(line.laws), table.law.astype(np.int64), table.scale
        if by == "joint":
            return "joint", [str(i) for i in range(count)], np.arange(count, dtype=np.int64), np.ones(count)
        raise InputError("unknown", where="by", value=by, remedy='use "law", "joint" or an array of groups')
    groups = np.asarray(by)
    if groups.shape != (count,) or not np.issubdtype(groups.dtype, np.integer):
        raise InputError(
            f"must be {count} whole numbers from -1 on, a group for each joint",
            where="by",
            value=f"shape {groups.shape}, {groups.dtype}",
        )
    bad = np.flatnonzero((groups < -1) | (groups >= count))
    if bad.size:
        raise InputError(
            f"a group of {count} joints is -1 for none, or 0 to {count - 1}",
            where=f"by[{bad[0]}]",
            value=int(groups[bad[0]]),
            remedy="number the groups from 0 on",
        )
    labels = [str(i) for i in range(int(groups.max(initial=-1)) + 1)]
    return "group", labels, groups.astype(np.int64), np.ones(count)


def _with_derivatives(
    data: xr.Dataset, line: Line, solved: Solved, name: str, groups: int, *, bodies: bool
) -> xr.Dataset:
    derivatives = solved.derivatives
    if derivatives is None:
        return data
    ends = ("sensor", "force")
    data[f"by_{name}"] = (("frequency", name, *ends), derivatives[:, :groups])
    data[f"by_{name}"].attrs = {"long_name": f"derivative by the stiffness of a {name}", "units": "m2/N2"}
    if not bodies:
        return data
    pairs, rest = line.beams(), derivatives[:, groups:]
    beams, masses = rest[:, : 4 * len(pairs)], rest[:, 4 * len(pairs) :]
    by_beam: Complexes = beams.reshape(beams.shape[0], len(pairs), 4, *beams.shape[2:]).copy()
    for index, (beam, _) in enumerate(pairs):
        if beam.shear_N == 0.0:
            by_beam[:, index, 1::2] = np.nan
    data["by_beam"] = (("frequency", "beam", "property", *ends), by_beam)
    data["by_beam"].attrs = {"long_name": "derivative by a property of a beam", "units": "m/N per property's unit"}
    data["by_mass"] = (("frequency", "mass", *ends), masses)
    data["by_mass"].attrs = {"long_name": "derivative by a mass", "units": "m/N/kg"}
    names = [s.name for s in line.segments()]
    return data.assign_coords(beam=names[: len(pairs)], mass=names[len(pairs) :], property=list(PROPERTIES))
