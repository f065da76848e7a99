"""A verdict as an engineer acts on it: what, where, how much, how sure, and what to do next, as plain data."""

from __future__ import annotations

from collections.abc import Sequence

from permway.diagnosis.catalogue import entries
from permway.diagnosis.plain_names import aim, chance, ends, estimate, name_of, parameter_of, stretch
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.tolerances import outside
from permway.diagnosis.verdict import NOVEL, UNPROVED, Effect, Verdict
from permway.diagnosis.verdict_numbers import held_dB, probability, strongest
from permway.diagnosis.verdict_words import DOMAIN, STATED, STATUS
from permway.diagnosis.weighed import Aside, Rival, Weighed
from permway.model.line import Line

Facts = list[tuple[str, str]]

MOST_RIVALS = 12
"""Sets that the page shows openly, beside the best of each size."""

LEAST = 0.005
"""Probability that is shown of what acts at no place along the line."""


def facts_first(verdict: Verdict) -> Facts:
    """The few numbers below the sentence, and what each is."""
    found = [(STATUS[verdict.status].capitalize(), "status")]
    for effect in verdict.effects[:1]:
        known, one = probability(effect), effect.parameters.get(effect.size or "")
        if known is not None:
            found.append((chance(known).capitalize(), f"probability of {_title(effect)}"))
        if one is not None:
            span = f"; 90 %: {ends(one)}" if ends(one) else ""
            found.append((estimate(one), f"{_meaning(effect, effect.size or '')}{span}"))
    best, errors = strongest(verdict), held_dB(verdict)
    if best is not None and errors is not None and verdict.effects:
        before, after = (f"{one:.1f}" for one in errors)
        if before == after:
            group, gain = best
            gained = f"gain of the log density of what was held out ({group}); {after} dB off as before"
            found.append((f"{gain.gain_nats:+.0f} nats", gained))
        else:
            found.append((f"{before} → {after} dB", "error of what was held out, before and after"))
    return found


def effect_cards(verdict: Verdict) -> list[tuple[str, Facts, list[tuple[str, str, str]]]]:
    """Of each effect a title, facts, and rows of parameters: name and meaning, value, 90 % interval."""
    return [(_title(effect).capitalize(), _facts(effect), _parameters(effect)) for effect in verdict.effects]


def _title(effect: Effect) -> str:
    if effect.name is not None:
        return name_of(effect.name)
    names = [name_of(m.name) for m in effect.class_]
    return " or ".join(names) if names else "something without a name"


def _facts(effect: Effect) -> Facts:
    within = effect.place.within
    entry = entries().get(effect.name or "")
    found = [
        ("Where", effect.place.label or DOMAIN[effect.domain]),
        ("Where, 90 %", "" if within is None else stretch(*within)),
        ("What", effect.law.words),
        ("In general", "" if entry is None else entry.SUMMARY),
        ("Shows at", ", ".join(f"{low:.3g} to {high:.3g} Hz" for low, high in effect.bands)),
        (
            "Could be",
            ", ".join(f"{name_of(m.name)} ({chance(m.probability)})" for m in effect.class_[: _rivals(effect)]),
        ),
    ]
    return [(name, text) for name, text in found if text]


def _rivals(effect: Effect) -> int:
    """How many names are shown: none where there is one only, which the probability is of."""
    return len(effect.class_) if len(effect.class_) > 1 else 0


def _parameters(effect: Effect) -> list[tuple[str, str, str]]:
    return [(_meaning(effect, name), estimate(one), ends(one)) for name, one in effect.parameters.items()]


def _meaning(effect: Effect, parameter: str) -> str:
    """A parameter with its meaning in the catalogue, without its range."""
    entry = entries().get(effect.name or (effect.class_[0].name if effect.class_ else ""))
    meaning = "" if entry is None else entry.PARAMETERS.get(parameter, "").partition(": ")[2].partition(";")[0]
    plain = parameter_of(parameter)
    # A mere symbol explains nothing.
    return f"{plain}: {meaning}" if len(meaning) > 2 else plain


def next_steps(diagnosis: Diagnosis) -> list[str]:
    """What to do, the first thing first."""
    verdict = diagnosis.verdict
    steps = [f"Put right in the campaign file: {one.where}: {one.remedy}." for one in verdict.blunders]
    off = outside(verdict.recalibrated.after or verdict.recalibrated.before)
    if verdict.status == "outside_tolerance":
        steps.append(
            f"Check what was stated of {' and '.join(off[:3])}: drawing, data sheet, temperature of the test. "
            "State the value that is right, or a wider tolerance, and diagnose again."
        )
    if verdict.status != "insufficient":
        steps += _looks(verdict.effects)
    steps += [f"Measure: {one.measurement}, to {aim(one.separates)}." for one in verdict.next[:2]]
    match verdict.status:
        case "recalibrated":
            steps.append(
                "Nothing to repair. Work on with the recalibrated model, amended.toml. What is smaller than the "
                "sizes below may be there and stay unseen."
            )
        case "insufficient" if not verdict.next:
            steps.append(
                "These records do not decide. Strike, or place a sensor, nearer to where the map is darkest; "
                "more blows lower the noise."
            )
        case status if status not in UNPROVED and any(e.domain != "measurement" for e in verdict.effects):
            steps.append("Predict with amended.toml, the model with the effect in it.")
    return steps


def _looks(effects: Sequence[Effect]) -> list[str]:
    """Where to look, each place once, with all that is expected there."""
    found: dict[str, dict[str, None]] = {}
    for effect in effects:
        where, expected = _look(effect)
        found.setdefault(where, {})[expected] = None
    names = {where: ", and ".join(filter(None, expected)) for where, expected in found.items()}
    return [f"{where} Expected: {names[where]}." if names[where] else where for where in found]


def _look(effect: Effect) -> tuple[str, str]:
    """Where to look, and what is expected there."""
    label, within = effect.place.label, effect.place.within
    if effect.domain == "measurement":
        channel = " and ".join(effect.place.channels) or label or "the measurement"
        words = (
            f"Check {channel}: mounting, cable, sign, calibration. Correct it in the campaign file or leave the "
            "channel out, and diagnose again."
        )
        return words, ""
    if effect.name == STATED:
        return f"Check what was stated of {label}: drawing, data sheet, temperature of the test.", ""
    # What has a place is gone to; what acts everywhere, as a law of all pads, is found in documents and tests.
    verb = "Check" if effect.place.x is None else "Inspect on site"
    reach = "" if within is None else f" (90 %: {stretch(*within)})"
    return f"{verb}: {label or DOMAIN[effect.domain]}{reach}.", _title(effect)


def rival_rows(weighed: Weighed) -> list[dict[str, str]]:
    """Sets of effects that were fitted to the end, and what no set is, the most probable first."""
    rows = [_row(one) for one in weighed.rivals]
    if weighed.unknown >= LEAST:
        rows.append(
            {
                "names": name_of(NOVEL).capitalize(),
                "ids": "",
                "what": "a discrepancy that no set explains",
                "probability": chance(weighed.unknown),
                "behind": "",
                "parameters": "",
            }
        )
    return rows


def rival_tables(weighed: Weighed) -> tuple[list[dict[str, str]], list[dict[str, str]]]:
    """Rows that the page shows openly, the best set of each size among them, and all others."""
    rows, sizes = rival_rows(weighed), [len(one.names) for one in weighed.rivals]
    first = {sizes.index(size) for size in sizes}
    is_open = [i < MOST_RIVALS or i in first or i >= len(sizes) for i in range(len(rows))]
    both = list(zip(rows, is_open, strict=True))
    return [row for row, shown in both if shown], [row for row, shown in both if not shown]


def _row(one: Rival) -> dict[str, str]:
    what = "; ".join(": ".join(part for part in both if part) for both in zip(one.places, one.laws, strict=True))
    return {
        "names": " and ".join(name_of(name) for name in one.names).capitalize() or "Nothing missing",
        "ids": ", ".join(one.names),
        "what": what or "the nominal model, recalibrated",
        "probability": chance(one.probability),
        "behind": f"{one.behind_nats:.1f}",
        "parameters": str(one.parameters),
    }


def elsewhere(weighed: Weighed, line: Line) -> list[str]:
    """What acts at no one place along the line, in words."""
    return [f"{_of(one, line)}: {chance(one.probability)}" for one in weighed.aside if one.probability >= LEAST]


def _of(one: Aside, line: Line) -> str:
    where = " ".join((one.what, *one.channels)).strip() or DOMAIN[one.domain]
    whole = one.what in line.laws or one.what.split("[")[0] in line.bodies
    return f"{where}{', all along' if whole else ''} ({one.family})"
