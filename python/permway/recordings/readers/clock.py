"""Times of a text table that are dates or times of day: "2026-01-05 10:00:00.001953", "10:00:00,5"."""

from __future__ import annotations

import re
from datetime import date

_CLOCK = re.compile(
    r"(?:(?P<date>\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4})[ T]+)?(?P<hour>\d{1,2}):(?P<minute>\d{2}):(?P<second>\d{2})"
    r"(?:[.,:](?P<part>\d{1,9}))?\s*(?:Z|UTC|[-+]\d{2}:?\d{2})?"
)


def is_clock(cell: str) -> bool:
    """Whether a cell is a date with a time of day, or such a time alone."""
    return _CLOCK.fullmatch(cell.strip()) is not None


def digits_of(cell: str) -> int:
    """Decimals of the seconds."""
    found = _CLOCK.fullmatch(cell.strip())
    return 0 if found is None else len(found["part"] or "")


class Clock:
    """From cells to seconds since the beginning of the first one's day.

    Of dates only the order of days matters: whether 05/01 is in May or in January changes nothing within a day,
    and across midnight a wrong order is a step that is refused.
    """

    def __init__(self) -> None:
        self._first: int | None = None

    def __call__(self, cell: str) -> float:
        """Seconds; ValueError for a cell that is no clock time."""
        found = _CLOCK.fullmatch(cell.strip().strip('"').strip())
        if found is None:
            raise ValueError(cell)
        day = 0 if found["date"] is None else _day(found["date"])
        if self._first is None:
            self._first = day
        whole = 3600 * int(found["hour"]) + 60 * int(found["minute"]) + int(found["second"])
        part = found["part"] or ""
        return float(86400 * (day - self._first) + whole) + (int(part) / 10.0 ** len(part) if part else 0.0)


def _day(text: str) -> int:
    """Number of a day; of day and month in either order, whichever can be."""
    a, b, c = (int(x) for x in re.split(r"[-/.]", text))
    for year, month, day in ((a, b, c), (c, b, a), (c, a, b)):
        if year > 99 and 1 <= month <= 12 and 1 <= day <= 31:
            return date(year, month, day).toordinal()
    raise ValueError(text)
