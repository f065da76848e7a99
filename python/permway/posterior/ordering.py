"""Sets of amendments put in order: records weighed by the best, its subsets tried, equals left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from permway.diagnosis.hypothesis import Hypothesis
from permway.errors import InputError, SolveError
from permway.posterior.beam import SAME, STEPS, Member, finished
from permway.posterior.fit import Fit, Fitter, Model, extended
from permway.posterior.idealised import idealised

LEVELS = (1.0, 0.2, 0.04)
"""Discrepancies at which cells are refined, neper: a factor, a fifth, a twenty-fifth of a response."""

LEFT = 12.0
"""Nats behind the best set from which a set is let go of: less than a class ever shows."""


def annealed(fitter: Fitter, fit: Fit) -> Fit:
    """To the end, the discrepancy falling."""
    for level, steps in zip(LEVELS, STEPS, strict=False):
        fit = fitter.fit(replace(fit, hyper=fit.hyper.with_discrepancy(level)), steps=steps)
    return finished(fitter, fit)


def ordered(
    fitter: Fitter, before: Member, members: Sequence[Member], nominal: Model
) -> tuple[Fitter, list[Member]]:
    """The most probable first, in records that are weighed by it, its subsets among them."""
    members = _pruned(fitter, sorted(members, key=lambda m: -m.log_mass), nominal)
    if members[0] is before:
        return fitter, members
    members = [m for m in apart(members) if m.log_mass > members[0].log_mass - LEFT or not m.amendments]
    fitter, fits = weighed(fitter, [m.fit for m in members], [m.amendments for m in members])
    members = [replace(m, fit=fit) for m, fit in zip(members, fits, strict=True)]
    return fitter, sorted(members, key=lambda m: -m.log_mass)


def weighed(
    fitter: Fitter, fits: Sequence[Fit], amendments: Sequence[tuple[Hypothesis, ...]]
) -> tuple[Fitter, list[Fit]]:
    """Records weighed by the first of some fits, and all of them fitted again."""
    best = fits[0]
    frame = fitter.frame.about(best.state.solved, best.covariance, best.state.residuals)
    slopes = Fitter(frame).begin(best.model, best.z, best.hyper)
    again = Fitter(frame.with_idealisation(idealised(slopes)))
    begun = [again.begin(fit.model, fit.z, fit.hyper, bend=fit.bend) for fit in fits]
    return again, [finished(again, fit, own) for fit, own in zip(begun, amendments, strict=True)]


def _pruned(fitter: Fitter, members: list[Member], nominal: Model) -> list[Member]:
    """With the best set's subsets, each begun where the set has it, as long as one is better.

    What came first may have stood in for what came after it.
    """
    while True:
        best = members[0]
        found = []
        for index in range(len(best.amendments) if len(best.amendments) > 1 else 0):
            kept = [i for i in range(len(best.amendments)) if i != index]
            fit = _without(fitter, best, kept, nominal)
            if fit is not None:
                own = tuple(best.amendments[i] for i in kept)
                found.append(Member(own, finished(fitter, fit, own), tuple(best.log_priors[i] for i in kept)))
        members = sorted([*members, *found], key=lambda m: -m.log_mass)
        if members[0] is best:
            return members


def _without(fitter: Fitter, member: Member, kept: Sequence[int], nominal: Model) -> Fit | None:
    """The set of some of a member's amendments, at the values that they have in it; the discrepancy falls anew."""
    fit = member.fit
    z = fit.z[: len(nominal.free)]
    model = nominal
    for number, index in enumerate(kept, start=1):
        model = extended(model, member.amendments[index], f"{number}.", fitter.frame.observations.campaign)
        z = np.concatenate([z, fit.z[member.own(index)]])
    try:
        found = fitter.begin(model, z, fit.hyper.with_discrepancy(LEVELS[1]), bend=fit.bend)
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
