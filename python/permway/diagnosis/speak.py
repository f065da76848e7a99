"""From what was found to the verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from permway.arrays import Reals
from permway.diagnosis import decide
from permway.diagnosis.catalogue import irregularity_level
from permway.diagnosis.choose import lines
from permway.diagnosis.decide import Conditions
from permway.diagnosis.detectable import detectable
from permway.diagnosis.fit import WIDTH, Fit
from permway.diagnosis.heldout import Gain
from permway.diagnosis.level import beyond
from permway.diagnosis.ragged import explains_elsewhere, unexplained_lines, unsteady_misfit
from permway.diagnosis.recalibrate import UNFIT
from permway.diagnosis.recalibrated_values import recalibrated_of
from permway.diagnosis.search import Finalist, Round
from permway.diagnosis.speak_effect import bands_of, effect_of, of_another_form
from permway.diagnosis.spot import Found
from permway.diagnosis.tolerances import outside
from permway.diagnosis.verdict import NOVEL, RIGHT, Status, Verdict
from permway.diagnosis.verdict_parts import (
    Condition,
    Effect,
    HeldOutGain,
    NextMeasurement,
    Place,
    Recalibrated,
    Weight,
)

SURE: tuple[Status, ...] = ("named", "measurement")
"""Statuses whose effects have names."""

REASON = 0.5
"""Share of a misfit that a free stiffness at a place has to explain, or else nothing is said to be there."""

LEFT, LITTLE = 1.3, 0.1
"""Mean square of the deviations from which something is left, and the share of what is too much that an effect has
to explain then."""

WEIGHS_RIGHTLY = 1.05
"""The same, up to which an amended model weighs records rightly."""

CREDITED = 1.1
"""Mean square of the deviations up to which names are true as often as they say: see docs/diagnosis.md."""

LARGEST_E = 1e300


@dataclass(frozen=True)
class Proof:
    """What records that were left out say of the amended model.

    Attributes
    ----------
    held_out, placebo : sequence of Gain
    unsteady : ndarray, shape (p,)
        Variance of the amended model's parameters beyond that of its fit.
    spans : mapping of str to (float, float)
        Ends of 90 % intervals in z of those that were sampled.
    weighed : Fit
        The amended model, records weighed by what it predicts itself: what its parameters are told by. (All that
        holds it against the base weighs alike on both sides: by what the base predicts.)
    log_e : float
        Natural logarithm of the e-value.
    bic_gain : float
    conditions : Conditions
    """

    held_out: Sequence[Gain]
    placebo: Sequence[Gain]
    unsteady: Reals
    weighed: Fit
    log_e: float
    bic_gain: float
    conditions: Conditions
    spans: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def verdict_of(
    base: Fit,
    rounds: Sequence[Round],
    accepted: Sequence[Finalist],
    found: Sequence[Found],
    left: Sequence[Found],
    proof: Proof | None,
    advice: tuple[NextMeasurement, ...] = (),
) -> Verdict:
    """Put the verdict together."""
    first = rounds[0]
    # Where no model fits, nobody knows what would have been seen.
    fits = (accepted[-1].fit if accepted else base).heat < UNFIT
    last = rounds[-1]
    sizes = detectable(last.ring, last.screened, last.threshold) if fits else {}
    weight = partial(Weight, false_alarm_threshold=first.threshold, misfit_before=base.heat)
    recalibrated = Recalibrated(before=recalibrated_of(base))
    status: Status
    effects: tuple[Effect, ...]
    told = _told(base, accepted, proof)
    if _unsteady(base, told):
        effects = (unexplained_lines(told),)
        return Verdict(
            status="located", effects=effects, evidence=weight(), recalibrated=recalibrated, detectable=sizes
        )
    if not accepted or proof is None:
        status, effects = _nothing(base, first, found)
        level = beyond(base, first.threshold) if status in RIGHT else None
        if level is not None:
            status, effects = "named", (level,)
        return Verdict(
            status=status,
            effects=effects,
            evidence=weight(unmet=("misfit",) if status == "insufficient" else ()),
            recalibrated=recalibrated,
            detectable=sizes,
        )
    amended = accepted[-1].fit
    if _explains_little(base.heat, amended.heat):
        short = weight(misfit_after=amended.heat, unmet=("misfit",))
        return Verdict(status="insufficient", evidence=short, recalibrated=recalibrated, detectable=sizes)
    gap = decide.explained(base, amended, left)
    by_prefix = {r.finalists[0].prefix: r for r in rounds if r.finalists}
    ends = _ends(proof)
    explained = gap * _credit(proof.weighed)
    names = [one.hypothesis.entry for one in accepted]
    effects = tuple(
        effect_of(one, by_prefix[one.prefix], proof.weighed, base, explained, ends, names) for one in accepted
    )
    unmet = _unmet(effects, proof, gap)
    status = "insufficient" if unmet else _status(effects, gap)
    if status == "insufficient" and proof.conditions.something and not proof.conditions.hold:
        # What foretells most records and harms others is missing, and has another form.
        status, effects = "located", (of_another_form(effects[0]),)
    status, effects = _with_its_form(status, effects, fits)
    if status in SURE and fits and irregularity_level.ID not in names:
        level = beyond(proof.weighed, first.threshold)
        if level is not None:
            # It is physics, whatever else is a fault of the measurement.
            status, effects = "named", (*effects, level)
    return Verdict(
        status=status,
        effects=effects,
        evidence=weight(
            bic_gain=proof.bic_gain,
            log10_bayes_factor=(amended.log_evidence - base.log_evidence) / np.log(10.0),
            e_value=float(np.exp(min(proof.log_e, np.log(LARGEST_E)))),
            misfit_after=amended.heat,
            unmet=unmet if status == "insufficient" else (),
        ),
        held_out=_held_out(proof.held_out),
        placebo=_held_out(proof.placebo),
        explained_gap=gap,
        recalibrated=Recalibrated(before=recalibrated_of(base), after=recalibrated_of(proof.weighed)),
        next=advice,
        detectable=sizes,
    )


def _explains_little(before: float, after: float) -> bool:
    """Whether so much of a misfit is left that what was found is no suspicion of anything."""
    if after > max(UNFIT, decide.HALF * before):
        return True
    return after > LEFT and before - after < LITTLE * (before - 1.0)


def _told(base: Fit, accepted: Sequence[Finalist], proof: Proof | None) -> Fit:
    """Which model says how steady lines are: by weights of a base that lacks a resonance those near it are not.

    What does not fit, as noise that stands for impacts, makes lines less coherent, and so hides that they scatter.
    """
    if proof is not None and proof.weighed.heat < WEIGHS_RIGHTLY:
        return proof.weighed
    return accepted[-1].fit if accepted else base


def _unsteady(base: Fit, amended: Fit) -> bool:
    """Whether lines of a run scatter as no steady record's do, and what was found leaves them so."""
    after = unsteady_misfit(amended)
    ragged = after > amended.heat and _explains_little(unsteady_misfit(base), after)
    return ragged and not explains_elsewhere(base, amended)


def _with_its_form(status: Status, effects: tuple[Effect, ...], fits: bool) -> tuple[Status, tuple[Effect, ...]]:
    """Without the mechanics of a description that does not fit: with so much off beside it, it is a place."""
    return ("located", (of_another_form(effects[0]),)) if status == "described" and not fits else (status, effects)


def _unmet(effects: Sequence[Effect], proof: Proof, gap: float) -> tuple[Condition, ...]:
    """Conditions that do not hold; what explains less than half is no effect of a domain that has no places."""
    opens = gap < decide.HALF and any(e.domain != "path" for e in effects)
    return (*proof.conditions.unmet, *(("explained_gap",) if opens else ()))


def _status(effects: Sequence[Effect], gap: float) -> Status:
    """Of effects that meet every condition."""
    if effects[0].class_ and effects[0].class_[0].name == NOVEL:
        # Of a form of the catalogue that is believed no more than this, no mechanics are told.
        sole = len(effects[0].class_) == 1
        return "described" if sole and effects[0].parameters and gap >= decide.EXPLAINED else "located"
    if gap < decide.HALF and effects[0].domain == "path":
        return "located"
    if any(effect.name is None for effect in effects):
        return "ambiguous"
    return "measurement" if all(effect.domain == "measurement" for effect in effects) else "named"


def _credit(amended: Fit) -> float:
    """Share of what an amended model explains that its names may be credited with, 0 to 1.

    What does not fit lacks physics, and what it has may stand in for that.
    """
    return min(1.0, CREDITED / amended.heat)


def _nothing(base: Fit, first: Round, found: Sequence[Found]) -> tuple[Status, tuple[Effect, ...]]:
    """Without an effect that passed: the place where something acts, if there is one."""
    if found:
        best = found[0]
        # Where the base does not fit at all, one place has to be the reason for a good part of it.
        reason = base.heat <= UNFIT or best.gain > REASON * best.total
        if reason and best.gain - best.degrees * np.log(lines(base)) > first.threshold:
            joint = best.spot.kind == "joint"
            place = Place(
                body=None if joint else best.spot.name,
                joint=best.spot.name if joint else None,
                x=best.spot.x_m,
                within=_alike(found),
            )
            return "located", (
                Effect(domain="path", place=place, bands=bands_of(best.frequency_Hz, best.by_band)),
            )
    if base.heat > UNFIT:
        return "insufficient", ()
    return ("outside_tolerance" if outside(recalibrated_of(base)) else "recalibrated"), ()


def _alike(found: Sequence[Found]) -> tuple[float, float]:
    """From and to of the places that explain as much as the best, but for what noise does (90 %)."""
    best = found[0]
    same = [f for f in found if f.spot.name == best.spot.name and best.surplus - f.surplus < 2.0 * np.log(10.0)]
    return min(f.spot.x_m[0] for f in same), max(f.spot.x_m[1] for f in same)


def _ends(proof: Proof) -> dict[str, tuple[float, float]]:
    """Ends of 90 % intervals in z of all parameters of the amended model, as wide as they are unsteady."""
    fit, found = proof.weighed, {}
    own, wider = WIDTH * np.sqrt(np.diag(fit.covariance)), WIDTH * np.sqrt(proof.unsteady)
    for f, z, reach, more in zip(fit.free, fit.z, own, wider, strict=True):
        low, high = proof.spans.get(f.name, (z - reach, z + reach))
        further = [float(np.hypot(end - z, more) - abs(end - z)) for end in (low, high)]
        found[f.name] = (low - further[0], high + further[1])
    return found


def _held_out(found: Sequence[Gain]) -> dict[str, HeldOutGain]:
    return {
        f"{g.part.axis}: {g.part.name}": HeldOutGain(
            gain_nats=g.nats,
            standard_error=g.standard_error if np.isfinite(g.standard_error) else None,
            db_before=g.before_dB if np.isfinite(g.before_dB) else None,
            db_after=g.after_dB if np.isfinite(g.after_dB) else None,
        )
        for g in found
    }
