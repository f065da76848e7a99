"""Laws measured or computed elsewhere: a table of complex numbers, or a Python function."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, model_validator

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.laws.base import Law
from permway.laws.frequency_table import check_columns, check_inside
from permway.laws.textfile import number, read_lines
from permway.records import FloatTuple

Quantity = Literal["dynamic_stiffness", "impedance", "apparent_mass"]
"""Force over displacement (N/m), over velocity (N s/m), over acceleration (kg)."""

_ORDER = {"dynamic_stiffness": 0, "impedance": 1, "apparent_mass": 2}
_COLUMNS = ("frequency_hz", "real", "imaginary")


def _to_stiffness(values: Complexes, omega: Reals, quantity: Quantity) -> Complexes:
    return np.asarray(values * (1j * omega) ** _ORDER[quantity], dtype=np.complex128)


class Measured(Law):
    """What a foundation, a damper or any structure answers at one point, as a table.

    Real and imaginary part are linear between the points over the logarithm of frequency, each as it was measured.
    A positive imaginary part of the dynamic stiffness, or real part of the impedance, is dissipation.

    Parameters
    ----------
    quantity : "dynamic_stiffness", "impedance" or "apparent_mass"
        Force over displacement (N/m), velocity (N s/m) or acceleration (kg).
    frequency_Hz : tuple of float, shape (n,)
        Strictly increasing, above zero, at least two.
    real, imaginary : tuple of float, shape (n,)

    Raises
    ------
    InputError
        On evaluation outside the table: it refuses to extrapolate.
    """

    type: Literal["measured"] = "measured"
    quantity: Quantity
    frequency_Hz: FloatTuple
    real: FloatTuple
    imaginary: FloatTuple

    @model_validator(mode="after")
    def _columns_fit(self) -> Measured:
        check_columns(self.frequency_Hz, real=self.real, imaginary=self.imaginary)
        return self

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        frequency = omega / (2.0 * np.pi)
        check_inside(frequency, self.frequency_Hz, "narrow the band, or measure wider")
        place, nodes = np.log(frequency), np.log(self.frequency_Hz)
        values = np.interp(place, nodes, self.real) + 1j * np.interp(place, nodes, self.imaginary)
        return _to_stiffness(np.asarray(values), omega, self.quantity)

    def _reach(self, temperature_C: float | None) -> tuple[float, float]:
        return self.frequency_Hz[0], self.frequency_Hz[-1]


class Given(Law):
    """A law as a Python function; from Python only, a file cannot hold it.

    Parameters
    ----------
    function : callable
        Takes frequencies in Hz, an array, and returns as many complex numbers.
    quantity : "dynamic_stiffness", "impedance" or "apparent_mass"
        What it returns: N/m, N s/m or kg.
    """

    type: Literal["given"] = "given"
    function: Callable[[Reals], Any] = Field(exclude=True)
    quantity: Quantity = "dynamic_stiffness"

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        try:
            values = np.asarray(self.function(omega / (2.0 * np.pi)), dtype=np.complex128)
        except (TypeError, ValueError) as error:
            raise InputError(f"the given function fails: {error}", where="function") from error
        if values.shape != omega.shape:
            raise InputError(
                "the given function must return one number for each frequency",
                where="function",
                value=values.shape,
                remedy=f"return an array of shape {omega.shape}",
            )
        return _to_stiffness(values, omega, self.quantity)


def read_measured(path: str | Path, quantity: Quantity) -> Measured:
    """Read a table with the columns `frequency_Hz`, `real` and `imaginary` (CSV or TSV).

    Raises
    ------
    InputError
        With line and column, for a file that cannot be read, a column that is missing, a cell that is no number.
    """
    header, *rows = read_lines(Path(path))
    names = [cell.lower() for cell in header.cells]
    missing = [name for name in _COLUMNS if name not in names]
    if missing:
        raise InputError(
            f"no column {missing[0].replace('hz', 'Hz')}",
            where=f"{path}, line {header.number}",
            value=list(header.cells),
            remedy="name the columns frequency_Hz, real and imaginary",
        )
    columns: list[list[float]] = [[], [], []]
    for row in rows:
        if len(row.cells) != len(names):
            raise InputError(
                f"{len(row.cells)} cells under {len(names)} columns",
                where=f"{path}, line {row.number}",
                remedy="give every row all cells",
            )
        for column, name in zip(columns, _COLUMNS, strict=True):
            place = f"{path}, line {row.number}, column {name.replace('hz', 'Hz')}"
            column.append(number(row.cells[names.index(name)], place))
    frequency, real, imaginary = columns
    return Measured(quantity=quantity, frequency_Hz=frequency, real=real, imaginary=imaginary)
