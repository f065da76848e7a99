"""Where recalibration begins in speeds and times of entry: phases turn with them, so that slopes lead astray.

Two wheelsets 20 m apart at 60 m/s and 400 Hz are two radians out of phase for a quarter of a percent of speed.
Each is therefore looked for on a grid, all other values at the centre of their priors; levels hardly matter. A
bridge that rings on behind the train has peaks so narrow that its stiffness is looked for, too. Speed, time of
entry and stiffness make up for each other, so all grids are gone over twice.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.observations import Observations
from permway.diagnosis.tangent import Problem

GRID, OF_BODIES = 41, 21
"""Points of the grid, from one bound to the other: for speeds within 1 % steps of 0.05 %; for a stiffness known to
7.5 % steps of 3 %, a frequency's of 1.5 %. With half of them fits of three bridges ended alike, begun
farther off; twice take twice the time."""

ROUNDS = 2
"""Times that all grids are gone over: with one, one of 67 bridges was begun in the valley of another stiffness.
Until nothing moves, six begin alike. Each takes a hundred predictions, 20 s where axles have springs."""

LIMITS = 4.0
"""Standard deviations of the prior to which values without bounds are looked for."""

ELSEWHERE = (".axles.load", ".suspension", ".loss_factor", ".damping_ratio", "_damping_s", "_damping_per_s")
"""What slopes find: loads and losses move no phase and no peak; a bogie's peaks are wide."""


def begin(observations: Observations, problem: Problem) -> Reals:
    """Coordinates z to begin at, shape (p,): 0 but for speeds that are free, and bodies of a line that is passed.

    Parameters
    ----------
    observations : Observations
    problem : Problem
        Whose free parameters are the campaign's own.
    """
    z = np.zeros(len(problem.free))
    runs, bodies = (_moving(observations, problem, part) for part in ("campaign.conditions", "line.bodies"))
    if not any(dataset.record.statistic == "passage" for dataset in observations.datasets):
        return _looked(problem, z, runs, ())[0]
    # A wrong stiffness bends the time of entry, and a wrong time the stiffness: whichever is begun with.
    orders = (runs + bodies, bodies + runs) if bodies else (runs,)
    return min((_settled(problem, z, order, bodies) for order in orders), key=lambda one: one[1])[0]


def _settled(problem: Problem, z: Reals, order: Sequence[int], coarse: Sequence[int]) -> tuple[Reals, float]:
    """As :func:`_looked`, again while it helps: what is looked for first was looked for with the others wrong."""
    best = np.inf
    for _ in range(ROUNDS):
        found, least = _looked(problem, z, order, coarse)
        if not least < best:
            break
        z, best = found, least
    return z, best


def _looked(problem: Problem, z: Reals, order: Sequence[int], coarse: Sequence[int]) -> tuple[Reals, float]:
    """Coordinates with the least robust sum of residuals and priors, on one grid after the other, and that sum."""
    best = np.inf
    for index in order:
        start = problem.at(z)
        if start is None:
            return z, best
        low, high = problem.free[index].limits
        began, best = z, _misfit(start.residuals, z)
        points = OF_BODIES if index in coarse else GRID
        for value in np.linspace(max(low, -LIMITS), min(high, LIMITS), points):
            tried = began.copy()
            tried[index] = value
            misfit = _misfit(problem.residuals(tried, start.solved)[0], tried)
            if misfit < best:
                best, z = misfit, tried
    return z, best


def _misfit(residuals: Reals, z: Reals) -> float:
    """Few lines must not outweigh all others: the base may be far off in some."""
    return float(np.log1p(residuals**2).sum() + z @ z)


def _moving(observations: Observations, problem: Problem, part: str) -> list[int]:
    """Free parameters of a part of campaign or model that move phases or peaks."""
    known = observations.campaign.parameters

    def moves(name: str) -> bool:
        paths = known.known[name].parameter.paths
        return part in known.touches(name) and not all(any(w in path for w in ELSEWHERE) for path in paths)

    return [index for index, free in enumerate(problem.free) if moves(free.name)]
