"""The deviance of a campaign's effects against the best base, by a fit: parameters may have moved far.

A shifted resonance is no straight line in a stiffness. How strong an effect is made is sought by the linear
deviance of :mod:`permway.challenge.small.strength`, which is quick; a truth states this one, which starts from the
true parameters and takes slopes anew.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy import linalg

from permway.challenge.beams import Complexes, Reals
from permway.challenge.small.strength import Part
from permway.errors import InputError, SolveError

Predicted = Callable[[Reals], Sequence[Complexes]]
"""From parameters, in standard deviations of their priors from the truth, to the responses of all records."""

STEP = 1e-3
"""Of slopes, in standard deviations of a prior."""

ROUNDS, STEPS, CUTS = 4, 4, (1.0, 0.5, 0.2, 0.05)
"""Times that slopes are taken, steps by the same slopes, and shares of a step that are tried: with half of each,
deviances of effects that shift narrow resonances come out up to a fifth higher."""

ENOUGH = 0.02
"""Share of the deviance below which a gain is none: deviances have classes three times as wide."""

FARTHEST = 8.0
"""Standard deviations from the truth within which parameters are sought, as a diagnosis does."""


def best_deviance(
    parts: Sequence[Part], concealed: Sequence[Complexes], predicted: Predicted, parameters: int
) -> float:
    """Least deviance of responses with effects from those of a base with other parameters.

    Parameters
    ----------
    parts : sequence of Part
    concealed : sequence of ndarray
        Responses with the effects, of all parts.
    predicted : callable
        Of the base; what differs between it and the parts' own base at the truth is left out.
    parameters : int
        How many there are.
    """
    goal = [p.difference(r) for p, r in zip(parts, concealed, strict=True)]
    zero = [p.difference(r) for p, r in zip(parts, predicted(np.zeros(parameters)), strict=True)]

    def displaced(z: Reals) -> list[Reals]:
        return [p.difference(r) - o for p, r, o in zip(parts, predicted(z), zero, strict=True)]

    def value(z: Reals) -> tuple[float, list[Reals]]:
        try:
            off = [p.wrapped(g - m) for p, g, m in zip(parts, goal, displaced(z), strict=True)]
        except (InputError, SolveError):
            return np.inf, []
        found = sum(_inner(p, o[:, None], o[:, None])[0, 0] for p, o in zip(parts, off, strict=True))
        return (float(found + z @ z) if np.isfinite(found) else np.inf), off

    z = np.zeros(parameters)
    least, off = value(z)
    for _ in range(ROUNDS if parameters else 0):
        started = least
        slopes = _slopes(displaced, z)
        normal = np.eye(parameters)
        for part, slope in zip(parts, slopes, strict=True):
            normal += _inner(part, slope, slope)
        factor = linalg.cho_factor(normal)
        for _ in range(STEPS):
            along = -z
            for part, slope, left in zip(parts, slopes, off, strict=True):
                along = along + _inner(part, slope, left[:, None])[:, 0]
            step, before = linalg.cho_solve(factor, along), least
            for cut in CUTS:
                tried = np.clip(z + cut * step, -FARTHEST, FARTHEST)
                new, left_there = value(tried)
                if new < least:
                    z, least, off = tried, new, left_there
                    break
            if before - least < ENOUGH * least:
                break
        if started - least < ENOUGH * least:
            break
    return least


def _inner(part: Part, one: Reals, other: Reals) -> Reals:
    """By the inverse of the covariance of noise and calibration errors."""
    return np.asarray(one.T @ other - part.reduced(one).T @ part.reduced(other))


def _slopes(displaced: Callable[[Reals], list[Reals]], z: Reals) -> list[Reals]:
    here, columns = displaced(z), []
    for index in range(z.size):
        beyond = z.copy()
        beyond[index] += STEP
        columns.append([(b - h) / STEP for b, h in zip(displaced(beyond), here, strict=True)])
    return [np.column_stack([column[i] for column in columns]) for i in range(len(here))]
