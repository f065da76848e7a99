"""A quick look at all hypotheses: each after one step, and the most promising as far as they go."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from permway.diagnosis.choose import RIVAL, WORTH, chosen_of, lines, penalty
from permway.diagnosis.clock import Progress
from permway.diagnosis.compete import Ring
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.quick import Quick
from permway.diagnosis.resonances import retuned
from permway.diagnosis.restarted import restarted
from permway.diagnosis.side_by_side import SMALL, each
from permway.errors import InputError, SolveError

TOGETHER = 2
"""Hypotheses that promise more than all others gain, and gain nothing while the base moves linearly."""

AT_ONCE = 128
"""Hypotheses that are screened side by side, each against the best of those before all of them."""

PROMISE = 3.0
"""Times that its other parameters may better what the start of a hypothesis promises."""


def looked(
    ring: Ring, offered: Sequence[Hypothesis], before: Sequence[Quick], most: int, progress: Progress
) -> tuple[list[Quick], list[Quick]]:
    """All that could be solved after a step, and the most promising as far as they go, the best first."""
    screened = _screened(ring, offered, before, progress)
    screened.sort(key=lambda q: penalty(q, ring) - q.gain)
    chosen = chosen_of(screened, ring, most)
    threads = ring.evidence.threads

    def followed_on(one: Quick) -> dict[str, Any]:
        return ring.quick(one.hypothesis, after=one).numbers

    numbers = each(followed_on, chosen, threads=threads, told=lambda begun: progress("follow", begun, len(chosen)))
    followed = [Quick(one.hypothesis, **found) for one, found in zip(chosen, numbers, strict=True)]
    best = max((q.gain for q in followed), default=0.0)
    unkept = [
        q
        for q in screened
        if q.hypothesis.domain == "path" and q.gain <= 0.0 and q.promise > max(best, penalty(q, ring))
    ]
    unkept.sort(key=lambda q: -q.promise)
    for one in unkept[:TOGETHER]:
        # The base is bent so far that moving it in a straight line leads nowhere.
        progress("follow", len(chosen), len(chosen))
        with contextlib.suppress(InputError, SolveError):
            followed.append(ring.together(one))
    best = max((q.gain for q in followed), default=0.0)
    near = [one for one in followed if one.gain > RIVAL * best]
    far = [one for one in followed if one.gain <= RIVAL * best]

    def begun_elsewhere(one: Quick) -> dict[str, Any]:
        # What asks for more than it gains is none in any valley.
        return retuned(ring, restarted(ring, one) if one.gain > penalty(one, ring) else one).numbers

    numbers = each(
        begun_elsewhere,
        near,
        threads=threads,
        told=lambda _: progress("follow", len(chosen), len(chosen)),
    )
    followed = [*far, *(Quick(one.hypothesis, **found) for one, found in zip(near, numbers, strict=True))]
    followed.sort(key=lambda q: penalty(q, ring) - q.gain)
    return screened, followed


def _screened(
    ring: Ring, offered: Sequence[Hypothesis], before: Sequence[Quick], progress: Progress
) -> list[Quick]:
    """All that could be solved, after a step from the most promising start."""
    known = {key(q.hypothesis): q for q in before if q.direction is not None}
    found: list[Quick] = []
    best = 0.0

    def numbers(hypothesis: Hypothesis) -> dict[str, Any]:
        asked = len(hypothesis.free) * np.log(lines(ring.fit))
        old = known.get(key(hypothesis))
        if hypothesis.domain != "path" and len(hypothesis.starts) > 1:
            # Another of its starts may be the better one now, and what leaves the line alone is soon tried.
            old = None
        if old is not None and (promise := ring.promise(old)) < asked / PROMISE:
            return replace(old, base_z=ring.fit.z, gain=promise, promise=promise).numbers
        return ring.screen(hypothesis, least=max(asked / PROMISE, WORTH * best / PROMISE)).numbers

    for start in range(0, len(offered), AT_ONCE):
        some = offered[start : start + AT_ONCE]
        for hypothesis in some:
            ring.about(hypothesis)
        told = partial(_told, progress, start, len(offered))
        pairs = zip(some, each(numbers, some, threads=ring.evidence.threads, least=SMALL, told=told), strict=True)
        new = [Quick(hypothesis, **found) for hypothesis, found in pairs]
        found += [one for one in new if np.isfinite(one.gain)]
        best = max([best, *(one.gain for one in found)])
    return found


def _told(progress: Progress, start: int, total: int, begun: int) -> None:
    progress("screen", start + begun, total)


def key(hypothesis: Hypothesis) -> tuple[str, ...]:
    """What makes a hypothesis the same as one of an earlier round: effect, place, and what is free."""
    values = {f.name: f.value(float(z)) for f, z in zip(hypothesis.free, hypothesis.starts[0], strict=True)}
    return *hypothesis.form, hypothesis.locate(values).label
