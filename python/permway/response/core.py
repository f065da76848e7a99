"""The call of the core: a line's tables in, arrays out, what fails stated in the user's words."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from permway import _core
from permway.arrays import Complexes, Reals
from permway.errors import InputError, SolveError
from permway.model.held_ends import held_ends, held_groups, with_held_ends
from permway.model.joint_table import JointTable
from permway.model.line import Line
from permway.response.limits import check_answer, check_dense, check_elements, check_threads

Formulation = Literal["chain", "receptance"]
OnError = Literal["raise", "mark"]
Progress = Callable[[int, int], object]
Columns = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Solved:
    """What the core returns.

    `receptance` (frequency, sensor, force), `extension` (frequency, joint, force), `derivatives` (frequency,
    parameter, sensor, force) and `own` (frequency, joint), in m/N; the table of joints; and the frequencies that
    failed, in words.
    """

    receptance: Complexes
    extension: Complexes | None
    derivatives: Complexes | None
    own: Complexes | None
    joints: JointTable
    failures: tuple[str, ...]


def run(
    line: Line,
    frequency: Reals,
    points: Mapping[str, Columns],
    *,
    temperature_C: float | None,
    formulation: Formulation = "chain",
    extensions: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
    on_error: OnError = "raise",
    derived: Mapping[str, Any] | None = None,
    joints: JointTable | None = None,
) -> Solved:
    """Solve checked frequencies and places.

    Parameters
    ----------
    points : mapping
        "forces" and "sensors", each as columns `body` and `x`.
    derived : mapping, optional
        What to derive, as the core's columns.
    joints : JointTable, optional
        The line's, if it is at hand.

    Raises
    ------
    InputError
        For a line that the formulation cannot solve, an answer too large to hold, tables that do not fit.
    SolveError
        If a frequency cannot be solved, unless failures are to be marked.
    """
    check_threads(threads)
    table = line.joint_table() if joints is None else joints
    pairs = line.beams()
    sensors, forces = len(points["sensors"]["x"]), len(points["forces"]["x"])
    check_answer(frequency.size, sensors + (table.x.size if extensions else 0), forces)
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
    beams, laws = line.beam_columns(), line.stiffness(frequency, temperature_C)
    columns = {name: getattr(table, name) for name in ("x", "upper", "lower", "law", "scale")}
    by_law = bool(derived.get("by_law")) if derived is not None else False
    derived = {key: value for key, value in derived.items() if key != "by_law"} if derived is not None else None
    held = held_ends(pairs, list(line.laws))
    if held:
        _check_chain(formulation, pairs[held[0].beam][1].body)
        beams, columns, laws = with_held_ends(held, beams, columns, laws)
        derived = None if derived is None else held_groups(held, derived, by_law=by_law)
    try:
        values, extension, derivatives, own, failures = _core.solve_line(
            formulation=formulation,
            frequencies=frequency,
            names=[s.name for s in line.segments()],
            beams=beams,
            masses=line.masses_kg(),
            joints=columns,
            laws=laws,
            forces=points["forces"],
            sensors=points["sensors"],
            extensions=extensions,
            threads=threads or os.cpu_count() or 1,
            progress=progress,
            derived=derived,
        )
    except _core.TablesError as error:
        raise InputError(str(error), where="line") from error
    if failures and on_error == "raise":
        more = f" (and {len(failures) - 1} more frequencies)" if len(failures) > 1 else ""
        raise SolveError(failures[0][2] + more)
    # The joints that hold ends come last, and are nobody's.
    extension = None if extension is None else extension[:, : table.x.size]
    own = None if own is None else own[:, : table.x.size]
    return Solved(values, extension, derivatives, own, table, tuple(text for _, _, text in failures))


def _check_chain(formulation: Formulation, body: str) -> None:
    if formulation != "chain":
        raise InputError(
            "clamped ends and rotational springs are for the chain formulation",
            where=f"line.bodies.{body}.ends",
            remedy='choose formulation = "chain"',
        )
