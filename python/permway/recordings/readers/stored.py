"""Named arrays as a file holds them, not yet read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from permway.arrays import real_numbers
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit
from permway.recordings.readers.limits import MOST_BYTES, MOST_CHANNELS, check_size

MOST_TEXT_BYTES = 2**26
"""Names and units that take more memory are a damaged file's."""


UNITS = {"units", "unit", "channel_units"}


@dataclass(frozen=True)
class Variable:
    """A named array, not yet read.

    Attributes
    ----------
    name : str
    shape : tuple of int
        Without axes of length 1 only where `read` drops them too.
    kind : str
        "real", "complex" or "text".
    read : callable
        From a slice for each axis to the array.
    attributes : mapping
        Of the variable: units and the like.
    axes : tuple of str
        Names of the axes where the format has them, else empty.
    step : float or None
        Resolution of the numbers relative to their size, of binary formats their machine epsilon.
    item_bytes : int
        What one value takes in memory: a text's may be long.
    """

    name: str
    shape: tuple[int, ...]
    kind: str
    read: Callable[[tuple[slice, ...]], NDArray[np.generic]]
    attributes: Mapping[str, object] = field(default_factory=dict)
    axes: tuple[str, ...] = ()
    step: float = 2.0**-52
    item_bytes: int = 8

    @property
    def size(self) -> int:
        """Number of values."""
        total = 1
        for length in self.shape:
            total *= int(length)
        return total

    def all(self, where: str, *, max_bytes: int = MOST_BYTES) -> NDArray[np.generic]:
        """The whole array, if it is not too large."""
        check_size(
            self.size,
            f"{where}: '{self.name}'",
            max_bytes=max_bytes,
            item=16 if self.kind == "complex" else max(self.item_bytes, 8),
        )
        return self.read(tuple(slice(None) for _ in self.shape))

    def unit(self) -> str | None:
        """Its unit, if an attribute says it."""
        return next((clean_unit(value) for key, value in self.attributes.items() if key.lower() in UNITS), None)


@dataclass(frozen=True)
class Store:
    """The named arrays of a file."""

    source: str
    variables: Mapping[str, Variable]
    attributes: Mapping[str, object] = field(default_factory=dict)

    def texts(self, names: set[str]) -> tuple[str, ...] | None:
        """The texts of the first variable or attribute of one of these names."""
        for name, variable in self.variables.items():
            if name.lower() in names and variable.kind == "text":
                check_size(variable.size, f"{self.source}: '{name}'", max_bytes=8 * MOST_CHANNELS)
                cells = np.ravel(variable.all(self.source, max_bytes=MOST_TEXT_BYTES))
                return tuple(str(x).strip().strip("\x00") for x in cells)
        for name, value in self.attributes.items():
            if name.lower() in names:
                return (value,) if isinstance(value, str) else _texts(value)
        return None

    def number(self, names: set[str], attributes: Mapping[str, object] | None = None) -> float | None:
        """The number of the first variable or attribute of one of these names."""
        for name, variable in self.variables.items():
            if name.lower() in names and variable.kind == "real" and variable.size == 1:
                return self._positive(name, variable.all(self.source))
        for table in (self.attributes, attributes or {}):
            for name, value in table.items():
                if name.lower() in names:
                    return self._positive(name, value)
        return None

    def _positive(self, name: str, value: object) -> float:
        try:
            number = float(np.ravel(real_numbers(np.asarray(value), name))[0])
        except (TypeError, ValueError, IndexError):
            number = float("nan")
        if not (np.isfinite(number) and number > 0.0):
            where = f"{self.source}: '{name}'"
            raise InputError("must be a finite number above 0", where=where, value=value, remedy="correct it")
        return number


def _texts(value: object) -> tuple[str, ...] | None:
    parts = np.ravel(np.asarray(value))
    if parts.dtype.kind not in "USO":
        return None
    return tuple(x.decode("utf-8", "replace") if isinstance(x, bytes) else str(x) for x in parts)
