"""What a file holds, as it stands there: samples in time, frequency responses, tables. Nothing is scaled."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from permway.arrays import Complexes, Reals
from permway.errors import InputError

Name = TypeVar("Name")

COHERENCE_OFF = 1e-4
"""A coherence of one may stand as so much more: printed with few digits, or summed in single precision.

Half of it refuses none of the files met; twice of it neither. A percentage is 50 times too large or more.
"""


@dataclass(frozen=True, kw_only=True)
class TimeRecord:
    """Raw samples of one or more channels.

    Attributes
    ----------
    channels : tuple of str
        Each name once.
    units : tuple of (str or None)
        As found in the file; None where the file has none.
    values : ndarray, shape (channel, sample)
        As found, float64. Samples that are not finite are there only if the reader was reported to keep them.
    sampling_Hz : float or None
        None if the file has none.
    start_s : float or None
        Time of the first sample, if the file states it.
    source : str
        File, for messages.
    notes : tuple of str
        What the reader understood beside what stands in the file.
    """

    channels: tuple[str, ...]
    units: tuple[str | None, ...]
    values: Reals
    sampling_Hz: float | None
    start_s: float | None = None
    source: str = ""
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check_names(self.channels, self.source, "channel")
        if len(self.units) != len(self.channels):
            what = f"{len(self.units)} units for {len(self.channels)} channels"
            raise InputError(what, where=self.source or "units", remedy="give one each, None where there is none")
        _check_shape(self.values, (len(self.channels), None), self.source, "(channel, sample)")
        if self.sampling_Hz is not None and not (np.isfinite(self.sampling_Hz) and self.sampling_Hz > 0.0):
            raise InputError(
                "a sampling rate must be finite and above 0 Hz",
                where=f"{self.source}: sampling_Hz",
                value=self.sampling_Hz,
            )

    def __len__(self) -> int:
        return int(self.values.shape[1])

    @property
    def duration_s(self) -> float | None:
        """Samples over sampling rate, s; None without a rate."""
        return None if self.sampling_Hz is None else len(self) / self.sampling_Hz

    def index(self, name: str) -> int:
        """Row of a channel.

        Raises
        ------
        InputError
            If the file has no channel of this name.
        """
        return _find(self.channels, name, self.source, "channel")

    def channel(self, name: str) -> Reals:
        """Samples of a channel, shape (sample,)."""
        return np.asarray(self.values[self.index(name)])

    def unit(self, name: str) -> str:
        """Unit of a channel as found.

        Raises
        ------
        InputError
            If the file has no such channel, or no unit for it.
        """
        found = self.units[self.index(name)]
        if found is None:
            raise InputError(
                "has no unit",
                where=f"{self.source}: channel '{name}'",
                remedy="say it in the header, as in 'acc [m/s2]', or in the campaign file",
            )
        return found


@dataclass(frozen=True, kw_only=True)
class FrfRecord:
    """Frequency responses, one row for each measured pair of response and reference.

    Attributes
    ----------
    responses, references : tuple of str
        Of each row, as named in the file; in universal files node and direction, as "11632:+Z".
    frequency_Hz : ndarray, shape (frequency,)
        Rising strictly, from 0 Hz on.
    values : ndarray of complex128, shape (pair, frequency)
        As found.
    coherence : ndarray, shape (pair, frequency), or None
    unit : str or None
        Response over reference, as "(m/s^2)/N"; None if the file has none, or pairs differ.
    units : tuple of (str or None), or None
        Of each pair, where the file states them pair by pair.
    averages : int or None
        None if the file does not say.
    source : str
        File, for messages.
    """

    responses: tuple[str, ...]
    references: tuple[str, ...]
    frequency_Hz: Reals
    values: Complexes
    coherence: Reals | None = None
    unit: str | None = None
    units: tuple[str | None, ...] | None = None
    averages: int | None = None
    source: str = ""

    def __post_init__(self) -> None:
        where = self.source or "FRF"
        if len(self.responses) != len(self.references) or not self.responses:
            what = f"{len(self.responses)} responses and {len(self.references)} references"
            raise InputError(what, where=where, remedy="give one of each for every pair, one pair at least")
        twice = _first_twice(list(zip(self.responses, self.references, strict=True)))
        if twice is not None:
            raise InputError(
                "a pair measured twice",
                where=where,
                value=f"{twice[0]} / {twice[1]}",
                remedy="keep one, or put repeats into files of their own",
            )
        frequency = np.asarray(self.frequency_Hz)
        if frequency.ndim != 1 or not frequency.size or not np.isfinite(frequency).all() or frequency[0] < 0.0:
            raise InputError("frequencies are finite and from 0 Hz on", where=where, value=frequency.shape)
        step = np.flatnonzero(np.diff(frequency) <= 0.0)
        if step.size:
            at = int(step[0]) + 1
            what = "frequencies must rise strictly"
            raise InputError(what, where=f"{where}: frequency_Hz[{at}]", value=float(frequency[at]))
        wanted = (len(self.responses), frequency.size)
        _check_shape(self.values, wanted, where, "(pair, frequency)")
        if self.coherence is not None:
            _check_shape(self.coherence, wanted, where, "coherence (pair, frequency)")

    def unit_of(self, row: int) -> str | None:
        """Unit of a pair, by its row."""
        return self.unit if self.units is None else self.units[row]

    def of(self, responses: Sequence[str] | None, references: Sequence[str] | None) -> FrfRecord:
        """The pairs of these labels alone; all, if there is no such pair."""
        rows = [
            row
            for row, (response, reference) in enumerate(zip(self.responses, self.references, strict=True))
            if (responses is None or response in responses) and (references is None or reference in references)
        ]
        if not rows or len(rows) == len(self.responses):
            return self
        units = None if self.units is None else tuple(self.units[row] for row in rows)
        return replace(
            self,
            responses=tuple(self.responses[row] for row in rows),
            references=tuple(self.references[row] for row in rows),
            values=self.values[rows],
            coherence=None if self.coherence is None else self.coherence[rows],
            unit=self.unit if units is None else units[0] if len(set(units)) == 1 else None,
            units=units,
        )

    def with_unit(self, unit: str | None) -> FrfRecord:
        """The same in a unit that was stated, if one was."""
        return self if unit is None else replace(self, unit=unit, units=None)

    def check_ratio(self) -> None:
        """Refuse levels: decibels have neither a phase nor a size without their reference.

        Raises
        ------
        InputError
            With the first pair in decibels.
        """
        for row in range(len(self.responses)):
            unit = self.unit_of(row)
            if unit is not None and re.search(r"(?<![A-Za-z])dB(?![A-Za-z])", unit):
                where = f"{self.source or 'FRF'}: {self.responses[row]} / {self.references[row]}"
                remedy = "export real and imaginary part, or magnitude and phase, in a plain unit"
                raise InputError(
                    "a frequency response in decibels is no ratio", where=where, value=unit, remedy=remedy
                )

    def check_finite(self, used: NDArray[np.bool_]) -> None:
        """Refuse numbers that are not finite on the lines that are used, shape (frequency,).

        Raises
        ------
        InputError
            With pair and frequency of the first, and their number.
        """
        tables = {"the response": self.values} | (
            {} if self.coherence is None else {"the coherence": self.coherence}
        )
        for name, table in tables.items():
            bad = ~np.isfinite(table) & used
            if name == "the coherence":
                # A pair without a coherence has NaN on all lines.
                bad &= ~np.isnan(table).all(axis=1, keepdims=True)
            if bad.any():
                row, line = (int(i) for i in np.argwhere(bad)[0])
                where = f"{self.source or 'FRF'}: {self.responses[row]} / {self.references[row]}"
                raise InputError(
                    f"{name} is empty or not a finite number ({int(bad.sum())} such here)",
                    where=f"{where}, {self.frequency_Hz[line]:g} Hz",
                    value=complex(table[row, line]) if np.iscomplexobj(table) else float(table[row, line]),
                    remedy=_line_remedy(self.frequency_Hz, used, line),
                )

    def check_coherence(self) -> None:
        """Refuse a coherence that is none.

        Raises
        ------
        InputError
            With pair, frequency and value of the first beyond 0 and 1.
        """
        if self.coherence is None:
            return
        where = self.source or "FRF"
        off = (self.coherence < -COHERENCE_OFF) | (self.coherence > 1.0 + COHERENCE_OFF)
        # Nothing uses 0 Hz, where programs divide by what is not there.
        bad = np.argwhere(off & (self.frequency_Hz > 0.0))
        if len(bad):
            row, line = (int(i) for i in bad[0])
            raise InputError(
                "coherence lies between 0 and 1",
                where=f"{where}: {self.responses[row]} / {self.references[row]}, {self.frequency_Hz[line]:g} Hz",
                value=float(self.coherence[row, line]),
                remedy="see whether another function was taken for it",
            )

    def index(self, response: str, reference: str) -> int:
        """Row of a pair.

        Raises
        ------
        InputError
            If the file has no such response, reference, or pair of the two.
        """
        _find(tuple(dict.fromkeys(self.responses)), response, self.source, "response")
        _find(tuple(dict.fromkeys(self.references)), reference, self.source, "reference")
        for row, pair in enumerate(zip(self.responses, self.references, strict=True)):
            if pair == (response, reference):
                return row
        raise InputError(
            "this pair was not measured", where=self.source or "FRF", value=f"{response} / {reference}"
        )

    def pair(self, response: str, reference: str) -> Complexes:
        """Frequency response of a pair, shape (frequency,)."""
        return np.asarray(self.values[self.index(response, reference)])


def _line_remedy(frequency_Hz: Reals, used: NDArray[np.bool_], line: int) -> str:
    """What takes one line out of a record: a band can do it at its ends alone."""
    at = float(frequency_Hz[line])
    inside = used & (frequency_Hz < at)
    if inside.any() and (used & (frequency_Hz > at)).any():
        return f"measure it again, or delete all rows of {at:g} Hz in a copy of the file (of arrays their entries)"
    low, high = (at, None) if not inside.any() else (None, at)
    side = f"above {low:g} Hz" if high is None else f"below {high:g} Hz"
    return f"measure it again, or keep to lines {side} by the record's band_Hz"


Cells = Reals | tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class TableRecord:
    """Columns by name, all of one length.

    Attributes
    ----------
    columns : dict of name to ndarray, shape (row,), or tuple of str
        Numbers or texts. An empty cell in a column of numbers is NaN; no other NaN is ever there.
    units : dict of name to (str or None)
        As found; None where the file has none.
    source : str
        File, for messages.
    """

    columns: dict[str, Cells]
    units: dict[str, str | None]
    source: str = ""

    def __post_init__(self) -> None:
        where = self.source or "table"
        _check_names(tuple(self.columns), where, "column")
        if set(self.units) != set(self.columns):
            raise InputError("units and columns have other names", where=where, value=sorted(self.units))
        rows = len(self)
        for name, cells in self.columns.items():
            if len(cells) != rows or (isinstance(cells, np.ndarray) and cells.ndim != 1):
                raise InputError(f"{len(cells)} cells, not {rows}", where=f"{where}: column '{name}'")

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    def numbers(self, name: str) -> Reals:
        """A column of numbers, shape (row,).

        Raises
        ------
        InputError
            If there is no such column, or it holds texts.
        """
        _find(tuple(self.columns), name, self.source, "column")
        cells = self.columns[name]
        if not isinstance(cells, np.ndarray):
            what = "holds texts, not numbers"
            raise InputError(what, where=f"{self.source}: column '{name}'", value=cells[0] if cells else None)
        return cells

    def texts(self, name: str) -> tuple[str, ...]:
        """A column of texts, or of numbers written as `%g`."""
        _find(tuple(self.columns), name, self.source, "column")
        cells = self.columns[name]
        return tuple(f"{x:g}" for x in cells) if isinstance(cells, np.ndarray) else cells


BandTable = TableRecord
"""A table whose columns are named by the middles of frequency bands is a table as any other."""


def _check_names(names: tuple[str, ...], source: str, what: str) -> None:
    if not names:
        raise InputError(f"no {what}", where=source or what, remedy="give one at least")
    twice = _first_twice(names)
    if twice is not None:
        raise InputError(f"a {what} named twice", where=source or what, value=twice, remedy="names must differ")


def _first_twice(names: Sequence[Name]) -> Name | None:
    seen: set[Name] = set()
    for name in names:
        if name in seen:
            return name
        seen.add(name)
    return None


def _check_shape(values: NDArray[np.generic], wanted: tuple[int | None, ...], source: str, meaning: str) -> None:
    fits = values.ndim == len(wanted) and all(
        n is None or n == m for n, m in zip(wanted, values.shape, strict=True)
    )
    if not fits:
        raise InputError(f"values must have the shape {meaning}", where=source or "values", value=values.shape)


def _find(names: tuple[str, ...], name: str, source: str, what: str) -> int:
    if name not in names:
        known = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
        raise InputError(f"there is no such {what}", where=source or what, value=name, remedy=f"it has {known}")
    return names.index(name)
