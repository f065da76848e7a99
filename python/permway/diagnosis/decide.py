"""Whether physics is called missing, and which: four conditions, classes of rivals, detectable sizes."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from permway.diagnosis.choose import lines, penalty
from permway.diagnosis.fit import Fit
from permway.diagnosis.heldout import Gain
from permway.diagnosis.quick import Quick
from permway.diagnosis.search import Finalist, Round, standing
from permway.diagnosis.spot import Found
from permway.diagnosis.verdict import NOVEL
from permway.diagnosis.verdict_parts import E_VALUE, ClassMember, Condition

STANDARD_ERRORS = 2.0
HARM_NATS = 3.0
"""Loss of log predictive density on an axis below which nothing is called harm: where an effect does not show, its
standard error is next to nothing."""

HARM_DB = 1.02
"""Ratio of errors in decibels, after over before, from which an axis is predicted worse."""

PLACEBO_SHARE = 0.5
"""Share of the effect's gain that a placebo may not reach."""

CLASS_DEVIANCE = 9.0
"""Deviance between best fits below which rivals are one class."""

NAMED = 0.9
"""Probability from which an effect is named."""

NOVEL_PRIOR = 0.05
"""Of physics that the catalogue does not hold, before anything was seen."""

DISCREPANCY = 0.03
"""Share of an effect's gain that its idealisation may leave to a free description: none is quite its model."""

EXPLAINED, HALF = 0.8, 0.5
"""Share of the gap to a free description that a named effect has to close, and below which none is offered."""


@dataclass(frozen=True)
class Conditions:
    """The four conditions under which physics is called missing.

    Attributes
    ----------
    bic : bool
        The gain of BIC is above the threshold.
    e_value : bool
        The e-value is above 20.
    held_out : bool
        The gain on records left out is above two standard errors on some axis, and none is predicted worse.
    placebo : bool
        As many parameters elsewhere do not do half as well.
    helps : bool
        The gain on records left out is above two standard errors on some axis, whatever it is on the others.
    """

    bic: bool
    e_value: bool
    held_out: bool
    placebo: bool
    helps: bool = True

    @property
    def something(self) -> bool:
        """Whether something is missing, be it not what was found: all hold, but that it harms somewhere."""
        return self.bic and self.e_value and self.helps and self.placebo

    @property
    def hold(self) -> bool:
        """Whether all do."""
        return not self.unmet

    @property
    def unmet(self) -> tuple[Condition, ...]:
        """Those that do not hold."""
        held: dict[Condition, bool] = {
            "bic_gain": self.bic,
            "e_value": self.e_value,
            "held_out": self.held_out,
            "placebo": self.placebo,
        }
        return tuple(name for name, holds in held.items() if not holds)


def conditions(
    *, bic_gain: float, threshold: float, log_e: float, held_out: Sequence[Gain], gain: float, placebo: float
) -> Conditions:
    """Judge the effects that were found.

    Parameters
    ----------
    bic_gain, threshold : float
    log_e : float
        Natural logarithm of the e-value.
    held_out : sequence of Gain
    gain, placebo : float
        Of the objective, by the effect and by the placebo.
    """
    helps = any(g.nats > STANDARD_ERRORS * g.standard_error for g in held_out)
    harms = any(_harmed(g) for g in held_out)
    return Conditions(
        bic=bic_gain > threshold,
        e_value=log_e > np.log(E_VALUE),
        held_out=not held_out or (helps and not harms),
        placebo=placebo < PLACEBO_SHARE * gain,
        helps=helps,
    )


def _harmed(gain: Gain) -> bool:
    """Whether an axis is predicted worse, in density and in decibels.

    A better model is surer of itself, and loses density where what it still lacks shows, with no worse levels.
    """
    worse = not gain.after_dB <= HARM_DB * gain.before_dB
    return worse and gain.nats < -max(STANDARD_ERRORS * gain.standard_error, HARM_NATS)


def unexplained(amended: Fit, left: Sequence[Found]) -> float:
    """What a free stiffness at one place would still gain, beyond what BIC asks for it."""
    if not left:
        return 0.0
    return float((left[0].gain - left[0].degrees * np.log(lines(amended))) * amended.heat)


def explained(base: Fit, amended: Fit, left: Sequence[Found]) -> float:
    """Share of the gap between recalibrated base and free description that the amended model closes, 0 to 1."""
    gained = max(base.objective - amended.objective, 1e-9)
    return float(gained / (gained + max(unexplained(amended, left), 0.0)))


def members(found: Round, *, explained: float, beside: Collection[str] = ()) -> list[ClassMember]:
    """The class of effects that the records allow, the most probable first.

    Parameters
    ----------
    found : Round
        Whose finalists rival each other.
    explained : float
        Share of the gap to a free description that the amended model closes: what is open is novel as likely as it
        is large.
    beside : collection of str
        What was found beside it, and so is no rival.
    """
    best = found.finalists[0]
    weight: dict[str, float] = {}
    for finalist in found.finalists:
        # While none fits, the records say less than they would. The best form of an effect comes first.
        less = standing(finalist, found.finalists) - standing(best, found.finalists)
        weight.setdefault(finalist.hypothesis.entry, float(np.exp(min(less, 0.0))))
    for quick in _twins(found, best):
        behind = 0.5 * (quick.gain - best.quick.gain) - 0.5 * (
            penalty(quick, found.ring) - penalty(best.quick, found.ring)
        )
        weight.setdefault(quick.hypothesis.entry, float(np.exp(min(behind, 0.0))))
    for name in {NOVEL, *(set(beside) - {best.hypothesis.entry})}:
        weight.pop(name, None)
    if not weight:
        return [ClassMember(name=NOVEL, probability=1.0)]
    total = sum(weight.values())
    open_share = 0.0 if explained > 1.0 - DISCREPANCY else 1.0 - explained
    novel = NOVEL_PRIOR + (1.0 - NOVEL_PRIOR) * open_share
    found_members = [(name, (1.0 - novel) * w / total) for name, w in weight.items()]
    found_members.append((NOVEL, novel))
    found_members.sort(key=lambda pair: -pair[1])
    kept = [(name, p) for name, p in found_members if p >= 1e-3]
    return [ClassMember(name=name, probability=float(p)) for name, p in kept]


def _twins(found: Round, best: Finalist) -> list[Quick]:
    """Rivals that were followed and do as well as the best did then; of what was fitted in full its fits tell."""
    return [
        q
        for q in found.followed
        if q.hypothesis.entry not in {best.hypothesis.entry, *found.fitted}
        and best.quick.gain - q.gain < CLASS_DEVIANCE
    ]
