"""The irregularity of a model file, whatever else the file lacks."""

from __future__ import annotations

from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from permway.errors import InputError
from permway.model.faults import model_error, refuse_coercion, table_at
from permway.model.irregularity import AnyIrregularity
from permway.reading import read_toml

_ADAPTER: TypeAdapter[AnyIrregularity] = TypeAdapter(AnyIrregularity)


def irregularity_of(path: str | Path) -> AnyIrregularity:
    """Read the table `[irregularity]` of a TOML file; the rest of it is not looked at.

    Raises
    ------
    InputError
        With file and place, for a file that cannot be read, has no such table, or states there what cannot be.
    """
    path = Path(path)
    content = read_toml(path, "name a model file (TOML)")
    if "irregularity" not in content:
        raise InputError(
            "has no irregularity",
            where=str(path),
            value=sorted(content),
            remedy='write [irregularity] with type = "german_low" or another of the model file\'s',
        )
    try:
        table = table_at(content["irregularity"], "irregularity")
        try:
            found = _ADAPTER.validate_python(table)
        except ValidationError as error:
            raise model_error(error, table, "irregularity") from error
        refuse_coercion(table, found, "irregularity")
    except InputError as error:
        raise InputError(
            error.what, where=f"{path}: {error.where}", value=error.value, remedy=error.remedy
        ) from error
    return found
