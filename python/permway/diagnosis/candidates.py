"""Everything that one round of the search tried, as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from permway.diagnosis.choose import penalty
from permway.diagnosis.hypothesis import Hypothesis, Where
from permway.diagnosis.quick import Quick
from permway.diagnosis.result import Candidate, Stage
from permway.diagnosis.search import Round
from permway.diagnosis.verdict_parts import Effect


def candidates(found: Round, spoken: Mapping[int, Effect] | None = None) -> list[Candidate]:
    """Everything that was tried, the most telling first, each as far as it was followed.

    Parameters
    ----------
    found : Round
    spoken : mapping of int to Effect, optional
        What the verdict says of hypotheses, by their `id`: it was fitted last, with all other effects, and what
        is known of it by then is not known of its rivals.
    """
    seen: set[int] = set()
    rows = []
    for finalist in found.finalists:
        seen.add(id(finalist.hypothesis))
        of_all = finalist.fit.intervals()
        spans = {f.name: of_all[finalist.prefix + f.name] for f in finalist.hypothesis.free}
        row = _row(finalist.hypothesis, finalist.values, spans, finalist.gain, finalist.log_evidence, "full")
        effect = (spoken or {}).get(id(finalist.hypothesis))
        rows.append(row if effect is None or not effect.parameters else _as_spoken(row, effect))
    stages: dict[Stage, tuple[Quick, ...]] = {"quick": found.followed, "screened": found.screened}
    for stage, quicks in stages.items():
        for quick in quicks:
            if id(quick.hypothesis) in seen:
                continue
            seen.add(id(quick.hypothesis))
            log_evidence = 0.5 * (quick.gain - penalty(quick, found.ring))
            rows.append(_row(quick.hypothesis, quick.values, {}, quick.gain, log_evidence, stage))
    return rows


def _as_spoken(row: Candidate, effect: Effect) -> Candidate:
    """A row with place, law and numbers of the verdict."""
    unknown = float("nan")
    place = effect.place
    return replace(
        row,
        place=Where(place.body or place.joint or "", place.x, place.channels),
        law=effect.law.words,
        parameters={
            name: (
                one.value,
                unknown if one.low is None else one.low,
                unknown if one.high is None else one.high,
                one.unit,
            )
            for name, one in effect.parameters.items()
        },
    )


def _row(
    hypothesis: Hypothesis,
    values: dict[str, float],
    spans: Mapping[str, tuple[float, float]],
    gain: float,
    log_evidence: float,
    stage: Stage,
) -> Candidate:
    unknown = (float("nan"), float("nan"))
    ends = {f.name: spans.get(f.name, unknown) for f in hypothesis.free}
    return Candidate(
        entry=hypothesis.entry,
        family=hypothesis.family,
        domain=hypothesis.domain,
        place=hypothesis.locate(values),
        law=hypothesis.law(values),
        gain=gain,
        log_evidence=log_evidence,
        parameters={
            f.name: (values[f.name], min(ends[f.name]), max(ends[f.name]), f.unit) for f in hypothesis.free
        },
        stage=stage,
    )
