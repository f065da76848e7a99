"""Names and units in the headers of columns and channels."""

from __future__ import annotations

import re

from permway.errors import InputError
from permway.units import parse_unit

_TIME_NAMES = {"t", "time", "zeit", "temps", "timestamp", "timestamps", "elapsed", "elapsed time", "rel. time"}
_TIME_SUFFIX = re.compile(r"(.+)[_ ](s|ms|us|sec|min)", re.IGNORECASE)
_NONE = {"", "-", "none", "n/a", "null", "unknown"}
# In round brackets these are a side or a number of a sensor rather than amperes or hours.
_NO_UNIT_IN_ROUND = {"A", "h", "C", "V", "K", "N", "g"}

TIME_SECONDS = {
    "s": 1.0,
    "sec": 1.0,
    "seconds": 1.0,
    "second": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    "ns": 1e-9,
    "min": 60.0,
}


def split_header(text: str) -> tuple[str, str | None]:
    """Name and unit of "acc [m/s2]", "acc (m/s^2)" or "acc": the unit as found, None if there is none.

    Square brackets hold a unit, known or not, but for a bare number; round ones only if what they hold is a unit.
    """
    text = text.strip()
    square = re.fullmatch(r"(.*\S)\s*\[([^\[\]]*)\]", text)
    if square is not None and not re.fullmatch(r"\s*\d+\s*", square[2]):
        return square[1], clean_unit(square[2])
    round_ = _round_brackets(text)
    if (
        round_ is not None
        and is_unit(round_[1])
        and (round_[1] not in _NO_UNIT_IN_ROUND or _names_quantity(round_))
    ):
        return round_[0], clean_unit(round_[1])
    return text, None


def _round_brackets(text: str) -> tuple[str, str] | None:
    """The last pair of round brackets, with what they hold in turn: "frf ((m/s^2)/N)"."""
    if not text.endswith(")"):
        return None
    depth = 0
    for at in range(len(text) - 1, -1, -1):
        depth += {")": 1, "(": -1}.get(text[at], 0)
        if depth == 0:
            name = text[:at].strip()
            return (name, text[at + 1 : -1].strip()) if name else None
    return None


def _names_quantity(parts: tuple[str, str]) -> bool:
    words = {
        "C": ("temp",),
        "K": ("temp",),
        "g": ("acc", "beschl"),
        "N": ("force", "kraft", "load", "hammer"),
        "V": ("volt", "spannung", "signal", "output"),
        "A": ("curr", "strom"),
        "h": ("time",),
    }
    return any(word in parts[0].lower() for word in words[parts[1]])


def clean_unit(text: object) -> str | None:
    """A unit as found, without brackets and blanks; None where the text says that there is none."""
    if not isinstance(text, str):
        return None
    bare = text.strip().strip("\x00").strip()
    if len(bare) > 1 and bare[0] == "[" and bare[-1] == "]":
        bare = bare[1:-1].strip()
    return None if bare.lower() in _NONE else bare


def is_unit(text: str) -> bool:
    """Whether a text is a unit that is known, and not a bare number."""
    if re.fullmatch(r"\s*[\d.]*\s*", text):
        return False
    try:
        parse_unit(text)
    except InputError:
        return False
    return True


def is_unit_row(cells: list[str]) -> bool:
    """Whether a row under the header holds the units: each cell a unit or none, one at least."""
    bare = [clean_unit(cell) for cell in cells]
    return any(bare) and all(
        unit is None or is_unit(unit) or cells[i].strip().startswith("[") for i, unit in enumerate(bare)
    )


def time_scale(name: str, unit: str | None, where: str) -> float | None:
    """Seconds in one of a time column's unit; None if the name is not that of a time column.

    Raises
    ------
    InputError
        For a time column in a unit that is not of time.
    """
    plain = name.strip().lower()
    suffix = _TIME_SUFFIX.fullmatch(plain)
    if plain not in _TIME_NAMES and suffix is not None and suffix[1] in _TIME_NAMES:
        plain, unit = suffix[1], unit or suffix[2]
    if plain not in _TIME_NAMES:
        return None
    if unit is None:
        return 1.0
    # "seconds since 2024-05-01" is how NetCDF writes a date; only the unit is wanted.
    bare = unit.strip().split(" since ")[0].strip()
    if bare not in TIME_SECONDS:
        raise InputError("is no unit of time", where=where, value=unit, remedy="give the time in s, ms or us")
    return TIME_SECONDS[bare]
