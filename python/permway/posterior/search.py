"""The search: cells scored, the best refined while the discrepancy falls, then sets of two and three.

A model that lacks something fits only with a large discrepancy. So cells are first compared with a discrepancy of
1 neper, at which a wrong base hides nothing, and refined with 0.2 and 0.04, at which only what acts can stay; at
the end each set of amendments is given its own most probable hyperparameters.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.speeds import begin
from permway.diagnosis.tangent import Problem
from permway.errors import InputError, SolveError
from permway.posterior.cells import SOMETHING, Cell, cells, resized, small
from permway.posterior.fit import Fit, Fitter, Model, estimated, grown
from permway.posterior.neighbours import rested
from permway.posterior.screening import screened

LEVELS = (1.0, 0.2, 0.04)
"""Discrepancies at which cells are refined, neper: a factor, a fifth, a twenty-fifth of a response."""

WIDTHS, PER_FORM = (72, 32, 12), (3, 2, 2)
"""Cells that are refined at each level, and at most so many of one form: sizes of the beam."""

FEW = (24, 8, 6)
"""The same where the nominal model fits."""

LACKING = 0.5
"""Probability that a fit lacks something, from which large changes are tried beside it."""

NEGLECTED = 0.01
"""Posterior odds, against the set that they would extend, of amendments that are not fitted to the end."""

BEHIND = 92.0
"""Of the objective, by which a fit may be behind the best at one discrepancy to be fitted at the next: odds of
1e-20, for at a large discrepancy a fit may still lie beside its best neighbour."""

LEFT = 12.0
"""Nats behind the best set from which a set is let go of: less than a class ever shows."""

MOVING = 5.0
"""Nats that a small change may lack before it is moved to better neighbours."""

STEPS = (4, 8, 8, 20)
"""Of the fit at each level, and at the end."""

MOST = 3
"""Amendments of one set, at most."""

SAME = 2.0
"""Of the objective: two fits of one form this near, that predict the same, are one."""

T = TypeVar("T")
Row = tuple[float, Hypothesis, tuple[Fit, Cell]]
Progress = Callable[[str, int, int], object]


@dataclass(frozen=True)
class Member:
    """A set of amendments with its fit.

    Attributes
    ----------
    amendments : tuple of Hypothesis
    fit : Fit
    log_prior : float
        Of the set, nats.
    """

    amendments: tuple[Hypothesis, ...]
    fit: Fit
    log_prior: float

    @property
    def log_mass(self) -> float:
        """Logarithm of prior times evidence, up to a constant of the records."""
        return self.log_prior + self.fit.log_evidence

    @property
    def names(self) -> tuple[str, ...]:
        """Entries of the catalogue, in alphabetical order."""
        return tuple(sorted(a.entry for a in self.amendments))

    def own(self, index: int) -> slice:
        """Where the parameters of one amendment stand among all."""
        counts = [len(a.free) for a in self.amendments]
        start = len(self.fit.model.free) - sum(counts) + sum(counts[:index])
        return slice(start, start + counts[index])

    def values(self, index: int) -> dict[str, float]:
        """Of one amendment's parameters, by their own names."""
        free, z = self.amendments[index].free, self.fit.z[self.own(index)]
        return {f.name: f.value(float(v)) for f, v in zip(free, z, strict=True)}


def explored(
    fitter: Fitter, *, ruled_out: Collection[str] = (), progress: Progress = lambda *_: None
) -> list[Member]:
    """All sets of amendments that were fitted to the end, the most probable first; the empty set is among them.

    Parameters
    ----------
    fitter : Fitter
    ruled_out : collection of str
    progress : callable
        Called with what is done, and how much of it.
    """
    campaign = fitter.frame.evidence.campaign
    nominal = Model(campaign.with_values, free_parameters(campaign))
    coarse = fitter.frame.first().with_discrepancy(LEVELS[0])
    z = _first_values(fitter, nominal)
    start = fitter.begin(nominal, z, coarse)
    fitter, (first,) = _weighed(fitter, [_annealed(fitter, start)], [()])
    start = fitter.begin(nominal, z, coarse)
    empty = Member((), first, float(np.log(1.0 - SOMETHING)))
    members = [empty]
    far = Member((), start, empty.log_prior)
    for count in range(1, MOST + 1):
        best = members[0]
        what = f"{count} amendment{'s' if count > 1 else ''}"
        lacking = best.fit.hyper.novel > LACKING
        found = [] if lacking else _near(fitter, best, ruled_out, progress, what)
        # What the nominal parameters took up shows about their stated values only.
        if lacking or count == 1:
            root = far if count == 1 else best
            found += _far(fitter, root, ruled_out, progress, what, WIDTHS if lacking else FEW)
        members = sorted([*members, *found], key=lambda m: -m.log_mass)
        # A set grows about its own fit; where a smaller one stays ahead, larger ones stay behind it.
        if len(members[0].amendments) < count:
            break
    # All that may count are held against the records as the best of them weighs these.
    members = [m for m in _apart(members) if m.log_mass > members[0].log_mass - LEFT or not m.amendments]
    _, fits = _weighed(fitter, [m.fit for m in members], [m.amendments for m in members])
    return sorted((replace(m, fit=fit) for m, fit in zip(members, fits, strict=True)), key=lambda m: -m.log_mass)


def _first_values(fitter: Fitter, nominal: Model) -> Reals:
    """The priors' centres; of passages speed and time of entry are looked for, within which slopes serve."""
    evidence = fitter.frame.evidence
    if all(dataset.record.statistic != "passage" for dataset in evidence.datasets):
        return np.zeros(len(nominal.free))
    return begin(evidence, Problem(evidence, nominal.build, nominal.free))


def _weighed(
    fitter: Fitter, fits: Sequence[Fit], amendments: Sequence[tuple[Hypothesis, ...]]
) -> tuple[Fitter, list[Fit]]:
    """Records weighed by the first of some fits, and all of them fitted again."""
    best = fits[0]
    again = Fitter(fitter.frame.about(best.state.solved, best.covariance, best.state.deviations))
    begun = [again.begin(fit.model, fit.z, fit.hyper) for fit in fits]
    return again, [_finished(again, fit, own) for fit, own in zip(begun, amendments, strict=True)]


def _annealed(fitter: Fitter, fit: Fit) -> Fit:
    """To the end, the discrepancy falling."""
    for level, steps in zip(LEVELS, STEPS, strict=False):
        fit = fitter.fit(replace(fit, hyper=fit.hyper.with_discrepancy(level)), steps=steps)
    return _finished(fitter, fit)


def _finished(fitter: Fitter, fit: Fit, amendments: Sequence[Hypothesis] = ()) -> Fit:
    """Each amendment moved to better neighbours, then with hyperparameters of its own."""
    fit = fitter.settled(fit)
    stop = len(fit.model.free)
    for amendment in reversed(amendments):
        own = slice(stop - len(amendment.free), stop)
        fit, stop = rested(fitter, fit, own, amendment, STEPS[-1]), own.start
    fit = fitter.fit(estimated(fitter.settled(fit)), steps=STEPS[-1])
    return fitter.settled(fit)


def _near(fitter: Fitter, root: Member, ruled_out: Collection[str], progress: Progress, what: str) -> list[Member]:
    """Sets with one amendment more, whose change is small: begun where the smaller set fits best."""
    starts = small(cells(root.fit, ruled_out))
    scores = screened(root.fit, starts, lambda done: progress(f"small changes, {what}", done, len(starts)))
    promised = 0.5 * scores.gain + np.array([cell.log_prior for cell in starts])
    worth = [
        (-promised[i], starts[i].hypothesis, resized(starts[i], float(scores.measure[i])))
        for i in range(len(starts))
        if promised[i] > np.log(NEGLECTED)
    ]
    chosen = _chosen(worth, WIDTHS[1], PER_FORM[1])
    # Hyperparameters are the smaller set's still: what is behind with them hardly comes first with its own.
    least = -root.fit.log_evidence - float(np.log(NEGLECTED))
    beam = []
    for done, cell in enumerate(chosen):
        progress(f"{what}, from small changes", done, len(chosen))
        fit = _begun(fitter, root, cell, None)
        if fit is None:
            continue
        fit = _refined(fitter, fit, cell.hypothesis, STEPS[0], moves=False)
        if -fit.log_evidence - cell.log_prior < least + MOVING:
            fit = _refined(fitter, fit, cell.hypothesis, STEPS[1], moves=True)
        beam.append((-fit.log_evidence - cell.log_prior, cell.hypothesis, (fit, cell)))
    kept = _chosen([one for one in _distinct(beam) if one[0] < least], WIDTHS[2], PER_FORM[2])
    return _members(fitter, root, kept, progress, what)


def _far(
    fitter: Fitter,
    root: Member,
    ruled_out: Collection[str],
    progress: Progress,
    what: str,
    widths: tuple[int, int, int],
) -> list[Member]:
    """Sets with one amendment more, whose change is large: begun far off, the discrepancy falling."""
    level = LEVELS[0] if not root.amendments else LEVELS[1]
    about = replace(root.fit, hyper=root.fit.hyper.with_discrepancy(level))
    starts = cells(about, ruled_out)
    scores = screened(about, starts, lambda done: progress(f"first look, {what}", done, len(starts)))
    # A start that changes nothing is fitted whatever the first look says.
    objective = np.where(np.isinf(scores.gain), -np.inf, scores.objective)
    rows = [
        (objective[i] - 2.0 * starts[i].log_prior, starts[i].hypothesis, starts[i]) for i in range(len(starts))
    ]
    fits = [(_begun(fitter, root, cell, level), cell) for cell in _chosen(rows, widths[0], PER_FORM[0])]
    beam = [(fit, cell) for fit, cell in fits if fit is not None]
    for stage, value in enumerate(LEVELS):
        if value > level:
            continue
        refined = []
        for done, (fit, cell) in enumerate(beam):
            progress(f"{what}, discrepancy {value:g}", done, len(beam))
            lower = replace(fit, hyper=fit.hyper.with_discrepancy(value))
            refined.append((_refined(fitter, lower, cell.hypothesis, STEPS[stage], moves=stage > 0), cell))
        ranked = _distinct(
            [(fit.objective - 2.0 * cell.log_prior, cell.hypothesis, (fit, cell)) for fit, cell in refined]
        )
        # Differences between fits grow while the discrepancy falls.
        ranked = [one for one in ranked if one[0] < ranked[0][0] + BEHIND]
        last = min(stage + 1, len(LEVELS) - 1)
        beam = _chosen(ranked, widths[last], PER_FORM[last])
    return _members(fitter, root, beam, progress, what)


def _members(
    fitter: Fitter, root: Member, beam: Sequence[tuple[Fit, Cell]], progress: Progress, what: str
) -> list[Member]:
    """Fitted to the end."""
    found = []
    for done, (fit, cell) in enumerate(beam):
        progress(f"{what}, to the end", done, len(beam))
        amendments = (*root.amendments, cell.hypothesis)
        found.append(Member(amendments, _finished(fitter, fit, amendments), root.log_prior + cell.log_prior))
    return found


def _apart(members: list[Member]) -> list[Member]:
    """Without members that are the same set of names with the same predictions as a more probable one."""
    kept: list[Member] = []
    for one in members:
        change = [
            one.fit.state.deviations - other.fit.state.deviations for other in kept if other.names == one.names
        ]
        if not any(one.fit.covariance.square(d) < SAME for d in change):
            kept.append(one)
    return kept


def _begun(fitter: Fitter, root: Member, cell: Cell, level: float | None) -> Fit | None:
    """A set with one amendment more, where the first look has it; slopes of the others as they are."""
    model = grown(root.fit, cell.hypothesis, f"{len(root.amendments) + 1}.")
    free = cell.hypothesis.free
    z = np.concatenate([root.fit.z, cell.z])
    try:
        blank = np.zeros((root.fit.state.deviations.size, len(free)))
        hyper = root.fit.hyper if level is None else root.fit.hyper.with_discrepancy(level)
        fit = fitter.begin(model, z, hyper, np.hstack([root.fit.jacobian, blank]))
        return fitter.settled(fit, fixed=len(root.fit.model.free))
    except (InputError, SolveError):
        return None


def _refined(fitter: Fitter, fit: Fit, hypothesis: Hypothesis, steps: int, *, moves: bool) -> Fit:
    """Fitted, and moved to better neighbours if that is asked for."""
    try:
        own = slice(len(fit.model.free) - len(hypothesis.free), len(fit.model.free))
        # Slopes of what was there before the hypothesis serve as they are until the end.
        fit = fitter.fit(fit, steps=steps, fixed=own.start)
        return rested(fitter, fit, own, hypothesis, steps) if moves else fit
    except (InputError, SolveError):
        return fit


def _chosen(ranked: Sequence[tuple[float, Hypothesis, T]], width: int, each: int) -> list[T]:
    """The best, at most so many of one form."""
    kept: list[T] = []
    count: Counter[tuple[str, ...]] = Counter()
    for score, hypothesis, item in sorted(ranked, key=lambda one: one[0]):
        if len(kept) == width or not score < np.inf:
            break
        if count[hypothesis.form] < each:
            count[hypothesis.form] += 1
            kept.append(item)
    return kept


def _distinct(ranked: list[Row]) -> list[Row]:
    """Without fits that came to where a better one of the same form is."""
    kept: list[Row] = []
    for one in sorted(ranked, key=lambda row: row[0]):
        if not any(other[1].form == one[1].form and _same(other, one) for other in kept):
            kept.append(one)
    return kept


def _same(one: Row, other: Row) -> bool:
    if abs(one[0] - other[0]) > SAME:
        return False
    change: Reals = one[2][0].state.deviations - other[2][0].state.deviations
    return one[2][0].covariance.square(change) < SAME
