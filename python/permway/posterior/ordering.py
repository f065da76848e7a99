"""Sets of amendments put in order: records weighed by the best, its subsets tried, equals left out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.blocks_passage import UNEVENNESS
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.side_by_side import each
from permway.errors import InputError, SolveError
from permway.posterior.beam import SAME, STEPS, finished
from permway.posterior.cells import coordinate
from permway.posterior.estimate import estimated
from permway.posterior.fit import STRETCH, Fit, Model, extended
from permway.posterior.fitter import Fitter
from permway.posterior.hyper import Hyper
from permway.posterior.idealised import idealised
from permway.posterior.member import Member

LEVELS = (1.0, 0.2, 0.04)
"""Discrepancies at which cells are refined, neper: a factor, a fifth, a twenty-fifth of a response."""

CLOSE, TURNS = 0.2, 8
"""Standard deviations by which a fit over unevenness may be from where its covariance was taken, and how often at
most that is taken anew. Left so far off a fit scatters 2 % more than it says; with twice 8 %, with half 0.5 %."""

LEFT = 12.0
"""Nats behind the best set from which a set counts no more: less than a class ever shows."""

_Numbers = tuple[Reals, Hyper, Reals, Reals | None]
"""Parameters, hyperparameters, slopes and their curvature, of a fit to the end."""


def annealed(fitter: Fitter, fit: Fit) -> Fit:
    """To the end, the discrepancy falling."""
    for level, steps in zip(LEVELS, STEPS, strict=False):
        fitter, fit = _about(fitter, fit)
        fit = fitter.fit(replace(fit, hyper=fit.hyper.with_discrepancy(level)), steps=steps)
    return finished(fitter, fit)


def _about(fitter: Fitter, fit: Fit) -> tuple[Fitter, Fit]:
    """A fit over unevenness with the covariance of where its axles are.

    Taken elsewhere, it would let the unevenness stand for loads that are there, and hold the fit to that place.
    """
    if UNEVENNESS not in fit.frame.sized:
        return fitter, fit
    again = Fitter(fit.frame.about(fit.state.solved, fit.covariance, fit.state.residuals))
    return again, again.begin(fit.model, fit.z, fit.hyper, bend=fit.bend)


def ordered(
    fitter: Fitter, before: Member, members: Sequence[Member], nominal: Model
) -> tuple[Fitter, list[Member]]:
    """The most probable first, in records that are weighed by it, its subsets among them."""
    members = _pruned(fitter, sorted(members, key=lambda m: -m.log_mass), nominal)
    if members[0] is before:
        return fitter, members
    members = _worth_keeping(apart(members))
    fitter, fits = weighed(fitter, [m.fit for m in members], [m.amendments for m in members])
    members = [replace(m, fit=fit) for m, fit in zip(members, fits, strict=True)]
    return fitter, sorted(members, key=lambda m: -m.log_mass)


def _worth_keeping(members: Sequence[Member]) -> list[Member]:
    """Those near the best, and the best of each size, the empty one among them; in order."""
    least = members[0].log_mass - LEFT
    marked = [replace(m, far_behind=bool(m.amendments) and m.log_mass <= least) for m in members]
    first = {len(m.amendments): m for m in reversed(marked)}
    return [m for m in marked if not m.far_behind or m is first[len(m.amendments)]]


def weighed(
    fitter: Fitter, fits: Sequence[Fit], amendments: Sequence[tuple[Hypothesis, ...]]
) -> tuple[Fitter, list[Fit]]:
    """Records weighed by the first of some fits, and all of them fitted again."""
    best = _in_place(fitter, fits[0])
    frame = best.frame.about(best.state.solved, best.covariance, best.state.residuals)
    slopes = Fitter(frame).begin(best.model, best.z, best.hyper)
    again = Fitter(frame.with_idealisation(idealised(slopes)))

    def work(index: int) -> Fit:
        fit = fits[index]
        return finished(again, again.begin(fit.model, fit.z, fit.hyper, bend=fit.bend), amendments[index])

    found = _shared(again, work, [fit.model for fit in fits])
    return again, [fit for fit in found if fit is not None]


def _shared(fitter: Fitter, work: Callable[[int], Fit | None], models: Sequence[Model]) -> list[Fit | None]:
    """Fits to the end of some models, made by several processes, which hand over numbers alone."""

    def numbers(index: int) -> _Numbers | None:
        fit = work(index)
        return None if fit is None else (fit.z, fit.hyper, fit.jacobian, fit.bend)

    made = each(numbers, range(len(models)), threads=fitter.frame.observations.threads)
    return [
        None if one is None else replace(fitter.begin(model, *one), exact=True).light()
        for model, one in zip(models, made, strict=True)
    ]


def _in_place(fitter: Fitter, fit: Fit) -> Fit:
    """A fit over unevenness about its own covariance and profile."""
    for _ in range(TURNS if UNEVENNESS in fit.frame.sized else 0):
        before = fit.z
        fitter, fit = _about(fitter, fit)
        fit = fitter.fit(estimated(fit), steps=STEPS[-1])
        if (np.abs(fit.z - before) < CLOSE * np.sqrt(np.diag(fit.spread))).all():
            break
    return fit


def _pruned(fitter: Fitter, members: list[Member], nominal: Model) -> list[Member]:
    """With the best set's subsets, each begun where the set has it, as long as one is better.

    What came first may have stood in for what came after it; and of two stretches of one form, one over both.
    """
    while True:
        best = members[0]
        members = sorted([*members, *_subsets(fitter, best, nominal)], key=lambda m: -m.log_mass)
        if members[0] is best:
            return members


def _subsets(fitter: Fitter, member: Member, nominal: Model) -> list[Member]:
    """Sets of one amendment less, fitted to the end."""
    smaller = list(_smaller(member))
    kept = [tuple(member.amendments[i] for i in own) for own, _ in smaller]
    models = [_model_of(fitter, own, nominal) for own in kept]

    def work(index: int) -> Fit | None:
        fit = _started(fitter, member, models[index], smaller[index][1], nominal)
        return None if fit is None else finished(fitter, fit, kept[index])

    return [
        Member(amendments, fit, tuple(member.log_priors[i] for i in own))
        for amendments, (own, _), fit in zip(kept, smaller, _shared(fitter, work, models), strict=True)
        if fit is not None
    ]


def _smaller(member: Member) -> Iterator[tuple[list[int], list[Reals]]]:
    """Sets of one amendment less: which of a member's they have, and the parameters of each."""
    count = len(member.amendments)
    own = [member.fit.z[member.own(index)] for index in range(count)]
    for gone in range(count if count > 1 else 0):
        kept = [index for index in range(count) if index != gone]
        yield kept, [own[index] for index in kept]
        for index in kept:
            both = _over_both(member, index, gone)
            if index < gone and both is not None:
                yield kept, [both if i == index else own[i] for i in kept]


def _over_both(member: Member, index: int, other: int) -> Reals | None:
    """Parameters of an amendment whose stretch has that of another of its form; None if there are no such."""
    amendment, values = member.amendments[index], [member.values(i) for i in (index, other)]
    if amendment.form != member.amendments[other].form or not set(STRETCH) <= set(values[0]):
        return None
    centre, length = STRETCH
    low = min(v[centre] - 0.5 * v[length] for v in values)
    high = max(v[centre] + 0.5 * v[length] for v in values)
    new = values[0] | {centre: 0.5 * (low + high), length: high - low}
    z = [coordinate(free, new[free.name]) for free in amendment.free]
    return None if None in z else np.array(z, dtype=np.float64)


def _model_of(fitter: Fitter, amendments: Sequence[Hypothesis], nominal: Model) -> Model:
    """The nominal model with a set of amendments."""
    for number, amendment in enumerate(amendments, start=1):
        nominal = extended(nominal, amendment, f"{number}.", fitter.frame.observations.campaign)
    return nominal


def _started(fitter: Fitter, member: Member, model: Model, z: Sequence[Reals], nominal: Model) -> Fit | None:
    """A set of some of a member's amendments, at these parameters; the discrepancy falls anew."""
    fit = member.fit
    whole = np.concatenate([fit.z[: len(nominal.free)], *z])
    try:
        found = fitter.begin(model, whole, fit.hyper.with_discrepancy(LEVELS[1]), bend=fit.bend)
        found = fitter.fit(found, steps=STEPS[1])
        return fitter.fit(replace(found, hyper=found.hyper.with_discrepancy(LEVELS[2])), steps=STEPS[2])
    except (InputError, SolveError):
        return None


def apart(members: list[Member]) -> list[Member]:
    """Without members that are the same set of names with the same predictions as a more probable one."""
    kept: list[Member] = []
    for one in members:
        change = [
            one.fit.state.residuals - other.fit.state.residuals for other in kept if other.names == one.names
        ]
        if not any(one.fit.covariance.square(d) < SAME for d in change):
            kept.append(one)
    return kept
