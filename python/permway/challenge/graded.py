"""Effects so weak that records hardly constrain them: each faded until it weighs what was drawn for it.

Effects of the other tiers are of a size that an engineer would call one, and most stand far out of the records.
What a diagnosis is worth at the edge of what can be known is seen on these.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from permway.challenge.case import Case, draw, write
from permway.challenge.weigh import Against, control_of

LEAST, MOST = 10.0, 300.0
"""Deviances that are drawn, equally likely in their logarithm: from too small to find to easy."""

NEAR = 1.25
"""Factor by which an effect's deviance may be off what was drawn."""

TRIES = 8

STEEPEST = 8.0
"""Power of the share by which a deviance may go; of a change that is small it is twice the change's own."""


def graded(seed: int, against: Against) -> tuple[Case, float]:
    """Draw a campaign of one effect, and fade it.

    Parameters
    ----------
    seed : int
    against : callable
        See :func:`permway.challenge.weigh.weigh`.

    Returns
    -------
    Case
    float
        Its deviance.

    Raises
    ------
    InputError
        For a seed below zero.
    """
    case = draw(seed, "graded")
    target = float(np.exp(np.random.default_rng([seed, 7]).uniform(math.log(LEAST), math.log(MOST))))
    with TemporaryDirectory() as place:
        folder, control = Path(place) / "case", Path(place) / "control"
        write(control_of(case), control)
        deviance = against(control)

        def weight(share: float) -> float:
            write(case.faded(share), folder)
            return deviance(folder)

        share, found = sought(weight, target)
    return case.faded(share), found


def sought(weight: Callable[[float], float], target: float) -> tuple[float, float]:
    """A share at which an effect weighs what it should, as near as some tries come.

    Parameters
    ----------
    weight : callable
        Of a share above 0, at most 1; it rises with it, and noise goes with it.
    target : float
        Above 1. An effect that is lighter as it was drawn is left so.

    Returns
    -------
    float, float
        The share, and what it weighs.
    """
    tried = [(1.0, weight(1.0))]
    while len(tried) < TRIES:
        best = min(tried, key=lambda pair: _off(pair, target))
        if _off(best, target) <= math.log(NEAR) or tried[0][1] <= target:
            break
        share = _next(tried, target)
        tried.append((share, weight(share)))
    return min(tried, key=lambda pair: _off(pair, target))


def _off(pair: tuple[float, float], target: float) -> float:
    # What weighs less than 1 is noise, or nothing.
    return abs(math.log(max(pair[1], 1.0) / target))


def _next(tried: list[tuple[float, float]], target: float) -> float:
    """By a power between the nearest two, one on each side if there are such."""
    points = sorted((math.log(share), math.log(max(found, 1.0))) for share, found in tried)
    goal = math.log(target)
    above = next(index for index, (_, found) in enumerate(points) if found > goal)
    if above == 0:
        (low, at_low), *others = points
        slope = 2.0
        if others:
            slope = min(max((others[0][1] - at_low) / (others[0][0] - low), 1.0), STEEPEST)
        return math.exp(low - (at_low - goal) / slope)
    (low, at_low), (high, at_high) = points[above - 1], points[above]
    part = (goal - at_low) / (at_high - at_low)
    return math.exp(low + min(max(part, 0.1), 0.9) * (high - low))
