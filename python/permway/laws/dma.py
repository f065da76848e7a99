"""Tables of dynamic mechanical analysis: what is in one, and reading it from a file."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from permway.arrays import Complexes, Reals, real_numbers
from permway.errors import InputError
from permway.laws.column_units import MODULUS, STIFFNESS
from permway.laws.columns import Column
from permway.laws.columns_read import (
    read_column,
    refuse_again,
    refuse_kelvin,
    refuse_missing,
    refuse_percent,
    two_columns,
    unit_scale,
)
from permway.laws.dma_layout import read_layout
from permway.laws.dma_values import storage_and_loss


@dataclass(frozen=True, kw_only=True)
class DmaTable:
    """Modulus, or a part's stiffness, against frequency and temperature.

    Attributes
    ----------
    frequency_Hz : ndarray, shape (n,)
        Hz.
    temperature_C : ndarray, shape (n,), or None
        Degrees Celsius; None if the source does not say.
    storage_Pa, loss_Pa : ndarray, shape (n,)
        Pa; N/m where `quantity` is "stiffness".
    quantity : {"modulus", "stiffness"}
        What the rows are of.
    strain : ndarray, shape (n,), or None
        Amplitude of dynamic strain, as a fraction.
    static_Pa : float or None
        Quasi-static modulus, if the source has one; never part of the rows above.
    source : str
        Where it came from.
    notes : tuple of str
        What the reader did beside reading.
    """

    frequency_Hz: Reals
    temperature_C: Reals | None
    storage_Pa: Reals
    loss_Pa: Reals
    quantity: Literal["modulus", "stiffness"] = "modulus"
    strain: Reals | None = None
    static_Pa: float | None = None
    source: str = ""
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        rows = len(self.frequency_Hz)
        for name in ("frequency_Hz", "temperature_C", "storage_Pa", "loss_Pa", "strain"):
            column = getattr(self, name)
            if column is None:
                continue
            fixed = real_numbers(column, name).copy()
            if fixed.shape != (rows,) or not np.isfinite(fixed).all():
                raise InputError(
                    "a column of a DMA table is finite and as long as frequency_Hz",
                    where=name,
                    value=fixed.shape,
                    remedy=f"give {rows} finite numbers",
                )
            if name not in ("temperature_C", "strain") and not (fixed > 0.0).all():
                raise InputError("must be above zero", where=name, value=float(fixed.min()))
            fixed.flags.writeable = False
            object.__setattr__(self, name, fixed)

    def __len__(self) -> int:
        return len(self.frequency_Hz)

    @property
    def modulus(self) -> Complexes:
        """Complex modulus, Pa (N/m of a stiffness), shape (n,)."""
        return np.asarray(self.storage_Pa + 1j * self.loss_Pa)

    @property
    def loss_factor(self) -> Reals:
        """Loss over storage, shape (n,)."""
        return np.asarray(self.loss_Pa / self.storage_Pa)

    def isotherms(self, gap_K: float = 1.0) -> Reals:
        """Mean temperature of each group of rows closer than `gap_K`, rising.

        A group wider than three gaps is a ramp, measured while the temperature rose, and cut into pieces so wide.
        """
        if self.temperature_C is None:
            return np.empty(0)
        ordered = np.sort(self.temperature_C)
        means: list[float] = []
        for group in np.split(ordered, np.nonzero(np.diff(ordered) > gap_K)[0] + 1):
            pieces = max(math.ceil((group[-1] - group[0]) / (3.0 * gap_K)), 1)
            edges = np.linspace(group[0], group[-1], pieces + 1)[1:-1]
            means += [float(part.mean()) for part in np.split(group, np.searchsorted(group, edges)) if part.size]
        return np.array(means)


def read_dma(
    path: str | Path,
    *,
    frequency_Hz: float | None = None,
    temperature_C: float | None = None,
    decimal: str | None = None,
    shape_factor_m: float | None = None,
) -> DmaTable:
    """Read a DMA table from a text file with a header.

    Columns are found by name and unit, in any order; see :mod:`permway.laws.columns` for the names. Needed are a
    storage modulus or stiffness, or an absolute value; a loss modulus, loss factor or phase; a frequency; a
    temperature unless the test was at an unstated one.

    Parameters
    ----------
    path : path
        Comma, semicolon, tab, bar or blanks between the cells; UTF-8, UTF-16 or Latin-1; lines above the header
        and lines that begin with # are passed over, a row of units may follow the header.
    frequency_Hz : float, optional
        Of a temperature sweep whose file has no frequency column.
    temperature_C : float, optional
        Of a frequency sweep whose file has no temperature column.
    decimal : {".", ","}, optional
        Found from the cells if not given.
    shape_factor_m : float, optional
        Stiffness of the part over modulus of its material, e A / h in m: makes a modulus of a table of stiffness.

    Returns
    -------
    DmaTable
        In SI units.

    Raises
    ------
    InputError
        For anything in the file that cannot be used, with line and column.
    """
    source = Path(path)
    layout = read_layout(source, decimal=decimal)
    columns, rows = layout.recognised.columns, layout.rows
    refuse_missing(layout.recognised, f"{source}: header (line {layout.header.number})", frequency_Hz=frequency_Hz)
    if not rows:
        raise InputError("a header but no rows", where=str(source), remedy="give at least one measured row")
    read = {name: read_column(source, layout, column) for name, column in columns.items()}
    frequency = _or_given(read.get("frequency"), frequency_Hz, len(rows), "frequency_Hz")
    assert frequency is not None
    temperature = _or_given(read.get("temperature"), temperature_C, len(rows), "temperature_C")
    if "temperature" in read:
        refuse_kelvin(source, rows, read["temperature"], columns["temperature"])
    elif "temperature" in layout.recognised.faults and temperature is None:
        raise InputError(
            "a column of temperatures that is not understood",
            where=f"{source}: header (line {layout.header.number})",
            remedy=layout.recognised.faults["temperature"],
        )
    elif temperature is None:
        refuse_again(source, rows, frequency)
    storage, loss = storage_and_loss(source, rows, read, columns)
    if "loss_factor" in read:
        refuse_percent(source, rows, read["loss_factor"], columns["loss_factor"])
    quantity, scale = _quantity(columns["storage" if "storage" in columns else _elastic(columns)], shape_factor_m)
    return DmaTable(
        frequency_Hz=frequency,
        temperature_C=temperature,
        storage_Pa=storage * scale,
        loss_Pa=loss * scale,
        quantity=quantity,
        strain=read.get("strain"),
        source=str(source),
        notes=(*layout.notes, *_assumed(columns), *_unused(columns, frequency_Hz, temperature_C)),
    )


def _or_given(column: Reals | None, given: float | None, count: int, name: str) -> Reals | None:
    """A column, or the one value that stands for it; where there are both the column is right, row by row."""
    if given is None or column is None:
        if given is not None and not (math.isfinite(given) and (name == "temperature_C" or given > 0.0)):
            raise InputError("must be a finite number, a frequency above zero", where=name, value=given)
        return column if given is None else np.full(count, float(given))
    return column


def _elastic(columns: dict[str, Column]) -> str:
    return "magnitude" if "magnitude" in columns else "loss"


def _quantity(column: Column, shape_factor_m: float | None) -> tuple[Literal["modulus", "stiffness"], float]:
    """What the rows are of, and the factor that makes them so."""
    if shape_factor_m is None:
        return ("stiffness" if column.elastic == STIFFNESS else "modulus"), 1.0
    if column.elastic == MODULUS:
        raise InputError(
            f"a shape factor goes with a stiffness, and column '{column.header}' is a modulus",
            where="shape_factor_m",
            value=shape_factor_m,
            remedy="leave the shape factor out; a pad's law takes area and thickness",
        )
    if not (math.isfinite(shape_factor_m) and shape_factor_m > 0.0):
        raise InputError("must be finite and above zero", where="shape_factor_m", value=shape_factor_m)
    return "modulus", 1.0 / shape_factor_m


def _unused(
    columns: dict[str, Column], frequency_Hz: float | None, temperature_C: float | None
) -> tuple[str, ...]:
    given = {"frequency": frequency_Hz, "temperature": temperature_C}
    return tuple(
        f"the {name} of each row is that of column '{columns[name].header}', not the one given, {value:g}"
        for name, value in given.items()
        if value is not None and name in columns
    )


def _assumed(columns: dict[str, Column]) -> tuple[str, ...]:
    units = {"frequency": "Hz", "temperature": "degrees Celsius"}
    if "frequency" in columns and columns["frequency"].factor != 1.0:
        units["frequency"] = "rad/s"
    return tuple(
        f"column '{columns[name].header}' has no unit; {unit} assumed"
        for name, unit in units.items()
        if name in columns and not columns[name].unit
    )


def read_modulus_pair(
    storage_path: str | Path,
    loss_path: str | Path,
    *,
    unit: str | None = None,
    temperature_C: float | None = None,
) -> DmaTable:
    """Join two headerless files, frequency with storage modulus and frequency with loss factor.

    A first line at 0 Hz is quasi-static and kept apart as `static_Pa`. The loss factor is interpolated over
    the logarithm of frequency onto the frequencies of the storage modulus that lie within its range;
    `notes` states how many fell outside.

    Parameters
    ----------
    storage_path, loss_path : path
        Two columns each.
    unit : {"Pa", "kPa", "MPa", "GPa"}, optional
        Of the modulus; else taken from the end of the file's name, as in `storage_modulus_MPa.tsv`.
    temperature_C : float, optional
        At which both were measured, if known.

    Returns
    -------
    DmaTable
        In SI units.

    Raises
    ------
    InputError
        For anything in either file that cannot be used, with line and column.
    """
    source, other = Path(storage_path), Path(loss_path)
    scale = unit_scale(source, unit)
    static, frequency, storage = two_columns(source, "storage modulus", scale)
    _, loss_frequency, loss_factor = two_columns(other, "loss factor", 1.0)
    inside = (frequency >= loss_frequency[0]) & (frequency <= loss_frequency[-1])
    if not inside.any():
        raise InputError(
            f"no frequency in common with {source}",
            where=str(other),
            value=(float(loss_frequency[0]), float(loss_frequency[-1])),
            remedy="give both over one band",
        )
    shifted = int(np.sum(~np.isin(frequency[inside], loss_frequency)))
    notes = (
        f"loss factor interpolated over log frequency at {shifted} of {int(inside.sum())} rows; "
        f"{int((~inside).sum())} rows of the storage modulus lie outside its range and were left out",
    )
    frequency, storage = frequency[inside], storage[inside]
    matched = np.interp(np.log(frequency), np.log(loss_frequency), loss_factor)
    return DmaTable(
        frequency_Hz=frequency,
        temperature_C=None if temperature_C is None else np.full(len(frequency), float(temperature_C)),
        storage_Pa=storage,
        loss_Pa=storage * matched,
        static_Pa=static,
        source=f"{source}, {other}",
        notes=notes,
    )
