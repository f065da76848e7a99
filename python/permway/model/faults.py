"""Where in a model file a fault lies, and what to say of it."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import PydanticCustomError

from permway.errors import InputError
from permway.records import FrozenModel, input_error, plain_words


def fault(what: str, *place: str | int, value: object = None) -> ValidationError:
    """A complaint of a validator about a part of its record, which keeps the part's place.

    Parameters
    ----------
    what : str
        What is wrong and what would be right.
    *place : str or int
        Keys and indices from the record down to the part.
    value : object, optional
        The value met, if `what` does not say it.
    """
    reported = PydanticCustomError("fault", "{what}", {"what": what})
    return ValidationError.from_exception_data("fault", [{"type": reported, "loc": place, "input": value}])


def model_error(error: ValidationError, table: Mapping[str, Any], place: str) -> InputError:
    """Turn the complaints about a table into an `InputError` with the place of the first in that table.

    Parameters
    ----------
    error : ValidationError
    table : mapping
        What was validated, as the file has it.
    place : str
        Name of the table itself; "" for the whole file.
    """
    return input_error(error, table, place, _words)


def _words(complaint: Mapping[str, Any]) -> tuple[str, object]:
    what, value = plain_words(complaint)
    context = complaint.get("ctx", {})
    match complaint["type"]:
        case "extra_forbidden":
            what, value = _unknown(str(complaint["loc"][-1])), None
        case "missing":
            what, value = "missing", None
        case "float_type" | "float_parsing":
            what = "must be a number"
        case "tuple_type":
            what = "must be a list"
        case "model_type" | "model_attributes_type" | "dict_type":
            what = "must be a table"
        case "union_tag_invalid":
            what = f"there is no type {context['tag']!r}; use one of {context['expected_tags']}"
        case "union_tag_not_found":
            what, value = "type is missing", None
    return what, value


def refuse_coercion(given: object, built: object, place: str) -> None:
    """Refuse text and truth values that were taken for numbers.

    Raises
    ------
    InputError
        Where the file has `"2.1e11"` or `true` and the record a number.
    """
    if isinstance(built, BaseModel) and isinstance(given, Mapping):
        for name, field in type(built).model_fields.items():
            key = field.alias or name
            if key in given:
                refuse_coercion(given[key], getattr(built, name), f"{place}.{key}" if place else key)
    elif isinstance(built, Mapping) and isinstance(given, Mapping):
        for key, item in built.items():
            refuse_coercion(given.get(key), item, f"{place}.{key}")
    elif isinstance(built, tuple) and isinstance(given, list | tuple):
        for index, (had, item) in enumerate(zip(given, built, strict=False)):
            refuse_coercion(had, item, f"{place}[{index}]")
    elif isinstance(built, int | float) and not isinstance(built, bool) and isinstance(given, str | bool):
        raise InputError("must be a number", where=place, value=given, remedy="write it without quotes")


def _unknown(key: str) -> str:
    known = _keys(FrozenModel)
    if key in known:
        return "does not belong in this table"
    close = difflib.get_close_matches(key, sorted(known), n=1)
    return "unknown key" + (f"; did you mean {close[0]!r}?" if close else "")


def _keys(model: type[BaseModel]) -> set[str]:
    own = {field.alias or name for name, field in model.model_fields.items()}
    return own.union(*(_keys(child) for child in model.__subclasses__()))


def table_at(value: object, where: str) -> dict[str, Any]:
    """A copy of a table, or an error with its place."""
    if not isinstance(value, Mapping):
        raise InputError("must be a table", where=where, value=value, remedy=f"write [{where}]")
    return dict(value)


def below(table: str, error: InputError) -> InputError:
    """The same complaint, its place taken to lie in a table."""
    return InputError(error.what, where=f"{table}.{error.where}", value=error.value, remedy=error.remedy)
