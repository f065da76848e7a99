"""The study file: TOML in, a checked study out."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import ValidationError

from permway import _core
from permway.errors import InputError
from permway.formats.model_file import model_from_dict
from permway.model.faults import model_error
from permway.problem.model import Model
from permway.reading import LARGEST_TABLE, inside, read_bytes, read_toml
from permway.records import FrozenModel
from permway.study.axes import read_axes
from permway.study.places import replaced
from permway.study.plan import Combine, Plan, Sample, digest, make_dimensions


class _File(FrozenModel):
    format: Literal[1] = 1
    title: str = ""
    model: str | dict[str, Any]
    axes: dict[str, Any]
    combine: Combine = "product"
    sample: Sample | None = None
    keep: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Study:
    """A model, what is varied in it, and what is kept of the answers.

    Attributes
    ----------
    title : str
    table : dict
        The model's table before anything is set in it.
    folder : Path, optional
        Where files that the model names lie.
    keep : tuple of str, optional
        Variables kept; None for all.
    plan : Plan
    """

    title: str
    table: dict[str, Any]
    folder: Path | None
    keep: tuple[str, ...] | None
    plan: Plan

    def model(self, index: int) -> Model:
        """The model of a case.

        Raises
        ------
        InputError
            If the case's values make no model; the place states which case.
        """
        try:
            table = self.table
            for place, value in self.plan.settings(index):
                table = replaced(table, place, value)
            return model_from_dict(table, folder=self.folder)
        except InputError as error:
            values = ", ".join(f"{k} = {_short(v)}" for k, v in self.plan.stated(index).items())
            raise InputError(
                error.what, where=f"case {index} ({values}): {error.where}", value=error.value, remedy=error.remedy
            ) from error


def read_study(path: str | Path) -> Study:
    """Read and check a study file; its cases are checked when it is run.

    Parameters
    ----------
    path : path
        TOML; see `docs/study-file.md`.

    Raises
    ------
    InputError
        With file, place in the file, value and remedy.
    """
    path = Path(path)
    table = read_toml(path, "name a study file (TOML)")
    try:
        return study_from_dict(table, folder=path.parent)
    except InputError as error:
        raise InputError(
            error.what, where=f"{path}: {error.where}", value=error.value, remedy=error.remedy
        ) from error


def study_from_dict(table: Mapping[str, Any], *, folder: Path | None = None) -> Study:
    """Build a study from a table, as TOML gives it.

    Parameters
    ----------
    table : mapping
    folder : path, optional
        Where the model file and the files it names lie; without it the table must not name any.

    Raises
    ------
    InputError
        With the place in the table.
    """
    try:
        given = _File.model_validate(dict(table))
    except ValidationError as error:
        raise model_error(error, table, "") from error
    model = given.model
    if isinstance(model, str):
        if folder is None:
            raise InputError("a table without a folder cannot name a file", where="model", value=model)
        path = inside(model, folder, where="model", of="the study's", remedy="put it beside the study")
        model, folder = read_toml(path, "name a model file (TOML)", where=f"model: {model}"), path.parent
    if not given.axes:
        raise InputError("there is no axis", where="axes", remedy="say what is varied: [axes.NAME]")
    axes = read_axes(given.axes)
    if given.keep is not None and (not given.keep or len(set(given.keep)) < len(given.keep)):
        raise InputError("must name variables, none twice", where="keep", value=list(given.keep))
    dimensions = make_dimensions(axes, given.combine, given.sample)
    # Another version may compute other numbers; of a file its content counts.
    rows = [
        [place[-1], row[i]]
        for d in dimensions
        for a in d.axes
        for row in a.rows
        for i, place in enumerate(a.places)
    ]
    names = {*_file_names(model), *(n for key, value in rows for n in _file_names({key: value}))}
    files = {name: _content(name, folder) for name in sorted(names)}
    base = digest([_core.__version__, model, files, sorted(given.keep) if given.keep else None])
    return Study(given.title, model, folder, given.keep, Plan(dimensions, base))


def _file_names(value: object) -> Iterator[str]:
    """Texts under a key `file`, at any depth."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            if key == "file" and isinstance(item, str):
                yield item
            yield from _file_names(item)
    elif isinstance(value, list | tuple):
        for item in value:
            yield from _file_names(item)


def _content(name: str, folder: Path | None) -> str | None:
    """Hash of a file's content; None for one that the model will refuse."""
    if folder is None:
        return None
    try:
        path = inside(name, folder, where="file", of="the model's", remedy="")
        return hashlib.sha256(read_bytes(path, LARGEST_TABLE)).hexdigest()
    except InputError:
        return None


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
