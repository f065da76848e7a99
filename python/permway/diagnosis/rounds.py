"""Effects one after another: forward while one passes, backward where a later one made an earlier one needless."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from permway.diagnosis.bases import BENT
from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.choose import BEYOND, lines, penalty
from permway.diagnosis.clock import Clock
from permway.diagnosis.compete import Ring
from permway.diagnosis.describe import Description
from permway.diagnosis.e_value import log_e_value
from permway.diagnosis.fit import Fit
from permway.diagnosis.heldout import Rest
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.nulls import threshold
from permway.diagnosis.quick import Quick, stacked
from permway.diagnosis.recalibrate import UNFIT, recalibrate
from permway.diagnosis.refit import settled, weighed_anew
from permway.diagnosis.search import Finalist, Round, search
from permway.diagnosis.slips import EXACT, MOST, gain_by_cell, mended
from permway.diagnosis.spot import Found
from permway.diagnosis.verdict_parts import E_VALUE
from permway.errors import InputError, SolveError

MOST_EFFECTS, MOST_ROUNDS = 3, 5
"""Effects together, and rounds: an effect that was dropped may be met again, when others are known better."""

MOST_OF_IT = 0.5
"""Share of what earlier effects leave that may be left by a smaller one."""

BELIEVED = 2.5
"""Standard deviations of its prior within which one believes a parameter."""


def effects(
    rough: Fit,
    base: Fit,
    found: tuple[Found, ...],
    seed: int,
    clock: Clock,
    description: Description,
    ruled_out: Collection[str] = (),
) -> tuple[list[Round], list[Finalist]]:
    """Add effects while one passes; take out those that a later one made needless.

    Where smooth errors of usual size do not explain what is left, the search begins from a base that has learnt no
    larger ones, for these would hide what is sought, and that takes responses less seriously, for what is missing
    would bend it; what it finds has to be better than the base that has learnt, on responses as they are.

    Where small elements do better than the first effect and leave next to nothing, no further one is sought.
    """

    def least(ring: Ring, screened: Sequence[Quick]) -> float:
        return threshold(ring, screened, seed=seed, progress=clock)

    rounds: list[Round] = []
    accepted: list[Finalist] = []
    fit = base
    screened: tuple[Quick, ...] = ()
    for order in range(MOST_ROUNDS):
        look = partial(search, learnt_base=fit, prefix=f"{order + 1}.", threshold=least, progress=clock)
        result, start, offered = None, fit, []
        for start in [fit] if rough is fit else [rough, fit]:
            offered = _of_the_owners(base, hypotheses(Situation(start, found), ruled_out), start)
            result = look(start, offered, before=screened)
            screened = result.screened
            if result.finalists:
                break
        assert result is not None
        if accepted and result.finalists and _mends(base, accepted, result.finalists[0]):
            # What mends the first says nothing of other domains, which may show something smaller.
            domain = result.finalists[0].hypothesis.domain
            others = look(start, [h for h in offered if h.domain != domain], before=screened)
            result = replace(others if others.finalists else result, screened=screened)
        rounds.append(result)
        if not result.finalists:
            break
        if accepted and (_mends(base, accepted, result.finalists[0]) or not _stands(accepted[-1], result, clock)):
            break
        accepted.append(result.finalists[0])
        if order == 0 and description.instead(result):
            break
        if len(accepted) > 1:
            accepted = _without_needless(base, accepted, result.threshold, clock)
        # Once a model nearly fits, nothing is gained from blunting, unless it does so by parameters far off.
        fit = accepted[-1].fit
        bent = fit.heat > UNFIT or fit.prior > BENT * len(fit.free)
        rough = settled(accepted[-1].rough) if bent else fit
        if len(accepted) == MOST_EFFECTS:
            break
        clock("locate")
        found = description.left(rough)
    return rounds, accepted


def _mends(base: Fit, accepted: Sequence[Finalist], last: Finalist) -> bool:
    """Whether a further effect is so small that it is as likely to mend how the first was idealised.

    Beside a large first effect that leaves a misfit, one that explains most of that is no such thing; nor is one
    that brings a parameter back from where nobody would believe it.
    """
    beside = _at_one_place(accepted[0], last)
    if accepted[0].hypothesis.entry in EXACT and not beside:
        return False
    before, after = accepted[-1].fit.heat - 1.0, last.fit.heat - 1.0
    if before > UNFIT - 1.0 and after < MOST_OF_IT * before:
        return False
    known = {f.name: abs(float(z)) for f, z in zip(last.fit.free, last.fit.z, strict=True)}
    own = zip(accepted[-1].fit.free, accepted[-1].fit.z, strict=True)
    if any(abs(z) > BEYOND and known[f.name] < BELIEVED for f, z in own if f.name in known):
        return False
    # What a sensor's fault does is in its own rows, and a slip of the first in the rows of all.
    channels = last.hypothesis.locate(last.values).channels if last.hypothesis.domain == "measurement" else ()
    further = gain_by_cell(accepted[-1].fit, last.fit, channels)
    first = gain_by_cell(base, accepted[0].fit, channels)
    return mended(first, further, one_place=beside) > MOST


def _at_one_place(first: Finalist, further: Finalist) -> bool:
    """Whether two effects are of one joint or body, or of one channel."""
    one, other = (f.hypothesis.locate(f.values) for f in (first, further))
    return bool(set(one.channels) & set(other.channels)) or (one.what != "" and one.what == other.what)


def _stands(before: Finalist, result: Round, clock: Clock) -> bool:
    """Whether a further effect still gains where the model without it weighs the records, and foretells there.

    A base that lacks the first effect weighs spectra wrongly, and so leaves what further ones seem to explain.
    """
    last = result.finalists[0]
    clock("weigh anew")
    known = weighed_anew(before.fit)
    fit = recalibrate(known.evidence, build=last.fit.build, free=last.fit.free, start=last.fit.z, learn=False)
    if known.objective - fit.objective - penalty(last.quick, result.ring) < result.threshold:
        return False
    return log_e_value(Rest(known), Rest(fit), len(result.screened)) > float(np.log(E_VALUE))


def _of_the_owners(base: Fit, offered: Iterable[Hypothesis], fit: Fit) -> list[Hypothesis]:
    """Without changes of what an earlier effect has brought: an effect is not explained by a second one on it."""
    owner, line = base.campaign.model.line, fit.campaign.model.line
    brought = {*line.laws, *line.bodies} - {*owner.laws, *owner.bodies}
    kept = []
    for hypothesis in offered:
        values = {f.name: f.value(float(z)) for f, z in zip(hypothesis.free, hypothesis.starts[0], strict=True)}
        if hypothesis.locate(values).what not in brought:
            kept.append(hypothesis)
    return kept


def _without_needless(base: Fit, accepted: list[Finalist], least: float, clock: Clock) -> list[Finalist]:
    """Backward: earlier effects that the last one has made needless are dropped, and the rest fitted again."""
    kept = list(accepted)
    before = [base, *(f.fit for f in accepted)]
    index = int(np.argmax([f.gain for f in accepted]))
    largest = gain_by_cell(before[index], accepted[index].fit)
    for one in accepted[:-1]:
        rest = [f for f in kept if f is not one]
        whole = kept[-1].fit
        clock("drop")
        build, free = base.build, base.free
        for other in rest:
            build, more = stacked(build, other.hypothesis, other.prefix)
            free = (*free, *more)
        at = {f.name: float(z) for f, z in zip(whole.free, whole.z, strict=True)}
        start = np.array([at[f.name] for f in free])
        try:
            build({f.name: f.value(float(z)) for f, z in zip(free, start, strict=True)})
            without = recalibrate(whole.evidence, build=build, free=free, start=start, learn=False)
        except (InputError, KeyError, SolveError):
            # A later effect stands on this one.
            continue
        asked = len(one.hypothesis.free) * float(np.log(lines(base)))
        small = without.objective - whole.objective < least + asked
        beside = _at_one_place(accepted[index], one)
        exact = accepted[index].hypothesis.entry in EXACT and not beside
        if small or (not exact and mended(largest, gain_by_cell(without, whole), one_place=beside) > MOST):
            kept = [*rest[:-1], _with_fit(rest[-1], without)]
    return kept


def _with_fit(finalist: Finalist, fit: Fit) -> Finalist:
    return replace(finalist, rough=fit, fit=fit)
