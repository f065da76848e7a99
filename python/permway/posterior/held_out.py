"""What amended models predict of records that were left out: log density and decibels, group by group.

The residuals of what is left out are predicted from all others: parameters, calibration errors and the discrepancy
are conditioned on what is kept, the model taken as linear about its fit to all. The density of the left out given
the kept is the ratio of two marginal likelihoods, each Gaussian. Decibels are of the model solved with the
parameters that the others ask for.

Source: Vehtari, Gelman and Gabry (2017), Statistics and Computing 27, 1413-1432, section 2.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from permway.diagnosis.side_by_side import each
from permway.diagnosis.tangent import Problem
from permway.posterior.covariance import Covariance
from permway.posterior.fit import Fit

HIDDEN = 0.115
"""Neper (1 dB): lines whose level noise scatters by as much are not counted in decibels, where a group has others:
they would show the noise."""


@dataclass(frozen=True)
class Gain:
    """What an amended model gains of one group that was left out.

    Attributes
    ----------
    axis, name : str
        Kind of group, and which.
    nats : float
        Gain of log predictive density.
    before_dB, after_dB : float
        Root mean square error of levels, no calibration error taken out; NaN without levels.
    """

    axis: str
    name: str
    nats: float
    before_dB: float
    after_dB: float


def gains(base: Fit, amended: Fit) -> list[Gain]:
    """Of every group of rows: sensors, hammer points, records, and thirds of the band."""
    rows = base.frame.observations.rows
    block_of = base.frame.observations.block_of
    names = [b.dataset.record.name for b in base.frame.observations.blocks]
    groups: list[tuple[str, str, np.ndarray]] = []
    for axis, labels in (("sensor", rows.sensor), ("force", rows.force), ("record", np.array(names)[block_of])):
        values = [str(v) for v in np.unique(labels) if str(v)]
        if len(values) > 1:
            groups += [(axis, value, labels == value) for value in values]
    edges = np.quantile(rows.frequency_Hz, [0.0, 1 / 3, 2 / 3, 1.0])
    for low, high in pairwise(edges.tolist()):
        mine = (rows.frequency_Hz >= low) & (rows.frequency_Hz <= high)
        if mine.any() and not mine.all():
            groups.append(("band", f"{low:.4g} to {high:.4g} Hz", mine))

    everything = np.ones(rows.channel.size, dtype=bool)
    whole = [_marginal(fit, everything)[0] for fit in (base, amended)]

    def gain(group: tuple[str, str, np.ndarray]) -> Gain:
        axis, name, out = group
        before, after = (_predicted(fit, out) for fit in (base, amended))
        gained = (whole[1] - after[0]) - (whole[0] - before[0])
        return Gain(axis, name, gained, before[1], after[1])

    return each(gain, groups, threads=base.frame.observations.threads, least=2)


def _predicted(fit: Fit, out: np.ndarray) -> tuple[float, float]:
    """Log marginal likelihood of all rows but those left out, and the error of these rows' levels in dB."""
    kept, shift = _marginal(fit, ~out)
    # Solved where the others have the parameters: slopes do not reach to where a resonance is elsewhere.
    observations = fit.frame.observations
    problem = Problem(observations, fit.model.build, fit.model.free)
    state = problem.at(np.clip(fit.z + shift, *fit.model.limits), fit.state.solved)
    if state is None:
        return kept, float("nan")
    levels = observations.levels_dB(state.solved.datasets)
    mine = out & np.isfinite(levels)
    clear = mine & (fit.frame.sigma < HIDDEN)
    mine = clear if clear.any() else mine
    error = float(np.sqrt(np.mean(levels[mine] ** 2))) if mine.any() else float("nan")
    return kept, error


def _marginal(fit: Fit, keep: np.ndarray) -> tuple[float, np.ndarray]:
    """Log marginal likelihood of some rows, and by how far the parameters are elsewhere without the others.

    Ends of stretches stay: between two joints they have no slope, so that the prior alone would move them.
    """
    ends = [index for centre, length, _ in fit.model.stretches for index in (centre, length)]
    moving = np.setdiff1d(np.arange(fit.z.size), ends)
    covariance = _of_rows(fit.covariance, keep)
    columns = np.column_stack([fit.state.residuals, fit.jacobian[:, moving]])
    roots = covariance.roots(columns)
    inner = roots.times(roots)
    normal = inner[1:, 1:] + np.eye(moving.size)
    slope = inner[1:, 0] + fit.z[moving]
    shift = np.zeros(fit.z.size)
    shift[moving] = -np.linalg.solve(normal, slope) if moving.size else 0.0
    least = inner[0, 0] + fit.z @ fit.z + slope @ shift[moving]
    curvature = np.linalg.slogdet(normal)[1] if moving.size else 0.0
    count = int(keep.sum())
    return -0.5 * float(least + curvature + covariance.log_determinant + count * np.log(2.0 * np.pi)), shift


def _of_rows(covariance: Covariance, keep: np.ndarray) -> Covariance:
    """As if other rows had no precision: they then weigh nothing, and their noise is not counted."""
    return covariance.frame.covariance(covariance.hyper, keep)
