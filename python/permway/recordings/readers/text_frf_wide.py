"""Frequency responses side by side in a table of text: a column, or a pair of columns, for each response."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.laws.textfile import Line
from permway.recordings.readers.headers import clean_unit, is_unit, split_header
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.scales import hertz_in
from permway.recordings.readers.store_frf import FREQUENCIES, REFERENCES, RESPONSES
from permway.recordings.readers.stored import is_one_of
from permway.recordings.readers.table import check_rows, lines_of
from permway.recordings.readers.text_lines import is_number
from permway.recordings.readers.text_numbers import (
    complex_number,
    degrees_in,
    in_decibels,
    is_complex,
    polar,
    signs_of,
    sizes_of,
)
from permway.recordings.record import FrfRecord
from permway.units import check_same

_WORDS = {
    **dict.fromkeys(("real", "re", "realteil", "real part", "realpart"), "real"),
    **dict.fromkeys(
        ("imaginary", "imag", "im", "imaginary part", "imag part", "imagpart", "imaginärteil"), "imag"
    ),
    **dict.fromkeys(("magnitude", "mag", "amplitude", "ampl", "abs", "betrag"), "size"),
    **dict.fromkeys(("phase", "angle", "arg", "phasenwinkel"), "angle"),
    **dict.fromkeys(("coherence", "coh", "gamma2", "g2", "kohärenz"), "coherence"),
}
"""What a column holds, by the word at either end of its name."""

_WORD = "|".join(sorted(map(re.escape, _WORDS), key=len, reverse=True))
_AT_END = re.compile(rf"(?P<stem>.*?)(?:^|[\s_\-.:|,;(\[]+)(?P<word>{_WORD})[)\]]?", re.IGNORECASE)
_AT_START = re.compile(rf"(?P<word>{_WORD})(?:$|[\s_\-.:|,;(\[{{]+(?P<stem>.*?)[)\]}}]?)", re.IGNORECASE)
_FUNCTION = re.compile(
    r"(?:frf|h|h1|h2|hv|tf|transfer function)\s*(?:[\s:_]\s*(?P<a>.+)|[(\[](?P<b>.+)[)\]])", re.I
)
_SCALE = re.compile(r"(?P<stem>.*?)(?:^|[\s_\-.]+)(?P<scale>log|lin)", re.IGNORECASE)
_SPECTRUM = re.compile(r"\b(?:[GSP](?:xx|xy|yx|yy)|psd|csd|asd|(?:cross|auto|power)[ -]?spec\w*)\b")
_MOST_HEADS = 4
ALONE = ("response", "reference")
"""Labels of a response that its table does not name."""

_FREQUENCY = FREQUENCIES | {"frequenz", "frequence", "fréquence", "freq."}


@dataclass(frozen=True)
class _Column:
    """A column: its whole name, its unit, what it holds and of which response, and its cells."""

    name: str
    unit: str | None
    part: str
    stem: str
    index: int


def read_frf(
    source: Path,
    *,
    responses: Sequence[str] | None = None,
    references: Sequence[str] | None = None,
    hints: Hints = NO_HINTS,
    max_bytes: int = MOST_BYTES,
) -> FrfRecord | None:
    """Read frequency responses side by side: complex text, real and imaginary part, or magnitude and phase.

    A column is named by its response and reference, "rail@8.64 / 3.20 real", and by what it holds; `pairs` of the
    hints states what a name without a stroke means.

    Returns
    -------
    FrfRecord or None
        None if the table has no frequencies with responses beside them, or has columns of sensors or points.

    Raises
    ------
    InputError
        If a part of a response that is asked for is missing, has no unit of angle, or is no number.
    """
    check_size(source.stat().st_size, str(source), max_bytes=max_bytes, item=32)
    names, units, rows = _head(lines_of(source, hints))
    at = _frequency(names, units)
    if at is None or any(is_one_of(name, (*RESPONSES, *REFERENCES)) for name in names):
        return None
    columns = _columns(names, units, rows, at)
    stems = list(dict.fromkeys(column.stem for column in columns if column.part != "coherence"))
    if not stems:
        return None
    check_rows(source, names, rows)
    table = _Table(source, rows, columns, hints)
    pairs = _pairs(source, stems, hints)
    spectrum = next((stem for stem in stems if _SPECTRUM.search(stem)), None)
    if spectrum is not None and not hints.pairs:
        what = "seems to be a spectrum, and no frequency response"
        remedy = "if it is one, say what was read and struck: pairs = { ... }; else export the record in time"
        raise InputError(what, where=str(source), value=spectrum, remedy=remedy)
    chosen = [
        stem
        for stem in stems
        if (responses is None or pairs[stem][0] in responses)
        and (references is None or pairs[stem][1] in references)
    ] or stems
    frequency = table.reals(_Column(names[at], units[at], "frequency", "", at))
    where = f"{source}: '{names[at]}'"
    parts = [table.response(stem) for stem in chosen]
    coherence = [table.coherence(stem) for stem in chosen]
    stated = {unit for _, unit in parts}
    return FrfRecord(
        responses=tuple(pairs[stem][0] for stem in chosen),
        references=tuple(pairs[stem][1] for stem in chosen),
        frequency_Hz=frequency * hertz_in(hints.unit_of(names[at]) or units[at], where),
        values=np.array([values for values, _ in parts]),
        coherence=None
        if all(row is None for row in coherence)
        else np.array([np.full(frequency.size, np.nan) if row is None else row for row in coherence]),
        unit=stated.pop() if len(stated) == 1 else None,
        units=tuple(unit for _, unit in parts),
        averages=None,
        source=str(source),
    )


def names_of(source: Path, hints: Hints = NO_HINTS) -> list[str]:
    """Names of the responses of a table, as its columns have them; "" of one that has none."""
    names, units, rows = _head(lines_of(source, hints))
    at = _frequency(names, units)
    columns = [] if at is None else _columns(names, units, rows, at)
    return list(dict.fromkeys(column.stem for column in columns if column.part != "coherence"))


def _head(lines: list[Line]) -> tuple[list[str], list[str | None], list[Line]]:
    """Names and units of the columns, from one to four lines above the numbers."""
    first = next(
        (i for i, line in enumerate(lines) if any(is_number(cell) or is_complex(cell) for cell in line.cells[:1])),
        0,
    )
    heads = lines[:first]
    if not heads or len(heads) > _MOST_HEADS:
        return [], [], lines
    width = len(heads[-1].cells)
    if any(len(line.cells) != width for line in heads):
        return [], [], lines
    whole: list[list[str]] = [[] for _ in range(width)]
    units: list[str | None] = [None] * width
    for number, line in enumerate(heads):
        # A name above two columns stands once where programs join cells.
        over = ""
        for i, cell in enumerate(line.cells):
            if number and _is_unit_cell(cell):
                units[i] = units[i] or clean_unit(cell)
                continue
            over = cell or (over if i > 1 and number + 1 < len(heads) else "")
            whole[i] += [over] if over else []
    names = [" ".join(parts) for parts in whole]
    split = [_name_and_unit(name) for name in names]
    return [name for name, _ in split], [a or b for (_, a), b in zip(split, units, strict=True)], lines[first:]


def _is_unit_cell(cell: str) -> bool:
    """Whether a cell below the first line of a header holds a unit."""
    bare = clean_unit(cell) or ""
    return is_unit(bare) or degrees_in(bare) is not None or (in_decibels(bare) and bare.startswith("dB"))


def _name_and_unit(text: str) -> tuple[str, str | None]:
    """Of "H1 Phase (deg)" and "Mag (dB re 1 (m/s2)/N)", too, which are no units of quantities."""
    found = re.fullmatch(r"(.*\S)\s*[(\[]\s*(°|deg|degrees?|rad|radians?|dB\b.*)\s*[)\]]", text)
    return (found[1], found[2].strip()) if found else split_header(text)


def _frequency(names: list[str], units: list[str | None]) -> int | None:
    found = [i for i, name in enumerate(names) if is_one_of(name, _FREQUENCY)]
    if not found and names and names[0].lower() in ("hz", "khz"):
        units[0] = units[0] or names[0]
        found = [0]
    if not found and names and (units[0] or "").lower() in ("hz", "khz", "rad/s"):
        found = [0]
    return found[0] if len(found) == 1 else None


def _columns(names: list[str], units: list[str | None], rows: list[Line], at: int) -> list[_Column]:
    """The columns that are parts of responses; others are left aside."""
    found = []
    for index, (name, unit) in enumerate(zip(names, units, strict=True)):
        if index == at:
            continue
        part = _AT_END.fullmatch(name) or _AT_START.fullmatch(name)
        cells = [row.cells[index] for row in rows if index < len(row.cells)]
        if any(is_complex(cell) for cell in cells[:50]):
            stem, within = _name_and_unit(name.strip())
            found.append(_Column(name, _agreed(unit, within, name), "complex", stem, index))
        elif part is not None:
            # Of "H1 [g/N] real" the unit stands within.
            stem, within = _name_and_unit((part["stem"] or "").strip(" _-.:|,;"))
            unit = _agreed(unit, within, name)
            if (scale := _SCALE.fullmatch(stem)) is not None:
                # A magnitude on a logarithmic scale is a level, whether it says so by its unit or not.
                stem = scale["stem"]
                unit = "dB" if scale["scale"].lower() == "log" and not in_decibels(unit) else unit
            found.append(_Column(name, unit, _WORDS[part["word"].lower()], stem, index))
    return found


def _agreed(unit: str | None, within: str | None, name: str) -> str | None:
    if unit is not None and within is not None and unit != within:
        raise InputError(f"the column states {unit!r} and {within!r}", where=f"'{name}'", remedy="keep one unit")
    return unit or within


def _pairs(source: Path, stems: list[str], hints: Hints) -> dict[str, tuple[str, str]]:
    """Response and reference of each name.

    Raises
    ------
    InputError
        For names that do not say both, unless the caller does.
    """
    stated: Mapping[str, tuple[str, str]] = hints.pairs or {}
    unknown = next((name for name in stated if name not in stems), None)
    if unknown is not None:
        what = "no response of this name in the table"
        raise InputError(what, where=f"{source}: pairs", value=unknown, remedy=f"it has {stems[:12]}")
    found: dict[str, tuple[str, str]] = {}
    for stem in stems:
        pair = stated.get(stem) or _pair(stem) or (ALONE if len(stems) == 1 else None)
        if pair is None:
            example = f'pairs = {{ "{stem}" = ["what was read", "what was struck"] }}'
            what = "what was read and what was struck cannot be determined from a name"
            remedy = f'name the columns "read / struck", or say it of each in the record: {example}'
            raise InputError(what, where=str(source), value=stem, remedy=remedy)
        found[stem] = pair
    return found


def _pair(stem: str) -> tuple[str, str] | None:
    function = _FUNCTION.fullmatch(stem)
    bare = stem if function is None else (function["a"] or function["b"]).strip()
    for mark in (" / ", " < ", "/", "<"):
        parts = [part.strip() for part in bare.split(mark)]
        if len(parts) == 2 and all(parts):
            return parts[0], parts[1]
    return None


class _Table:
    """The cells of a table, as numbers when they are asked for."""

    def __init__(self, source: Path, rows: list[Line], columns: list[_Column], hints: Hints) -> None:
        self._source, self._rows, self._columns, self._hints = source, rows, columns, hints

    def reals(self, column: _Column) -> Reals:
        """Numbers of a column; an empty cell is NaN."""
        return self._numbers(column, real=True).real

    def response(self, stem: str) -> tuple[Complexes, str | None]:
        """Values and unit of a response."""
        if (whole := self._one(stem, "complex")) is not None:
            return self._numbers(whole), self._unit(whole)
        real, imaginary = self._one(stem, "real"), self._one(stem, "imag")
        if real is not None and imaginary is not None:
            unit, other = self._unit(real), self._unit(imaginary)
            if unit is not None and other is not None:
                check_same(other, unit, where=f"{self._source}: '{imaginary.name}'")
            values = self.reals(real) + 1j * self.reals(imaginary)
            return np.asarray(values, dtype=np.complex128), unit or other
        size, angle = self._one(stem, "size"), self._one(stem, "angle")
        if size is not None and angle is not None:
            where = f"{self._source}: '{size.name}'"
            values, unit = sizes_of(self.reals(size), self._unit(size), where, size.name)
            return polar(values, self.reals(angle) * self._degrees(angle)), unit
        lone = next(column for column in self._columns if column.stem == stem and column.part != "coherence")
        missing = {"real": "imaginary part", "imag": "real part", "size": "phase", "angle": "magnitude"}[lone.part]
        remedy = "export real and imaginary part, or magnitude and phase, of every response"
        raise InputError(f"has no column of its {missing}", where=f"{self._source}: '{lone.name}'", remedy=remedy)

    def coherence(self, stem: str) -> Reals | None:
        """Of a response; of the only one also without its name."""
        column = self._one(stem, "coherence")
        if column is None and len({other.stem for other in self._columns if other.part != "coherence"}) == 1:
            column = self._one("", "coherence")
        if column is None:
            return None
        return self.reals(column) / (100.0 if column.unit == "%" else 1.0)

    def _one(self, stem: str, part: str) -> _Column | None:
        found = [column for column in self._columns if column.stem == stem and column.part == part]
        if len(found) > 1:
            what = "more than one column of one part of a response"
            remedy = "give each response a name of its own"
            raise InputError(what, where=str(self._source), value=found[1].name, remedy=remedy)
        return found[0] if found else None

    def _unit(self, column: _Column) -> str | None:
        return self._hints.channel_unit(column.name) or self._hints.unit_of(column.stem) or column.unit

    def _degrees(self, column: _Column) -> float:
        unit = self._hints.unit_of(column.name) or column.unit or self._hints.unit_of("phase")
        where = f"{self._source}: '{column.name}'"
        if unit is None:
            remedy = "write it as in 'phase [deg]', or say it in the record: unit = { phase = \"rad\" }"
            raise InputError("a phase without a unit: degrees or radians?", where=where, remedy=remedy)
        found = degrees_in(unit)
        if found is None:
            raise InputError("must be in deg or rad", where=where, value=unit, remedy="export it in degrees")
        return found

    def _numbers(self, column: _Column, *, real: bool = False) -> Complexes:
        cells = [row.cells[column.index] for row in self._rows]
        self._check_signs(column, cells)
        values = [
            complex_number(cell, f"{self._source}: line {row.number}, column '{column.name}'")
            for row, cell in zip(self._rows, cells, strict=True)
        ]
        found = np.array(values, dtype=np.complex128)
        if real and np.any(found.imag):
            raise InputError("must be real", where=f"{self._source}: '{column.name}'")
        return found

    def _check_signs(self, column: _Column, cells: list[str]) -> None:
        """Refuse points and commas in one column, and commas that may part thousands."""
        signs, where = signs_of(cells), f"{self._source}: '{column.name}'"
        if len(signs) == 2 or (self._hints.decimal is not None and signs - {self._hints.decimal}):
            sign = "," if self._hints.decimal != "," else "."
            value = next((cell for cell in cells if sign in cell), None)
            what = "decimal points and decimal commas in one column, or not the sign that was stated"
            raise InputError(what, where=where, value=value, remedy="write all numbers alike")
        parts = [part for cell in cells if "," in cell for part in re.findall(r"\d+,\d+", cell)]
        thousands = parts and all(re.fullmatch(r"[1-9]\d{0,2},\d{3}", part) for part in parts)
        if thousands and self._hints.decimal is None:
            what = "a comma that may part decimals or thousands"
            remedy = 'say in the record which sign parts decimals: decimal = "," (or export without thousands)'
            raise InputError(what, where=where, value=parts[0], remedy=remedy)
