"""The search: cells scored, the best refined while the discrepancy falls, then sets of two and three.

A model that lacks something fits only with a large discrepancy. So cells are first compared with a discrepancy of
1 neper, at which a wrong base hides nothing, and refined with 0.2 and 0.04, at which only what acts can stay; at
the end each set of amendments is given its own most probable hyperparameters.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from permway.diagnosis.fit import free_parameters
from permway.posterior.alternatives import alternatives, rivals, without_each
from permway.posterior.beam import STEPS, Progress, Trial, advanced, chosen, completed, distinct, leading
from permway.posterior.cells import Cell, cells, resized, small
from permway.posterior.covariance import Frame
from permway.posterior.fit import Fit, Model
from permway.posterior.fitter import Fitter
from permway.posterior.hyper import LACKING
from permway.posterior.member import Member, tempered
from permway.posterior.ordering import LEFT, LEVELS, annealed, apart, ordered, weighed
from permway.posterior.recalibrated import first_values, recalibrated
from permway.posterior.screening import Scores, screened

WIDTHS, PER_FORM = (48, 16, 6), (6, 2, 1)
"""Cells that are refined at each level, and at most so many of one form: sizes of the beam."""

NEGLECTED = 0.01
"""Posterior odds, against the set that they would extend, of amendments that are not fitted to the end."""

BEHIND = 92.0
"""Of the objective, by which a fit may be behind the best at one discrepancy to be fitted at the next: odds of
1e-20, for at a large discrepancy a fit may still lie beside its best neighbour."""

PREDICTED = 0.03
"""The same by a linear look, which predicts too much: it has no penalty for what parameters could have been."""

GROWS = 0.5
"""Share of the best's gain, or of what an amendment gains, by which what is not yet fitted may be behind it."""

MOVING = 5.0
"""Nats that a small change may lack before it is moved to better neighbours."""

MOST = 3
"""Amendments of one set, at most."""


@dataclass(frozen=True)
class Explored:
    """What a search found.

    Attributes
    ----------
    members : list of Member
        All sets of amendments that were fitted to the end, the most probable first; the empty set is among them.
    small : tuple of (list of Cell, Scores)
        The last look at small changes; of none if the best set still lacks something.
    """

    members: list[Member]
    small: tuple[list[Cell], Scores]


def explored(fitter: Fitter, *, ruled_out: Collection[str] = (), progress: Progress = lambda *_: None) -> Explored:
    """Search the sets of amendments.

    Parameters
    ----------
    fitter : Fitter
    ruled_out : collection of str
    progress : callable
        Called with what is done, and how much of it.
    """
    campaign = fitter.frame.observations.campaign
    nominal = Model(campaign.with_values, free_parameters(campaign))
    coarse = fitter.frame.first().with_discrepancy(LEVELS[0])
    z = first_values(fitter, nominal)
    start = fitter.begin(nominal, z, coarse)
    fitter, (first,) = weighed(fitter, [annealed(fitter, start)], [()])
    # About the stated values, for what the nominal parameters took up shows there only.
    far = Member((), fitter.begin(nominal, z, coarse), ())
    members, seen = [Member((), first, ())], (list[Cell](), Scores.none(0))
    tried: list[Member] = []
    root: Member | None = members[0]
    while root is not None and len(root.amendments) < MOST:
        best = root
        count = len(best.amendments) + 1
        what = f"{count} amendment{'s' if count > 1 else ''}"
        found = []
        lacks = best.fit.hyper.lacks
        if lacks < LEVELS[1]:
            seen = _small_changes(best, small(_offered(best, best.fit, ruled_out)), progress, what)
            found += _near(fitter, best, *seen, progress, what)
        hyper = max((best, *found), key=lambda m: m.log_mass).fit.hyper
        if hyper.novel > LACKING or hyper.strained:
            # What lacks little is not to be looked for where nothing shows. What is missing may have been taken
            # for errors of chains, too, about which no small change gains.
            far_off = count == 1 and (lacks > LEVELS[1] or hyper.strained)
            found += _far(fitter, far if far_off else best, far_off, ruled_out, progress, what)
        leader = max((best, *found), key=lambda m: m.log_mass)
        # What explains nothing of what lacks is no start for more, and gets no name.
        vain = leader is not best and leader.fit.hyper.lacks_as(best.fit.hyper)
        if leader is not best and not vain:
            for index, others in without_each(fitter, leader, nominal):
                found += _alike(fitter, leader, index, others, tried, ruled_out, progress, what)
        tried += found
        fitter, members = ordered(fitter, best, [*members, *found], nominal)
        root = None if vain else _next_root(members, count)
    return Explored(apart(members), seen)


def unsearched(frame: Frame) -> Explored:
    """Nothing but the empty set: of records from which nothing else can be concluded."""
    return Explored([Member((), recalibrated(frame.observations), ())], ([], Scores.none(0)))


def _next_root(members: Sequence[Member], count: int) -> Member | None:
    """The set of so many amendments that larger ones extend; None if they would stay behind a smaller one.

    A set grows about its own fit; where a smaller one stays ahead, larger ones stay behind it. But if that one
    strains its errors of chains, several changes at once may be what they hide.
    """
    best = members[0]
    if len(best.amendments) >= count:
        return best
    if not best.fit.hyper.strained:
        return None
    return next(
        (m for m in members if len(m.amendments) == count and not (m.far_behind or m.fit.hyper.strained)), None
    )


def _small_changes(root: Member, starts: list[Cell], progress: Progress, what: str) -> tuple[list[Cell], Scores]:
    """A look at all small changes about a set that fits."""
    say = _saying(progress, f"small changes, {what}", len(starts))
    return starts, screened(root.fit, starts, say, root.fit.hyper.smaller())


def _offered(root: Member, about: Fit, ruled_out: Collection[str]) -> list[Cell]:
    """Starts beside a set: a value that it has as wrongly stated is not wrong twice, at half the price each."""
    moved = {amendment.moves for amendment in root.amendments} - {""}
    return [cell for cell in cells(about, ruled_out) if cell.hypothesis.moves not in moved]


def _alike(
    fitter: Fitter,
    leader: Member,
    index: int,
    others: Member,
    tried: Sequence[Member],
    ruled_out: Collection[str],
    progress: Progress,
    what: str,
) -> list[Member]:
    """Sets with another amendment where the leader has one.

    Those are fitted that may come as near as a class shows, or gain half as much before; and to the end what is
    near then. What smaller sets have last is tried again: what the leader has may have led for what was still
    missing.

    Parameters
    ----------
    fitter : Fitter
    leader : Member
    index : int
        Of the amendment.
    others : Member
        The leader without it.
    tried : sequence of Member
        Smaller sets.
    ruled_out : collection of str
    progress : callable
    what : str
    """
    fit, without = leader.fit, others.fit
    offered = _offered(others, without, ruled_out)
    starts = small(alternatives(leader, index, offered))
    large = [*alternatives(leader, index, offered, sized=True), *rivals(leader, tried)]
    count = fit.state.residuals.size
    say = _saying(progress, f"alternatives, {what}", len(starts) + len(large))
    scores = screened(without, starts, say, ())
    cells_of = [resized(cell, float(scores.measure[i])) for i, cell in enumerate(starts)] + large
    # A large change bends what it does: with the same values another form may do nearly the same.
    objective = [*(without.objective - scores.gain), *screened(without, large, say).objective]
    least = fit.objective + (1.0 - GROWS) * (without.objective - fit.objective)
    lacking = [
        tempered(0.5 * (one - fit.objective), count) + leader.log_priors[index] - cell.log_prior
        for one, cell in zip(objective, cells_of, strict=True)
    ]
    worth = [
        (lacking[i], cell.hypothesis, Trial.of(others, cell, fit.hyper))
        for i, cell in enumerate(cells_of)
        if objective[i] < least or lacking[i] < LEFT
    ]
    trials = chosen(worth, WIDTHS[1], PER_FORM[1])
    say = _saying(progress, f"alternatives, {what}, fitted", len(trials))
    trials = advanced(fitter, others, trials, steps=STEPS[1], moves=False, progress=say)
    rows = [
        (tempered(fit.log_evidence - t.log_evidence, count) - t.cell.log_prior, t.cell.hypothesis, t)
        for t in trials
    ]
    near = [row for row in distinct(rows) if row[0] + leader.log_priors[index] < 2.0 * LEFT]
    kept = chosen(near, WIDTHS[2], PER_FORM[2])
    return completed(fitter, others, kept, _saying(progress, f"alternatives, {what}, to the end", len(kept)))


def _near(
    fitter: Fitter, root: Member, starts: Sequence[Cell], scores: Scores, progress: Progress, what: str
) -> list[Member]:
    """Sets with one amendment more, whose change is small: begun where the smaller set fits best."""
    count = root.fit.state.residuals.size
    predicted = np.array([tempered(0.5 * gain, count) for gain in scores.gain.tolist()])
    predicted += [cell.log_prior for cell in starts]
    hypers = [root.fit.hyper, *root.fit.hyper.smaller()]
    worth = []
    for i in np.flatnonzero(predicted > np.log(PREDICTED)).tolist():
        cell, hyper = resized(starts[i], float(scores.measure[i])), hypers[scores.view[i]]
        worth.append((-predicted[i], cell.hypothesis, Trial.beside(root, cell, hyper)))
    # Hyperparameters are the smaller set's still: what is behind with them hardly comes first with its own.
    least = -tempered(root.fit.log_evidence, count) - float(np.log(NEGLECTED))
    trials = chosen(worth, WIDTHS[1], PER_FORM[1])
    for moves in (False, True):
        say = _saying(progress, f"{what}, from small changes", len(trials))
        trials = advanced(fitter, root, trials, steps=STEPS[int(moves)], moves=moves, progress=say)
        rows = [(-tempered(t.log_evidence, count) - t.cell.log_prior, t.cell.hypothesis, t) for t in trials]
        # What has gained half of the best may still gain the rest: a large change is far from where it began.
        gained = GROWS * (least - min((row[0] for row in rows), default=least))
        if not moves:
            trials = [row[2] for row in leading(rows, max(0.5 * BEHIND, gained)) if row[0] < least + MOVING]
    rows = [row for row in leading(distinct(rows), max(2.0 * LEFT, gained)) if row[0] < least]
    kept = chosen(rows, WIDTHS[2], PER_FORM[2])
    return completed(fitter, root, kept, _saying(progress, f"{what}, to the end", len(kept)))


def _far(
    fitter: Fitter,
    root: Member,
    far_off: bool,
    ruled_out: Collection[str],
    progress: Progress,
    what: str,
) -> list[Member]:
    """Sets with one amendment more, whose change is large: begun far off, the discrepancy falling."""
    level = LEVELS[0] if far_off else LEVELS[1]
    about = replace(root.fit, hyper=root.fit.hyper.with_discrepancy(level))
    starts = _offered(root, about, ruled_out)
    scores = screened(about, starts, _saying(progress, f"first look, {what}", len(starts)))
    ranked = scores.objective - 2.0 * np.array([cell.log_prior for cell in starts])
    first = [(ranked[i], starts[i].hypothesis, starts[i]) for i in range(len(starts))]
    trials = [Trial.of(root, cell, about.hyper) for cell in chosen(first, WIDTHS[0], PER_FORM[0])]
    for stage, value in enumerate(LEVELS):
        if value > level:
            continue
        say = _saying(progress, f"{what}, discrepancy {value:g}", len(trials))
        lower = [trial.with_discrepancy(value) for trial in trials]
        # Of the many that are begun most are let go of: only what is left is worth slopes of its own.
        trials = advanced(fitter, root, lower, steps=STEPS[stage], moves=value < level, progress=say)
        rows = distinct([(t.objective - 2.0 * t.cell.log_prior, t.cell.hypothesis, t) for t in trials])
        # Differences between fits grow while the discrepancy falls.
        rows = leading(rows, BEHIND if stage + 1 < len(LEVELS) else 4.0 * LEFT)
        last = min(stage + 1, len(LEVELS) - 1)
        trials = chosen(rows, WIDTHS[last], PER_FORM[last])
    return completed(fitter, root, trials, _saying(progress, f"{what}, to the end", len(trials)))


def _saying(progress: Progress, what: str, count: int) -> Callable[[int], object]:
    return lambda done: progress(what, done, count)
