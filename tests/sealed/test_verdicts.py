"""Verdicts on campaigns whose truths are not in this repository: whole, and with what they rest on."""

from __future__ import annotations

from pathlib import Path

import pytest
from permway.diagnosis.catalogue import entries
from permway.diagnosis.verdict import NOVEL, Verdict

VERDICTS = sorted(Path(__file__).parent.glob("*.verdict.json"))


@pytest.mark.parametrize("path", VERDICTS, ids=[p.name.split(".")[0] for p in VERDICTS])
def test_a_verdict_is_whole(path: Path) -> None:
    verdict = Verdict.from_json(path.read_text())
    assert verdict.sentence.endswith(".")
    known = {*entries(), NOVEL, "sensor_labels"}
    for effect in verdict.effects:
        assert effect.name is None or effect.name in known
        assert {member.name for member in effect.class_} <= known
    if verdict.status in ("named", "ambiguous", "described"):
        assert verdict.evidence.log10_bayes_factor is not None
        assert verdict.evidence.log10_bayes_factor > 1.0
        assert verdict.held_out
    assert verdict.recalibrated.before
