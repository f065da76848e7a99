"""Everything that one round of the search tried, as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping

from permway.diagnosis.choose import penalty
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.quick import Quick
from permway.diagnosis.result import Candidate, Stage
from permway.diagnosis.search import Round


def candidates(found: Round) -> list[Candidate]:
    """Everything that was tried, the most telling first, each as far as it was followed."""
    seen: set[int] = set()
    rows = []
    for finalist in found.finalists:
        seen.add(id(finalist.hypothesis))
        of_all = finalist.fit.intervals()
        spans = {f.name: of_all[finalist.prefix + f.name] for f in finalist.hypothesis.free}
        row = _row(finalist.hypothesis, finalist.values, spans, finalist.gain, finalist.log_evidence, "full")
        rows.append(row)
    stages: dict[Stage, tuple[Quick, ...]] = {"quick": found.followed, "screened": found.screened}
    for stage, quicks in stages.items():
        for quick in quicks:
            if id(quick.hypothesis) in seen:
                continue
            seen.add(id(quick.hypothesis))
            log_evidence = 0.5 * (quick.gain - penalty(quick, found.ring))
            rows.append(_row(quick.hypothesis, quick.values, {}, quick.gain, log_evidence, stage))
    return rows


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
