"""Frozen, validated records, whose faults are stated with place, value and remedy."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Strict, ValidationError

from permway.errors import InputError


def _as_python(value: object) -> object:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


Number = Annotated[float, Strict(), BeforeValidator(_as_python)]
"""A float that takes integers and numpy's numbers, but neither text nor a truth value."""

FloatTuple = Annotated[tuple[Number, ...], BeforeValidator(_as_python)]
"""A tuple of such numbers that also takes a numpy array."""


class FrozenModel(BaseModel):
    """A frozen record whose faults are reported as :class:`permway.errors.InputError`."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def __init__(self, *values: object, **data: Any) -> None:
        if values:
            stated = ", ".join(
                f"{name}={_brief(value)}" for name, value in zip(_in_order(type(self)), values, strict=False)
            )
            raise InputError(
                "takes its values by name", where=type(self).__name__, remedy=f"{stated} if that is meant"
            )
        try:
            super().__init__(**{name: _unwarned(value) for name, value in data.items()})
        except ValidationError as error:
            raise input_error(error, data, type_name(type(self))) from error

    # Pydantic then builds nested records itself, so that a fault inside one keeps its full path.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]


def _in_order(model: type[BaseModel]) -> list[str]:
    """Names of a record's values, as a call would list them: those it needs first, without tags of files."""
    each = model.model_fields.items()
    fields = {field.alias or name: field for name, field in each if name not in ("type", "format")}
    return sorted(fields, key=lambda name: not fields[name].is_required())


def _brief(value: object) -> str:
    """A number or a text as it is, of anything longer its type."""
    text = repr(value)
    return text if len(text) <= 30 else f"<{type(value).__name__}>"


def _unwarned(value: object) -> object:
    """Complex numbers of numpy as Python's, which pydantic refuses; it would cut those of numpy with a warning."""
    if isinstance(value, np.complexfloating):
        return complex(value)
    if isinstance(value, list | tuple) and any(isinstance(item, np.complexfloating) for item in value):
        return [_unwarned(item) for item in value]
    return value


MOST_TOLD = 6
"""Further faults of a table that are named."""

Words = Callable[[Mapping[str, Any]], tuple[str, object]]
"""From one of pydantic's complaints to what is wrong and the value met."""


def input_error(error: ValidationError, table: object, place: str, words: Words | None = None) -> InputError:
    """Turn pydantic's complaints into one `InputError`: the first with its value, the others named behind it.

    Parameters
    ----------
    error : ValidationError
    table : object
        What was validated, to distinguish its keys from the tags that pydantic adds for unions.
    place : str
        Name of the table itself; "" for the whole file.
    words : callable, optional
        What to say of a complaint; by default what pydantic states.
    """
    words = words or plain_words
    every = error.errors(include_url=False)
    # A list whose items are all at fault is called empty, too.
    first, *others = [one for one in every if not (one["type"] == "too_short" and _holds_fault(one["loc"], every))]
    what, value = words(first)
    remedy = ""
    if others:
        each = [f"{place_in(table, one['loc'], place)}: {words(one)[0]}" for one in others[:MOST_TOLD]]
        reported = "; ".join(dict.fromkeys(each)) + ("; ..." if len(others) > MOST_TOLD else "")
        faults = "fault" if len(others) == 1 else "faults"
        remedy = f"{len(others)} further {faults} in the same {'table' if place else 'file'}: {reported}"
    return InputError(what, where=place_in(table, first["loc"], place), value=value, remedy=remedy)


def _holds_fault(location: tuple[str | int, ...], faults: Iterable[Mapping[str, Any]]) -> bool:
    """Whether something inside a place is at fault."""
    depth = len(location)
    return any(len(one["loc"]) > depth and one["loc"][:depth] == location for one in faults)


def plain_words(complaint: Mapping[str, Any]) -> tuple[str, object]:
    """What pydantic states, in shorter words where it has long ones, and the value met where it is not stated."""
    context = complaint.get("ctx", {})
    match complaint["type"]:
        case "missing":
            return "missing", None
        case "extra_forbidden":
            return "unknown name", None
        case "union_tag_invalid":
            return f"there is no type {context['tag']!r}; use one of {context['expected_tags']}", None
        case "union_tag_not_found":
            return "type is missing", None
    what = str(complaint["msg"]).removeprefix("Value error, ")
    value = None if complaint["type"] in ("missing", "value_error", "union_tag_invalid") else complaint["input"]
    return what[:1].lower() + what[1:], value


def type_name(model: type[BaseModel]) -> str:
    """The `type` of a record in a file, or else its class's name."""
    field = model.model_fields.get("type")
    return str(field.default) if field is not None else model.__name__


def place_in(table: object, location: tuple[str | int, ...], place: str = "") -> str:
    """Write pydantic's location as a place in the file, without the tags of unions: `line.joints[2].law`."""
    for part in location:
        if isinstance(table, BaseModel):
            table = table.model_dump(by_alias=True)
        if isinstance(part, int):
            place, table = f"{place}[{part}]", _item(table, part)
            continue
        if isinstance(table, Mapping) and part not in table and part == table.get("type"):
            continue
        place, table = f"{place}.{part}" if place else part, _item(table, part)
    return place or "the file"


def _item(table: object, key: str | int) -> object:
    try:
        return table[key]  # type: ignore[index]
    except (KeyError, IndexError, TypeError):
        return None
