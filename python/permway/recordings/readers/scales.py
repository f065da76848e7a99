"""What one unit of time is in seconds, and one of frequency in hertz."""

from __future__ import annotations

import math

from permway.errors import InputError

_SECONDS: dict[str, float] = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds", "sek", "Sek", "sekunden"), 1.0),
    **dict.fromkeys(("ms", "msec", "msecs", "milli", "millis", "millisecond", "milliseconds"), 1e-3),
    **dict.fromkeys(("us", "usec", "usecs", "micros", "microsecond", "microseconds"), 1e-6),
    **dict.fromkeys(("ns", "nsec", "nanos", "nanosecond", "nanoseconds"), 1e-9),
    **dict.fromkeys(("min", "mins", "minute", "minutes"), 60.0),
    **dict.fromkeys(("h", "hr", "hour", "hours"), 3600.0),
    **dict.fromkeys(("d", "day", "days"), 86400.0),
}
_HERTZ: dict[str, float] = {
    "hz": 1.0,
    "hertz": 1.0,
    "khz": 1e3,
    "rad/s": 0.5 / math.pi,
    "rad/sec": 0.5 / math.pi,
    "rad s-1": 0.5 / math.pi,
    "rad*s-1": 0.5 / math.pi,
    "rad*s^-1": 0.5 / math.pi,
    "rad s^-1": 0.5 / math.pi,
}


def seconds_of(unit: str) -> float | None:
    """Seconds in one of a unit, None if it is none of time; of "seconds since 2024-05-01" the unit alone."""
    bare = unit.strip().split(" since ")[0].strip().replace("µ", "u").replace("μ", "u")
    # Ms are megaseconds: only words are written with capitals by chance.
    return _SECONDS.get(bare) or (_SECONDS.get(bare.lower()) if len(bare) > 2 else {"S": 1.0}.get(bare))


def seconds_in(unit: str, where: str) -> float:
    """Seconds in one of a unit of time.

    Raises
    ------
    InputError
        For any other.
    """
    found = seconds_of(unit)
    if found is None:
        remedy = 'give the time in s, ms or us, or state its unit in the record: unit = { time = "ms" }'
        raise InputError("is no unit of time", where=where, value=unit, remedy=remedy)
    return found


def hertz_in(unit: str | None, where: str) -> float:
    """Hertz in one of a unit of frequency; without a unit, frequencies are in hertz.

    Raises
    ------
    InputError
        For a text that is no unit of frequency.
    """
    if unit is None:
        return 1.0
    plain = unit.strip().replace("·", "*").replace("⋅", "*").replace("⁻¹", "-1")
    # mHz and MHz differ by their first letter alone.
    special = {"mHz": 1e-3, "MHz": 1e6}
    found = special.get(plain) or _HERTZ.get(plain.lower())
    if found is None:
        remedy = "give frequencies in Hz, kHz or rad/s"
        raise InputError("frequencies must be in Hz", where=where, value=unit, remedy=remedy)
    return found
