"""Units as they are written in the field, and what one of them is in SI.

A unit is a product or quotient of symbols with powers, as "m/s^2", "m s-2", "(mm/s)/kN", "(m/s2)^2/Hz", "µm/m",
or a level over its reference, "dB re 1 um". The symbols are a table here and not a units library: the texts that
loggers write ("g" for gravity, "mg", "ms-2", "dB/m") are what a library reads otherwise or not at all.
"""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from permway.arrays import ABSOLUTE_ZERO_C, Reals
from permway.errors import InputError

Dimension = tuple[int, ...]
"""Powers of metre, kilogram, second, kelvin, ampere, radian and decibel."""

STANDARD_GRAVITY = 9.80665
"""m/s2, exact by definition (ISO 80000-3)."""

_NONE = (0, 0, 0, 0, 0, 0, 0)
_DECIBEL = (0, 0, 0, 0, 0, 0, 1)
_PREFIXES = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6, "G": 1e9}

# Symbol: factor to SI, dimension, prefixes it is met with.
_SYMBOLS: dict[str, tuple[float, Dimension, str]] = {
    "m": (1.0, (1, 0, 0, 0, 0, 0, 0), "numck"),
    "in": (0.0254, (1, 0, 0, 0, 0, 0, 0), ""),
    "ft": (0.3048, (1, 0, 0, 0, 0, 0, 0), ""),
    "s": (1.0, (0, 0, 1, 0, 0, 0, 0), "num"),
    "sec": (1.0, (0, 0, 1, 0, 0, 0, 0), ""),
    "min": (60.0, (0, 0, 1, 0, 0, 0, 0), ""),
    "h": (3600.0, (0, 0, 1, 0, 0, 0, 0), ""),
    "kg": (1.0, (0, 1, 0, 0, 0, 0, 0), ""),
    "g": (STANDARD_GRAVITY, (1, 0, -2, 0, 0, 0, 0), "um"),
    "gn": (STANDARD_GRAVITY, (1, 0, -2, 0, 0, 0, 0), ""),
    "gal": (1e-2, (1, 0, -2, 0, 0, 0, 0), "m"),
    "N": (1.0, (1, 1, -2, 0, 0, 0, 0), "mkM"),
    "lbf": (4.4482216152605, (1, 1, -2, 0, 0, 0, 0), ""),
    "Pa": (1.0, (-1, 1, -2, 0, 0, 0, 0), "umkMG"),
    "bar": (1e5, (-1, 1, -2, 0, 0, 0, 0), "m"),
    "Hz": (1.0, (0, 0, -1, 0, 0, 0, 0), "mkM"),
    "rad": (1.0, (0, 0, 0, 0, 0, 1, 0), "um"),
    "deg": (math.pi / 180.0, (0, 0, 0, 0, 0, 1, 0), ""),
    "rpm": (math.pi / 30.0, (0, 0, -1, 0, 0, 1, 0), ""),
    "K": (1.0, (0, 0, 0, 1, 0, 0, 0), "m"),
    "A": (1.0, (0, 0, 0, 0, 1, 0, 0), "um"),
    "V": (1.0, (2, 1, -3, 0, -1, 0, 0), "numk"),
    "pC": (1e-12, (0, 0, 1, 0, 1, 0, 0), ""),
    "dB": (1.0, _DECIBEL, ""),
    "%": (1e-2, _NONE, ""),
    "strain": (1.0, _NONE, "um"),
    "eps": (1.0, _NONE, "um"),
}

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
    _NONE: "ratio",
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

_USUAL = (
    *(
        "m/s^2",
        "m/s2",
        "m/s²",
        "mm/s^2",
        "g",
        "mg",
        "m/s",
        "mm/s",
        "km/h",
        "m",
        "mm",
        "um",
        "N",
        "kN",
        "N/m",
        "kN/mm",
    ),
    *("(m/s^2)/N", "g/N", "(m/s)/N", "m/N", "Pa", "kPa", "MPa", "GPa", "Hz", "kHz", "rad/s", "rpm", "degC", "K"),
    *("%", "strain", "ustrain", "um/m", "dB/m", "V", "mV", "s", "ms", "(m/s^2)^2/Hz", "g^2/Hz"),
)


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
        array = np.asarray(values, dtype=np.float64)
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
            raise _unknown(text, where, "a level's reference is a plain quantity")
        unit = Unit(text, f"level of {reference.quantity}", reference.factor, 0.0, reference.dimension, level=True)
    else:
        factor, dimension = _Grammar(text, _WHOLE.get(plain, plain), where).read()
        if dimension == _DECIBEL:
            raise InputError(
                "a level without its reference", where=where, value=text, remedy="write it as in 'dB re 1 um'"
            )
        unit = Unit(text, QUANTITIES.get(dimension, "unnamed"), factor, 0.0, dimension)
    if quantity is not None and unit.quantity != quantity:
        raise InputError(f"is a unit of {unit.quantity}, not of {quantity}", where=where, value=text)
    return unit


def check_same(found: str, said: str, *, where: str) -> None:
    """Refuse a file's unit that means another than what was said of it.

    Raises
    ------
    InputError
        If they differ, or either is not known.
    """
    if found == said:
        return
    if not parse_unit(found, where=where).same(parse_unit(said, where=where)):
        raise InputError(
            f"the file says {found!r}, but was said to be in {said!r}",
            where=where,
            remedy="correct whichever is wrong; nothing is converted in silence",
        )


def _plain(text: str) -> str:
    """One spelling for signs that have several."""
    for sign, plain in (("µ", "u"), ("μ", "u"), ("·", "*"), ("⋅", "*"), ("×", "*"), ("−", "-"), ("‑", "-")):
        text = text.replace(sign, plain)
    text = text.translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")).replace("**", "^")
    return text.replace("°", "deg") if "°C" not in text else text


_TOKEN = re.compile(r"\s*(?:(\d+\.?\d*(?:[eE][-+]?\d+)?)|([A-Za-zε%]+)|(.))")
_POWER = re.compile(r"\s*\^\s*(?:([-+]?\d)|\(\s*([-+]?\d)\s*\))(?![\d.])|([-+]?\d)(?![\d.])")


class _Grammar:
    """product = factor {("*" | "." | " " | "/") factor}; factor = ("(" product ")" | symbol) [power] | number."""

    def __init__(self, text: str, plain: str, where: str) -> None:
        self.text, self.rest, self.where = text, plain.strip(), where
        self.depth = 0

    def read(self) -> tuple[float, Dimension]:
        if not self.rest:
            raise _unknown(self.text, self.where, "the unit is empty")
        if len(self.rest) > 80:
            raise _unknown(self.text, self.where, "longer than any unit")
        found = self._product()
        if self.rest.strip():
            raise _unknown(self.text, self.where)
        if not (math.isfinite(found[0]) and found[0] > 0.0):
            raise _unknown(self.text, self.where, "the factor is not a number above zero")
        return found

    def _product(self) -> tuple[float, Dimension]:
        factor, dimension = self._factor()
        divided = False
        while (rest := self.rest.lstrip()) and rest[0] != ")":
            if rest[0] == "/":
                self.rest, divided, sign = rest[1:], True, -1
            elif divided:
                # "N/m s" is read either way by people, and is refused.
                raise _unknown(
                    self.text, self.where, "a product after a quotient can be read two ways, set brackets"
                )
            else:
                self.rest, sign = (rest[1:] if rest[0] in "*." else rest), 1
            one, powers = self._factor()
            factor = _times(factor, one, sign)
            dimension = tuple(a + sign * b for a, b in zip(dimension, powers, strict=True))
        return factor, dimension

    def _factor(self) -> tuple[float, Dimension]:
        token = _TOKEN.match(self.rest)
        if token is None:
            raise _unknown(self.text, self.where)
        self.rest = self.rest[token.end() :]
        number, symbol, mark = token.groups()
        if number is not None:
            return float(number), _NONE
        if symbol is not None:
            factor, dimension = self._symbol(symbol)
        elif mark == "(" and self.depth < 8:
            self.depth += 1
            factor, dimension = self._product()
            self.depth -= 1
            if not self.rest.lstrip().startswith(")"):
                raise _unknown(self.text, self.where, "a bracket is not closed")
            self.rest = self.rest.lstrip()[1:]
        else:
            raise _unknown(self.text, self.where)
        power = _POWER.match(self.rest)
        if power is None:
            return factor, dimension
        self.rest = self.rest[power.end() :]
        n = int(power[1] or power[2] or power[3])
        return factor**n, tuple(n * p for p in dimension)

    def _symbol(self, symbol: str) -> tuple[float, Dimension]:
        if symbol in _SYMBOLS:
            return _SYMBOLS[symbol][:2]
        known = _SYMBOLS.get(symbol[1:])
        if known is None or symbol[0] not in known[2]:
            raise _unknown(self.text, self.where)
        return known[0] * _PREFIXES[symbol[0]], known[1]


def _times(a: float, b: float, sign: int) -> float:
    if sign > 0:
        return a * b
    return a / b if b else math.inf


def _unknown(text: str, where: str, what: str = "the unit is not known") -> InputError:
    near = difflib.get_close_matches(text.strip(), _USUAL, n=3, cutoff=0.5)
    remedy = (
        "did you mean " + " or ".join(near) + "?"
        if near
        else "write it as in m/s^2, g, mm/s, um, kN, (m/s^2)/N, MPa"
    )
    return InputError(what, where=where, value=text, remedy=remedy)
