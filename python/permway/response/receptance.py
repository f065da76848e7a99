"""From a line, forces and sensors to a labelled dataset of receptances."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Literal, get_args

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from permway import _core
from permway.arrays import Reals
from permway.errors import InputError, SolveError
from permway.model.bodies import Metres
from permway.model.line import Line
from permway.records import FrozenModel
from permway.response.limits import check_answer, check_dense, check_elements, check_threads

Formulation = Literal["chain", "receptance"]
Progress = Callable[[int, int], object]

CONVENTION = "exp(+i omega t), displacement and force positive down"


class Place(FrozenModel):
    """A place on a body, of a unit force or of a sensor.

    Parameters
    ----------
    body : str
        Name of the body; "girder[2]" for the second of a row.
    x_m : float
        Place along the line.
    name : str, optional
        Label in the dataset; by default "body@x".
    """

    body: str
    x_m: Metres
    name: str | None = None

    @property
    def label(self) -> str:
        """The name, or body and place."""
        return self.name or f"{self.body}@{self.x_m:g}"


def receptance(
    line: Line,
    frequency_Hz: ArrayLike,
    *,
    forces: Sequence[Place],
    sensors: Sequence[Place],
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    extensions: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
    on_error: Literal["raise", "mark"] = "raise",
) -> xr.Dataset:
    """Displacement at sensors per unit force, frequency by frequency.

    Parameters
    ----------
    line : Line
    frequency_Hz : array_like, shape (F,)
        Ascending, positive.
    forces, sensors : sequence of Place
        Where unit forces act, and where displacement is read.
    temperature_C : float, optional
        Needed if a law of the line depends on it.
    formulation : "chain" or "receptance"
        Exact impedance marched along the line, or the paper's equations (4) to (16) as one dense system.
    extensions : bool
        Whether to return the extension of every joint too.
    threads : int, optional
        Number of threads; by default all processors.
    progress : callable, optional
        Called with (done, total) from time to time; an exception from it stops the sweep.
    on_error : "raise" or "mark"
        Whether a frequency that cannot be solved stops everything, or is left as NaN and named in the
        attribute `failures`.

    Returns
    -------
    xarray.Dataset
        `receptance` (frequency, sensor, force), complex, m/N; `extension` (frequency, joint, force) on request.

    Raises
    ------
    InputError
        For frequencies, places or laws that do not fit.
    SolveError
        If the line is singular, not finite or badly conditioned at a frequency.
    """
    frequency = check_sweep(frequency_Hz)
    for where, chosen, choices in (
        ("formulation", formulation, get_args(Formulation)),
        ("on_error", on_error, ("raise", "mark")),
    ):
        if chosen not in choices:
            raise InputError("unknown", where=where, value=chosen, remedy=f"use one of {list(choices)}")
    check_threads(threads)
    segments = line.segments()
    table = line.joint_table()
    pairs = line.beams()
    points = {"forces": check_places(line, forces, "forces"), "sensors": check_places(line, sensors, "sensors")}
    check_answer(frequency.size, len(sensors) + (table.x.size if extensions else 0), len(forces))
    if formulation == "chain" and any(beam.modes for beam, _ in pairs):
        modal = next(segment.name for beam, segment in pairs if beam.modes)
        raise InputError(
            "modes are for the receptance formulation; the chain is exact",
            where=f"line.bodies.{modal}.modes",
            remedy='leave modes out, or choose formulation = "receptance"',
        )
    if formulation == "receptance":
        check_dense(table)
    elif frequency.size:
        check_elements(line, table, np.concatenate([p["x"] for p in points.values()]), float(frequency[-1]))

    try:
        values, joints, failures = _core.solve_line(
            formulation=formulation,
            frequencies=frequency,
            names=[s.name for s in segments],
            beams=line.beam_columns(),
            masses=line.masses_kg(),
            joints={name: getattr(table, name) for name in ("x", "upper", "lower", "law", "scale")},
            laws=line.stiffness(frequency, temperature_C),
            forces=points["forces"],
            sensors=points["sensors"],
            extensions=extensions,
            threads=threads or os.cpu_count() or 1,
            progress=progress,
        )
    except _core.TablesError as error:
        raise InputError(str(error), where="line") from error
    if failures and on_error == "raise":
        more = f" (and {len(failures) - 1} more frequencies)" if len(failures) > 1 else ""
        raise SolveError(failures[0][2] + more)
    data = xr.Dataset(
        {"receptance": (("frequency", "sensor", "force"), values)},
        coords={
            "frequency": frequency_coordinate(frequency),
            **_place_coordinates("sensor", sensors),
            **_place_coordinates("force", forces),
        },
        attrs={
            "convention": CONVENTION,
            "formulation": formulation,
            "permway_version": _core.__version__,
            "failures": "; ".join(text for _, _, text in failures),
        },
    )
    data["receptance"].attrs = {"long_name": "receptance", "units": "m/N"}
    if temperature_C is not None:
        data.attrs["temperature_C"] = temperature_C
    if joints is not None:
        data["extension"] = (("frequency", "joint", "force"), joints)
        data["extension"].attrs = {"long_name": "joint extension, upper less lower", "units": "m/N"}
        data.coords["joint_x"] = ("joint", table.x, {"units": "m"})
        data.coords["joint_law"] = ("joint", [list(line.laws)[i] for i in table.law])
    return data


def check_places(line: Line, places: Sequence[Place], where: str) -> dict[str, np.ndarray]:
    """Places as the core's columns: segment of each, and x.

    Raises
    ------
    InputError
        For a name that stands twice, and a place that is on no body, off it, or where two beams meet.
    """
    for index, place in enumerate(places):
        if not isinstance(place, Place):
            raise InputError("must be a Place", where=f"{where}[{index}]", value=place)
    labels = [p.label for p in places]
    for index, label in enumerate(labels):
        if label in labels[:index]:
            raise InputError(
                "the name stands twice", where=f"{where}[{index}]", value=label, remedy="give each its own name"
            )
    found = [line.locate(p.body, p.x_m, where=f"{where}[{i}]") for i, p in enumerate(places)]
    return {"body": np.array(found, dtype=np.int64), "x": np.array([p.x_m for p in places], dtype=np.float64)}


def check_sweep(frequency_Hz: ArrayLike) -> Reals:
    """Frequencies of a sweep as an array: one-dimensional, finite, positive, strictly ascending.

    Raises
    ------
    InputError
        Naming the first frequency at fault.
    """
    try:
        frequency = np.atleast_1d(np.asarray(frequency_Hz, dtype=np.float64))
    except (TypeError, ValueError) as error:
        raise InputError("frequencies must be numbers", where="frequency_Hz", value=frequency_Hz) from error
    if frequency.ndim != 1:
        raise InputError("frequencies must be a list", where="frequency_Hz", value=frequency.shape)
    bad = np.flatnonzero(~(np.isfinite(frequency) & (frequency > 0.0)))
    if bad.size:
        raise InputError(
            "a frequency must be finite and above 0 Hz",
            where=f"frequency_Hz[{bad[0]}]",
            value=float(frequency[bad[0]]),
            remedy="leave 0 Hz out; for the static limit take a low frequency",
        )
    back = np.flatnonzero(np.diff(frequency) <= 0.0)
    if back.size:
        raise InputError(
            "frequencies must ascend",
            where=f"frequency_Hz[{back[0] + 1}]",
            value=float(frequency[back[0] + 1]),
            remedy=f"it follows {frequency[back[0]]:g} Hz: sort them and drop repetitions",
        )
    return frequency


def frequency_coordinate(frequency: Reals) -> tuple[str, Reals, dict[str, str]]:
    """The coordinate that all datasets share."""
    return ("frequency", frequency, {"long_name": "frequency", "units": "Hz"})


def _place_coordinates(kind: str, places: Sequence[Place]) -> dict[str, object]:
    return {
        kind: [p.label for p in places],
        f"{kind}_body": (kind, [p.body for p in places]),
        f"{kind}_x": (kind, [p.x_m for p in places], {"units": "m"}),
    }
