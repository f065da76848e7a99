"""The model file: TOML in, a validated model out."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from permway.errors import InputError, must_be
from permway.formats.model_parts import line_of, train_of
from permway.model.faults import model_error, refuse_coercion, table_at
from permway.problem.model import Model
from permway.reading import read_toml


def read_model(path: str | Path) -> Model:
    """Read and check a model file.

    Parameters
    ----------
    path : path
        TOML; see `docs/model-file.md`.

    Raises
    ------
    InputError
        With file, place in the file, value and remedy, for a file that cannot be read, is not TOML, or states
        something that cannot be.
    """
    must_be(path, (str, Path), "path", remedy="a table is read by model_from_dict")
    path = Path(path)
    table = read_toml(path, "name a model file (TOML)")
    try:
        return model_from_dict(table, folder=path.parent)
    except InputError as error:
        raise InputError(
            error.what, where=f"{path}: {error.where}", value=error.value, remedy=error.remedy
        ) from error


def model_from_dict(table: Mapping[str, Any], *, folder: Path | None = None) -> Model:
    """Build a model from a table, as TOML gives it; presets and law files are filled in.

    Parameters
    ----------
    table : mapping
    folder : path, optional
        Where the files of laws lie; without it the table must not name any.

    Raises
    ------
    InputError
        With the place in the table.
    """
    must_be(table, Mapping, "table", remedy="a file is read by read_model")
    # A model written as JSON states null where a file states nothing.
    filled = {key: value for key, value in table.items() if value is not None}
    if "line" in filled:
        filled["line"] = line_of(table_at(filled["line"], "line"), folder)
    if "train" in filled:
        filled["train"] = train_of(table_at(filled["train"], "train"))
    # Absurd numbers overflow on the way to the check that refuses them.
    with np.errstate(all="ignore"):
        try:
            model = Model.model_validate(filled)
        except ValidationError as error:
            raise model_error(error, filled, "") from error
        refuse_coercion(filled, model, "")
        model.check()
    return model
