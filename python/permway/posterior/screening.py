"""The first look: every cell scored about one fit, its parameters moving along in a straight line.

Two scores. The objective of a cell as it stands serves where the fit lacks much: the cell may be most of it. What
the cell's change would gain if it came in any measure serves where the fit lacks little: a small effect changes
the residuals in proportion to its size, so that this bounds what a full fit can gain, to first order.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.side_by_side import each
from permway.posterior.cells import SMALL as SHARE
from permway.posterior.cells import Cell, least_measure, resized, times
from permway.posterior.changes import Changes
from permway.posterior.covariance import Covariance
from permway.posterior.fit import Fit
from permway.posterior.hyper import Hyper
from permway.posterior.journal import kept_table
from permway.posterior.roots import Roots, Weighted

EACH_FORM, EACH_SMALL = 12, 4
"""Changes of the line of one form, the best by hammer tests, that are scored by all records, and of small ones:
twice as many as are fitted."""

PARTS, MOST_AT_ONCE = 16, 64
"""Batches that cells are scored in, so that each process has several, and cells of one batch, at most: 10 MB of a
large campaign's. Half and twice as many take the same time."""

ROUNDED = 1e-16
"""Square of a change, in standard deviations, that residuals are rounded to."""

SEEN = 0.01
"""Square of a change, in standard deviations, from which hammer tests show it. The discrepancy is large where they
are asked, so that a tenth of a deviation is a change of a tenth of one line."""

SEEN_WHOLE = 10.0
"""The same in a look at small changes, of a change as large as a start has it: three deviations."""

CLOSER = 6.0
"""Of the objective, from which what gains is looked at once more: of less, few are worth a fit."""

LIMITED = 0.01
"""Share by which a size stays behind what would gain most because of its limits."""


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
        That measure of its size: 1 is the change as it stands, 0 none, below 0 the other way.
    shown : ndarray, shape (cells,)
        Square of its change as it stands, in standard deviations, the fit's parameters moved along.
    view : ndarray of int, shape (cells,)
        With which hyperparameters it gains most: 0 the fit's own.
    """

    objective: Reals
    gain: Reals
    measure: Reals
    shown: Reals
    view: np.ndarray

    @staticmethod
    def none(count: int) -> Scores:
        """Of cells that are not scored."""
        nothing = np.zeros(count)
        return Scores(
            np.full(count, np.inf), nothing, nothing.copy(), nothing.copy(), np.zeros(count, dtype=np.int64)
        )

    @staticmethod
    def joined(parts: Sequence[Scores]) -> Scores:
        """Of all cells, from those of some at a time."""
        every = [Scores.none(0), *parts]
        return Scores(*(np.concatenate([getattr(one, f.name) for one in every]) for f in fields(Scores)))


def screened(
    fit: Fit,
    cells: Sequence[Cell],
    progress: Callable[[int], object] = lambda _: None,
    others: Sequence[Hyper] | None = None,
) -> Scores:
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
    others : sequence of Hyper, optional
        If given, cells are small changes, and what gains is looked at once more where it gains most. With these
        hyperparameters a gain counts, too, less what the fit itself loses by them.
    """
    logs = [hyper.log for hyper in others or ()]
    given = (fit.state.residuals, fit.z, fit.hyper.log, *logs, len(cells), *(cell.z for cell in cells))

    def take() -> Scores:
        if others is None:
            return _looked(fit, cells, progress)
        return _closer(fit, cells, _looked(fit, cells, progress, others, small=True), others)

    return kept_table(take, Scores, *given)


def _closer(fit: Fit, cells: Sequence[Cell], found: Scores, others: Sequence[Hyper]) -> Scores:
    """With what gains changed by as much: a change may bend, and its size may have limits."""
    at = np.flatnonzero(found.gain > CLOSER).tolist()
    changed = [resized(cells[i], float(found.measure[i])) for i in at]
    again = _scored(fit, changed, lambda _: None, others)
    gain, measure = found.gain[at], found.measure[at]
    reached = np.array([times(new, cells[i]) for i, new in zip(at, changed, strict=True)])
    limited = np.abs(reached) < (1.0 - LIMITED) * np.abs(measure)
    better = limited | (again.gain > gain)
    found.measure[at] = np.where(again.gain > 0.0, reached * again.measure, measure)
    found.gain[at] = np.where(better, again.gain, gain)
    found.view[at] = np.where(better, again.view, found.view[at])
    return found


def _looked(
    fit: Fit,
    cells: Sequence[Cell],
    progress: Callable[[int], object],
    others: Sequence[Hyper] = (),
    small: bool = False,
) -> Scores:
    """In hammer tests first where there are runs, too."""
    kinds = {block.dataset.record.statistic for block in fit.frame.observations.blocks}
    if not {"frf", "csd"} <= kinds:
        return _scored(fit, cells, progress, others, small)
    of_line = [index for index, cell in enumerate(cells) if cell.hypothesis.domain == "path"]
    first = _scored(fit.only("frf"), [cells[i] for i in of_line], progress, (), small)
    chosen = set(range(len(cells))) - set(of_line)
    least = SEEN_WHOLE * SHARE**2 if small else SEEN
    chosen |= {index for index, shown in zip(of_line, first.shown, strict=True) if shown < least}
    prior = np.array([cells[i].log_prior for i in of_line])
    score = (-first.gain if small else first.objective) - 2.0 * prior
    count: Counter[tuple[str, ...]] = Counter()
    for index in (of_line[at] for at in np.argsort(score).tolist()):
        form = cells[index].hypothesis.form
        count[form] += 1
        if count[form] <= (EACH_SMALL if small else EACH_FORM):
            chosen.add(index)
    again, done = sorted(chosen), len(of_line)
    rest = _scored(fit, [cells[i] for i in again], lambda n: progress(min(done + n, len(cells))), others, small)
    found = Scores.none(len(cells))
    for name in ("objective", "gain", "measure", "shown", "view"):
        getattr(found, name)[again] = getattr(rest, name)
    return found


@dataclass(frozen=True)
class _View:
    """A fit with some sizes of errors, and what the first look needs of it.

    Attributes
    ----------
    covariance : Covariance
    about : Roots
        Of the residuals and the slopes.
    factor : (ndarray, bool) or None
        Of half the curvature; None of a fit without parameters.
    uphill : ndarray, shape (p,)
        Half the slope.
    moved : float
        The least objective of the fit itself, its parameters moved along.
    """

    covariance: Covariance
    about: Roots
    factor: tuple[Reals, bool] | None
    uphill: Reals
    moved: float

    @staticmethod
    def of(fit: Fit, covariance: Covariance, weighted: Weighted) -> _View:
        """Of a fit whose residuals and slopes are weighed."""
        about = covariance.rooted(weighted)
        inner = about.times(about)
        uphill = inner[1:, 0] + fit.z
        factor = linalg.cho_factor(inner[1:, 1:] + np.eye(fit.z.size)) if fit.z.size else None
        gain = 0.0 if factor is None else float(uphill @ linalg.cho_solve(factor, uphill))
        objective = fit.objective_of(covariance, float(inner[0, 0]))
        return _View(covariance, about, factor, uphill, objective - gain)

    def scores(self, changed: _Changed) -> tuple[Reals, Reals, Reals]:
        """Of columns d that residuals r change by: the least objective, and the products r'd and d'd.

        All with the fit's parameters moved along; without the prior of the change.
        """
        below = self.covariance.rooted(changed.weighted).below
        size = changed.size - np.einsum("nk,nk->k", below, below)
        products = changed.beside - self.about.below.T @ below
        along, slope = products[0], products[1:]
        if self.factor is not None:
            turned = linalg.cho_solve(self.factor, slope)
            along, size = along - self.uphill @ turned, size - np.einsum("pk,pk->k", slope, turned)
        return self.moved + 2.0 * along + size, along, size


@dataclass(frozen=True)
class _Changed:
    """Columns that residuals change by; their products with themselves, (k,), and with residuals and slopes."""

    weighted: Weighted
    size: Reals
    beside: Reals

    @staticmethod
    def of(view: _View, changes: Reals) -> _Changed:
        """For all views that share a view's noise."""
        weighted = view.covariance.weighted(changes)
        above = weighted.above
        return _Changed(weighted, np.einsum("nk,nk->k", above, above), view.about.above.T @ above)


def _scored(
    fit: Fit,
    cells: Sequence[Cell],
    progress: Callable[[int], object],
    others: Sequence[Hyper] = (),
    small: bool = False,
) -> Scores:
    """By all records of a fit, and with other hyperparameters where these make more of a change."""
    weighted = fit.covariance.weighted(np.column_stack([fit.state.residuals, fit.jacobian]))
    covariances = [fit.covariance, *(fit.covariance.resized(hyper) for hyper in others)]
    views = [_View.of(fit, covariance, weighted) for covariance in covariances]
    changes = Changes(fit, small=small)
    size = min(max(len(cells) // PARTS, 1), MOST_AT_ONCE)
    starts = range(0, len(cells), size)

    def work(start: int) -> Scores:
        return _of_batch(views, changes, cells[start : start + size])

    threads = fit.frame.observations.threads
    found = each(work, starts, threads=threads, progress=lambda n: progress(n * size))
    progress(len(cells))
    return Scores.joined(found)


def _of_batch(views: Sequence[_View], changes: Changes, cells: Sequence[Cell]) -> Scores:
    """Of a few cells, by each view of the fit."""
    scores = Scores.none(len(cells))
    solved = {index: found for index, found in enumerate(changes.residuals(cells)) if found is not None}
    if not solved:
        return scores
    at = np.array(list(solved))
    moved = np.stack(list(solved.values()), axis=1) - changes.fit.state.residuals[:, None]
    changed = _Changed.of(views[0], moved)
    power = np.array([cells[i].hypothesis.power for i in at])
    low = _to_the(power, np.array([least_measure(cells[i]) for i in at]))
    discrete = np.array([not cells[i].hypothesis.free for i in at])
    for number, view in enumerate(views):
        objective, along, size = view.scores(changed)
        # Of r + a d. What changes less than residuals are rounded to says nothing.
        best = np.where(size > ROUNDED, -along / np.maximum(size, ROUNDED), 0.0)
        measure = np.where(discrete, 1.0, np.maximum(best, low))
        gain = -measure * (2.0 * along + measure * size) - (view.moved - views[0].moved)
        if not number:
            scores.objective[at] = objective + [float(cells[i].z @ cells[i].z) for i in at]
            scores.shown[at] = size
        better = np.full(at.size, True) if not number else gain > scores.gain[at]
        sizes = _to_the(1.0 / power, measure)
        scores.gain[at[better]], scores.measure[at[better]] = gain[better], sizes[better]
        scores.view[at[better]] = number
    return scores


def _to_the(power: Reals, values: Reals) -> Reals:
    """Values to a power, of either sign."""
    return np.asarray(np.sign(values) * np.abs(values) ** power)
