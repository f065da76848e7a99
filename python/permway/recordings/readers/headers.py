"""Names and units in the headers of columns and channels."""

from __future__ import annotations

import re

from permway.errors import InputError
from permway.recordings.readers.scales import seconds_in, seconds_of
from permway.units import parse_unit

_TIME_NAMES = {
    "t", "time", "zeit", "temps", "timestamp", "timestamps", "elapsed", "elapsed time", "rel. time",
    "relative time", "time stamp", "unix time", "epoch", "abs. time", "absolute time"}  # fmt: skip
_UNIT_NAMES = {
    "millis",
    "milliseconds",
    "micros",
    "microseconds",
    "nanoseconds",
    "seconds",
    "secs",
    "msec",
    "usec",
}
_TIME_SUFFIX = re.compile(r"(.+)[_ ](s|ms|us|ns|sec|msec|usec|millis|min)", re.IGNORECASE)
_NONE = {"", "-", "none", "n/a", "null", "unknown"}
# In round brackets these are a side or a number of a sensor rather than amperes or hours.
_NO_UNIT_IN_ROUND = {"A", "h", "C", "V", "K", "N", "g"}


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
    comma = re.fullmatch(r"(.*\S),\s+([^,;()\[\]]+)", text)
    if (
        comma is not None
        and is_unit(comma[2])
        and (comma[2] not in _NO_UNIT_IN_ROUND or comma[2] in ("V", "N", "g"))
    ):
        return comma[1], clean_unit(comma[2])
    # "a / (m/s²)" and "a / mm" as DIN 1313 writes axes, "a in mm"; "t/s" only of times.
    over = re.fullmatch(r"(.*\S)\s+(?:/|in)\s+\(?([^()]+)\)?", text) or re.fullmatch(
        r"(t|[Tt]ime|Zeit)/(\S+)", text
    )
    if over is not None and is_unit(over[2]):
        return over[1], clean_unit(over[2])
    last = text.rpartition(" ")[2]
    if last != text and re.search(r"[/²^]", last) and is_unit(last):
        return text, clean_unit(last)
    # Of "acc [mm/s2] filtered" the unit is known, too; all of it is the name.
    within: list[tuple[str, str]] = re.findall(r"\[([^\[\]]+)\]|\(([^()]+)\)", text)
    units = [a or b for a, b in within if is_unit(a) or (is_unit(b) and b.strip() not in _NO_UNIT_IN_ROUND)]
    return text, clean_unit(units[0]) if len(units) == 1 else None


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
    """A unit as found, without brackets and blanks; None where the text states that there is none."""
    if not isinstance(text, str):
        return None
    bare = text.strip().strip("\x00").strip()
    for opening, closing in ("[]", "()"):
        inner = bare[1:-1]
        if (
            len(bare) > 1
            and bare[0] == opening
            and bare[-1] == closing
            and closing not in inner.partition(opening)[0]
        ):
            bare = inner.strip()
    return None if bare.lower() in _NONE else bare


def is_unit(text: str) -> bool:
    """Whether a text is a unit that is known; a number before it, as in "100g", is a range and no unit."""
    if re.match(r"\s*[\d.]+(?!\s*/)", text) or not text.strip():
        return False
    if seconds_of(text) is not None:
        return True
    try:
        parse_unit(text)
    except InputError:
        return False
    return True


def is_unit_row(cells: list[str]) -> bool:
    """Whether a row under the header holds the units.

    Each cell is a unit or none, or half of those that are not empty are, which a row of names never has.
    """
    bare = [clean_unit(cell) for cell in cells]
    stated = [i for i, unit in enumerate(bare) if unit is not None]
    known = [i for i in stated if is_unit(bare[i] or "") or cells[i].strip().startswith(("[", "("))]
    return bool(known) and 2 * len(known) >= len(stated)


def _is_temperature(unit: str) -> bool:
    try:
        return parse_unit(unit).quantity == "temperature"
    except InputError:
        return False


def time_scale(name: str, unit: str | None, where: str) -> tuple[bool, float | None]:
    """Whether a name is that of a time column, and seconds in one of its unit: None where there is no unit.

    A bare T is a temperature: only t is a time without a unit of time.

    Raises
    ------
    InputError
        For a time column in a unit that is not of time.
    """
    bare = name.strip()
    plain = bare.lower()
    suffix = _TIME_SUFFIX.fullmatch(plain)
    if plain not in _TIME_NAMES and suffix is not None and suffix[1] in _TIME_NAMES:
        plain, bare, unit = suffix[1], bare[: len(suffix[1])], unit or suffix[2]
    if plain in _UNIT_NAMES and unit is None:
        return True, seconds_in(plain, where)
    if plain not in _TIME_NAMES:
        return False, None
    if bare == "T" and (unit is None or seconds_of(unit) is None):
        return False, None
    if bare == "t" and unit is not None and seconds_of(unit) is None and _is_temperature(unit):
        return False, None
    return True, None if unit is None else seconds_in(unit, where)
