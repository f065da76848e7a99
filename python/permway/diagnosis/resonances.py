"""A resonance is looked for along frequency: a fit settles in the valley that it begins in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import optimize

from permway.arrays import Reals
from permway.diagnosis.compete import Ring
from permway.diagnosis.fit import Free
from permway.diagnosis.quick import Quick

NAME = "frequency_Hz"
"""Of the constant that says where something resonates."""

PER_OCTAVE = 3
"""Frequencies at which it is looked for, by what its change there promises."""

NEAR, MOST = 0.5, 2
"""Share of what was gained that a valley must promise to be followed, and how many are."""


def retuned(ring: Ring, found: Quick) -> Quick:
    """What was followed, or the same about another frequency, where it gains more.

    Parameters
    ----------
    ring : Ring
    found : Quick
        As it was followed; what has no such constant comes back as it is.
    """
    names = [f.name for f in found.hypothesis.free]
    if NAME not in names or found.hypothesis.about or not found.gain > 0.0:
        return found
    place, hypothesis = names.index(NAME), found.hypothesis
    tried = []
    for z in _along(hypothesis.free[place], ring.evidence.rows.frequency_Hz):
        # In the other valley mass and loss may have gone where they are no start for this one.
        start = (*hypothesis.starts[0][:place], z, *hypothesis.starts[0][place + 1 :])
        tried.append(ring.screen(replace(hypothesis, starts=(start,)), least=np.inf))
    promises = np.array([-np.inf, *(q.promise for q in tried), -np.inf])
    peaks = [
        q
        for q, left, right in zip(tried, promises, promises[2:], strict=False)
        if left <= q.promise > right and q.promise > NEAR * found.gain
    ]
    peaks = sorted(peaks, key=lambda q: -q.promise)[:MOST]
    best = max([found, *(ring.quick(q.hypothesis) for q in peaks)], key=lambda q: q.gain)
    if best is found:
        return found
    return replace(found, z=best.z, base_z=best.base_z, gain=best.gain, columns=best.columns)


def _along(free: Free, lines_Hz: Reals) -> list[float]:
    """Coordinates of frequencies of the records, from the lowest that the constant may have to the highest."""
    low, high = free.limits
    low_Hz, high_Hz = max(free.value(low), float(lines_Hz.min())), min(free.value(high), float(lines_Hz.max()))
    if not low_Hz < high_Hz:
        return []
    count = max(2, int(np.ceil(PER_OCTAVE * np.log2(high_Hz / low_Hz))) + 1)
    inner = np.geomspace(low_Hz, high_Hz, count)[1:-1]
    return [float(optimize.brentq(lambda z, f=f: free.value(z) - f, low, high)) for f in inner]
