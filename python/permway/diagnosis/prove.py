"""What an amendment is held against: records left out, an e-value, a placebo."""

from __future__ import annotations

import numpy as np

from permway.diagnosis import decide
from permway.diagnosis.choose import lines
from permway.diagnosis.clock import Clock
from permway.diagnosis.e_value import log_e_value
from permway.diagnosis.fit import Fit, gained
from permway.diagnosis.heldout import Rest, between_lines, gains, parts
from permway.diagnosis.hypothesis import Where
from permway.diagnosis.quick import Quick
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.refit import weighed_anew
from permway.diagnosis.search import Finalist, Round
from permway.diagnosis.speak import Proof
from permway.diagnosis.thermometers import misread
from permway.diagnosis.unsteady import unsteady


def prove(
    base: Fit, amended: Fit, rounds: list[Round], accepted: list[Finalist], clock: Clock, *, others: Round
) -> Proof:
    """Records left out, e-value, and a placebo of what was screened in another round, or in the same."""
    faults = [part for one in accepted for part in one.faults]
    profile = list(between_lines(base.evidence)) if accepted[0].hypothesis.domain == "irregularity" else []
    chosen = [*parts(base.evidence), *faults, *profile]
    before, after = Rest(base), Rest(amended)
    held_out = gains(before, after, chosen)
    # Without the bands of a line nothing is known of its size: that it moves then says nothing of its steadiness.
    told = [gain for gain in held_out if all(gain.part is not part for part in profile)]
    tried = [len(found.screened) for found in rounds[: len(accepted)]]
    log_e = log_e_value(before, after, int(np.prod(tried)), faults)
    clock("weigh anew")
    weighed = weighed_anew(amended)
    clock("placebo")
    sham = _placebo(others, accepted[0])
    placebo_gain, placebo_held_out = 0.0, []
    if sham is not None:
        found = others.ring.full(sham, prefix="placebo.", most_steps=6)
        fit = recalibrate(
            base.evidence, build=found.build, free=found.free, start=found.z, learn=False, most_steps=6
        )
        placebo_gain = gained(base, fit)
        placebo_held_out = gains(before, Rest(fit), chosen)
    gain = gained(base, amended)
    bic = gain - sum(len(f.hypothesis.free) for f in accepted) * float(np.log(lines(base)))
    return Proof(
        held_out=held_out,
        log_e=log_e,
        placebo=placebo_held_out,
        unsteady=unsteady(amended, told) + weighed.idealisation + misread(weighed, accepted),
        weighed=weighed,
        bic_gain=bic,
        conditions=decide.conditions(
            bic_gain=bic,
            threshold=rounds[0].threshold,
            log_e=log_e,
            held_out=held_out,
            gain=gain,
            placebo=placebo_gain,
        ),
    )


def proven(
    base: Fit, rounds: list[Round], accepted: list[Finalist], clock: Clock, *, others: Round
) -> tuple[list[Finalist], Proof]:
    """The effects with their proof; without the last ones, where all together fail and those before pass.

    A further effect that stands for nothing may spoil what a right one foretells.
    """
    whole = prove(base, accepted[-1].fit, rounds, accepted, clock, others=others)
    if whole.conditions.hold:
        return accepted, whole
    for count in range(len(accepted) - 1, 0, -1):
        fewer = accepted[:count]
        if not _alone(fewer):
            continue
        proof = prove(base, fewer[-1].fit, rounds, fewer, clock, others=others)
        if proof.conditions.hold:
            return fewer, proof
    return accepted, whole


def _alone(accepted: list[Finalist]) -> bool:
    """Whether the last of these was fitted with no other effect than these."""
    last, known = accepted[-1].fit, accepted[-1].fit.evidence.campaign.parameters.known
    own = {name for one in accepted for name in one.own}
    return all(f.name in own or f.name in known or not f.name[0].isdigit() for f in last.free)


def _placebo(found: Round, best: Finalist) -> Quick | None:
    """As many parameters, nearly, of another family, at another place if any is; of those one of middling gain."""
    count, there = len(best.hypothesis.free), best.hypothesis.locate(best.values)
    others = [q for q in found.screened if q.hypothesis.family != best.hypothesis.family]
    others = [q for q in others if not _meet(there, q.hypothesis.locate(q.values))] or others
    if not others:
        return None
    near = min(abs(len(q.hypothesis.free) - count) for q in others)
    alike = sorted((q for q in others if abs(len(q.hypothesis.free) - count) == near), key=lambda q: q.gain)
    return alike[len(alike) // 2]


def _meet(one: Where, other: Where) -> bool:
    """Whether two stretches have a place in common: what is done to a rail there does something to its pads."""
    if one.x_m is None or other.x_m is None:
        return False
    return one.x_m[0] <= other.x_m[1] and other.x_m[0] <= one.x_m[1]
