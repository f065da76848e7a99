"""Priors that span what records can show: an entry of the catalogue states what engineers meet."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.special import ndtr, ndtri

from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Hypothesis

WIDER = 4.0
"""Times the standard deviation that an entry states of the logarithm of its size: what is a factor of 2.5 of what
engineers meet is a factor of 40 of what clean records show. Twice as much costs every such effect ln 2 nats."""

SPREADS = (1.0, 1 / 4, 1 / 16, 1 / 64)
"""Of what is many numbers about none, as factors of pads that scatter: over how far an entry states that they
scatter, each equally likely. With one of them each number is paid for as if it were large."""

BEYOND = 2.0**0.5
"""Factor beyond the ends of the records' band that a resonator's frequency may lie at: it still shows there."""

APART = 0.2
"""Octaves between frequencies at which a resonator is begun, as wide a peak as lies between two. A look at small
changes then sees a loss factor of 0.03 with a quarter of its gain or more, of 0.06 with half. With twice as many
octaves it is a tenth and a fifth: such are missed at a deviance of 180; half of it takes 25 % longer.
"""


def widened(hypothesis: Hypothesis) -> Hypothesis:
    """The same with a prior of its size that spans what clean records can show.

    An entry states sizes that engineers meet. What is a thousandth of them shows in clean records, too.
    """
    free = []
    starts = np.array(hypothesis.starts, dtype=np.float64)
    for index, one in enumerate(hypothesis.free):
        if one.name != hypothesis.size or hypothesis.none != 0.0 or not _logarithmic(one):
            free.append(one)
            continue
        low, high = one.limits
        free.append(replace(one, value=partial(_wider, one.value), limits=(min(low, -high), high / WIDER)))
        starts[:, index] /= WIDER
    return replace(hypothesis, free=tuple(free), starts=tuple(tuple(map(float, row)) for row in starts))


def tuned(hypothesis: Hypothesis, band_Hz: tuple[float, float]) -> Hypothesis:
    """The same with a frequency of its own anywhere in a band, evenly likely in its logarithm.

    An entry states the frequencies that engineers met; a damper may be tuned to any.
    """
    at = next((i for i, f in enumerate(hypothesis.free) if f.name == "frequency_Hz" and _logarithmic(f)), None)
    if at is None:
        return hypothesis
    free = list(hypothesis.free)
    free[at] = replace(free[at], value=partial(_between, band_Hz), limits=(-4.0, 4.0))
    low, high = np.log2(band_Hz)
    count = max(1, round((high - low) / APART))
    places = ndtri((np.arange(count) + 0.5) / count)
    others = dict.fromkeys(
        (start[:at], start[at + 1 :]) for start in map(partial(_broad, free), hypothesis.starts)
    )
    starts = tuple((*before, float(z), *after) for before, after in others for z in places)
    return replace(hypothesis, free=tuple(free), starts=starts)


def with_starts(hypothesis: Hypothesis) -> Hypothesis:
    """The same with starts on either side, in place of those at which there is nothing: no look shows these."""
    at = next((i for i, f in enumerate(hypothesis.free) if f.name == hypothesis.size), None)
    if at is None:
        return hypothesis
    starts: list[tuple[float, ...]] = []
    for start in hypothesis.starts:
        away = (0.0,) if hypothesis.free[at].value(start[at]) != hypothesis.none else (-1.0, 1.0)
        starts.extend((*start[:at], start[at] + side, *start[at + 1 :]) for side in away)
    return replace(hypothesis, starts=tuple(starts))


def spread_out(hypothesis: Hypothesis) -> Iterator[Hypothesis]:
    """The same with its many numbers about none scattering less, if it is such."""
    alone = hypothesis.size or len(hypothesis.free) < 3
    if alone or any(
        f.value(0.0) != 0.0 or not math.isclose(f.value(-1.0), -f.value(1.0)) for f in hypothesis.free
    ):
        yield hypothesis
        return
    for spread in SPREADS:
        free = tuple(replace(f, value=partial(_times, f.value, spread)) for f in hypothesis.free)
        yield replace(hypothesis, free=free)


def _broad(free: Sequence[Free], start: Sequence[float]) -> tuple[float, ...]:
    """A start with a loss factor of at least the distance to the next: a narrower peak is seen by none."""
    found = list(start)
    for index, one in enumerate(free):
        if one.name == "loss_factor" and _logarithmic(one):
            middle, next_to = one.value(0.0), one.value(1.0)
            enough = math.log(APART * math.log(2.0) / middle) / math.log(next_to / middle)
            found[index] = min(max(start[index], enough), one.limits[1])
    return tuple(found)


def _between(band: tuple[float, float], z: float) -> float:
    return float(band[0] * (band[1] / band[0]) ** float(ndtr(z)))


def _times(value: Callable[[float], float], factor: float, z: float) -> float:
    return factor * value(z)


def _wider(value: Callable[[float], float], z: float) -> float:
    return value(WIDER * z)


def _logarithmic(free: Free) -> bool:
    """Whether its values go with the exponential of z."""
    ends = [free.value(z) for z in (0.0, 1.0, 2.0)]
    return ends[0] > 0.0 and math.isclose(ends[1] ** 2, ends[0] * ends[2], rel_tol=1e-9)
