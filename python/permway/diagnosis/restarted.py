"""A hypothesis begun anew from each of its starts: what leaves the line alone is soon tried, and has valleys."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from permway.diagnosis.compete import Ring
from permway.diagnosis.quick import Quick

NEAR, MOST = 0.5, 3
"""Share of what was gained that one step from a start must gain for it to be followed, and how many are."""


def restarted(ring: Ring, found: Quick) -> Quick:
    """What was followed, or the same from another of its starts, where it gains more.

    Screening keeps the start that promises most before a step is taken. A bending bogie frame promised 1562 near
    its frequency and ended with 2730; from a start that promised nothing one step led to 2503, and on to 13330.

    Parameters
    ----------
    ring : Ring
    found : Quick
        As it was followed; a change of the line, each step of which is a solve, comes back as it is.
    """
    hypothesis = found.hypothesis
    if hypothesis.domain == "path" or hypothesis.about or len(hypothesis.starts) < 2 or not found.gain > 0.0:
        return found
    others = [
        start for start in hypothesis.starts if found.start is None or not np.array_equal(start, found.start)
    ]
    stepped = [ring.screen(replace(hypothesis, starts=(start,))) for start in others]
    stepped = sorted((q for q in stepped if q.gain > NEAR * found.gain), key=lambda q: -q.gain)[:MOST]
    best = max([found, *(ring.quick(q.hypothesis, after=q) for q in stepped)], key=lambda q: q.gain)
    return found if best is found else replace(best, hypothesis=hypothesis)
