"""The smallest size of every effect that a campaign would have shown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.diagnosis.choose import penalty
from permway.diagnosis.compete import Ring
from permway.diagnosis.felt import FELT
from permway.diagnosis.fit import Free
from permway.diagnosis.quick import Quick
from permway.diagnosis.verdict_parts import E_VALUE, Smallest
from permway.errors import InputError, SolveError

HALVES = 5.0
"""Gain of the objective over that of the density of one half of the records foretold from the other: 4 if both
told alike, and they never do."""

MOST_TIMES = 5.0
"""Times a usual size beyond which an effect is not said to be detectable."""


def detectable(ring: Ring, screened: Sequence[Quick], threshold: float) -> dict[str, Smallest]:
    """The smallest size of every effect that these records would have shown.

    Its deviance, which grows with the square of its size, must pass the threshold, what BIC asks and what an
    e-value asks; and its change of predictions what is felt; both are known at the size that the effect was
    screened at. Sizes of smooth errors are learnt again with the effect in the records: m coefficients of one size
    take up all but m ln(1 + d / m) of a deviance d. Of physics it is said where it shows most; of faults of the
    measurement for the channel that shows them least, for nobody chooses which channel goes wrong.

    Returns
    -------
    dict
        By effect, in the unit of the parameter that says how strong it is; those that no plausible size would show
        are left out.
    """
    foretold = HALVES * float(np.log(E_VALUE) + np.log(max(len(screened), 1)) + 0.5)
    shown: dict[str, dict[tuple[str, ...], tuple[float, Smallest | None]]] = {}
    for quick in screened:
        hypothesis = quick.hypothesis
        if quick.direction is None or quick.start is None or not hypothesis.size:
            continue
        needed = _needed(ring, quick, max(threshold + penalty(quick, ring), foretold))
        if needed is None:
            continue
        index = [f.name for f in hypothesis.free].index(hypothesis.size)
        size = _size(hypothesis.free[index], float(quick.start[index]), hypothesis.none, needed)
        values = {f.name: f.value(float(z)) for f, z in zip(hypothesis.free, quick.start, strict=True)}
        fault = hypothesis.domain == "measurement"
        channels = hypothesis.locate(values).channels if fault else ()
        if size is None or needed >= MOST_TIMES:
            needed, size = np.inf, None
        best = shown.setdefault(hypothesis.entry, {})
        if needed <= best.get(channels, (np.inf, None))[0]:
            best[channels] = needed, size
    least = {entry: max(places.values(), key=lambda one: one[0]) for entry, places in shown.items()}
    return {entry: size for entry, (_, size) in least.items() if size is not None}


def _needed(ring: Ring, quick: Quick, gain: float) -> float | None:
    """Times the size that a hypothesis was screened at for a gain; None where it cannot be said."""
    assert quick.direction is not None
    assert quick.start is not None
    column = np.asarray(quick.direction[:, None], dtype=np.float64)
    deviance = float(ring.projected(column, column)[0, 0])
    if deviance <= 0.0:
        return None
    coefficients = _coefficients(ring, quick)
    more = gain if coefficients == 0 else coefficients * float(np.expm1(min(gain / coefficients, 50.0)))
    needed = float(np.sqrt(more / deviance))
    if quick.hypothesis.domain == "measurement":
        return needed
    try:
        # However sure, what nobody would feel is not called.
        return max(needed, FELT / max(ring.felt(quick.hypothesis, quick.start), 1e-12))
    except (InputError, SolveError):
        # It was screened about an earlier base, and cannot stand beside what was found since.
        return None


def _coefficients(ring: Ring, quick: Quick) -> int:
    """Of smooth errors' gains, whose sizes are learnt: of the channels at fault, or of all."""
    channels: tuple[str, ...] = ()
    if quick.hypothesis.domain == "measurement" and quick.start is not None:
        free = quick.hypothesis.free
        values = {f.name: f.value(float(z)) for f, z in zip(free, quick.start, strict=True)}
        channels = quick.hypothesis.locate(values).channels
    origins = {o.name: o.wander.count for b in ring.fit.evidence.blocks for o in b.smooth.origins if not o.fixed}
    mine = [count for name, count in origins.items() if not channels or name.split(" ", 1)[-1] in channels]
    return sum(mine)


def _size(free: Free, start: float, none: float, times: float) -> Smallest | None:
    """So many times as far from nothing as a start is; None beyond what the effect can be."""
    usual = free.value(start)
    if np.isinf(none):
        return Smallest(parameter=free.name, value=usual / float(np.sqrt(times)), unit=free.unit, none=None)
    value = none + times * (usual - none)
    ends = sorted(free.value(z) for z in free.limits)
    if usual == none or not ends[0] <= value <= ends[1]:
        return None
    return Smallest(parameter=free.name, value=value, unit=free.unit, none=none)
