"""One round of the search for what is missing: screen all hypotheses, follow the best, fit finalists in full."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from permway.diagnosis.choose import (
    CLOSE,
    FOLLOWED,
    RIVAL,
    WORTH,
    chosen_of,
    elsewhere,
    finalists_of,
    lines,
    penalty,
)
from permway.diagnosis.compete import Ring
from permway.diagnosis.felt import FELT, moved
from permway.diagnosis.fit import Fit, gained
from permway.diagnosis.heldout import Part, at_fault
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.in_detail import in_detail
from permway.diagnosis.journal import current
from permway.diagnosis.quick import Quick
from permway.diagnosis.quick_files import noted, recalled
from permway.diagnosis.recalibrate import UNFIT
from permway.diagnosis.refit import relearnt
from permway.diagnosis.resonances import retuned
from permway.errors import InputError, SolveError

TOGETHER = 2
"""Hypotheses that promise more than all others gain, and gain nothing while the base moves linearly."""

PROMISE = 3.0
"""Times that its other parameters may better what the start of a hypothesis promises."""

FITS, CLOSE_TO_FITTING = 1.2, 0.95
"""Mean square of the deviations below which a finalist explains all there is, and the share of its gain from which
a rival may then be the better one."""

Progress = Callable[[str, int, int], object]
"""Told a stage, how much of it is done, and of how much."""

Threshold = Callable[[Ring, Sequence[Quick]], float]


@dataclass(frozen=True)
class Finalist:
    """A hypothesis fitted in full.

    Attributes
    ----------
    quick : Quick
        From where.
    rough, fit : Fit
        Base and effect together, with the base's sizes of smooth errors, and with sizes learnt anew.
    prefix : str
        Of the effect's parameters among the fit's.
    gain, log_evidence : float
        Of the objective, and of the log evidence in nats, over the base's, sizes of smooth errors learnt on both
        sides.
    correction : float
        Of the log evidence, by sampling: see :mod:`permway.diagnosis.sampling`.
    """

    quick: Quick
    rough: Fit
    fit: Fit
    prefix: str
    gain: float
    log_evidence: float
    correction: float = 0.0

    @property
    def hypothesis(self) -> Hypothesis:
        """What was fitted."""
        return self.quick.hypothesis

    @property
    def own(self) -> list[str]:
        """Names of the effect's parameters among the fit's."""
        return [self.prefix + f.name for f in self.hypothesis.free]

    @property
    def values(self) -> dict[str, float]:
        """The effect's parameters by their own names."""
        start = len(self.prefix)
        return {k[start:]: v for k, v in self.fit.values().items() if self.prefix and k.startswith(self.prefix)}

    @property
    def faults(self) -> list[Part]:
        """Rows that tell of the channels that it says are at fault; none if it is no fault of a measurement."""
        channels = self.hypothesis.locate(self.values).channels
        if self.hypothesis.domain != "measurement" or not channels:
            return []
        return list(at_fault(self.fit.evidence, channels))


def standing(one: Finalist, rivals: Sequence[Finalist]) -> float:
    """Log evidence by which a finalist is compared with its rivals, in nats over the heat of the best fit.

    Where none of them fits, something else is missing, too: on responses as they are that decides which does best.
    On those that the search blunted it tells less.
    """
    heat = min(f.fit.heat for f in rivals)
    if heat > UNFIT:
        return (one.rough.log_evidence + one.correction) / min(f.rough.heat for f in rivals)
    return (one.fit.log_evidence + one.correction) / heat


@dataclass(frozen=True)
class Round:
    """What one round found.

    Attributes
    ----------
    ring : Ring
        Of the base.
    screened : tuple of Quick
        All that could be solved, the best first.
    followed : tuple of Quick
        Those that were followed, the best first.
    finalists : tuple of Finalist
        Those that passed the threshold, the best first.
    fitted : frozenset of str
        Effects that were fitted in full, those that fell behind among them.
    threshold : float
        Gain of BIC that had to be passed.
    """

    ring: Ring
    screened: tuple[Quick, ...]
    followed: tuple[Quick, ...]
    finalists: tuple[Finalist, ...]
    fitted: frozenset[str]
    threshold: float


def search(
    fit: Fit,
    hypotheses: Iterable[Hypothesis],
    *,
    learnt_base: Fit,
    prefix: str,
    threshold: Threshold,
    before: Sequence[Quick] = (),
    most: int = FOLLOWED,
    progress: Progress,
) -> Round:
    """Hold hypotheses against the records.

    Parameters
    ----------
    fit : Fit
        The base that hypotheses are put into, recalibrated, with earlier effects in it or not.
    hypotheses : iterable of Hypothesis
    learnt_base : Fit
        The same base with the sizes of smooth errors learnt: what a finalist has to be better than.
    prefix : str
        For the parameters of a further effect.
    before : sequence of Quick
        What was screened against an earlier base: what still promises little by its slopes of then is not tried
        again.
    most : int
        Hypotheses that are followed.
    threshold : callable
        From the base and what was screened to the gain of BIC below which nothing is a finalist.
    progress : callable
    """
    ring = Ring(fit)
    offered = list(hypotheses)
    journal = current()
    kept = None if journal is None else journal.recall("search", [_key(h) for h in offered], fit.z)
    if kept is None:
        screened, followed = looked(ring, offered, before, most, progress)
        if journal is not None:
            journal.keep({**noted(screened, offered, "screened"), **noted(followed, offered, "followed")})
    else:
        screened, followed = (recalled(kept, offered, name) for name in ("screened", "followed"))
    least = threshold(ring, screened)
    rivals = finalists_of(followed, ring, least)
    fitted: list[tuple[Quick, Fit]] = []
    close = CLOSE
    for index, one in enumerate(rivals):
        progress("fit", index, len(rivals))
        if fit.heat > FITS and fitted and fitted[0][1].heat < FITS:
            # The first explains all there was: only a rival that did nearly as well may do so, too.
            close = CLOSE_TO_FITTING
            if one.gain < close * fitted[0][0].gain:
                continue
        # What cannot be solved all around is no finalist.
        with contextlib.suppress(InputError, SolveError):
            fitted.append((one, ring.full(one, prefix=prefix, settle=False)))
    fitted.sort(key=lambda pair: pair[1].objective + penalty(pair[0], ring))
    for one in elsewhere(fitted, followed):
        progress("fit", len(rivals), len(rivals) + 1)
        with contextlib.suppress(InputError, SolveError):
            fitted.append((one, ring.full(one, prefix=prefix, settle=False)))
            fitted.sort(key=lambda pair: pair[1].objective + penalty(pair[0], ring))
    finalists, best = [], np.inf
    for index, (one, rough) in enumerate(fitted):
        if fit.objective - rough.objective < close * (fit.objective - fitted[0][1].objective):
            continue
        progress("learn", index, len(fitted))
        try:
            amended = relearnt(rough, learnt_base.evidence, best=best)
        except (InputError, SolveError):
            # It ends where the model ends: two changes of one place have met, say.
            continue
        if index == 0:
            one, rough, amended = in_detail(ring, (one, rough, amended), learnt_base, prefix)
        best = min(best, amended.objective)
        gain = gained(learnt_base, amended)
        # A fault of a sensor may show in phases, or in noise, alone.
        domain = one.hypothesis.domain
        felt = domain == "measurement" or moved(learnt_base, amended, domain) > FELT
        if gain - penalty(one, ring) > least and felt:
            more = amended.log_evidence - learnt_base.log_evidence
            more -= 0.5 * (learnt_base.objective - amended.objective - gain)
            finalists.append(Finalist(one, rough, amended, prefix, gain, more))
    finalists = sorted(finalists, key=lambda f: -standing(f, finalists))
    for other in finalists[1:]:
        # Of rivals little more is asked than how well they do; a diagnosis has dozens of them.
        if other.fit.evidence is not learnt_base.evidence:
            other.fit.evidence.forget()
    tried = frozenset(one.hypothesis.entry for one, _ in fitted)
    return Round(ring, tuple(screened), tuple(followed), tuple(finalists), tried, least)


def looked(
    ring: Ring, offered: Sequence[Hypothesis], before: Sequence[Quick], most: int, progress: Progress
) -> tuple[list[Quick], list[Quick]]:
    """All that could be solved after a step, and the most promising as far as they go, the best first."""
    screened: list[Quick] = []
    best = 0.0
    known = {_key(q.hypothesis): q for q in before if q.direction is not None}
    for index, hypothesis in enumerate(offered):
        progress("screen", index, len(offered))
        asked = len(hypothesis.free) * np.log(lines(ring.fit))
        old = known.get(_key(hypothesis))
        if hypothesis.domain != "path" and len(hypothesis.starts) > 1:
            # Another of its starts may be the better one now, and what leaves the line alone is soon tried.
            old = None
        if old is not None and (promise := ring.promise(old)) < asked / PROMISE:
            screened.append(replace(old, hypothesis=hypothesis, base_z=ring.fit.z, gain=promise, promise=promise))
            continue
        found = ring.screen(hypothesis, least=max(asked / PROMISE, WORTH * best / PROMISE))
        if np.isfinite(found.gain):
            screened.append(found)
            best = max(best, found.gain)
    screened.sort(key=lambda q: penalty(q, ring) - q.gain)
    chosen = chosen_of(screened, ring, most)
    followed: list[Quick] = []
    for index, one in enumerate(chosen):
        progress("follow", index, len(chosen))
        followed.append(ring.quick(one.hypothesis, after=one))
    best = max((q.gain for q in followed), default=0.0)
    unkept = [
        q
        for q in screened
        if q.hypothesis.domain == "path" and q.gain <= 0.0 and q.promise > max(best, penalty(q, ring))
    ]
    unkept.sort(key=lambda q: -q.promise)
    for one in unkept[:TOGETHER]:
        # The base is bent so far that moving it in a straight line leads nowhere.
        progress("follow", len(chosen), len(chosen))
        with contextlib.suppress(InputError, SolveError):
            followed.append(ring.together(one))
    best = max((q.gain for q in followed), default=0.0)
    for index, one in enumerate(followed):
        if one.gain > RIVAL * best:
            progress("follow", len(chosen), len(chosen))
            followed[index] = retuned(ring, one)
    followed.sort(key=lambda q: penalty(q, ring) - q.gain)
    return screened, followed


def _key(hypothesis: Hypothesis) -> tuple[str, ...]:
    """What makes a hypothesis the same as one of an earlier round: effect, place, and what is free."""
    values = {f.name: f.value(float(z)) for f, z in zip(hypothesis.free, hypothesis.starts[0], strict=True)}
    return *hypothesis.form, hypothesis.locate(values).label
