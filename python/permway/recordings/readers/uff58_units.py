"""Units of a universal file: of the axes of a function, and of the whole file (dataset 164).

Source: University of Cincinnati, SDRL, "Universal File Formats for Modal Analysis Testing", datasets 58 and 164.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from permway.errors import InputError
from permway.recordings.readers.headers import clean_unit
from permway.recordings.readers.uff import Block, Text
from permway.unit_symbols import Dimension
from permway.units import parse_unit

# Records 8 to 11 are (I10, 3I5, 2(1X, 20A1)): type, three exponents, label, unit.
_LABEL, _UNIT = 26, 47
_WIDTH = 20

# Dimension of an axis by its type, and the unit it has in a system of lengths L and forces F.
_MEASURED: dict[int, tuple[Dimension, str]] = {
    8: ((1, 0, 0, 0, 0, 0, 0), "L"),
    9: ((1, 1, -2, 0, 0, 0, 0), "F"),
    11: ((1, 0, -1, 0, 0, 0, 0), "L/s"),
    12: ((1, 0, -2, 0, 0, 0, 0), "L/s^2"),
    13: ((1, 1, -2, 0, 0, 0, 0), "F"),
}
_LENGTHS = {1.0: "m", 1e2: "cm", 1e3: "mm", 1e6: "um", 1.0 / 0.0254: "in", 1.0 / 0.3048: "ft"}
_FORCES = {1.0: "N", 1e3: "mN", 1e-3: "kN", 1.0 / 4.4482216152605: "lbf"}
_FACTORS_AGREE = 1e-4
"""Relative: factors are printed with five digits at least. The nearest two units of one kind lie 8 % apart."""


@dataclass(frozen=True)
class Axis:
    """An axis of a function: type, label and unit as found, None where there is none."""

    kind: int
    label: str
    unit: str | None


@dataclass(frozen=True)
class System:
    """Units of a file: those of length and force, None where they have no usual name."""

    length: str | None
    force: str | None


def axis_of(text: Text, line: str, at: int) -> Axis:
    """The axis that a line of the header describes.

    A unit that begins one column early, after a blank, is taken whole: some programs count so.
    """
    line = line.expandtabs()
    first = _UNIT
    if line[_UNIT - 1 : _UNIT].strip() and not line[_UNIT - 2 : _UNIT - 1].strip():
        first -= 1
    unit = clean_unit(line[first : _UNIT + _WIDTH])
    return Axis(text.field(line, at, 0, 10, "type of an axis"), line[_LABEL : _LABEL + _WIDTH].strip(), unit)


def system_of(text: Text, block: Block) -> System:
    """What a dataset 164 states: factors from SI to the file's units."""
    _, second = text.line(block.body)
    line, _ = text.line(second)
    factors = [text.real(line, second, first, 25, "factor of a unit") for first in (0, 25)]
    return System(_nearest(factors[0], _LENGTHS), _nearest(factors[1], _FORCES))


def _nearest(factor: float, known: dict[float, str]) -> str | None:
    return next((name for each, name in known.items() if math.isclose(factor, each, rel_tol=_FACTORS_AGREE)), None)


def ordinate_unit(ordinate: Axis, denominator: Axis, system: System | None) -> str | None:
    """Unit of the values, by the axes' own units, or by the file's system where they have none.

    The unit of a ratio may stand in both axes: "(m/s^2)/N" over "N" is (m/s^2)/N, and not divided twice.
    """
    over, under = ordinate.unit or _by_system(ordinate, system), denominator.unit
    if over is not None and under is None and ordinate.unit is None:
        under = _by_system(denominator, system)
    if over is None or under is None:
        return over
    if _is_whole(over, under, ordinate):
        return over
    plain = re.fullmatch(r"[A-Za-zµ%]+", over)
    bottom = under if re.fullmatch(r"[A-Za-zµ%]+", under) else f"({under})"
    return f"{over if plain else f'({over})'}/{bottom}"


def _by_system(axis: Axis, system: System | None) -> str | None:
    if system is None or axis.kind not in _MEASURED:
        return None
    text = _MEASURED[axis.kind][1]
    if system.length is None or system.force is None:
        return None
    return text.replace("L", system.length).replace("F", system.force)


def _is_whole(over: str, under: str, ordinate: Axis) -> bool:
    """Whether the numerator's unit is that of the ratio already."""
    try:
        top, bottom = parse_unit(over), parse_unit(under)
    except InputError:
        return over.replace(" ", "").endswith("/" + under.replace(" ", ""))
    if ordinate.kind in _MEASURED:
        wanted = _MEASURED[ordinate.kind][0]
        return top.dimension == tuple(a - b for a, b in zip(wanted, bottom.dimension, strict=True))
    return top.quantity in ("receptance", "mobility", "accelerance") and bottom.quantity == "force"
