"""Recalibrated parameters against true ones, of verdicts that are written by hand."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from permway.challenge.recalibrated import by_parameter, pulls


def case(root: Path, name: str, *, true: float, value: float, when: str = "before", **flags: Any) -> Any:
    (root / "truth").mkdir(exist_ok=True)
    (root / "truth" / f"{name}.json").write_text(json.dumps({"parameters": {"pad": {"k": true, "other": 1.0}}}))
    (root / "verdicts" / name).mkdir(parents=True)
    moved = {"pad.k": {"value": value, "prior": 5e7, "z": 0.0, "low": value / 1.1, "high": value * 1.1}}
    reported = {"recalibrated": {"before": {}, "after": {}, when: moved}}
    (root / "verdicts" / name / "verdict.json").write_text(json.dumps(reported))
    usual = {"status": "recalibrated", "found": None, "family": None, "all_found": None, "false_name": False}
    return SimpleNamespace(name=name, **{**usual, **flags})


def test_one_that_leans_the_same_way_everywhere_is_seen(tmp_path: Path) -> None:
    reported = {"status": "named", "found": True, "family": True}
    scored = [
        case(tmp_path, "null-1", true=6e7, value=5.5e7),
        case(tmp_path, "null-2", true=6e7, value=5.3e7),
        case(tmp_path, "single-1", true=6e7, value=5.4e7, when="after", **reported),
        # Whose fit is not right anyhow.
        case(tmp_path, "null-3", true=6e7, value=1e7, status="named"),
        case(tmp_path, "single-2", true=6e7, value=1e7, when="after", **{**reported, "family": False}),
        case(tmp_path, "single-3", true=6e7, value=1e7, when="after", **reported, false_name=True),
        case(tmp_path, "multiple-1", true=6e7, value=1e7, when="after", **reported, all_found=False),
    ]
    found = pulls(tmp_path, cast(Any, scored))
    assert [p.case for p in found] == ["null-1", "null-2", "single-1"]
    # log(60 / 55) of log(1.1) for 1.645 standard deviations.
    assert found[0].sigmas == pytest.approx(1.645 * 0.0870 / 0.0953, rel=1e-3)
    assert [p.inside for p in found] == [True, False, False]
    (row,) = by_parameter(found)
    assert (row["parameter"], row["campaigns"], row["inside"]) == ("pad.k", 3, 1)
    assert row["leaning"] == pytest.approx(row["mean"] * 3**0.5, abs=0.1)
    assert row["leaning"] > 3.0


def test_verdicts_without_intervals_constrain_nothing(tmp_path: Path) -> None:
    one = case(tmp_path, "null-1", true=6e7, value=5.5e7)
    path = tmp_path / "verdicts" / "null-1" / "verdict.json"
    reported = json.loads(path.read_text())
    del reported["recalibrated"]["before"]["pad.k"]["low"]
    path.write_text(json.dumps(reported))
    assert pulls(tmp_path, cast(Any, [one])) == []
    assert by_parameter([]) == []
