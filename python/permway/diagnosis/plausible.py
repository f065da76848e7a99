"""What the catalogue says that an effect's parameters may plausibly be, and which effects go beyond it.

An effect that explains the records with constants that no such thing has stands in for something else.
"""

from __future__ import annotations

import re
from functools import cache

from permway.diagnosis.catalogue import entries
from permway.diagnosis.search import Finalist

RANGE = re.compile(r"[^,]*, ([-\d.e]+) to ([-\d.e]+)(?=:|$)")
"""A parameter's unit, and from what to what it may be, as `PARAMETERS` of an entry has it."""

NATURAL = 0.03
"""How near to none or to all, 0 and 1, an end is one beyond which nothing can be."""

AT_END = 0.002
"""Share of an end within which a parameter has come to it."""


@cache
def plausible(entry: str) -> dict[str, tuple[float, float]]:
    """Lowest and highest plausible value by parameter, for those that have such; none for what is no entry."""
    if entry not in entries():
        return {}
    said = {name: RANGE.match(text) for name, text in entries()[entry].PARAMETERS.items()}
    return {name: (float(m[1]), float(m[2])) for name, m in said.items() if m is not None}


def beyond_belief(one: Finalist) -> bool:
    """Whether a parameter's whole 90 % interval lies where the catalogue says that it cannot be.

    Or whether it ends where its range does, and would go on: at an end that is not next to none, or to all.
    """
    intervals, values, ranges = one.fit.intervals(), one.values, plausible(one.hypothesis.entry)
    for free, own in zip(one.hypothesis.free, one.own, strict=True):
        if free.name in ranges:
            (low, high), (least, most) = sorted(intervals[own]), ranges[free.name]
            ends = [end for end in (least, most) if min(abs(end), abs(1.0 - end)) > NATURAL]
            if high < least or low > most or any(abs(values[free.name] - end) < AT_END * abs(end) for end in ends):
                return True
    return False
