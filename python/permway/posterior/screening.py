"""The first look: every cell scored about one fit, its parameters moving along in a straight line.

Two scores. The objective of a cell as it stands serves where the fit lacks much: the cell may be most of it. What
the cell's change would gain if it came in any measure serves where the fit lacks little: a small effect changes
the residuals in proportion to its size, so that this bounds what a full fit can gain, to first order.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.side_by_side import SMALL, each
from permway.errors import InputError, SolveError
from permway.posterior.cells import Cell
from permway.posterior.fit import Fit, grown

BATCH = 64
"""Cells whose residuals are held at once."""


@dataclass(frozen=True)
class Scores:
    """Of cells, in their order.

    Attributes
    ----------
    objective : ndarray, shape (cells,)
        Minus two log posterior of each as it stands, the fit's parameters moved along, comparable with
        :attr:`permway.posterior.fit.Fit.objective`; infinite where it cannot be solved.
    gain : ndarray, shape (cells,)
        By how much its change in the most favourable measure lowers the fit's objective.
    measure : ndarray, shape (cells,)
        That measure: 1 is the change as it stands, 0 none.
    """

    objective: Reals
    gain: Reals
    measure: Reals


def screened(fit: Fit, cells: Sequence[Cell], progress: Callable[[int], object] = lambda _: None) -> Scores:
    """Score all cells about a fit.

    Parameters
    ----------
    fit : Fit
        With exact slopes.
    cells : sequence of Cell
    progress : callable
        Called with how many are done.
    """
    evidence, solved, build = fit.frame.evidence, fit.state.solved, fit.model.build
    base = build(fit.values())
    factor = linalg.cho_factor(fit.normal) if fit.z.size else None
    rest = fit.objective - fit.covariance.square(fit.state.deviations) - float(fit.z @ fit.z)

    def amended(cell: Cell) -> Campaign:
        if not cell.hypothesis.moves:
            return cell.hypothesis.amend(base, cell.values)
        own = {f"+{name}": value for name, value in cell.values.items()}
        return grown(fit, cell.hypothesis, "+").build({**fit.values(), **own})

    def residuals(cell: Cell) -> Reals | None:
        try:
            predicted = evidence.predicted(amended(cell), solved)
            found = evidence.deviations(predicted.datasets)
        except (InputError, SolveError):
            return None
        return found if np.isfinite(found).all() else None

    objective, gain, measure = np.full(len(cells), np.inf), np.zeros(len(cells)), np.zeros(len(cells))
    before = fit.covariance.roots(fit.state.deviations[:, None])
    least = float(before.squares()[0])
    uphill = fit.roots.times(before)[:, 0] + fit.z
    for start in range(0, len(cells), BATCH):
        batch = each(residuals, cells[start : start + BATCH], threads=evidence.threads, least=SMALL)
        solved_ones = {index: found for index, found in enumerate(batch) if found is not None}
        if solved_ones:
            roots = fit.covariance.roots(np.stack(list(solved_ones.values()), axis=1))
            square, across = roots.squares(), before.times(roots)[0]
            # Of r + a d: d' r, and d' d, by the inverse of the covariance.
            along, size = across - least, square - 2.0 * across + least
            if factor is not None:
                slope = fit.roots.times(roots) + fit.z[:, None]
                square += float(fit.z @ fit.z) - np.einsum("pk,pk->k", slope, linalg.cho_solve(factor, slope))
                change = slope - uphill[:, None]
                turned = linalg.cho_solve(factor, change)
                along = along - uphill @ turned
                size = size - np.einsum("pk,pk->k", change, turned)
            at = start + np.array(list(solved_ones))
            objective[at] = square + np.array([float(cells[i].z @ cells[i].z) for i in at]) + rest
            # Of r + a d with a at least 0.
            measure[at] = np.where(along < 0.0, -along / np.maximum(size, 1e-300), 0.0)
            gain[at] = -measure[at] * along
        progress(min(start + BATCH, len(cells)))
    return Scores(objective, gain, measure)
