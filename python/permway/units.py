"""Units as they are written in the field, and what one of them is in SI.

A unit is a product or quotient of symbols with powers, as "m/s^2", "m s-2", "(mm/s)/kN", "(m/s2)^2/Hz", "µm/m",
or a level over its reference, "dB re 1 um". The symbols are a table here and not a units library: the texts that
loggers write ("g" for gravity, "mg", "ms-2", "dB/m") are what a library reads otherwise or not at all.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from permway.arrays import ABSOLUTE_ZERO_C, Reals, real_numbers
from permway.errors import InputError
from permway.unit_grammar import Grammar
from permway.unit_symbols import DECIBEL, NONE, Dimension, unknown

# Whole texts that the grammar would read as something else (ms as milliseconds) or cannot read.
_WHOLE: dict[str, str] = {
    "ms-2": "m/s2",
    "ms^-2": "m/s2",
    "ms-1": "m/s",
    "ms^-1": "m/s",
    "m/ss": "m/s2",
    "microstrain": "ustrain",
    "ue": "ustrain",
    "uε": "ustrain",
    "uD": "ustrain",
    "percent": "%",
    "pct": "%",
    "-": "1",
    "rev/min": "rpm",
    "1/min": "rpm",
    "micron": "um",
    "newton": "N",
    "Newton": "N",
    "volt": "V",
    "Volt": "V",
    "kph": "km/h",
    "km/hr": "km/h",
}
_CELSIUS = {"degC", "deg C", "C", "°C", "℃", "celsius", "Celsius"}

QUANTITIES: dict[Dimension, str] = {
    NONE: "ratio",
    (1, 0, 0, 0, 0, 0, 0): "displacement",
    (1, 0, -1, 0, 0, 0, 0): "velocity",
    (1, 0, -2, 0, 0, 0, 0): "acceleration",
    (1, 1, -2, 0, 0, 0, 0): "force",
    (0, -1, 2, 0, 0, 0, 0): "receptance",
    (0, -1, 1, 0, 0, 0, 0): "mobility",
    (0, -1, 0, 0, 0, 0, 0): "accelerance",
    (0, 1, -2, 0, 0, 0, 0): "stiffness",
    (-1, 1, -2, 0, 0, 0, 0): "pressure",
    (0, 1, 0, 0, 0, 0, 0): "mass",
    (0, 0, 1, 0, 0, 0, 0): "time",
    (0, 0, -1, 0, 0, 0, 0): "frequency",
    (0, 0, 0, 0, 0, 1, 0): "angle",
    (0, 0, -1, 0, 0, 1, 0): "angular velocity",
    (0, 0, 0, 1, 0, 0, 0): "temperature",
    (2, 1, -3, 0, -1, 0, 0): "voltage",
    (0, 0, 0, 0, 1, 0, 0): "current",
    (-1, 0, 0, 0, 0, 0, 0): "wavenumber",
    (-1, 0, 0, 0, 0, 0, 1): "decay rate",
    (2, 0, 1, 0, 0, 0, 0): "displacement density",
    (2, 0, -1, 0, 0, 0, 0): "velocity density",
    (2, 0, -3, 0, 0, 0, 0): "acceleration density",
    (2, 2, -3, 0, 0, 0, 0): "force density",
}
"""Name of a quantity by its dimension; a pressure may be a modulus, a ratio a strain or a loss factor."""


@dataclass(frozen=True)
class Unit:
    """A unit that was understood.

    Attributes
    ----------
    text : str
        As found.
    quantity : str
        As in :data:`QUANTITIES`, "level of ..." for decibels over a reference, or "unnamed".
    factor : float
        What one of it is in SI; of a level, its reference in SI.
    offset : float
        Added after the factor: 273.15 K for degrees Celsius.
    dimension : tuple of int
    level : bool
        Decibels, 20 lg over the reference.
    """

    text: str
    quantity: str
    factor: float
    offset: float
    dimension: Dimension
    level: bool = False

    def to_SI(self, values: ArrayLike) -> Reals:
        """Bring values to SI: kelvin for temperatures, the quantity itself for levels; dB/m stays dB/m."""
        array = real_numbers(values, self.text)
        if self.level:
            return np.asarray(self.factor * 10.0 ** (array / 20.0))
        return np.asarray(array * self.factor + self.offset)

    def same(self, other: Unit) -> bool:
        """Whether both mean the same, however written."""
        return (
            self.dimension == other.dimension
            and self.level == other.level
            and math.isclose(self.factor, other.factor, rel_tol=1e-12)
            and self.offset == other.offset
        )


def parse_unit(text: str, *, where: str = "unit", quantity: str | None = None) -> Unit:
    """Understand a unit.

    Parameters
    ----------
    text : str
        As in a file's header.
    where : str
        File and channel, for the error.
    quantity : str, optional
        What it must be of.

    Raises
    ------
    InputError
        For a unit that is not known, with the nearest that are; for one of another quantity.
    """
    plain = " ".join(_plain(text).split())
    if plain in _CELSIUS:
        unit = Unit(text, "temperature", 1.0, -ABSOLUTE_ZERO_C, (0, 0, 0, 1, 0, 0, 0))
    elif (level := re.fullmatch(r"dB\s*(?:re\.?|ref\.?|rel\.?)\s*:?\s*(.+)", plain, re.IGNORECASE)) is not None:
        reference = parse_unit(level[1], where=where)
        if reference.level or reference.offset:
            raise unknown(text, where, "a level's reference is a plain quantity")
        unit = Unit(text, f"level of {reference.quantity}", reference.factor, 0.0, reference.dimension, level=True)
    else:
        factor, dimension = Grammar(text, _WHOLE.get(plain, plain), where).read()
        if dimension == DECIBEL:
            raise InputError(
                "a level without its reference", where=where, value=text, remedy="write it as in 'dB re 1 um'"
            )
        unit = Unit(text, QUANTITIES.get(dimension, "unnamed"), factor, 0.0, dimension)
    if quantity is not None and unit.quantity != quantity:
        raise InputError(f"is a unit of {unit.quantity}, not of {quantity}", where=where, value=text)
    return unit


def check_same(found: str, stated: str, *, where: str) -> None:
    """Refuse a file's unit that means another than what was stated about it.

    Raises
    ------
    InputError
        If they differ, or either is not known.
    """
    if found == stated:
        return
    if not parse_unit(found, where=where).same(parse_unit(stated, where=where)):
        raise InputError(
            f"the file states {found!r}, but was stated to be in {stated!r}",
            where=where,
            remedy="correct whichever is wrong; nothing is converted in silence",
        )


def _plain(text: str) -> str:
    """One spelling for signs that have several."""
    for sign, plain in (("µ", "u"), ("μ", "u"), ("·", "*"), ("⋅", "*"), ("×", "*"), ("−", "-"), ("‑", "-")):
        text = text.replace(sign, plain)
    text = text.translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")).replace("**", "^")
    return text.replace("°", "deg") if "°C" not in text else text
