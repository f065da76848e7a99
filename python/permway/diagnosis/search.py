"""One round of the search for what is missing: screen all hypotheses, follow the best, fit finalists in full."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from permway.diagnosis.choose import (
    CLOSE,
    FOLLOWED,
    elsewhere,
    finalists_of,
    penalty,
)
from permway.diagnosis.clock import Progress
from permway.diagnosis.compete import Ring
from permway.diagnosis.felt import FELT, moved
from permway.diagnosis.fit import Fit, gained
from permway.diagnosis.heldout import Part, at_fault
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.in_detail import Told, in_detail
from permway.diagnosis.journal import current, silent
from permway.diagnosis.looked import key, looked
from permway.diagnosis.quick import Quick
from permway.diagnosis.quick_files import noted, recalled
from permway.diagnosis.recalibrate import UNFIT
from permway.diagnosis.refit import relearnt
from permway.diagnosis.several_fits import fitted_in_full, relearnt_all
from permway.errors import InputError, SolveError

FITS, CLOSE_TO_FITTING = 1.2, 0.95
"""Mean square of the deviations below which a finalist explains all there is, and the share of its gain from which
a rival may then be the better one."""

EXPLAINS = 1.05
"""Mean square of the deviations of responses as they are from which those that were spared are tried after all: a
rod in place of some pads left 1.07; a part of their own stiffness, which is there, does as well by two constants
less."""

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
    kept = None if journal is None else journal.recall("search", [key(h) for h in offered], fit.z)
    if kept is None:
        with silent():
            screened, followed = looked(ring, offered, before, most, progress)
        if journal is not None:
            journal.keep({**noted(screened, offered, "screened"), **noted(followed, offered, "followed")})
    else:
        screened, followed = (recalled(kept, offered, name) for name in ("screened", "followed"))
    least = threshold(ring, screened)
    rivals = finalists_of(followed, ring, least)
    fitted: list[tuple[Quick, Fit]] = []
    in_full = partial(_in_full, ring, fitted, prefix, progress)
    # What cannot be solved all around is no finalist.
    waiting = rivals
    while waiting and not fitted:
        in_full(waiting[:1])
        waiting = waiting[1:]
    close, spared = CLOSE, []
    if fit.heat > FITS and fitted and fitted[0][1].heat < FITS:
        # The first explains all there was: only a rival that did nearly as well may do so, too.
        close = CLOSE_TO_FITTING
        least_gain = close * fitted[0][0].gain
        spared = [one for one in waiting if one.gain < least_gain]
        waiting = [one for one in waiting if one.gain >= least_gain]
    in_full(waiting)
    in_full(elsewhere(fitted, followed))
    near = _near(fit, fitted, close)
    learnt = _learnt(ring, near, learnt_base, prefix, progress)
    if spared and not any(amended.heat < EXPLAINS for _, _, amended in learnt):
        # Of blunted responses it did, and of responses as they are does not.
        in_full(spared)
        in_full(elsewhere(fitted, followed))
        seen = {id(rough) for _, rough in near}
        further = [pair for pair in _near(fit, fitted, CLOSE) if id(pair[1]) not in seen]
        learnt += _learnt(ring, further, learnt_base, prefix, progress)
    finalists = []
    for one, rough, amended in learnt:
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


def _in_full(
    ring: Ring, fitted: list[tuple[Quick, Fit]], prefix: str, progress: Progress, quicks: Sequence[Quick]
) -> None:
    """Add to those that are fitted in full, and have the best of all first."""
    total = len(fitted) + len(quicks)
    fitted += fitted_in_full(
        ring, quicks, prefix=prefix, told=lambda begun: progress("fit", total - len(quicks) + begun, total)
    )
    fitted.sort(key=lambda pair: pair[1].objective + penalty(pair[0], ring))


def _near(fit: Fit, fitted: Sequence[tuple[Quick, Fit]], close: float) -> list[tuple[Quick, Fit]]:
    """Those that gain nearly what the first does."""
    if not fitted:
        return []
    best = fit.objective - fitted[0][1].objective
    return [pair for pair in fitted if not fit.objective - pair[1].objective < close * best]


def _learnt(
    ring: Ring, near: Sequence[tuple[Quick, Fit]], learnt_base: Fit, prefix: str, progress: Progress
) -> list[Told]:
    """With sizes of smooth errors learnt anew; the first in more detail, and the others as far as they come near.

    What ends where its model ends is left out: two changes of one place have met, say.
    """
    sharp, found, best = learnt_base.evidence, [], np.inf
    if near:
        progress("learn", 0, len(near))
        one, rough = near[0]
        with contextlib.suppress(InputError, SolveError):
            first = in_detail(ring, (one, rough, relearnt(rough, sharp)), learnt_base, prefix)
            found, best = [first], first[2].objective
    others = [rough for _, rough in near[1:]]
    fits = relearnt_all(others, sharp, best=best, told=lambda begun: progress("learn", 1 + begun, len(near)))
    pairs = zip(near[1:], fits, strict=True)
    return [*found, *((one, rough, amended) for (one, rough), amended in pairs if amended is not None)]
