"""Columns of a material's table, read and checked."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.laws.column_units import MODULUS_UNITS
from permway.laws.columns import Column, Recognised
from permway.laws.dma_layout import Layout
from permway.laws.textfile import Line, number, read_lines

WAYS = tuple(
    frozenset(way)
    for way in (
        *(("storage", "loss"), ("storage", "loss_factor"), ("storage", "phase"), ("magnitude", "phase")),
        *(("magnitude", "loss_factor"), ("magnitude", "loss"), ("loss", "loss_factor"), ("loss", "phase")),
    )
)
"""Pairs of columns that give a complex modulus, the more direct first."""

_KELVIN_ABOVE_C = 200.0
"""No rubber is tested above: half would refuse tests of hot seals, twice would let most tables in kelvin pass."""

_COLDEST_C = -190.0
"""Liquid nitrogen cools a machine to -150 degC or so. Half would refuse cold tests; nothing is below -273.15."""

_UNSTATED_ABOVE_C = 140.0
"""Without a unit, above this, degrees Celsius, Fahrenheit and kelvin are all likely. Half would refuse warm
tests, twice would let kelvin pass."""

_MOST_LOSS_FACTOR = 6.0
"""Rubber at its glass transition has 1 to 3. Half would refuse damping rubber, twice let 7 % pass as 7."""

_PLAIN = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d{1,3})?", re.ASCII)


def refuse_missing(recognised: Recognised, where: str, *, frequency_Hz: float | None) -> None:
    """Refuse a table that lacks a column, or what stands in for it, and name what was not understood."""
    columns = recognised.columns
    missing: list[tuple[str, tuple[str, ...]]] = []
    if "frequency" not in columns and frequency_Hz is None:
        missing.append(("frequency", ("frequency",)))
    if not any(way <= columns.keys() for way in WAYS):
        if not columns.keys() & {"storage", "magnitude"}:
            missing.append(("storage", ("storage", "magnitude")))
        if not columns.keys() & {"loss", "loss_factor", "phase"}:
            missing.append(("loss or loss_factor", ("loss", "loss_factor", "phase")))
    if not missing:
        return
    faults = [recognised.faults[name] for _, names in missing for name in names if name in recognised.faults]
    advice = "name the columns as in freq_hz, temperature_C, G_storage_Pa, G_loss_Pa or tan_delta"
    if missing[0][0] == "frequency" and len(missing) == 1:
        advice += "; of a sweep at one frequency, give it: --frequency (Python: frequency_Hz=)"
    raise InputError(
        f"no column for {', '.join(name for name, _ in missing)}",
        where=where,
        value=sorted(column.header for column in columns.values()),
        remedy="; ".join([f"not understood: {_some(recognised.unread)}", *faults, advice]),
    )


def _some(headers: tuple[str, ...]) -> str:
    """The first headers, quoted."""
    shown = ", ".join(repr(header[:60]) for header in headers[:12])
    return (shown or "none") + (f" and {len(headers) - 12} more" if len(headers) > 12 else "")


def read_column(source: Path, layout: Layout, column: Column) -> Reals:
    """One column in SI."""
    values = np.empty(len(layout.rows))
    signed = column.quantity in ("temperature", "strain")
    for index, row in enumerate(layout.rows):
        if not layout.decimal_comma and _PLAIN.fullmatch(row.cells[column.index]):
            # The place is worded for what is wrong only: most cells are plain.
            values[index] = column.to_si(float(row.cells[column.index]))
            if np.isfinite(values[index]) and (signed or values[index] > 0.0):
                continue
        place = f"{source}: line {row.number}, column '{column.header}'"
        cell = row.cells[column.index]
        plain = cell.replace("−", "-")
        if layout.decimal_comma:
            if "." in plain:
                what = "a decimal point in a table with decimal commas"
                raise InputError(what, where=place, value=cell, remedy="write all numbers alike")
            plain = plain.replace(",", ".", 1)
        value = column.to_si(_number(plain, place))
        if not signed and value <= 0.0:
            raise InputError(
                "must be above zero",
                where=place,
                value=cell,
                remedy="check the sign, and leave quasi-static rows out of the sweep",
            )
        values[index] = value
    return values


def _number(cell: str, place: str) -> float:
    """A cell as a number, without Python's own ways to write one (1_000, full-width digits)."""
    if cell and not _PLAIN.fullmatch(cell) and ("_" in cell or not cell.isascii()):
        raise InputError(
            "not a number", where=place, value=cell, remedy="give a plain number, units in the header"
        )
    return number(cell, place)


def refuse_kelvin(source: Path, rows: list[Line], temperature: Reals, column: Column) -> None:
    """Refuse temperatures that can only be in kelvin, and high ones without a unit."""
    most = _KELVIN_ABOVE_C if column.unit else _UNSTATED_ABOVE_C
    hot = np.nonzero(temperature > most)[0]
    if len(hot):
        raise InputError(
            f"a temperature above {most:g} degC: kelvin given as degrees Celsius?",
            where=f"{source}: line {rows[hot[0]].number}, column '{column.header}'",
            value=float(temperature[hot[0]]),
            remedy="subtract 273.15, or name the column temperature_K",
        )
    at = int(temperature.argmin())
    if temperature[at] < _COLDEST_C:
        raise InputError(
            f"a temperature below {_COLDEST_C:g} degC, or absolute zero: degrees Celsius given as kelvin?",
            where=f"{source}: line {rows[at].number}, column '{column.header}'",
            value=f"{temperature[at]:.6g} degC",
            remedy="correct the value or the unit of the column",
        )


def refuse_percent(source: Path, rows: list[Line], loss_factor: Reals, column: Column) -> None:
    """Refuse a loss factor that can only be in per cent."""
    at = int(loss_factor.argmax())
    if loss_factor[at] > _MOST_LOSS_FACTOR:
        raise InputError(
            f"a loss factor above {_MOST_LOSS_FACTOR:g}: per cent?",
            where=f"{source}: line {rows[at].number}, column '{column.header}'",
            value=float(loss_factor[at]),
            remedy="name the column tan_delta_pct, or correct the value",
        )


def refuse_again(source: Path, rows: list[Line], frequency: Reals) -> None:
    """Refuse a table without temperatures whose frequencies come again: sweeps at several that nobody states."""
    _, first = np.unique(frequency, return_index=True)
    again = np.setdiff1d(np.arange(len(frequency)), first)
    if len(again):
        raise InputError(
            "the frequencies come again and no column states the temperature of each sweep",
            where=f"{source}: line {rows[again[0]].number}",
            value=f"{frequency[again[0]]:g} Hz",
            remedy="add a column temperature_C; if all rows are of one temperature, give it: --temperature",
        )


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
