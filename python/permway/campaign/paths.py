"""Numbers in a model or a campaign, found and replaced by path: `line.laws.pad.stiffness`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache, lru_cache
from typing import Any

from pydantic import BaseModel, ValidationError

from permway.errors import InputError
from permway.model.faults import model_error

Steps = tuple[str | int, ...]
Change = Callable[[float], float]
Changes = tuple[tuple[Steps, Change], ...]
Changed = dict[Steps, tuple[object, Changes, object]]
"""What was last made of the record at each place: the record, the changes below it, and the copy."""

_PART = re.compile(r"""(?:\.|^)([A-Za-z_][A-Za-z0-9_-]*)|\[(\d{1,9})\]|\["([^"\]]+)"\]""")


@lru_cache(maxsize=4096)
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
        If the path leads nowhere; its text states where it ends.
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
    return _number(steps, value_at(record, steps))


def _number(steps: Steps, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise KeyError(f"{written(steps)} is no number")
    return float(value)


def leads(record: object, steps: Steps) -> bool:
    """Whether there is a number at a path."""
    try:
        number_at(record, steps)
    except KeyError:
        return False
    return True


def with_numbers(record: Any, changes: Iterable[tuple[Steps, Change]], known: Changed | None = None) -> Any:
    """A copy with some numbers changed, those of one place in turn; what lies beside is shared, not copied.

    Of pydantic records only those that hold the numbers are checked again, so a copy costs microseconds; what
    records say of each other (names, places) a number cannot upset, or the core finds it.

    Parameters
    ----------
    record
        Of pydantic, a mapping, a list or a tuple.
    changes : iterable of (steps, callable)
    known : dict, optional
        Of the last call, brought up to date by this one: a part in which equal changes meet the same record again
        is not copied again. The changes must then tell by `==` whether they are equal.

    Raises
    ------
    InputError
        From the record that holds a number.
    KeyError
        If a path leads nowhere, or to no number.
    """
    found = tuple(changes)
    return _with(record, found, 0, known) if found else record


def _with(record: Any, changes: Changes, depth: int, known: Changed | None) -> Any:
    """All changes below a record, those that go the same way together."""
    place = changes[0][0][:depth]
    last = None if known is None else known.get(place)
    if last is not None and last[0] is record and last[1] == changes:
        return last[2]
    ways: dict[str | int, list[tuple[Steps, Change]]] = {}
    for steps, change in changes:
        ways.setdefault(_key(record, steps[depth], place), []).append((steps, change))
    news: dict[Any, Any] = {}
    ends: tuple[Steps, ...] = ()
    for key, mine in ways.items():
        child = _at(record, key)
        further = []
        for steps, change in mine:
            if len(steps) == depth + 1:
                child, ends = change(_number(steps, child)), (*ends, steps)
            else:
                further.append((steps, change))
        news[key] = _with(child, tuple(further), depth + 1, known) if further else child
    made = _copied(record, news, ends, changes[0][0][: depth + 1])
    if known is not None:
        known[place] = record, changes, made
    return made


def _copied(record: Any, news: dict[Any, Any], ends: tuple[Steps, ...], first: Steps) -> Any:
    """A record with some parts new: checked again where numbers are among them, which `ends` lead to."""
    if isinstance(record, BaseModel):
        if not ends and all(isinstance(new, BaseModel | Mapping | tuple) for new in news.values()):
            return record.model_copy(update=news)
        return _checked(record, news, (ends or (first,))[0])
    if isinstance(record, Mapping):
        return {**record, **news}
    return type(record)(news.get(index, item) for index, item in enumerate(record))


def _checked(record: BaseModel, news: Mapping[Any, object], steps: Steps) -> BaseModel:
    """The record with some fields changed, its own checks made again."""
    fields = type(record).model_fields
    table = {field.alias or key: getattr(record, key) for key, field in fields.items()}
    for name, value in news.items():
        whole = fields[name].annotation is int and isinstance(value, float) and value.is_integer()
        table[fields[name].alias or name] = int(value) if whole else value  # type: ignore[call-overload]
    try:
        return type(record).model_validate(table)
    except ValidationError as error:
        raise model_error(error, table, written(steps[:-1])) from error


def _child(record: object, step: str | int, before: Steps) -> object:
    return _at(record, _key(record, step, before))


def _at(record: Any, key: str | int) -> object:
    return getattr(record, str(key)) if isinstance(record, BaseModel) else record[key]


def _key(record: object, step: str | int, before: Steps) -> str | int:
    """What a step is to a record: a field by its own name, an item by its index.

    Raises
    ------
    KeyError
        If it has no such part.
    """
    found: str | int | None
    if isinstance(record, BaseModel):
        found = _field(record, step)
    elif isinstance(record, Mapping):
        found = step if step in record else None
    else:
        found = _index(record, step)
    if found is not None:
        return found
    if isinstance(record, BaseModel):
        known = [field.alias or key for key, field in type(record).model_fields.items()]
    else:
        known = [str(key) for key in record] if isinstance(record, Mapping) else []
    stated = f": it has {', '.join(known[:12])}{', ...' if len(known) > 12 else ''}" if known else ""
    raise KeyError(f"{written(before) or 'the file'} has no {step!r}{stated}")


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
