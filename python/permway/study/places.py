"""Places in a model's table: `line.joints[2].scale`."""

from __future__ import annotations

import re
from typing import Any

from permway.errors import InputError

Steps = tuple[str | int, ...]

_PART = re.compile(r"([A-Za-z_][A-Za-z0-9_-]*)((?:\[\d{1,9}\])*)")


def parse_place(path: object, where: str) -> Steps:
    """Split a path into keys and indices.

    Parameters
    ----------
    path : object
        Keys between dots, indices from 0 in brackets.
    where : str
        The path's own place in the study file, for errors.

    Raises
    ------
    InputError
        If it is no such path.
    """
    steps: list[str | int] = []
    for part in path.split(".") if isinstance(path, str) else [""]:
        match = _PART.fullmatch(part)
        if match is None:
            raise InputError(
                "is no path in a model", where=where, value=path, remedy='write it as in "line.joints[2].scale"'
            )
        steps.append(match[1])
        steps += [int(index) for index in re.findall(r"\d+", match[2])]
    return tuple(steps)


def replaced(table: Any, steps: Steps, value: Any) -> Any:
    """A copy of a table with one value set; what lies beside the path is shared, not copied.

    Tables on the way that the file leaves out are made: whether the keys in them mean anything, the model states.

    Raises
    ------
    InputError
        If the path leads through a value that holds no others, or to an element that a list does not have.
    """
    return _replaced(table, steps, 0, value)


def _replaced(table: Any, steps: Steps, depth: int, value: Any) -> Any:
    if depth == len(steps):
        return value
    step = steps[depth]
    if isinstance(step, int):
        if not isinstance(table, list | tuple):
            raise _no_way(steps, depth, "is no list", table)
        if step >= len(table):
            raise _no_way(steps, depth, f"has no element {step}: it has {len(table)}, counted from 0", None)
        return [*table[:step], _replaced(table[step], steps, depth + 1, value), *table[step + 1 :]]
    if table is None and depth:
        table = {}
    if not isinstance(table, dict):
        raise _no_way(steps, depth, f"is no table, so it has no {step!r}", table)
    return {**table, step: _replaced(table.get(step), steps, depth + 1, value)}


def written(steps: Steps) -> str:
    """The path as it is written in a study file."""
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in steps)
    return text.removeprefix(".")


def _no_way(steps: Steps, depth: int, what: str, value: object) -> InputError:
    reason = f"unknown path: {written(steps[:depth]) or 'the model'} {what}"
    return InputError(reason, where=written(steps), value=value)
