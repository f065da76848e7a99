"""Units of the columns of a DMA table: what one of them is in SI, or degrees Celsius."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from permway.arrays import ABSOLUTE_ZERO_C
from permway.errors import InputError
from permway.units import parse_unit

MODULUS_UNITS = {"pa": 1.0, "kpa": 1e3, "mpa": 1e6, "gpa": 1e9, "n_mm2": 1e6, "n_m2": 1.0}

MODULUS, STIFFNESS = "modulus", "stiffness"


@dataclass(frozen=True)
class ColumnUnit:
    """A unit that was understood: value times `factor` plus `offset` is in SI, or degrees Celsius.

    Attributes
    ----------
    factor, offset : float
    kind : str
        "modulus" (Pa) or "stiffness" (N/m) of what is one of the two, else empty.
    """

    factor: float
    offset: float = 0.0
    kind: str = ""


_HERTZ = 0.5 / math.pi
_NONE = {"": ColumnUnit(1.0)}
_RATIO = _NONE | {
    **{name: ColumnUnit(1.0) for name in ("1", "none", "dimensionless", "mm_mm", "m_m")},
    **{name: ColumnUnit(0.01) for name in ("pct", "percent", "prozent")},
}
_RAD_PER_S = {name: ColumnUnit(_HERTZ) for name in ("rad_s", "rad_s_1", "rad_sec", "rads", "radians_s")}
_ELASTIC = {
    **{name: ColumnUnit(factor, kind=MODULUS) for name, factor in MODULUS_UNITS.items()},
    "mn_m2": ColumnUnit(1e6, kind=MODULUS),
    "kn_mm2": ColumnUnit(1e9, kind=MODULUS),
    "n_m": ColumnUnit(1.0, kind=STIFFNESS),
    "n_mm": ColumnUnit(1e3, kind=STIFFNESS),
    "kn_m": ColumnUnit(1e3, kind=STIFFNESS),
    "kn_mm": ColumnUnit(1e6, kind=STIFFNESS),
    "mn_m": ColumnUnit(1e6, kind=STIFFNESS),
}
_CELSIUS = ("c", "degc", "deg_c", "celsius", "degrees_celsius", "degree_celsius", "grad_celsius")
_FAHRENHEIT = ("f", "degf", "deg_f", "fahrenheit")

_SPELLED: dict[str, dict[str, ColumnUnit]] = {
    "frequency": _NONE
    | _RAD_PER_S
    | {name: ColumnUnit(1.0) for name in ("hz", "hertz", "1_s", "s_1", "cps")}
    | {"khz": ColumnUnit(1e3)},
    "omega": {"": ColumnUnit(_HERTZ)} | _RAD_PER_S | {name: ColumnUnit(_HERTZ) for name in ("1_s", "s_1")},
    "temperature": _NONE
    | {name: ColumnUnit(1.0) for name in _CELSIUS}
    | {name: ColumnUnit(1.0, ABSOLUTE_ZERO_C) for name in ("k", "kelvin")}
    | {name: ColumnUnit(5.0 / 9.0, -160.0 / 9.0) for name in _FAHRENHEIT},
    "storage": _ELASTIC,
    "loss": _ELASTIC,
    "magnitude": _ELASTIC,
    "loss_factor": _RATIO,
    "phase": {
        **{name: ColumnUnit(math.pi / 180.0) for name in ("deg", "degree", "degrees", "grad")},
        **{name: ColumnUnit(1.0) for name in ("rad", "radian", "radians")},
        "mrad": ColumnUnit(1e-3),
    },
    "strain": {name: unit for name, unit in _RATIO.items() if name},
}
_READ = {
    "frequency": {"frequency": 1.0, "angular velocity": _HERTZ},
    "omega": {"angular velocity": _HERTZ},
    "storage": {"pressure": 1.0, "stiffness": 1.0},
    "loss": {"pressure": 1.0, "stiffness": 1.0},
    "magnitude": {"pressure": 1.0, "stiffness": 1.0},
    "loss_factor": {"ratio": 1.0},
    "phase": {"angle": 1.0},
    "strain": {"ratio": 1.0},
}
_FOREIGN = {"psi", "ksi", "bar", "kgf_cm2", "dyn_cm2", "dyne_cm2", "rpm", "f", "deg", "rad", "mhz", "n_cm2", "k"}
_DEGREE_SIGNS = ("Â°", "º", "˚", "℃", "℉")
_UNIT_TEXT = re.compile(r"[\w\s/^*·⋅.()%°º˚℃℉¹²³⁻−-]*")
_BRACKETS = {"[": "]", "(": ")", "<": ">", "{": "}"}


def bare(text: str) -> str:
    """A unit without the marks and brackets around it, and without "in" before it."""
    text = text.strip().lstrip("_,/:;.- \t\n").rstrip(",;:. \t\n")
    while len(text) > 1 and _BRACKETS.get(text[0]) == text[-1] and _closes_last(text):
        text = text[1:-1].strip()
    text = re.sub(r"^in\s+", "", text)
    return "" if text.lower() in ("-", "–", "—", "--", "n/a", "none", "unitless") else text


def _closes_last(text: str) -> bool:
    depth = 0
    for index, mark in enumerate(text):
        depth += (mark == text[0]) - (mark == _BRACKETS[text[0]])
        if depth == 0:
            return index == len(text) - 1
    return False


def words(text: str) -> str:
    """Small letters and digits, joined by underscores; degrees, per cent and powers spelt out."""
    for sign, plain in zip(_DEGREE_SIGNS, ("°", "°", "°", "°C", "°F"), strict=True):
        text = text.replace(sign, plain)
    text = text.replace("%", " pct ").replace("°", " deg ").replace("−", "-").replace("⁻", "-")
    text = text.translate(str.maketrans("¹²³µμ", "123uu")).lower()
    return "_".join(re.findall(r"[a-z0-9]+", text)).replace("deg_deg", "deg")


def column_unit(quantity: str, text: str) -> ColumnUnit | None:
    """Understand a unit for a quantity; None if it is not one.

    Parameters
    ----------
    quantity : str
        As in `permway.laws.columns.recognise`, or "omega".
    text : str
        As :func:`bare` gives it; empty where the header has none.
    """
    if len(text) > 40 or not _UNIT_TEXT.fullmatch(text):
        return None
    spelt = words(text)
    # Small m before a capital is a thousandth: mPa is no MPa, mHz no MHz, mN/m no MN/m. Spelling drops marks, so
    # that a product (N m, N.m) would look like a quotient.
    quotient = "_" not in spelt or re.search(r"[/_]|s ?[\^(]*[-−⁻]|deg|[°º˚℃℉]|grad", text.lower()) is not None
    if not re.match(r"m[A-Z]", text) and quotient:
        found = _SPELLED[quantity].get(spelt)
        if found is not None and (text == "" or spelt):
            return found
    known = _READ.get(quantity, {})
    if not text or not known or re.match(r"^[\d.\s]*$", text):
        return None
    try:
        unit = parse_unit(text)
    except InputError:
        return None
    if unit.quantity not in known or unit.level or unit.offset:
        return None
    kind = {"pressure": MODULUS, "stiffness": STIFFNESS}.get(unit.quantity, "")
    # A modulus in mPa may be meant in MPa, a factor of a thousand million: not to be guessed.
    if kind and unit.factor < 1.0:
        return None
    return ColumnUnit(unit.factor * known[unit.quantity], kind=kind)


def is_any_unit(text: str) -> bool:
    """Whether a text is a unit of whatever quantity, as in a row of units under a header."""
    inner = bare(text)
    if not inner:
        return True
    return any(column_unit(quantity, inner) is not None for quantity in _SPELLED) or _parses(inner)


def looks_like_unit(text: str) -> bool:
    """Whether a text that is no unit of its quantity is meant as one."""
    return words(text) in _FOREIGN or _parses(text) or re.match(r"m[A-Z]", text) is not None


def known_units(quantity: str) -> str:
    """What a quantity may be given in, for messages."""
    return ", ".join(sorted(filter(None, _SPELLED[quantity])))


def _parses(text: str) -> bool:
    if len(text) > 40 or re.match(r"^[\d.\s]*$", text):
        return False
    try:
        parse_unit(text)
    except InputError:
        return False
    return True
