"""From a line, forces and sensors to a labelled dataset of receptances."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Sized
from dataclasses import replace
from functools import lru_cache, partial
from typing import get_args

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from permway import _core
from permway.arrays import Reals, real_numbers
from permway.errors import InputError, must_be
from permway.model.joint_table import JointTable
from permway.model.line import Line
from permway.model.place import Place
from permway.model.segments import Integers, Segment, find
from permway.response.core import Formulation as Formulation
from permway.response.core import OnError, Solved, run
from permway.response.core import Progress as Progress

CONVENTION = "exp(+i omega t), displacement and force positive down"


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
    on_error: OnError = "raise",
) -> xr.Dataset:
    """Displacement at sensors per unit force, frequency by frequency.

    Parameters
    ----------
    line : Line
    frequency_Hz : array_like, shape (F,)
        Ascending, positive.
    forces, sensors : sequence of Place
        Where unit forces act, and where displacement is read. Solved from the side that has fewer: the line is
        reciprocal.
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
    check_line(line)
    frequency = check_sweep(frequency_Hz)
    check_given(forces, "forces")
    if not extensions:
        # What joints extend by needs no sensor.
        check_given(sensors, "sensors")
    solved = between(
        line,
        frequency,
        forces=forces,
        sensors=sensors,
        temperature_C=temperature_C,
        formulation=formulation,
        extensions=extensions,
        threads=threads,
        progress=progress,
        on_error=on_error,
    )
    data = xr.Dataset(
        {"receptance": (("frequency", "sensor", "force"), solved.receptance)},
        coords={
            "frequency": frequency_coordinate(frequency),
            **place_coordinates("sensor", sensors),
            **place_coordinates("force", forces),
        },
        attrs={
            "convention": CONVENTION,
            "formulation": formulation,
            "permway_version": _core.__version__,
            "failures": "; ".join(solved.failures),
        },
    )
    data["receptance"].attrs = {"long_name": "receptance", "units": "m/N"}
    if temperature_C is not None:
        data.attrs["temperature_C"] = temperature_C
    if solved.extension is not None:
        data["extension"] = (("frequency", "joint", "force"), solved.extension)
        data["extension"].attrs = {"long_name": "joint extension, upper less lower", "units": "m/N"}
        data = data.assign_coords(joint_coordinates(line, solved.joints))
    return data


def between(
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
    on_error: OnError = "raise",
) -> Solved:
    """The same as plain arrays, for who solves thousands of times; see :func:`receptance`."""
    frequency = check_sweep(frequency_Hz)
    for where, chosen, choices in (
        ("formulation", formulation, get_args(Formulation)),
        ("on_error", on_error, get_args(OnError)),
    ):
        if chosen not in choices:
            raise InputError("unknown", where=where, value=chosen, remedy=f"use one of {list(choices)}")
    if isinstance(temperature_C, str | bool):
        raise InputError(
            "must be a number", where="temperature_C", value=temperature_C, remedy="in degrees Celsius"
        )
    pushed, read = check_places(line, forces, "forces"), check_places(line, sensors, "sensors")
    # Every line is reciprocal: it is of linear bodies and joints alone, and a place is pushed by what does work on
    # what is read there. A force costs a solve at every frequency, a sensor nearly nothing, so the side that has
    # fewer is pushed. What joints extend by belongs to the forces that are asked for.
    turned = not extensions and 0 < read["x"].size < pushed["x"].size
    solved = run(
        line,
        frequency,
        {"forces": read, "sensors": pushed} if turned else {"forces": pushed, "sensors": read},
        temperature_C=temperature_C,
        formulation=formulation,
        extensions=extensions,
        threads=threads,
        progress=progress,
        on_error=on_error,
    )
    return replace(solved, receptance=solved.receptance.transpose(0, 2, 1)) if turned else solved


def check_line(line: object, where: str = "line") -> None:
    """Refuse what is no line.

    Raises
    ------
    InputError
        For anything else, a model too.
    """
    must_be(line, Line, where, remedy="of a model it is model.line")


def check_given(places: object, where: str) -> None:
    """Refuse an empty list of places; what is none is refused with the places."""
    if isinstance(places, Sized) and not isinstance(places, str) and not len(places):
        raise InputError("none given", where=where, remedy="as in [Place(body=..., x_m=...)]")


def check_places(line: Line, places: Sequence[Place], where: str) -> dict[str, np.ndarray]:
    """Places as the core's columns: segment of each, and x.

    Raises
    ------
    InputError
        For a name that stands twice, and a place that is on no body, off it, or where two beams meet.
    """
    check_line(line)
    if isinstance(places, Place | str) or not isinstance(places, Iterable):
        remedy = "as in [Place(body=..., x_m=...)], also of one"
        raise InputError("must be a list of Places", where=where, value=places, remedy=remedy)
    for index, place in enumerate(places):
        if not isinstance(place, Place):
            raise InputError("must be a Place", where=f"{where}[{index}]", value=place)
    found, x = _placed(tuple(line.segments()), tuple(places), where)
    return {"body": found.copy(), "x": x.copy()}


# A diagnosis asks for the same places on thousands of lines, of which most have the same bodies.
@lru_cache(maxsize=64)
def _placed(segments: tuple[Segment, ...], places: tuple[Place, ...], where: str) -> tuple[Integers, Reals]:
    """Segment of each place, and x."""
    labels = [p.label for p in places]
    if len(set(labels)) < len(labels):
        index = next(i for i, label in enumerate(labels) if label in labels[:i])
        named = places[index].name is not None
        raise InputError(
            "the name stands twice" if named else "has no name, and the one made of its place stands twice",
            where=f"{where}[{index}]",
            value=labels[index],
            remedy="give each its own name",
        )
    found, x = np.zeros(len(places), dtype=np.int64), np.array([p.x_m for p in places], dtype=np.float64)
    for body in dict.fromkeys(p.body for p in places):
        mine = [index for index, place in enumerate(places) if place.body == body]
        found[mine] = find(segments, body, x[mine], partial(_which, where, mine))
    return found, x


def _which(where: str, indices: Sequence[int], index: int) -> str:
    return f"{where}[{indices[index]}]"


def check_sweep(frequency_Hz: ArrayLike) -> Reals:
    """Frequencies of a sweep as an array: one-dimensional, finite, positive, strictly ascending.

    Raises
    ------
    InputError
        Naming the first frequency at fault.
    """
    if frequency_Hz is None:
        raise InputError("must be given", where="frequency_Hz", remedy="as a list or an array in Hz")
    frequency = np.atleast_1d(real_numbers(frequency_Hz, "frequency_Hz"))
    if frequency.ndim != 1:
        raise InputError("frequencies must be a list", where="frequency_Hz", value=frequency.shape)
    if not frequency.size:
        raise InputError("none given", where="frequency_Hz", remedy="give one frequency in Hz at least")
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


def joint_coordinates(line: Line, table: JointTable) -> dict[str, object]:
    """Where the joints are, and of which law."""
    return {
        "joint_x": ("joint", table.x, {"units": "m"}),
        "joint_law": ("joint", [list(line.laws)[i] for i in table.law]),
    }


def place_coordinates(kind: str, places: Sequence[Place]) -> dict[str, object]:
    """Labels, bodies and x of forces or sensors."""
    return {
        kind: [p.label for p in places],
        f"{kind}_body": (kind, [p.body for p in places]),
        f"{kind}_x": (kind, [p.x_m for p in places], {"units": "m"}),
    }
