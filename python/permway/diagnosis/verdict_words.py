"""The verdict in words: one sentence."""

from __future__ import annotations

from collections.abc import Sequence

from permway.diagnosis.plain_names import (
    again,
    aim,
    chance,
    ends,
    estimate,
    name_of,
    parameter_of,
    seen,
    stated,
    stretch,
)
from permway.diagnosis.tolerances import outside
from permway.diagnosis.verdict import NOVEL, Effect, Moved, Smallest, Verdict
from permway.diagnosis.verdict_numbers import held_dB, probability, quantity, strongest
from permway.diagnosis.verdict_parts import E_VALUE, Condition

MOST_SIZES = 3
"""Detectable sizes that a sentence names, at most."""

INCOMPLETE = 1.5
"""Misfit from which an amended model is called incomplete."""

MOST_OUTSIDE = 2
"""Parameters outside their tolerance that a sentence names, at most."""

STATED = "owner_value"
"""Effect whose place is a parameter that was stated wrongly."""

STATUS = {
    "recalibrated": "nothing missing",
    "outside_tolerance": "parameter outside its tolerance",
    "measurement": "fault in the measurement",
    "named": "effect named",
    "ambiguous": "effect found, several names possible",
    "described": "effect described, none of the catalogue",
    "located": "effect located",
    "insufficient": "not enough information",
}
"""Statuses in words."""

DOMAIN = {
    "path": "track and structure",
    "irregularity": "irregularity",
    "vehicle": "vehicle",
    "measurement": "measurement",
}
"""Domains in words."""


def sentence(verdict: Verdict) -> str:
    """The verdict in one plain sentence for an engineer; before it, what is probably stated wrongly."""
    sure = [one for one in verdict.blunders if not one.asked]
    if not sure:
        return _of_physics(verdict)
    more = f" (and {len(sure) - 1} more)" if len(sure) > 1 else ""
    first = f"{sure[0].where}: {sure[0].what}; {sure[0].remedy}{more}."
    return f"Put right first: {first} As the records stand: {_of_physics(verdict)}"


def _of_physics(verdict: Verdict) -> str:
    match verdict.status:
        case "recalibrated":
            parts = ["Nothing is missing beyond what the stated tolerances allow", _seen(verdict)]
        case "outside_tolerance":
            parts = [_outside(verdict), _seen(verdict)]
        case "insufficient":
            # What screening found is no suspicion: it has no class.
            suspects = [effect for effect in verdict.effects if effect.class_]
            faulty = [_named(effect) for effect in verdict.effects if not effect.class_]
            suspect = f"the suspicion is {_named(suspects[0])}" if suspects else ""
            words = "Nothing that was tried explains enough of these records to be called missing"
            sure = f"at fault is {' and '.join(faulty)}" if faulty else ""
            parts = [words, suspect, sure, _short(verdict), _seen(verdict), _advice(verdict)]
        case "named":
            parts = [_named(verdict.effects[0]), _more(verdict), _better(verdict), _open(verdict)]
        case "measurement":
            sure = "" if _open(verdict) or outside(_moved(verdict)) else " and no physics is missing"
            words = f"The measurement is at fault{sure}: {_named(verdict.effects[0])}"
            parts = [words, _more(verdict), _better(verdict), _open(verdict)]
        case "ambiguous":
            first = next(i for i, effect in enumerate(verdict.effects) if effect.name is None)
            rivals = _rivals(verdict, first)
            parts = [rivals, _more(verdict, first), _better(verdict), _open(verdict), _advice(verdict)]
        case "described":
            effect = verdict.effects[0]
            words = f"{_at(effect)} acts what the catalogue does not hold: {effect.law.words or 'novel physics'}"
            parts = [words, _more(verdict), _better(verdict), _open(verdict)]
        case "located":
            effect = verdict.effects[0]
            words = f"{_at(effect)} physics is missing that these records cannot describe"
            words += f" ({effect.law.words})" if effect.law.words else ""
            parts = [words, _more(verdict), _better(verdict), _advice(verdict)]
    if verdict.status != "outside_tolerance":
        parts.append(_beyond(verdict))
    if verdict.ruled_out:
        parts.append(
            f"not considered, for somebody had ruled it out: {', '.join(map(name_of, verdict.ruled_out))}"
        )
    text = "; ".join(part for part in parts if part)
    return f"{text[:1].upper()}{text[1:]}."


def smallest(name: str, one: Smallest) -> str:
    """What would have been seen of an effect."""
    return f"{name_of(name)} ({seen(one)})"


def _named(effect: Effect, others: Sequence[Effect] = ()) -> str:
    """What, where, how much, how surely, with 90 % intervals; kept apart from others of the same names."""
    known = probability(effect)
    names = _names(effect)
    alike = any(_names(one) == names for one in others)
    what = again(names[0], alike) if len(names) == 1 else " or ".join(name_of(one) for one in names)
    what = "another of the same names" if alike and len(names) > 1 else what
    place = f"{effect.place.label}{_within(effect)}"
    text = " at ".join(part for part in (what, place) if part)
    what = f"{effect.law.words or _values(effect)}{_strength(effect)}"
    text = ": ".join(part for part in (text, what) if part) or "an effect"
    return text if known is None or effect.name is None else f"{text}, probability {chance(known)}"


def _names(effect: Effect) -> list[str]:
    return [effect.name] if effect.name else [member.name for member in effect.class_]


def _strength(effect: Effect) -> str:
    """The 90 % interval of what says how strong it is."""
    one = effect.parameters.get(effect.size or "")
    return "" if one is None or not ends(one) else f" (90 %: {parameter_of(effect.size or '')} {ends(one)})"


def _within(effect: Effect) -> str:
    """The 90 % interval of its place, where that is not only its most probable one."""
    x, within = effect.place.x, effect.place.within
    if not effect.size or x is None or within is None or stretch(*x) == stretch(*within):
        return ""
    return f" (90 %: {stretch(*within)})"


def _values(effect: Effect) -> str:
    return ", ".join(f"{parameter_of(name)} {estimate(one)}" for name, one in effect.parameters.items())


def _at(effect: Effect) -> str:
    label = effect.place.label
    bands = " and ".join(f"{low:.3g} to {high:.3g} Hz" for low, high in effect.bands)
    where = f"at {label}" if label else f"in {DOMAIN[effect.domain]}"
    return f"{where}, {bands}," if bands else where


def _rivals(verdict: Verdict, first: int) -> str:
    effect, known = verdict.effects[first], {one.name for one in verdict.effects}
    names = " or ".join(f"{again(m.name, m.name in known)} ({chance(m.probability)})" for m in effect.class_)
    return f"{_at(effect)} physics is missing that these records allow to be {names}"


def _more(verdict: Verdict, first: int = 0) -> str:
    """The effects beside the first that is named."""
    rest = [e for i, e in enumerate(verdict.effects) if i != first and not _disbelieved(e)]
    others = [_named(e, [verdict.effects[first], *rest[:i]]) for i, e in enumerate(rest)]
    return f"beside that {'; and '.join(others)}" if others else ""


def _disbelieved(effect: Effect) -> bool:
    """Whether it more likely is something else than any of its names."""
    return len(effect.class_) > 1 and effect.class_[0].name == NOVEL


def _better(verdict: Verdict) -> str:
    """How much better all records are predicted that were left out, one after the other: root mean squares."""
    found, errors = strongest(verdict), held_dB(verdict)
    if found is None or errors is None:
        return ""
    before, after = errors
    if found[1].gain_nats > 0.0 and f"{before:.1f}" == f"{after:.1f}":
        nats = quantity(found[1].gain_nats)
        return (
            f"held-out records become more probable by up to {nats} nats, their levels stay within {after:.1f} dB"
        )
    moves = "improves" if after < before else "does not improve:"
    return f"the prediction of held-out records {moves} from {before:.1f} to {after:.1f} dB"


def _short(verdict: Verdict) -> str:
    """What a suspicion falls short of, or the model where there is none."""
    weight, gap = verdict.evidence, verdict.explained_gap
    left = weight.misfit_before if weight.misfit_after is None else weight.misfit_after
    asked = weight.false_alarm_threshold

    def number(value: float | None) -> str:
        return "not known" if value is None else quantity(value)

    words: dict[Condition, str] = {
        "bic_gain": f"its gain of BIC is {number(weight.bic_gain)}, {number(asked)} are asked",
        "e_value": f"its e-value is {number(weight.e_value)}, {E_VALUE:.0f} are asked",
        "held_out": "records that were left out are not predicted better by it",
        "placebo": "as many parameters elsewhere gain half as much",
        "explained_gap": f"it explains {number(None if gap is None else 100.0 * gap)} % of what is missing",
        "misfit": f"what is left has {number(left)} times the mean square that errors explain",
    }
    return " and ".join(words[one] for one in weight.unmet)


def _open(verdict: Verdict) -> str:
    """That something is left which no error explains."""
    left = verdict.evidence.misfit_after
    if left is None or left < INCOMPLETE:
        return ""
    return f"this is not all of it: what is left has {quantity(left)} times the mean square that errors explain"


def _moved(verdict: Verdict) -> dict[str, Moved]:
    """The campaign's parameters as the last of the fits has them."""
    return verdict.recalibrated.after or verdict.recalibrated.before


def _beyond(verdict: Verdict) -> str:
    """Parameters outside their tolerances beside those named, the farthest first."""
    known = _moved(verdict)
    # Those that an effect of its own states.
    named = {effect.place.body for effect in verdict.effects if effect.name == STATED}
    words = [
        f"{name} has to be {estimate(known[name])} for it, {quantity(abs(known[name].z))} standard "
        f"deviations from the nominal {stated(known[name].prior, known[name].unit)}"
        for name in [name for name in outside(known) if name not in named][:MOST_OUTSIDE]
    ]
    return " and ".join(words)


def _outside(verdict: Verdict) -> str:
    """That the model fits with values only that the tolerances do not allow."""
    known, names = _moved(verdict), outside(_moved(verdict))
    words = " and ".join(_off(name, known[name]) for name in names[:MOST_OUTSIDE])
    more = f" (and {len(names) - MOST_OUTSIDE} more)" if len(names) > MOST_OUTSIDE else ""
    return (
        f"The model fits only with {words or 'a value outside its tolerance'}{more}: what is stated there is "
        "wrong, or something is missing that acts like it"
    )


def _off(name: str, one: Moved) -> str:
    """A parameter's value, and how far from the stated one."""
    spread = f" (90 %: {text})" if (text := ends(one)) else ""
    share = one.value / one.prior - 1.0 if one.prior else 0.0
    percent = (
        f"{quantity(100.0 * abs(share))} % {'below' if share < 0.0 else 'above'} " if share else "in place of "
    )
    return (
        f"{name} at {estimate(one)}{spread}, {percent}the stated {stated(one.prior, one.unit)} and "
        f"{quantity(abs(one.z))} standard deviations of its tolerance away"
    )


def _seen(verdict: Verdict) -> str:
    # A share of what is there is plainer than a parameter of its own.
    known = [(not one.none, name, one) for name, one in verdict.detectable.items() if one.value is not None]
    sizes = [smallest(name, one) for _, name, one in sorted(known, key=lambda row: row[0])]
    if not sizes:
        return ""
    more = f" and {len(sizes) - MOST_SIZES} more" if len(sizes) > MOST_SIZES else ""
    return f"would have been seen: {', '.join(sizes[:MOST_SIZES])}{more}"


def _advice(verdict: Verdict) -> str:
    if not verdict.next:
        return ""
    first = verdict.next[0]
    return f"to {aim(first.separates)}, measure: {first.measurement}"
