"""Named arrays as a file holds them, not yet read."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from permway.arrays import real_numbers
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit
from permway.recordings.readers.limits import MOST_BYTES, MOST_CHANNELS, check_size

MOST_TEXT_BYTES = 2**26
"""Names and units that take more memory are a damaged file's."""


OBJECT = (
    "an object of MATLAB (a table, timetable or string), which is not stored openly: save a struct of arrays, "
    "as by table2struct(T, 'ToScalar', true) with the rate beside it, or a text by writetimetable or writetable; "
    "or pip install 'permway[mat]' for tables and timetables"
)
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
        "real", "complex" or "text"; "unread" of what is left aside, which `reason` explains.
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
    resolution : float
        Of the numbers, absolute: of packed ones the factor of their scale.
    reason : str
        Why it is not read.
    ordered : bool
        Whether the format keeps axes in the order of whoever wrote them, as MATLAB's and NumPy's do. In HDF5 many
        programs write them turned.
    """

    name: str
    shape: tuple[int, ...]
    kind: str
    read: Callable[[tuple[slice, ...]], NDArray[np.generic]]
    attributes: Mapping[str, object] = field(default_factory=dict)
    axes: tuple[str, ...] = ()
    step: float = 2.0**-52
    item_bytes: int = 8
    resolution: float = 0.0
    reason: str = ""
    ordered: bool = False

    @property
    def leaf(self) -> str:
        """Its name without the group or struct that it is in."""
        return self.name.rpartition("/")[2]

    @property
    def folder(self) -> str:
        """The group or struct that it is in, empty for none."""
        return self.name.rpartition("/")[0]

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
        """Its unit, if an attribute states it."""
        return next((clean_unit(value) for key, value in self.attributes.items() if key.lower() in UNITS), None)


def unread(name: str, reason: str) -> Variable:
    """What is in the file and is left aside."""

    def refuse(_: tuple[slice, ...]) -> NDArray[np.generic]:
        raise InputError(reason, where=f"'{name}'")

    return Variable(name, (), "unread", refuse, reason=reason)


@dataclass(frozen=True)
class Store:
    """The named arrays of a file."""

    source: str
    variables: Mapping[str, Variable]
    attributes: Mapping[str, object] = field(default_factory=dict)

    def within(self, folder: str) -> Store | None:
        """The arrays of one group or struct, by their names in it; None if there is no such."""
        head = f"{folder.strip('/')}/"
        found = {
            name[len(head) :]: replace(variable, name=name[len(head) :])
            for name, variable in self.variables.items()
            if name.startswith(head)
        }
        return Store(self.source, found, self.attributes) if found else None

    def without_common(self) -> Store:
        """The same, where all arrays are in one group or struct by their names in it."""
        folders = {variable.folder for variable in self.variables.values()}
        common = folders.pop() if len(folders) == 1 else ""
        return (self.within(common) or self) if common else self

    def named(self, names: Collection[str], near: str | None = None) -> list[Variable]:
        """Arrays of one of these names: those beside `near`, a group or struct, else above it, else anywhere."""
        found = [variable for variable in self.variables.values() if is_one_of(variable.leaf, names)]
        folder = near
        while folder is not None:
            here = [variable for variable in found if variable.folder == folder]
            if here:
                return here
            folder = folder.rpartition("/")[0] if folder else None
        return found

    def texts(self, names: set[str], near: str | None = None) -> tuple[str, ...] | None:
        """The texts of the first variable or attribute of one of these names."""
        for variable in self.named(names, near):
            if variable.kind == "text":
                check_size(variable.size, f"{self.source}: '{variable.name}'", max_bytes=8 * MOST_CHANNELS)
                cells = np.ravel(variable.all(self.source, max_bytes=MOST_TEXT_BYTES))
                return tuple(str(x).strip().strip("\x00") for x in cells)
        for name, value in self.attributes.items():
            if name.lower() in names:
                return (value,) if isinstance(value, str) else _texts(value)
        return None

    def number(
        self, names: set[str], attributes: Mapping[str, object] | None = None, near: str | None = None
    ) -> float | None:
        """The number of the variables or else of the first attribute of one of these names.

        Raises
        ------
        InputError
            If it is not above 0, or if several variables, none of them nearer, have several.
        """
        found = [x for x in self.named(names, near) if x.kind == "real" and x.size == 1]
        each = {x.name: self._positive(x.name, x.all(self.source)) for x in found}
        if len(set(each.values())) > 1:
            remedy = "choose the group or struct in the record: part = ..."
            raise InputError("several values of one thing", where=self.source, value=each, remedy=remedy)
        if each:
            return next(iter(each.values()))
        for table in (attributes or {}, self.attributes):
            for name, value in table.items():
                if name.lower() in names:
                    return self._positive(name, value)
        return None

    def held(self) -> dict[str, str]:
        """What is there, for messages: kind and shape of each array, or why it is left aside."""
        return {
            name: variable.reason if variable.kind == "unread" else f"{variable.kind} {variable.shape}"
            for name, variable in list(self.variables.items())[:12]
        }

    def left_aside(self) -> InputError | None:
        """The error of the first array that is left aside."""
        for name, variable in self.variables.items():
            if variable.kind == "unread":
                return InputError(variable.reason, where=f"{self.source}: '{name}'")
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


def is_one_of(name: str, names: Collection[str]) -> bool:
    """Whether a name is among these, capitals aside but for single letters: F is a force, f a frequency."""
    return name in names or (len(name) > 1 and name.lower() in names)


def decoded(raw: bytes) -> str:
    """A text in UTF-8, or else in Latin-1 as older programs write it."""
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _texts(value: object) -> tuple[str, ...] | None:
    parts = np.ravel(np.asarray(value))
    if parts.dtype.kind not in "USO":
        return None
    return tuple(decoded(x) if isinstance(x, bytes) else str(x) for x in parts)
