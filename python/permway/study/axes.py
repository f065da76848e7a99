"""Axes of a study: what is varied, and over which values."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import Field, ValidationError, model_validator

from permway.arrays import Reals
from permway.errors import InputError
from permway.model.faults import fault, model_error
from permway.records import FrozenModel, Number
from permway.study.places import Steps, parse_place

MOST_CASES = 1_000_000

MOST_CELLS = 2 * MOST_CASES
"""Values that all axes may have together, one for each place: they are held in memory."""


class Range(FrozenModel):
    """Numbers between two ends: in steps, so many, or left open for a sample.

    Parameters
    ----------
    first, last : float
        The ends, `from` and `to` in the file; both belong to it.
    step : float, optional
    count : int, optional
    spacing : "linear" or "logarithmic"
        Of `count` numbers, or of a sample.
    """

    first: Number = Field(alias="from")
    last: Number = Field(alias="to")
    step: Number | None = Field(default=None, gt=0.0)
    count: int | None = Field(default=None, ge=2, le=MOST_CASES, strict=True)
    spacing: Literal["linear", "logarithmic"] = "linear"

    @model_validator(mode="after")
    def _check(self) -> Range:
        if not self.last > self.first:
            raise fault(f"must lie above from = {self.first:g}", "to", value=self.last)
        if not math.isfinite(self.last - self.first):
            raise fault("lies too far from `from`", "to", value=self.last)
        if self.step is not None and self.count is not None:
            raise ValueError("give step or count, not both")
        if self.spacing == "logarithmic" and (self.first <= 0.0 or self.step is not None):
            raise ValueError("equal ratios need from above 0, and count, not step")
        if self.step is not None and (self.last - self.first) / self.step >= MOST_CASES:
            raise fault(f"makes more than {MOST_CASES} values", "step", value=self.step)
        return self

    @property
    def is_open(self) -> bool:
        """Whether the numbers are left to a sample."""
        return self.step is None and self.count is None

    def values(self) -> list[float]:
        """The numbers of a range in steps or of so many."""
        if self.step is not None:
            count = math.floor((self.last - self.first) / self.step * (1.0 + 1e-12)) + 1
            return [self.first + self.step * i for i in range(count)]
        assert self.count is not None
        return self.between(np.arange(self.count) / (self.count - 1))

    def between(self, share: Reals) -> list[float]:
        """Numbers at shares of the way from 0 to 1."""
        if self.spacing == "logarithmic":
            values = self.first * (self.last / self.first) ** share
        else:
            values = self.first + (self.last - self.first) * share
        return [float(v) for v in np.clip(values, self.first, self.last).ravel()]


@dataclass(frozen=True)
class Axis:
    """One named axis.

    Attributes
    ----------
    name : str
    places : tuple of steps
        Where in the model its values go.
    rows : tuple of tuple
        For each point of the axis a value for every place; empty if `open_range` is to be sampled.
    labels : tuple of str, optional
        Names of the points.
    open_range : Range, optional
    """

    name: str
    places: tuple[Steps, ...]
    rows: tuple[tuple[Any, ...], ...]
    labels: tuple[str, ...] | None = None
    open_range: Range | None = None

    def coordinate(self) -> list[Any]:
        """What stands along the axis: labels, numbers, text, or else the values as JSON."""
        if self.labels is not None:
            return list(self.labels)
        values: list[Any] = [row[0] if len(row) == 1 else list(row) for row in self.rows]
        if all(isinstance(v, int | float) and not isinstance(v, bool) for v in values):
            return [float(v) for v in values]
        if all(isinstance(v, str) for v in values):
            return values
        return [json.dumps(v, sort_keys=True) for v in values]


def read_axes(tables: Mapping[str, object]) -> list[Axis]:
    """Build all axes of a study.

    Raises
    ------
    InputError
        With the place in the study file; for axes that are too long together.
    """
    axes: list[Axis] = []
    cells = 0
    for name, table in tables.items():
        axes.append(read_axis(name, table))
        cells += len(axes[-1].rows) * len(axes[-1].places)
        if cells > MOST_CELLS:
            raise InputError(
                f"makes more than {MOST_CELLS} values with the axes before it",
                where=f"axes.{name}",
                remedy="take fewer axes, or shorter ones",
            )
    return axes


def read_axis(name: str, table: object) -> Axis:
    """Build an axis from its table in the study file.

    Raises
    ------
    InputError
        With the place in the study file.
    """
    where = f"axes.{name}"
    if not name.isidentifier():
        raise InputError("a name has letters, digits and _, and begins with a letter", where=where, value=name)
    if not isinstance(table, Mapping):
        raise InputError("must be a table", where=where, value=table, remedy="give it path and values")
    unknown = set(table) - {"path", "paths", "values", "labels"}
    if unknown:
        raise InputError(
            "unknown key", where=f"{where}.{min(unknown)}", remedy="an axis has path or paths, values and labels"
        )
    if ("path" in table) == ("paths" in table):
        raise InputError("give path, or paths to set several together", where=where)
    if "values" not in table:
        raise InputError("missing", where=f"{where}.values", remedy="give a list, or { from, to, step or count }")
    together = "paths" in table
    places = _places(table["paths"], where) if together else (parse_place(table["path"], f"{where}.path"),)
    given = table["values"]
    if isinstance(given, Mapping):
        return _ranged(name, places, given, together, "labels" in table)
    rows = _rows(given, len(places), together, f"{where}.values")
    return Axis(name, places, rows, _labels(table.get("labels"), len(rows), f"{where}.labels"))


def _ranged(
    name: str, places: tuple[Steps, ...], given: Mapping[str, Any], together: bool, labelled: bool
) -> Axis:
    where = f"axes.{name}.values"
    if together or labelled:
        raise InputError("a range goes with one path and no labels", where=where, remedy="list the values")
    try:
        span = Range.model_validate(dict(given))
    except ValidationError as error:
        raise model_error(error, given, where) from error
    if span.is_open:
        return Axis(name, places, (), open_range=span)
    return Axis(name, places, tuple((v,) for v in span.values()))


def _places(paths: object, where: str) -> tuple[Steps, ...]:
    if not isinstance(paths, Sequence) or isinstance(paths, str) or not paths:
        raise InputError("must be a list of paths", where=f"{where}.paths", value=paths)
    return tuple(parse_place(path, f"{where}.paths[{i}]") for i, path in enumerate(paths))


def _rows(values: object, width: int, together: bool, where: str) -> tuple[tuple[Any, ...], ...]:
    if not isinstance(values, Sequence) or isinstance(values, str):
        raise InputError("must be a list, or a table { from, to, step or count }", where=where, value=values)
    if not values:
        raise InputError("the axis is empty", where=where, remedy="give at least one value")
    if len(values) > MOST_CASES:
        raise InputError(f"more than {MOST_CASES} values", where=where, value=len(values))
    seen: dict[str, int] = {}
    rows = []
    for i, value in enumerate(values):
        if together and (not isinstance(value, Sequence) or isinstance(value, str) or len(value) != width):
            raise InputError(
                f"must be a list of {width}, a value for each path", where=f"{where}[{i}]", value=value
            )
        try:
            text = json.dumps(value, sort_keys=True, allow_nan=False)
        except (TypeError, ValueError):
            raise InputError("no value of a model", where=f"{where}[{i}]", value=value) from None
        if text in seen:
            raise InputError(f"stands there already, at {seen[text]}", where=f"{where}[{i}]", value=value)
        seen[text] = i
        rows.append(tuple(value) if together else (value,))
    return tuple(rows)


def _labels(labels: object, count: int, where: str) -> tuple[str, ...] | None:
    if labels is None:
        return None
    if not isinstance(labels, Sequence) or isinstance(labels, str) or not all(isinstance(v, str) for v in labels):
        raise InputError("must be a list of texts", where=where, value=labels)
    if len(labels) != count or len(set(labels)) != count:
        raise InputError(f"must be {count}, one for each value, none twice", where=where, value=list(labels))
    return tuple(labels)
