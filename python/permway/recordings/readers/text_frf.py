"""Frequency responses in a table of text: a row for each frequency, sensor and point, or side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.recordings.readers import text_frf_wide
from permway.recordings.readers.headers import clean_unit
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES
from permway.recordings.readers.scales import hertz_in
from permway.recordings.readers.store_frf import COHERENCES, FREQUENCIES, REFERENCES, RESPONSES
from permway.recordings.readers.stored import is_one_of
from permway.recordings.readers.table import read_text_table
from permway.recordings.readers.text_numbers import (
    complex_number,
    degrees_in,
    is_complex,
    polar,
    signs_of,
    sizes_of,
)
from permway.recordings.record import FrfRecord, TableRecord
from permway.units import check_same

REAL, IMAGINARY = {"real", "re"}, {"imaginary", "imag", "im"}
MAGNITUDE, PHASE = (
    {"magnitude", "mag", "amplitude", "abs"},
    {"phase", "phase_deg", "phase_rad", "angle", "angle_deg", "angle_rad"},
)
REMEDY = (
    "give a row for each frequency, sensor and point, with columns frequency, sensor, force, real and imaginary "
    "(or magnitude, and phase [deg] or phase [rad]), and coherence; or side by side, named "
    "'read / struck real' and 'read / struck imaginary'"
)


def read_frf(
    source: Path,
    *,
    responses: Sequence[str] | None = None,
    references: Sequence[str] | None = None,
    hints: Hints = NO_HINTS,
    max_bytes: int = MOST_BYTES,
) -> FrfRecord:
    """Read frequency responses from a table of text.

    Columns that name sensors or points make it a table with a row for each frequency, sensor and point; else they
    stand side by side: see :mod:`permway.recordings.readers.text_frf_wide`.

    Raises
    ------
    InputError
        If a column is missing, cells are no numbers, or pairs do not have the same frequencies.
    """
    beside = text_frf_wide.read_frf(
        source, responses=responses, references=references, hints=hints, max_bytes=max_bytes
    )
    if beside is not None:
        return beside
    head = _named(read_text_table(source, hints=hints, max_bytes=max_bytes), (*RESPONSES, *REFERENCES))
    table = read_text_table(source, texts=head, hints=hints, max_bytes=max_bytes)
    frequency, column = _numbers(table, FREQUENCIES, "frequencies"), _one(table, FREQUENCIES, "frequencies")
    frequency = frequency * hertz_in(hints.unit_of(column) or table.units[column], f"{source}: '{column}'")
    sensors, points = _texts(table, RESPONSES, "sensors"), _texts(table, REFERENCES, "points")
    values, unit = _values(table, hints)
    coherence = None
    if _named(table, tuple(COHERENCES)):
        percent = table.units[_one(table, COHERENCES, "coherence")] == "%"
        coherence = _numbers(table, COHERENCES, "coherence") / (100.0 if percent else 1.0)
    rows: dict[tuple[str, str], list[int]] = {}
    for index, pair in enumerate(zip(sensors, points, strict=True)):
        rows.setdefault(pair, []).append(index)
    first, *others = rows
    axis = frequency[rows[first]]
    for pair in others:
        mine = frequency[rows[pair]]
        if mine.size != axis.size or not np.array_equal(mine, axis):
            raise InputError(
                f"does not have the frequencies of {first[0]} < {first[1]}, in their order",
                where=f"{source}: {pair[0]} < {pair[1]}",
                value=f"{mine.size} of {axis.size} rows, from {mine[0]:g} Hz",
                remedy="write every pair at the same frequencies",
            )
    order = np.array(list(rows.values()))
    units = _row_units(table, rows, unit)
    if units is not None and len(set(units)) == 1:
        unit, units = units[0], None
    return FrfRecord(
        responses=tuple(pair[0] for pair in rows),
        references=tuple(pair[1] for pair in rows),
        frequency_Hz=axis,
        values=values[order],
        coherence=None if coherence is None else coherence[order],
        unit=unit if units is None else None,
        units=units,
        averages=None,
        source=str(source),
    )


def _row_units(
    table: TableRecord, rows: dict[tuple[str, str], list[int]], header: str | None
) -> tuple[str | None, ...] | None:
    """The unit of each pair, of a column of units; None without such a column.

    Raises
    ------
    InputError
        If it changes within a pair, or is not what the header states.
    """
    named = _named(table, ("unit", "units"))
    cells = table.columns[named[0]] if len(named) == 1 else None
    if cells is None or isinstance(cells, np.ndarray):
        return None
    found: list[str | None] = []
    for pair, at in rows.items():
        where = f"{table.source}: '{named[0]}', {pair[0]} < {pair[1]}"
        each = list(dict.fromkeys(cells[i].strip() for i in at))
        if len(each) > 1:
            remedy = "write each response in one unit"
            raise InputError("several units of one response", where=where, value=each[:4], remedy=remedy)
        unit = clean_unit(each[0])
        if unit is not None and header is not None:
            check_same(unit, header, where=where)
        found.append(unit or header)
    return tuple(found)


def _named(table: TableRecord, names: tuple[str, ...]) -> list[str]:
    return [column for column in table.columns if is_one_of(column, names)]


def _one(table: TableRecord, names: set[str], what: str) -> str:
    found = _named(table, tuple(names))
    if len(found) != 1:
        what = f"no column of {what}" if not found else f"more than one column of {what}"
        raise InputError(what, where=table.source, value=found or list(table.columns)[:12], remedy=REMEDY)
    return found[0]


def _numbers(table: TableRecord, names: set[str], what: str) -> Reals:
    name = _one(table, names, what)
    cells = table.columns[name]
    if not isinstance(cells, np.ndarray):
        raise InputError("must hold numbers", where=f"{table.source}: '{name}'", value=cells[0], remedy=REMEDY)
    return np.asarray(cells, dtype=np.float64)


def _texts(table: TableRecord, names: tuple[str, ...], what: str) -> tuple[str, ...]:
    return tuple(str(cell) for cell in table.columns[_one(table, set(names), what)])


def _values(table: TableRecord, hints: Hints) -> tuple[Complexes, str | None]:
    """Of real and imaginary part, or of magnitude and phase, and the unit in their header."""
    whole = [
        name
        for name, cells in table.columns.items()
        if not isinstance(cells, np.ndarray) and any(map(is_complex, cells))
    ]
    if len(whole) == 1:
        return _complexes(table, whole[0]), table.units[whole[0]]
    if _named(table, tuple(REAL)):
        real = _numbers(table, REAL, "real parts")
        imaginary = _numbers(table, IMAGINARY, "imaginary parts")
        names = _one(table, REAL, ""), _one(table, IMAGINARY, "")
        unit, other = (table.units[name] for name in names)
        if unit is not None and other is not None:
            check_same(other, unit, where=f"{table.source}: '{names[1]}'")
        return np.asarray(real + 1j * imaginary, dtype=np.complex128), unit or other
    name = _one(table, MAGNITUDE, "real parts or magnitudes")
    size = _numbers(table, MAGNITUDE, "magnitudes")
    unit = hints.channel_unit(name) or table.units[name]
    size, unit = sizes_of(size, unit, f"{table.source}: '{name}'", name)
    return polar(size, _numbers(table, PHASE, "phases") * _degrees(table, hints)), unit


def _complexes(table: TableRecord, name: str) -> Complexes:
    """Of a column of complex text."""
    where = f"{table.source}: '{name}'"
    cells = [str(cell) for cell in table.columns[name]]
    if signs_of(cells) == {".", ","}:
        remedy = "write all numbers alike"
        raise InputError(
            "decimal points and decimal commas in one column", where=where, value=cells[0], remedy=remedy
        )
    return np.array([complex_number(cell, where) for cell in cells], dtype=np.complex128)


def _degrees(table: TableRecord, hints: Hints) -> float:
    """Degrees in one of the phase's unit, which the header, the name or the caller has to say.

    Raises
    ------
    InputError
        If none does, or it is no angle.
    """
    name = _one(table, PHASE, "phases")
    where = f"{table.source}: '{name}'"
    unit = hints.unit_of(name) or table.units[name] or name.lower().partition("_")[2] or None
    if unit is None:
        remedy = f"write it as in 'phase [deg]', or say it in the record: unit = {{ {name} = \"rad\" }}"
        raise InputError("a phase without a unit: degrees or radians?", where=where, remedy=remedy)
    found = degrees_in(unit)
    if found is None:
        raise InputError("must be in deg or rad", where=where, value=unit, remedy="export it in degrees")
    return found
