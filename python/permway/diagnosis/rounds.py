"""Effects one after another: forward while one passes, backward where a later one made an earlier one needless."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace

import numpy as np

from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.clock import Clock
from permway.diagnosis.compete import Quick, Ring, stacked
from permway.diagnosis.describe import Description
from permway.diagnosis.fit import Fit
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.locate import Found
from permway.diagnosis.nulls import threshold
from permway.diagnosis.recalibrate import UNFIT, recalibrate, settled
from permway.diagnosis.search import Finalist, Round, lines, search
from permway.errors import InputError, SolveError

MOST_EFFECTS = 3

SECOND = 0.03
"""Share of the first effect's gain from which a further one counts as an effect."""

MOST_OF_IT = 0.5
"""Share of what earlier effects leave that may be left by a smaller one."""


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
        return threshold(ring, screened, seed=seed)

    rounds: list[Round] = []
    accepted: list[Finalist] = []
    fit = base
    screened: tuple[Quick, ...] = ()
    for order in range(MOST_EFFECTS):
        result = None
        for start in [fit] if rough is fit else [rough, fit]:
            offered = _of_the_owners(base, hypotheses(Situation(start, found), ruled_out), start)
            prefix = f"{order + 1}."
            result = search(
                start,
                offered,
                learnt_base=fit,
                prefix=prefix,
                threshold=least,
                before=screened,
                progress=clock,
            )
            screened = result.screened
            if result.finalists:
                break
        assert result is not None
        rounds.append(result)
        if not result.finalists:
            break
        if accepted and _mends(accepted, result.finalists[0]):
            break
        accepted.append(result.finalists[0])
        if order == 0 and description.instead(result):
            break
        if len(accepted) > 1:
            accepted = _without_needless(base, accepted, result.threshold, clock)
        # Once a model nearly fits, nothing is gained from blunting.
        fit = accepted[-1].fit
        rough = fit if fit.heat < UNFIT else settled(accepted[-1].rough)
        if order + 1 < MOST_EFFECTS:
            clock("locate")
            found = description.left(rough)
    return rounds, accepted


def _mends(accepted: Sequence[Finalist], last: Finalist) -> bool:
    """Whether a further effect is so small that it is as likely to mend how the first was idealised.

    Beside a large first effect that leaves a misfit, one that explains most of that is no such thing.
    """
    before, after = accepted[-1].fit.heat - 1.0, last.fit.heat - 1.0
    return last.gain < SECOND * accepted[0].gain and not (before > UNFIT - 1.0 and after < MOST_OF_IT * before)


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
        needed = max(least + asked, SECOND * max(f.gain for f in accepted))
        if without.objective - whole.objective < needed:
            kept = [*rest[:-1], _with_fit(rest[-1], without)]
    return kept


def _with_fit(finalist: Finalist, fit: Fit) -> Finalist:
    return replace(finalist, rough=fit, fit=fit)
