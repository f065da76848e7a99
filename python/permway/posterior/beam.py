"""Sets of amendments on their way to the end: fitted further, ranked, and the best of each form kept.

What is kept of a fit between two stages is its parameters. So hundreds take no memory, and several processes may
share the work.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.hypothesis import Hypothesis, Where
from permway.diagnosis.side_by_side import each
from permway.errors import InputError, SolveError
from permway.posterior.cells import Cell
from permway.posterior.estimate import estimated
from permway.posterior.fit import STRETCH, Fit, Model, grown
from permway.posterior.fitter import Fitter
from permway.posterior.hyper import IDEAL, IDEALISATION, Hyper
from permway.posterior.journal import kept_trials
from permway.posterior.member import Member
from permway.posterior.neighbours import rested

STEPS = (4, 8, 8, 20)
"""Of the fit at each discrepancy, and at the end."""

TAKEN_UP = 4.0
"""Times its median, two standard deviations, from which an idealisation may have taken an effect up."""

SAME, ALIKE = 2.0, 0.01
"""Of the objective, and of each value in proportion: two fits of one form this near are one."""

Item = TypeVar("Item")
Progress = Callable[[str, int, int], object]


@dataclass(frozen=True)
class Trial:
    """A set with one amendment more, on its way.

    Attributes
    ----------
    cell : Cell
        Of the amendment.
    z : ndarray
        Of all parameters.
    hyper : Hyper
    bend : ndarray, optional
        See :class:`permway.posterior.fit.Fit`.
    objective, log_evidence : float
        Of the fit; infinite, and minus that, before there is one.
    slopes : ndarray, optional
        At the end of the fit, of the few that are fitted to the end.
    """

    cell: Cell
    z: Reals
    hyper: Hyper
    bend: Reals | None
    objective: float = np.inf
    log_evidence: float = -np.inf
    slopes: Reals | None = None

    @staticmethod
    def of(root: Member, cell: Cell, hyper: Hyper) -> Trial:
        """Where the first look has it."""
        return Trial(cell, np.concatenate([root.fit.z, cell.z]), hyper, root.fit.bend)

    @staticmethod
    def beside(root: Member, cell: Cell, hyper: Hyper) -> Trial:
        """Where a look at small changes has it: a nominal parameter that it moves moves back by as much."""
        trial = Trial.of(root, cell, hyper)
        names = [f.name for f in root.fit.model.free]
        if cell.hypothesis.moves in names:
            trial.z[names.index(cell.hypothesis.moves)] -= cell.hypothesis.free[0].value(float(cell.z[0]))
        return trial

    def with_discrepancy(self, value: float) -> Trial:
        """The same with another discrepancy."""
        return replace(self, hyper=self.hyper.with_discrepancy(value))


def advanced(
    fitter: Fitter,
    root: Member,
    trials: Sequence[Trial],
    *,
    steps: int,
    moves: bool,
    progress: Callable[[int], object],
) -> list[Trial]:
    """Fitted further; those that cannot be solved are left out.

    Parameters
    ----------
    fitter : Fitter
    root : Member
        The set that each extends.
    trials : sequence of Trial
    steps : int
        Of the fit.
    moves : bool
        Whether each is moved to better neighbours, with slopes of its own: for the few that are left.
    progress : callable
        Called with how many are begun.
    """
    fixed = len(root.fit.model.free)
    # Most trials have the same hyperparameters: what these make of the slopes is found once.
    likely = {t.hyper.log.tobytes(): replace(root.fit, hyper=t.hyper) for t in trials}
    for fit in likely.values():
        _ = fit.roots

    def work(trial: Trial) -> Trial | None:
        hypothesis = trial.cell.hypothesis
        own = slice(fixed, fixed + len(hypothesis.free))
        try:
            if moves:
                # A large change bends the slopes of what was there before it.
                fit = fitter.begin(_model(root, trial.cell), trial.z, trial.hyper, bend=trial.bend)
            else:
                # They serve as long as they lead somewhere.
                fit = fitter.grown(
                    likely[trial.hyper.log.tobytes()], _model(root, trial.cell), trial.z, trial.bend
                )
            fit = fitter.fit(fit, steps=steps, fixed=0 if moves else fixed)
            if moves:
                fit = rested(fitter, fitter.settled(fit, fixed=fixed), own, hypothesis, steps)
        except (InputError, SolveError):
            return None
        return _kept(trial, fit)

    return _shared(fitter, work, trials, progress)


def completed(
    fitter: Fitter, root: Member, trials: Sequence[Trial], progress: Callable[[int], object]
) -> list[Member]:
    """Fitted to the end, the amendment that is new moved to better neighbours."""

    def work(trial: Trial) -> Trial | None:
        try:
            started = fitter.begin(_model(root, trial.cell), trial.z, trial.hyper, bend=trial.bend)
            fit = finished(fitter, started, (trial.cell.hypothesis,))
            return replace(_kept(trial, fit), slopes=fit.jacobian)
        except (InputError, SolveError):
            return None

    found = []
    for trial in _shared(fitter, work, trials, progress):
        fit = fitter.begin(_model(root, trial.cell), trial.z, trial.hyper, trial.slopes, trial.bend)
        fit = replace(fit, exact=True).light()
        amendments = (*root.amendments, trial.cell.hypothesis)
        found.append(Member(amendments, fit, (*root.log_priors, trial.cell.log_prior)))
    return found


def _shared(
    fitter: Fitter,
    work: Callable[[Trial], Trial | None],
    trials: Sequence[Trial],
    progress: Callable[[int], object],
) -> list[Trial]:
    """The work shared between processes, hypotheses put back: they cannot be handed over."""

    def bare(trial: Trial) -> Trial | None:
        found = work(trial)
        return None if found is None else replace(found, cell=None)  # type: ignore[arg-type]

    def take() -> list[Trial | None]:
        return each(bare, trials, threads=fitter.frame.observations.threads, least=2, progress=progress)

    found = kept_trials(take, trials)
    return [replace(one, cell=trial.cell) for one, trial in zip(found, trials, strict=True) if one is not None]


def _model(root: Member, cell: Cell) -> Model:
    return grown(root.fit, cell.hypothesis, f"{len(root.amendments) + 1}.")


def _kept(trial: Trial, fit: Fit) -> Trial:
    return Trial(trial.cell, fit.z, fit.hyper, fit.bend, fit.objective, fit.log_evidence)


def finished(fitter: Fitter, fit: Fit, amendments: Sequence[Hypothesis] = ()) -> Fit:
    """The last so many amendments moved to better neighbours, then with hyperparameters of its own."""
    fit = fitter.settled(fit)
    stop = len(fit.model.free)
    for amendment in reversed(amendments):
        own = slice(stop - len(amendment.free), stop)
        fit, stop = rested(fitter, fit, own, amendment, STEPS[-1]), own.start
    # Slopes of nominal parameters change little: only at the end are they taken at every step.
    fixed = stop if amendments else 0
    fit = fitter.fit(fitter.settled(fit, fixed=fixed), steps=STEPS[-1], fixed=fixed)
    found = _estimated(fitter, fit, fixed)
    if amendments and found.hyper[IDEALISATION] > TAKEN_UP * IDEAL:
        # What a large idealisation takes up constrains no amendment: with a usual one both may fit better.
        usual = found.hyper.moved(
            np.where([n == IDEALISATION for n in found.hyper.names], np.log(IDEAL), found.hyper.log)
        )
        other = fitter.fit(fitter.settled(replace(found, hyper=usual)), steps=STEPS[-1], fixed=fixed)
        found = max(found, _estimated(fitter, other, fixed), key=lambda one: one.log_evidence)
    return found


def _estimated(fitter: Fitter, fit: Fit, fixed: int) -> Fit:
    """With the most probable hyperparameters, and slopes of all at the end."""
    fit = fitter.fit(estimated(fit), steps=STEPS[-1], fixed=fixed)
    return fitter.settled(fitter.fit(fitter.settled(fit), steps=STEPS[-1]))


def chosen(ranked: Sequence[tuple[float, Hypothesis, Item]], width: int, per_form: int) -> list[Item]:
    """The best, at most so many of one form."""
    kept: list[Item] = []
    count: Counter[tuple[str, ...]] = Counter()
    for score, hypothesis, item in sorted(ranked, key=lambda one: one[0]):
        if len(kept) == width or not score < np.inf:
            break
        if count[hypothesis.form] < per_form:
            count[hypothesis.form] += 1
            kept.append(item)
    return kept


Row = tuple[float, Hypothesis, Trial]
"""What ranks a trial, lowest first; its hypothesis; and it."""


def leading(rows: list[Row], behind: float) -> list[Row]:
    """Those that are not farther behind the best."""
    best = min((row[0] for row in rows), default=np.inf)
    return [row for row in rows if row[0] < best + behind]


def distinct(rows: list[Row]) -> list[Row]:
    """Without fits that came to where a better one of the same form is."""
    kept: list[Row] = []
    for one in sorted(rows, key=lambda row: row[0]):
        if not any(other[1].form == one[1].form and _same(other, one) for other in kept):
            kept.append(one)
    return kept


def _same(one: Row, other: Row) -> bool:
    """Whether both came to the same values: at a large discrepancy, other values may predict much the same."""
    if abs(one[0] - other[0]) > SAME:
        return False
    (first, where), (second, elsewhere) = _reached(one), _reached(other)
    return where == elsewhere and bool(np.allclose(first, second, rtol=ALIKE, atol=0.0))


def _reached(row: Row) -> tuple[list[float], Where]:
    """Values of a row's last amendment, and its place without what the values say of it."""
    _, hypothesis, trial = row
    z = trial.z[trial.z.size - len(hypothesis.free) :]
    values = {f.name: f.value(float(v)) for f, v in zip(hypothesis.free, z, strict=True)}
    where = hypothesis.locate(values)
    moving = {"x_m", *STRETCH} & set(values)
    return list(values.values()), replace(where, x_m=None) if moving else where
