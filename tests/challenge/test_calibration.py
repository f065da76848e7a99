"""Power, reliability and confusion of scores that are written by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest
from permway.challenge.calibration import confusion, power, reliability
from permway.challenge.score import Claim, Scored

ONE = Scored(
    name="single-1",
    tier="single",
    status="named",
    truth=("fastener_loss",),
    named=("fastener_loss",),
    found=True,
    placed=True,
    family=True,
    in_class=True,
    false_name=False,
    covered=(),
    harmed=False,
    seconds=1.0,
    deviance=100.0,
    concealed_family="local loss",
    named_family="local loss",
)


def test_power_is_counted_by_deviance() -> None:
    missed = replace(ONE, found=False, placed=False, family=False, deviance=20.0)
    null = replace(ONE, found=None, deviance=None)
    rows = power([ONE, replace(ONE, family=False), missed, null, replace(ONE, deviance=-5.0)])
    assert [(row["from"], row["to"], row["cases"]) for row in rows] == [
        (None, 15.0, 1),
        (15.0, 50.0, 1),
        (50.0, 200.0, 2),
    ]
    assert [row["found"]["count"] for row in rows] == [1, 0, 2]
    assert rows[2]["family"]["count"] == 1
    # One of two: Clopper and Pearson's 2.5 to 97.5 %.
    assert rows[2]["family"]["low"] == pytest.approx(0.025, abs=1e-3)


def test_probabilities_are_held_against_what_is_so() -> None:
    right = replace(ONE, claims=(Claim("fastener_loss", 0.95, true=True), Claim("novel", 0.05, true=False)))
    wrong = replace(ONE, claims=(Claim("sensor_gain", 0.9, true=False), Claim("sure", 1.0, true=True)))
    rows = {row["from"]: row for row in reliability([right, wrong])}
    assert rows.keys() == {0.0, 0.9}
    assert (rows[0.9]["claims"], rows[0.9]["true"]["count"]) == (3, 2)
    assert rows[0.9]["mean"] == pytest.approx((0.95 + 0.9 + 1.0) / 3.0, abs=1e-3)
    assert rows[0.0]["true"]["count"] == 0


def test_families_are_counted_with_what_is_named_for_them() -> None:
    cases = [
        ONE,
        ONE,
        replace(ONE, named_family="insufficient"),
        replace(ONE, concealed_family="", named_family="described"),
        replace(ONE, found=None, named_family="recalibrated"),
    ]
    assert confusion(cases) == [
        {"concealed": "local loss", "cases": 3, "named": {"local loss": 2, "insufficient": 1}},
        {"concealed": "no name", "cases": 1, "named": {"described": 1}},
    ]
