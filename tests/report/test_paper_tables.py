"""tables.json against the bars set for it.

Source: "Insights into Underrail Rubber Pad's Effect on Vehicle-Track-Viaduct System Dynamics", Shock and
Vibration, 2021, tables 5 to 8 and the minima of figures 11 to 13. Its conventions are in
`permway.paper.conventions`. Left out: table 8, which contradicts tables 5 and 7 (`permway.paper.table8`) and is
open.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from permway.paper.conventions import PAPER, PAPER_FREE_GIRDER, RIGHT
from permway.paper.printed import PRINTED, TEMPERATURES_C
from permway.paper.tables import FREE, ONE_LAW

MISSED = {("body_bounce", 5.0, -20), ("body_bounce", 5.0, -30)}
"""Missed with one law: 2.4 % against 2 % at most."""


def numbers(tree: Any) -> list[float]:
    if isinstance(tree, dict):
        return [n for branch in tree.values() for n in numbers(branch)]
    if isinstance(tree, list):
        return [n for branch in tree for n in numbers(branch)]
    return [tree] if isinstance(tree, int | float) and not isinstance(tree, bool) else []


def rows(report: Any, convention: str, pad: str, *quantities: str) -> list[dict[str, Any]]:
    found = [
        r
        for r in report.tables["rows"]
        if r["convention"] == convention and r["pad"] == pad and (r["quantity"] in quantities or not quantities)
    ]
    assert found
    return found


def test_every_number_is_finite_and_every_printed_one_is_there(report: Any) -> None:
    assert all(math.isfinite(n) for n in numbers(report.tables))
    for convention, pad in (
        (PAPER, FREE),
        (PAPER, ONE_LAW),
        (PAPER_FREE_GIRDER, FREE),
        (PAPER_FREE_GIRDER, ONE_LAW),
        (RIGHT, ONE_LAW),
    ):
        assert [(r["quantity"], r["temperature_C"], r["printed"]) for r in rows(report, convention.name, pad)] == [
            (p.quantity, p.temperature_C, p.value) for p in PRINTED
        ]


@pytest.mark.parametrize("convention", [PAPER.name, PAPER_FREE_GIRDER.name])
@pytest.mark.parametrize(
    ("pad", "quantity", "bar"),
    [
        (FREE, "force", 0.02),
        (FREE, "wheelset", 0.03),
        (FREE, "body_bounce", 0.02),
        (FREE, "body_pitch", 0.02),
        (ONE_LAW, "force", 0.08),
        (ONE_LAW, "wheelset", 0.15),
        (ONE_LAW, "body_pitch", 0.02),
    ],
)
def test_values_come_out(report: Any, convention: str, pad: str, quantity: str, bar: float) -> None:
    for row in rows(report, convention, pad, quantity):
        assert row["computed"] == pytest.approx(row["printed"], rel=bar), row
        assert row["status"] == "holds"


@pytest.mark.parametrize("convention", [PAPER.name, PAPER_FREE_GIRDER.name])
@pytest.mark.parametrize("pad", [FREE, ONE_LAW])
@pytest.mark.parametrize(
    "quantity", ["flexibility_minimum_Hz", "bridge_peak_Hz", "force_peak_Hz", "wheelset_peak_Hz"]
)
def test_frequencies_come_out(report: Any, convention: str, pad: str, quantity: str) -> None:
    for row in rows(report, convention, pad, quantity):
        assert row["computed"] == pytest.approx(row["printed"], abs=3.0), row
        assert row["status"] == "holds"


@pytest.mark.parametrize("convention", [PAPER.name, PAPER_FREE_GIRDER.name])
def test_two_rows_are_missed_with_one_law_and_no_others(report: Any, convention: str) -> None:
    judged = rows(report, convention, FREE) + rows(report, convention, ONE_LAW)
    missed = [r for r in judged if r["status"] == "missed"]
    assert {(r["quantity"], r["at_Hz"], r["temperature_C"]) for r in missed} == MISSED
    assert {r["pad"] for r in missed} == {ONE_LAW}
    # They miss 2 % by 0.4 % of the value.
    assert all(0.02 < r["ratio"] - 1.0 < 0.025 for r in missed)


def test_table_8_is_open_and_contradicts_tables_5_and_7(report: Any) -> None:
    found = [r for r in report.tables["rows"] if r["table"] == "Table 8" and r["convention"] != RIGHT.name]
    assert len(found) == 24
    assert {r["status"] for r in found} == {"open"}
    bounds = report.tables["table_8"]["bounds"]
    assert [b["temperature_C"] for b in bounds] == [20, -20]
    assert all(b["contradiction"] and b["printed"] > b["bound"] for b in bounds)


def test_right_densities_are_the_papers_over_v_by_two_pi_where_the_spectra_agree(report: Any) -> None:
    # Line and pad are the same in both; in Sato's range, above 97.2 Hz, the irregularity is as well.
    printed = report.result.runs[PAPER_FREE_GIRDER.name, ONE_LAW]
    right = report.result.runs[RIGHT.name, ONE_LAW]
    factor = 350.0 / 3.6 / (2.0 * math.pi)
    for t in TEMPERATURES_C:
        for name in ("irregularity_psd", "wheel_rail_force_psd", "line_acceleration_psd"):
            short, long = slice(98.0, 200.0), slice(1.0, 20.0)
            ratio = printed[t][name] / right[t][name]
            assert ratio.sel(frequency=short).values == pytest.approx(factor, rel=1e-9)
            # With w_s for w_c the long waves are up to 3.5 times larger.
            assert float(ratio.sel(frequency=long).max()) == pytest.approx(factor * 3.49, rel=0.01)


@pytest.mark.parametrize("convention", [PAPER.name, PAPER_FREE_GIRDER.name])
@pytest.mark.parametrize("temperature_C", TEMPERATURES_C)
def test_the_law_is_passive_and_causal_and_table_1_is_not(
    report: Any, convention: str, temperature_C: int
) -> None:
    check = report.result.law(convention).check((0.1, 1e4), float(temperature_C))
    assert check.passive, check.reasons
    assert check.causal, check.reasons
    assert not report.result.table_1.causal


def test_statements_are_judged_in_the_papers_order(report: Any) -> None:
    statements = report.tables["statements"]
    numbers_of_figures = [int("".join(c for c in s["figure"].split()[1] if c.isdigit())) for s in statements]
    assert numbers_of_figures == sorted(numbers_of_figures)
    assert all(s["text"] and s["evidence"] for s in statements)
    # The paper's own temperature order shows: warm to cold, the resonance moves up.
    assert next(s for s in statements if "moves up as it gets colder" in s["text"])["holds"]


def test_free_pads_stiffen_and_lose_more_in_the_cold(report: Any) -> None:
    for pads in report.tables["pads"].values():
        stiffness = [pads[str(t)]["stiffness_N_per_m"] for t in TEMPERATURES_C]
        loss = [pads[str(t)]["loss_factor"] for t in TEMPERATURES_C]
        assert (np.diff(stiffness) > 0.0).all()
        assert (np.diff(loss) > 0.0).all()
