"""Frequency responses in a table of text: a row for each frequency, sensor and point."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.recordings.readers.limits import MOST_BYTES
from permway.recordings.readers.store_frf import COHERENCES, FREQUENCIES, REFERENCES, RESPONSES
from permway.recordings.readers.table import read_text_table
from permway.recordings.record import FrfRecord, TableRecord

REAL, IMAGINARY = {"real", "re"}, {"imaginary", "imag", "im"}
MAGNITUDE, PHASE = {"magnitude", "mag", "amplitude", "abs"}, {"phase", "phase_deg", "angle"}
DEGREES = {None, "deg", "degree", "degrees", "°"}

REMEDY = (
    "give a row for each frequency, sensor and point, with columns frequency, sensor, force, real and imaginary "
    "(or magnitude and phase in deg), and coherence"
)


def read_frf(source: Path, *, max_bytes: int = MOST_BYTES) -> FrfRecord:
    """Read frequency responses from a table of text.

    Raises
    ------
    InputError
        If a column is missing, cells are no numbers, or pairs do not have the same frequencies.
    """
    head = _named(read_text_table(source, max_bytes=max_bytes), (*RESPONSES, *REFERENCES))
    table = read_text_table(source, texts=head, max_bytes=max_bytes)
    frequency, column = _numbers(table, FREQUENCIES, "frequencies"), _one(table, FREQUENCIES, "frequencies")
    if table.units[column] not in (None, "Hz"):
        raise InputError("frequencies must be in Hz", where=f"{source}: '{column}'", value=table.units[column])
    sensors, points = _texts(table, RESPONSES, "sensors"), _texts(table, REFERENCES, "points")
    values, unit = _values(table)
    coherence = _numbers(table, COHERENCES, "coherence") if _named(table, tuple(COHERENCES)) else None
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
    return FrfRecord(
        responses=tuple(pair[0] for pair in rows),
        references=tuple(pair[1] for pair in rows),
        frequency_Hz=axis,
        values=values[order],
        coherence=None if coherence is None else coherence[order],
        unit=unit,
        averages=None,
        source=str(source),
    )


def _named(table: TableRecord, names: tuple[str, ...]) -> list[str]:
    return [column for column in table.columns if column.lower() in names]


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


def _values(table: TableRecord) -> tuple[Complexes, str | None]:
    """Of real and imaginary part, or of magnitude and phase, and the unit in their header."""
    if _named(table, tuple(REAL)):
        real = _numbers(table, REAL, "real parts")
        imaginary = _numbers(table, IMAGINARY, "imaginary parts")
        return np.asarray(real + 1j * imaginary, dtype=np.complex128), table.units[_one(table, REAL, "")]
    name = _one(table, MAGNITUDE, "real parts or magnitudes")
    phase = _one(table, PHASE, "phases")
    if table.units[phase] not in DEGREES:
        raise InputError("must be in deg", where=f"{table.source}: '{phase}'", value=table.units[phase])
    size, angle = _numbers(table, MAGNITUDE, "magnitudes"), np.deg2rad(_numbers(table, PHASE, "phases"))
    return np.asarray(size * np.exp(1j * angle), dtype=np.complex128), table.units[name]
