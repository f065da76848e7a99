"""The plan of a study: its dimensions, and which values a case of a given index takes."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import Field

from permway.errors import InputError
from permway.records import FrozenModel
from permway.study.axes import MOST_CASES, Axis
from permway.study.places import Steps, written

_TAKEN = {"case", "sample", "case_status"}
Combine = Literal["product", "zip", "sample"]


class Sample(FrozenModel):
    """A sample over all axes whose range is open.

    Parameters
    ----------
    count : int
    seed : int
        The same seed gives the same sample.
    method : "sobol" or "latin_hypercube"
    """

    count: int = Field(ge=1, le=MOST_CASES, strict=True)
    seed: int = Field(default=0, ge=0, strict=True)
    method: Literal["sobol", "latin_hypercube"] = "sobol"

    def shares(self, axes: int) -> np.ndarray[Any, np.dtype[np.float64]]:
        """Points in the unit cube, shape (count, axes)."""
        # Half a second to load, which only samples need.
        from scipy.stats import qmc

        random = np.random.default_rng(self.seed)
        if self.method == "latin_hypercube":
            return np.asarray(qmc.LatinHypercube(axes, seed=random).random(self.count))
        # Sobol's points are balanced in powers of two.
        bits = max(math.ceil(math.log2(self.count)), 0)
        return np.asarray(qmc.Sobol(axes, seed=random).random_base2(bits))[: self.count]


@dataclass(frozen=True)
class Dimension:
    """One dimension of the answer: an axis, or several that go together."""

    name: str
    axes: tuple[Axis, ...]

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.axes[0].rows)


Settings = list[tuple[Steps, Any]]


@dataclass(frozen=True)
class Plan:
    """Dimensions of a study and what its cases are made of.

    Attributes
    ----------
    dimensions : tuple of Dimension
        Cases are their product, the last running fastest.
    base : str
        Hash of all that the cases have in common.
    """

    dimensions: tuple[Dimension, ...]
    base: str

    @property
    def shape(self) -> tuple[int, ...]:
        """Cases along each dimension."""
        return tuple(d.size for d in self.dimensions)

    @property
    def cases(self) -> int:
        """Number of cases."""
        return math.prod(self.shape)

    def settings(self, index: int) -> Settings:
        """Places in the model, and the values a case sets there."""
        at = np.unravel_index(index, self.shape)
        return [
            (place, value)
            for dimension, i in zip(self.dimensions, at, strict=True)
            for axis in dimension.axes
            for place, value in zip(axis.places, axis.rows[int(i)], strict=True)
        ]

    def stated(self, index: int) -> dict[str, Any]:
        """A case's values by their paths, for people."""
        return {written(place): value for place, value in self.settings(index)}

    def file_name(self, index: int) -> str:
        """The case's file: its index, and a hash of the model and of what is kept."""
        return f"case-{index:06d}-{digest([self.base, self.settings(index)])[:16]}.nc"

    def hash(self) -> str:
        """Hash of the whole study."""
        axes = [[d.name, [[a.name, a.places, a.rows, a.labels] for a in d.axes]] for d in self.dimensions]
        return digest([self.base, axes])


def digest(value: object) -> str:
    """Hash of plain data, by its JSON."""
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=str).encode()).hexdigest()


def make_dimensions(axes: Sequence[Axis], combine: Combine, sample: Sample | None) -> tuple[Dimension, ...]:
    """Arrange axes in dimensions.

    Raises
    ------
    InputError
        If they do not go together, set the same place, or make more than :data:`MOST_CASES` cases.
    """
    _check_places(axes)
    sampled = [axis for axis in axes if axis.open_range is not None]
    if combine != "sample":
        if sampled:
            raise InputError(
                "a range needs step or count",
                where=f"axes.{sampled[0].name}.values",
                remedy='only a sample (combine = "sample") leaves it open',
            )
        if sample is not None:
            raise InputError("does not go with this combine", where="sample", remedy='write combine = "sample"')
    if combine == "zip":
        sizes = {axis.name: len(axis.rows) for axis in axes}
        if len(set(sizes.values())) > 1:
            raise InputError("axes that run together must be equally long", where="axes", value=sizes)
        dimensions = [Dimension("case", tuple(axes))]
    elif combine == "sample":
        if sample is None or not sampled:
            raise InputError(
                "a sample needs [sample] with count and seed, and an axis with values = { from, to }",
                where="combine",
            )
        dimensions = [_sampled(sampled, sample)]
        dimensions += [Dimension(axis.name, (axis,)) for axis in axes if axis.open_range is None]
    else:
        dimensions = [Dimension(axis.name, (axis,)) for axis in axes]
    if any(axis.name in _TAKEN for axis in axes):
        raise InputError(
            f"an axis cannot be named any of {sorted(_TAKEN)}", where="axes", remedy="name it otherwise"
        )
    cases = math.prod(d.size for d in dimensions)
    if cases > MOST_CASES:
        raise InputError(
            f"too many cases, at most {MOST_CASES}", where="axes", value=cases, remedy="take a sample"
        )
    return tuple(dimensions)


def _sampled(axes: list[Axis], sample: Sample) -> Dimension:
    shares = sample.shares(len(axes))
    filled = []
    for i, axis in enumerate(axes):
        assert axis.open_range is not None
        rows = tuple((value,) for value in axis.open_range.between(shares[:, i]))
        filled.append(Axis(axis.name, axis.places, rows))
    return Dimension("sample", tuple(filled))


def _check_places(axes: Sequence[Axis]) -> None:
    """Refuse two axes for one place, or for a place and a part of it."""
    taken: list[tuple[Steps, str]] = []
    for axis in axes:
        for place in axis.places:
            for other, name in taken:
                shorter = min(len(place), len(other))
                if place[:shorter] == other[:shorter]:
                    raise InputError(
                        f"duplicate axis: {written(other)} is set by axes.{name}",
                        where=f"axes.{axis.name}",
                        value=written(place),
                    )
            taken.append((place, axis.name))
