"""Where recalibration begins in speeds and times of entry: phases turn with them, so that slopes lead astray.

Two wheelsets 20 m apart at 60 m/s and 400 Hz are two radians out of phase for a quarter of a percent of speed.
Each is therefore looked for on a grid, all other values at the centre of their priors; levels hardly matter. Of a
passage time and speed make up for each other, so both are looked for twice.
"""

from __future__ import annotations

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.observations import Observations
from permway.diagnosis.tangent import Problem

GRID = 41
"""Points of the grid, from one bound to the other: for bounds of 1 %, steps of 0.05 %."""

LIMITS = 4.0
"""Standard deviations of the prior to which speeds without bounds are looked for."""


def begin(observations: Observations, problem: Problem) -> Reals:
    """Coordinates z to begin at, shape (p,): 0 but for speeds that are free.

    Parameters
    ----------
    observations : Observations
    problem : Problem
        Whose free parameters are the campaign's own.
    """
    z = np.zeros(len(problem.free))
    known = observations.campaign.parameters
    mine = [i for i, f in enumerate(problem.free) if "campaign.conditions" in known.touches(f.name)]
    # Loads act in proportion, and slopes find them.
    mine = [i for i in mine if not _is_load(observations, problem.free[i].name)]
    start = problem.at(z) if mine else None
    if start is None:
        return z
    passing = any(dataset.record.statistic == "passage" for dataset in observations.datasets)
    for index in mine * (2 if passing else 1):
        low, high = problem.free[index].limits
        best = np.inf
        for value in np.linspace(max(low, -LIMITS), min(high, LIMITS), GRID):
            tried = z.copy()
            tried[index] = value
            residuals, _ = problem.residuals(tried, start.solved)
            # Few lines must not outweigh all others: the base may be far off in some.
            misfit = float(np.log1p(residuals**2).sum()) + value**2
            if misfit < best:
                best, z[index] = misfit, value
    return z


def _is_load(observations: Observations, name: str) -> bool:
    paths = observations.campaign.parameters.known[name].parameter.paths
    return all(".axles.load" in path for path in paths)
