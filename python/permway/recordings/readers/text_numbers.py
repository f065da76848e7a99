"""Numbers of frequency responses as tables of text hold them: complex text, levels in decibels, phases."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit
from permway.units import parse_unit

_REAL = r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eEdD][-+]?\d+)?"
_UNSIGNED = _REAL.removeprefix("[-+]?")
_IMAGINARY = rf"(?:{_UNSIGNED}\s*\*?\s*[ij]|[ij]\s*\*?\s*{_UNSIGNED})"
_BOTH = re.compile(rf"(?P<re>{_REAL})\s*(?P<sign>[-+])\s*(?P<im>{_IMAGINARY})")
_PURE = re.compile(rf"(?P<sign>[-+]?)\s*(?P<im>{_IMAGINARY})")
_PLAIN = re.compile(_REAL)
_ENDLESS = re.compile(r"[-+]?(?:1[.,]#)?inf(?:inity)?(?:[-+].*)?|.*[-+]inf(?:inity)?\s*\*?[ij]", re.IGNORECASE)

_DECIBELS = re.compile(r"(?<![A-Za-z])dB(?![A-Za-z])")
_LEVEL = re.compile(
    r"\s*dB\s*[\[(]?\s*(?:re|ref|rel)\b[.:]?\s*(?P<one>[-+.\d]+(?:[eE][-+]?\d+)?)?\s*(?P<unit>\S.*?)\s*\)?"
)

_DEGREES = {
    **dict.fromkeys(("deg", "degree", "degrees", "°", "grad °", "altgrad"), 1.0),
    **dict.fromkeys(("rad", "radian", "radians"), 180.0 / np.pi),
}


def is_complex(cell: str) -> bool:
    """Whether a cell is a complex number with an imaginary part: "1.2+3.4j", "1,2 - 3,4i", "(1.2+j3.4)"."""
    bare = _bare(cell)
    return bool(_BOTH.fullmatch(bare) or _PURE.fullmatch(bare))


def complex_number(cell: str, where: str) -> complex:
    """A complex number from a text; one without an imaginary part is real, an empty one NaN.

    A comma is a decimal sign here: whether it can be is for the caller to see.

    Raises
    ------
    InputError
        For a text that is none.
    """
    bare = _bare(cell)
    if not bare or bare.lower() in ("nan", "na", "n/a", "-"):
        return complex("nan")
    if _PLAIN.fullmatch(bare):
        return complex(_float(bare), 0.0)
    if _ENDLESS.fullmatch(bare):
        remedy = "measure it again, or delete its row in a copy of the file"
        raise InputError("not a finite number", where=where, value=cell, remedy=remedy)
    found = _BOTH.fullmatch(bare) or _PURE.fullmatch(bare)
    if found is None:
        remedy = "give a plain number, or write both parts as 1.2+3.4j"
        raise InputError("no complex number", where=where, value=cell, remedy=remedy)
    size = _float(re.sub(r"[\sij*]", "", found["im"]))
    real = _float(found["re"]) if "re" in found.re.groupindex else 0.0
    return complex(real, -size if found["sign"] == "-" else size)


def signs_of(cells: Sequence[str]) -> set[str]:
    """Which of point and comma stand in these cells."""
    return {sign for cell in cells for sign in ".," if sign in cell}


def degrees_in(unit: str | None) -> float | None:
    """Degrees in one of a unit of angle; None if it is none."""
    return None if unit is None else _DEGREES.get(unit.strip().lower())


def in_decibels(unit: str | None) -> bool:
    """Whether a unit is one of levels."""
    return unit is not None and bool(_DECIBELS.search(unit))


def sizes_of(values: Reals, unit: str | None, where: str, label: str) -> tuple[Reals, str | None]:
    """Magnitudes and their plain unit, of magnitudes or of levels whose reference is stated.

    A level of a response is 20 lg of its magnitude over the reference, as ISO 1683 has it for field quantities.

    Raises
    ------
    InputError
        For decibels without a reference, and for magnitudes below zero.
    """
    if not in_decibels(unit):
        below = np.flatnonzero(values < 0.0)
        if below.size:
            remedy = f'if it is, say so in the record: unit = {{ "{label}" = "dB re 1 (m/s2)/N" }}'
            raise InputError(
                "a magnitude below 0: is it a level in dB?",
                where=where,
                value=float(values[below[0]]),
                remedy=f"{remedy}; or export real and imaginary part, or magnitudes in a plain unit",
            )
        return values, unit
    found = _LEVEL.fullmatch(unit or "")
    reference = None if found is None else clean_unit(found["unit"])
    try:
        if found is None or reference is None:
            raise ValueError(unit)
        one = float(found["one"] or 1.0)
        parse_unit(reference)
    except (InputError, ValueError) as error:
        raise InputError(
            "decibels without a reference are no ratio",
            where=where,
            value=unit,
            remedy=f'say it in the record: unit = {{ "{label}" = "dB re 1 (m/s2)/N" }}; '
            "or export real and imaginary part",
        ) from error
    if not one > 0.0:
        raise InputError("the reference of a level must be above 0", where=where, value=unit)
    return np.asarray(one * 10.0 ** (values / 20.0)), reference


def polar(size: Reals, angle_deg: Reals) -> Complexes:
    """Complex numbers from magnitudes and phases in degrees."""
    return np.asarray(size * np.exp(1j * np.deg2rad(angle_deg)), dtype=np.complex128)


def _bare(cell: str) -> str:
    text = cell.strip().replace("−", "-")
    return text[1:-1].strip() if text.startswith("(") and text.endswith(")") else text


def _float(text: str) -> float:
    return float(text.replace(",", ".").replace("D", "E").replace("d", "e"))
