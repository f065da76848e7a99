"""The tables of a diagnosis, as plain data for its template."""

from __future__ import annotations

from typing import Any

import numpy as np

from permway.diagnosis.catalogue import entries
from permway.diagnosis.compare_tables import LEFT
from permway.diagnosis.plain_names import name_of, seen
from permway.diagnosis.result import Diagnosis
from permway.diagnosis.verdict import NOVEL, Effect, HeldOutGain, Moved, Verdict
from permway.diagnosis.verdict_parts import RECALIBRATED
from permway.diagnosis.verdict_words import DOMAIN, INCOMPLETE, STATUS, interval, probability, quantity, span
from permway.report.compare.tables import NOTABLE_DB, BandTable, decibels, signed
from permway.report.diagnosis.changes import Change

BAR_ERRORS = 2.0
"""Of a held-out gain in standard errors, to call physics missing."""

WENT_BACK = 0.5
"""Standard deviations of the prior by which a parameter must near its nominal value to be stated to."""

FEW_CHANNELS = 16
"""Channels of a record that its table shows openly."""


def headline(verdict: Verdict) -> list[tuple[str, str]]:
    """Status and confidence: value and words of each."""
    found = [(STATUS[verdict.status].capitalize(), "status")]
    chance = probability(verdict.effects[0]) if verdict.effects else None
    if chance is not None:
        found.append((f"{chance:.2f}", f"probability of {_whose(verdict.effects[0])}, among all that was tried"))
    weight = verdict.evidence
    if weight.misfit_after is not None and weight.misfit_after >= INCOMPLETE:
        found.append(
            (quantity(weight.misfit_after), "times the mean square that errors explain is left: not all of it")
        )
    return found


def _whose(effect: Effect) -> str:
    """What the probability beside the status is of."""
    if effect.name is not None:
        return "the name"
    return "no name of the catalogue" if effect.class_[0].name == NOVEL else "the likeliest name"


def effect_blocks(verdict: Verdict) -> list[dict[str, Any]]:
    """What is stated about each effect."""
    return [_effect(effect) for effect in verdict.effects]


def _effect(effect: Effect) -> dict[str, Any]:
    entry = entries().get(effect.name or "")
    bands = ", ".join(f"{low:.3g} to {high:.3g} Hz" for low, high in effect.bands)
    within = effect.place.within
    facts = [
        ("Part of", DOMAIN[effect.domain]),
        ("Place", effect.place.label),
        ("Place, 90 %", "" if within is None else f"{within[0]:.4g} to {within[1]:.4g} m"),
        ("Bands", bands),
        ("Mechanics", effect.law.words),
        ("Law", _law(effect)),
        ("In the catalogue", "" if entry is None else entry.SUMMARY),
        ("Shows in", "" if entry is None else entry.SIGNATURE),
    ]
    return {
        "title": effect.name or ("one of a class" if len(effect.class_) > 1 else "without a name"),
        "place": effect.place.label,
        "facts": [(name, text) for name, text in facts if text],
        "parameters": [
            (name, quantity(one.value), interval(one), "" if one.unit == "1" else one.unit)
            for name, one in effect.parameters.items()
        ],
        "class": [(m.name, f"{m.probability:.2f}") for m in effect.class_],
        "named": effect.name is not None,
    }


def _law(effect: Effect) -> str:
    values = []
    for name, value in effect.law.parameters.items():
        match value:
            case str():
                values.append(f"{name} {value}")
            case tuple():
                values.append(f"{name} [{', '.join(quantity(v) for v in value)}]")
            case _:
                values.append(f"{name} {quantity(value)}")
    return ": ".join(part for part in (effect.law.type or "", ", ".join(values)) if part)


def candidate_rows(diagnosis: Diagnosis) -> list[dict[str, str]]:
    """Everything that was held against the records, the most informative first."""
    chance = {m.name: m.probability for effect in diagnosis.verdict.effects for m in effect.class_}
    rows = []
    for one in diagnosis.candidates:
        rows.append(
            {
                "entry": one.entry,
                "family": one.family,
                "place": one.place.label,
                "law": one.law,
                "parameters": ", ".join(_estimate(name, *v) for name, v in one.parameters.items()),
                "gain": _known(one.gain),
                "log_evidence": _known(one.log_evidence),
                "probability": f"{chance[one.entry]:.2f}" if one.entry in chance else "",
                "stage": one.stage,
            }
        )
    return rows


def _estimate(name: str, value: float, low: float, high: float, unit: str) -> str:
    """With its interval, if one is known."""
    ends = f" ({span(low, high)})" if np.isfinite([low, high]).all() else ""
    return f"{name} {quantity(value, unit)}{ends}"


def _known(value: float) -> str:
    return quantity(value) if np.isfinite(value) else ""


def weight_rows(verdict: Verdict) -> list[tuple[str, str]]:
    """What the decision rests on: what, and its value."""
    weight, found = verdict.evidence, []
    if weight.log10_bayes_factor is not None:
        found.append(("Bayes factor over nothing missing, common logarithm", quantity(weight.log10_bayes_factor)))
    if weight.misfit_before is not None:
        words = "Mean square that the recalibrated model leaves, over what errors explain"
        found.append((words, quantity(weight.misfit_before)))
    if weight.misfit_after is not None:
        found.append(("The same of the amended model", quantity(weight.misfit_after)))
    return found


def held_out_rows(verdict: Verdict) -> list[dict[str, Any]]:
    """By axis: gain with its standard error, dB before and after, and the negative control's gain."""
    rows = []
    for axis in dict.fromkeys([*verdict.held_out, *verdict.placebo]):
        gain, placebo = verdict.held_out.get(axis), verdict.placebo.get(axis)
        clear = gain is not None and gain.standard_error is not None
        rows.append(
            {
                "axis": axis,
                "gain": _gain(gain),
                "before": "" if gain is None else decibels(gain.db_before),
                "after": "" if gain is None else decibels(gain.db_after),
                "clear": bool(
                    clear and gain is not None and gain.gain_nats > BAR_ERRORS * (gain.standard_error or 0.0)
                ),
                "harm": bool(
                    clear and gain is not None and gain.gain_nats < -BAR_ERRORS * (gain.standard_error or 0.0)
                ),
                "placebo": _gain(placebo),
            }
        )
    return rows


def _gain(one: HeldOutGain | None) -> str:
    if one is None:
        return ""
    error = "" if one.standard_error is None else f" ± {quantity(one.standard_error)}"
    return f"{quantity(one.gain_nats)}{error}"


def change_table(change: Change) -> tuple[BandTable, BandTable | None]:
    """Deviations in one-third octaves before and after: the channels that changed most, and the others."""
    used = np.flatnonzero(np.isfinite(change.before_dB.values).any(axis=0))
    bands = [f"{change.before_dB['band'].values[b]:g}" for b in used]
    rows = []
    for channel in change.order():
        cells = []
        for band in used:
            before = float(change.before_dB.values[channel, band])
            after = before if change.after_dB is None else float(change.after_dB.values[channel, band])
            text = "" if change.after_dB is None else signed(after)
            cells.append((signed(before), text, bool(abs(after) >= NOTABLE_DB)))
        rows.append((str(change.before_dB["channel"].values[channel]).replace("<", "from"), cells))
    rest = BandTable(change.name, bands, rows[FEW_CHANNELS:]) if len(rows) > FEW_CHANNELS else None
    return BandTable(change.name, bands, rows[:FEW_CHANNELS]), rest


def parameter_rows(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """The parameters: belief and tolerance, before and after with z and 90 % intervals."""
    verdict, rows = diagnosis.verdict.recalibrated, []
    for known in diagnosis.comparison.campaign.parameters.known.values():
        before, after = verdict.before.get(known.name), verdict.after.get(known.name)
        rows.append(
            {
                "name": known.name,
                "unit": known.parameter.unit,
                "owner": quantity(known.nominal),
                "tolerance": f"{quantity(known.value(-2.0))} to {quantity(known.value(2.0))}",
                "before": "" if before is None else quantity(before.value),
                "before_span": "" if before is None else interval(before),
                "before_z": "" if before is None else signed(before.z, 2),
                "after": "" if after is None else quantity(after.value),
                "after_span": "" if after is None else interval(after),
                "after_z": "" if after is None else signed(after.z, 2),
                "left": before is not None and abs(before.z) > LEFT,
                "said": _went(before, after),
            }
        )
    return rows


def _went(before: Moved | None, after: Moved | None) -> str:
    """What the amendment did to a parameter."""
    if before is None or after is None:
        return ""
    if abs(after.z) > LEFT:
        return "outside its tolerance"
    return "went back" if abs(after.z) < abs(before.z) - WENT_BACK else ""


def next_rows(verdict: Verdict) -> list[dict[str, str]]:
    """What to measure next."""
    return [
        {
            "measurement": one.measurement,
            "separates": " from ".join("nothing missing" if n == RECALIBRATED else n for n in one.separates),
            "before": quantity(one.separation_before),
            "after": quantity(one.separation_after),
        }
        for one in verdict.next
    ]


def detectable_rows(verdict: Verdict) -> list[dict[str, str]]:
    """What would have been seen."""
    return [
        {
            "name": name_of(name).capitalize(),
            "size": seen(one),
        }
        for name, one in verdict.detectable.items()
    ]


def looked_for(diagnosis: Diagnosis) -> str:
    """What was looked for where nothing is called missing, in words."""
    names = list(dict.fromkeys(c.entry for c in diagnosis.candidates))
    count = "1 effect was" if len(names) == 1 else f"{len(names)} effects were"
    text = f"{count} held against the records: {', '.join(names)}." if names else ""
    if diagnosis.found:
        best = diagnosis.found[0]
        text += (
            f" A free stiffness was tried at {len(diagnosis.found)} places of track and structure; the most"
            f" informative is {best.spot.label}, gaining {quantity(best.gain)} for {best.degrees} free numbers."
        )
    return text.strip()
