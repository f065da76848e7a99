"""A model as a table that a model file may hold: presets spelled out, defaults left out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from permway.errors import InputError
from permway.problem.model import Model

KIND = "type"
"""The key that states which record a table is, written even where it is the default."""


def model_table(model: Model) -> dict[str, Any]:
    """The table of a model file; :func:`permway.formats.model_file.model_from_dict` makes the same model of it.

    Raises
    ------
    InputError
        If the model holds what no file can, as a law given as a function.
    """
    return {"format": 1, **_plain(model, "model")}


def _plain(value: Any, where: str) -> Any:
    match value:
        case BaseModel():
            found = {}
            for name, field in type(value).model_fields.items():
                inner = getattr(value, name)
                if inner is None or (name != KIND and inner == field.get_default(call_default_factory=True)):
                    continue
                found[field.alias or name] = _plain(inner, f"{where}.{name}")
            return found
        case Mapping():
            return {key: _plain(inner, f"{where}.{key}") for key, inner in value.items()}
        case tuple() | list():
            return [_plain(inner, f"{where}[{index}]") for index, inner in enumerate(value)]
        case bool() | int() | float() | str():
            return value
    raise InputError(
        f"a {type(value).__name__} cannot be written into a model file",
        where=where,
        remedy="replace it by a table over frequency",
    )
