"""Numbers in a model or a campaign, found and replaced by path: `line.laws.pad.stiffness`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any

from pydantic import BaseModel, ValidationError

from permway.errors import InputError
from permway.model.faults import model_error

Steps = tuple[str | int, ...]

_PART = re.compile(r"""(?:\.|^)([A-Za-z_][A-Za-z0-9_-]*)|\[(\d{1,9})\]|\["([^"\]]+)"\]""")


def parse_path(path: str, where: str) -> Steps:
    """Split a path into keys and indices.

    Parameters
    ----------
    path : str
        Keys between dots, indices from 0 in brackets, names that are no plain words quoted in brackets:
        `line.joints[2].scale`, `campaign.sensors["rail@16"].chain.gain`.
    where : str
        The path's own place in the campaign file, for errors.

    Raises
    ------
    InputError
        If it is no such path.
    """
    steps: list[str | int] = []
    at = 0
    while at < len(path):
        match = _PART.match(path, at)
        if match is None or match.end() == at:
            break
        key, index, quoted = match.groups()
        steps.append(int(index) if index is not None else (key if key is not None else quoted))
        at = match.end()
    if at < len(path) or not steps or not isinstance(steps[0], str):
        raise InputError("is no path", where=where, value=path, remedy='write it as in "line.joints[2].scale"')
    return tuple(steps)


def written(steps: Steps) -> str:
    """The path as it is written in a file."""
    text = ""
    for step in steps:
        plain = isinstance(step, str) and re.fullmatch(r"[A-Za-z_][A-Za-z0-9_-]*", step)
        text += f".{step}" if plain else f"[{step}]" if isinstance(step, int) else f'["{step}"]'
    return text.removeprefix(".")


def value_at(record: object, steps: Steps) -> object:
    """What stands at a path in a record or in a table.

    Elements of a list are named by index, or by their `name`.

    Raises
    ------
    KeyError
        If the path leads nowhere; its text says where it ends.
    """
    for depth, step in enumerate(steps):
        record = _child(record, step, steps[:depth])
    return record


def number_at(record: object, steps: Steps) -> float:
    """The number at a path.

    Raises
    ------
    KeyError
        If there is nothing, or no number.
    """
    value = value_at(record, steps)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise KeyError(f"{written(steps)} is no number")
    return float(value)


def with_value(record: Any, steps: Steps, value: float) -> Any:
    """A copy with one number set; what lies beside the path is shared, not copied.

    Of pydantic records only the one that holds the number is checked again, so a copy costs microseconds; what
    records say of each other (names, places) a number cannot upset, or the core finds it.

    Raises
    ------
    InputError
        From the record that holds the number.
    KeyError
        If the path leads nowhere.
    """
    return _with(record, steps, 0, value)


def _with(record: Any, steps: Steps, depth: int, value: float) -> Any:
    if depth == len(steps):
        return value
    step = steps[depth]
    new = _with(_child(record, step, steps[:depth]), steps, depth + 1, value)
    if isinstance(record, BaseModel):
        name = _field(record, step)
        assert name is not None
        if depth + 1 < len(steps) and isinstance(new, BaseModel | Mapping | tuple):
            return record.model_copy(update={name: new})
        return _checked(record, name, new, steps)
    if isinstance(record, Mapping):
        return {**record, step: new}
    index = _index(record, step)
    assert index is not None
    return type(record)((*record[:index], new, *record[index + 1 :]))


def _checked(record: BaseModel, name: str, value: object, steps: Steps) -> BaseModel:
    """The record with one field changed, its own checks made again."""
    fields = type(record).model_fields
    table = {field.alias or key: getattr(record, key) for key, field in fields.items()}
    key = fields[name].alias or name
    given = fields[name].annotation
    table[key] = int(value) if given is int and isinstance(value, float) and value.is_integer() else value
    try:
        return type(record).model_validate(table)
    except ValidationError as error:
        raise model_error(error, table, written(steps[:-1])) from error


def _child(record: object, step: str | int, before: Steps) -> object:
    if isinstance(record, BaseModel):
        name = _field(record, step)
        if name is not None:
            return getattr(record, name)
    elif isinstance(record, Mapping):
        if step in record:
            return record[step]
    else:
        index = _index(record, step)
        if index is not None:
            return record[index]  # type: ignore[index]
    if isinstance(record, BaseModel):
        known = [field.alias or key for key, field in type(record).model_fields.items()]
    else:
        known = [str(key) for key in record] if isinstance(record, Mapping) else []
    said = f": it has {', '.join(known[:12])}{', ...' if len(known) > 12 else ''}" if known else ""
    raise KeyError(f"{written(before) or 'the file'} has no {step!r}{said}")


def _field(record: BaseModel, step: str | int) -> str | None:
    return _field_of(type(record), step)


@cache
def _field_of(kind: type[BaseModel], step: str | int) -> str | None:
    for name, field in kind.model_fields.items():
        if step in (field.alias, name):
            return name
    return None


def _index(record: object, step: str | int) -> int | None:
    if not isinstance(record, list | tuple):
        return None
    if isinstance(step, int):
        return step if step < len(record) else None
    named = [i for i, item in enumerate(record) if getattr(item, "name", None) == step]
    return named[0] if named else None
