"""The first look: every cell scored about one fit, its parameters moving along in a straight line.

Two scores. The objective of a cell as it stands serves where the fit lacks much: the cell may be most of it. What
the cell's change would gain if it came in any measure serves where the fit lacks little: a small effect changes
the residuals in proportion to its size, so that this bounds what a full fit can gain, to first order.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.side_by_side import SMALL, each
from permway.errors import InputError, SolveError
from permway.posterior.cells import Cell
from permway.posterior.fit import Fit, grown
from permway.recordings.campaign import Campaign

BATCH = 64
"""Cells whose residuals are held at once."""

EACH_FORM = 12
"""Changes of the line of one form, the best by hammer tests, that are scored by all records: twice as many as are
fitted."""

SEEN = 0.01
"""Square of a change, in standard deviations, from which hammer tests show it. The discrepancy is large where they
are asked, so that a tenth of a deviation is a change of a tenth of one line."""


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
    shown : ndarray, shape (cells,)
        Square of its change as it stands, in standard deviations, the fit's parameters moved along.
    """

    objective: Reals
    gain: Reals
    measure: Reals
    shown: Reals

    @staticmethod
    def none(count: int) -> Scores:
        """Of cells that are not scored."""
        return Scores(np.full(count, np.inf), np.zeros(count), np.zeros(count), np.zeros(count))


def screened(fit: Fit, cells: Sequence[Cell], progress: Callable[[int], object] = lambda _: None) -> Scores:
    """Score all cells about a fit.

    Runs cost most, and say little of the line that hammer tests of it do not say. So where there are both, changes
    of the line are looked at in the hammer tests first. The best, and those that these hardly show, are then
    scored by all records; the others are given no gain.

    Parameters
    ----------
    fit : Fit
        With exact slopes.
    cells : sequence of Cell
    progress : callable
        Called with how many are done.
    """
    kinds = {block.dataset.record.statistic for block in fit.frame.evidence.blocks}
    if not {"frf", "csd"} <= kinds:
        return _scored(fit, cells, progress)
    of_line = [index for index, cell in enumerate(cells) if cell.hypothesis.domain == "path"]
    first = _scored(fit.only("frf"), [cells[i] for i in of_line], progress)
    chosen = set(range(len(cells))) - set(of_line)
    chosen |= {index for index, shown in zip(of_line, first.shown, strict=True) if shown < SEEN}
    prior = np.array([cells[i].log_prior for i in of_line])
    for score in (first.objective - 2.0 * prior, -first.gain - 2.0 * prior):
        count: Counter[tuple[str, ...]] = Counter()
        for index in (of_line[at] for at in np.argsort(score).tolist()):
            form = cells[index].hypothesis.form
            count[form] += 1
            if count[form] <= EACH_FORM:
                chosen.add(index)
    again, done = sorted(chosen), len(of_line)
    rest = _scored(fit, [cells[i] for i in again], lambda count: progress(min(done + count, len(cells))))
    found = Scores.none(len(cells))
    for name in ("objective", "gain", "measure", "shown"):
        getattr(found, name)[again] = getattr(rest, name)
    return found


def _scored(fit: Fit, cells: Sequence[Cell], progress: Callable[[int], object]) -> Scores:
    """By all records of a fit."""
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

    scores = Scores.none(len(cells))
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
            scores.objective[at] = square + np.array([float(cells[i].z @ cells[i].z) for i in at]) + rest
            # Of r + a d with a at least 0.
            scores.measure[at] = np.where(along < 0.0, -along / np.maximum(size, 1e-300), 0.0)
            scores.gain[at] = -scores.measure[at] * along
            scores.shown[at] = size
        progress(min(start + BATCH, len(cells)))
    return scores
