"""Columns of a material's table, read and checked."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.laws.columns import MODULUS_UNITS, Column
from permway.laws.textfile import Line, number, read_lines

_KELVIN_ABOVE_C = 200.0


_DISAGREE = 0.05
"""Relative difference between tan delta and loss/storage beyond rounding of either."""


def refuse_missing(columns: dict[str, Column], source: Path, frequency_Hz: float | None) -> None:
    """Refuse a table that lacks a column, or what stands in for it."""
    missing = [name for name in ("frequency", "storage") if name not in columns]
    if "frequency" in missing and frequency_Hz is not None and frequency_Hz > 0.0:
        missing.remove("frequency")
    if "loss" not in columns and "loss_factor" not in columns:
        missing.append("loss or loss_factor")
    if missing:
        raise InputError(
            f"no column for {', '.join(missing)}",
            where=f"{source}: header",
            value=sorted(column.header for column in columns.values()),
            remedy="name the columns as in freq_hz, temperature_C, G_storage_Pa, G_loss_Pa or tan_delta",
        )


def read_column(source: Path, rows: list[Line], header: Line, column: Column) -> Reals:
    """One column in SI."""
    values = np.empty(len(rows))
    for index, row in enumerate(rows):
        if len(row.cells) != len(header.cells):
            raise InputError(
                f"{len(row.cells)} cells where the header has {len(header.cells)}",
                where=f"{source}: line {row.number}",
                value=",".join(row.cells),
                remedy="complete or remove the line (a file cut short ends like this)",
            )
        place = f"{source}: line {row.number}, column '{column.header}'"
        value = column.to_si(number(row.cells[column.index], place))
        if column.quantity not in ("temperature", "strain") and value <= 0.0:
            raise InputError(
                "must be above zero",
                where=place,
                value=row.cells[column.index],
                remedy="check the sign, and leave quasi-static rows out of the sweep",
            )
        values[index] = value
    return values


def refuse_kelvin(source: Path, rows: list[Line], temperature: Reals, column: Column) -> None:
    """Refuse temperatures that can only be in kelvin."""
    hot = np.nonzero(temperature > _KELVIN_ABOVE_C)[0]
    if len(hot):
        raise InputError(
            f"a temperature above {_KELVIN_ABOVE_C:g} degC: kelvin given as degrees Celsius?",
            where=f"{source}: line {rows[hot[0]].number}, column '{column.header}'",
            value=float(temperature[hot[0]]),
            remedy="subtract 273.15, or name the column temperature_K",
        )


def loss_of(source: Path, rows: list[Line], read: dict[str, Reals], columns: dict[str, Column]) -> Reals:
    """The loss modulus, also from the loss factor; where there are both they have to agree."""
    if "loss" not in read:
        return read["storage"] * read["loss_factor"]
    if "loss_factor" in read:
        ratio = read["loss"] / read["storage"]
        apart = np.nonzero(np.abs(ratio - read["loss_factor"]) > _DISAGREE * np.abs(ratio))[0]
        if len(apart):
            at = apart[0]
            raise InputError(
                f"loss over storage is {ratio[at]:.4g}, which the loss factor beside it contradicts",
                where=f"{source}: line {rows[at].number}, column '{columns['loss_factor'].header}'",
                value=float(read["loss_factor"][at]),
                remedy="mixed units or a shifted column? correct or remove one of the two",
            )
    return read["loss"]


def unit_scale(source: Path, unit: str | None) -> float:
    """Factor to Pa of a unit, or of the end of a file's name."""
    name = unit if unit is not None else source.stem.rsplit("_", 1)[-1]
    scale = MODULUS_UNITS.get(name.lower())
    if scale is None:
        raise InputError(
            "the unit of the modulus is not known",
            where=str(source) if unit is None else "unit",
            value=name,
            remedy='say unit="MPa" (Pa, kPa, MPa, GPa) or end the file name in _MPa',
        )
    return scale


def two_columns(source: Path, what: str, scale: float) -> tuple[float | None, Reals, Reals]:
    """The modulus at rest, if the first line is 0 Hz; frequencies; and values in SI."""
    static: float | None = None
    pairs: list[tuple[float, float]] = []
    for line in read_lines(source):
        place = f"{source}: line {line.number}"
        if len(line.cells) != 2:
            raise InputError(
                f"{len(line.cells)} cells where frequency and {what} are expected",
                where=place,
                value=" ".join(line.cells),
                remedy="give two columns",
            )
        frequency = number(line.cells[0], f"{place}, column 'frequency'")
        value = scale * number(line.cells[1], f"{place}, column '{what}'")
        if not math.isfinite(value) or value <= 0.0:
            raise InputError("must be above zero", where=f"{place}, column '{what}'", value=line.cells[1])
        if frequency == 0.0 and not pairs and static is None:
            static = value
            continue
        if frequency <= (pairs[-1][0] if pairs else 0.0):
            raise InputError(
                "frequencies rise strictly from above 0 (a first line at 0 Hz is the quasi-static one)",
                where=f"{place}, column 'frequency'",
                value=frequency,
                remedy="sort the lines by frequency",
            )
        pairs.append((frequency, value))
    if not pairs:
        raise InputError("no rows above 0 Hz", where=str(source), remedy="give at least one")
    table = np.array(pairs)
    return static, table[:, 0], table[:, 1]
