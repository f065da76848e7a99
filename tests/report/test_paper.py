"""The paper, reproduced once: tables.json against the bars set for it, and the page, complete and self-contained.

Source: "Insights into Underrail Rubber Pad's Effect on Vehicle-Track-Viaduct System Dynamics", Shock and
Vibration, 2021, tables 5 to 8 and the minima of figures 11 to 13. Its conventions are in
`permway.paper.conventions`. Left out: table 8, which contradicts tables 5 and 7 (`permway.paper.table8`) and is
open.
"""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.errors import InputError
from permway.paper import report as paper
from permway.paper.conventions import PAPER, PAPER_FREE_GIRDER, RIGHT
from permway.paper.misprints import misprints
from permway.paper.printed import PRINTED, TEMPERATURES_C
from permway.paper.tables import FREE, ONE_LAW
from plotly.offline import get_plotlyjs

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


FIGURES = [f"figure-{n}" for n in range(7, 19)]
TABLES = [f"table-{n}" for n in range(5, 9)]


@pytest.fixture(scope="module")
def own(report: Any) -> str:
    """The page without plotly.js."""
    page = report.page
    assert page.count(get_plotlyjs()) == 1, "plotly.js once"
    return page.replace(get_plotlyjs(), "")


@pytest.mark.parametrize(
    "name", [*FIGURES, *TABLES, "table-figures-11-13", "table-8-open", "misprints", "choices"]
)
def test_every_part_is_there_once(own: str, name: str) -> None:
    assert own.count(f'id="{name}"') == 1


def test_figures_come_in_the_papers_order(own: str) -> None:
    places = [own.index(f'id="{name}"') for name in FIGURES]
    assert places == sorted(places)


def test_nothing_is_loaded_from_outside(own: str) -> None:
    assert not re.search(r"https?:", own)
    assert not re.search(r"url\(|@import|<link|<iframe|<img", own)
    for target in re.findall(r"(?:src|href)\s*=\s*[\"']?([^\"'\s>]+)", own):
        assert target.startswith("#"), target


def test_links_have_their_targets(own: str) -> None:
    for target in re.findall(r'href="#([^"]+)"', own):
        assert f'id="{target}"' in own, target


def test_every_figure_holds_curves(own: str) -> None:
    drawn = dict(
        re.findall(r'<script type="application/json" id="data-([0-9ab]+)">(.*?)</script>', own, flags=re.S)
    )
    assert list(drawn) == ["7", "8", "9a", "9b", *map(str, range(10, 19))]
    assert all(len(json.loads(text)["data"]) > 0 for text in drawn.values())
    # Printed peaks stand in figures 16 to 18.
    for name in ("16", "17", "18"):
        assert any("printed" in trace["name"] for trace in json.loads(drawn[name])["data"])


def test_buttons_show_one_convention_at_a_time(own: str) -> None:
    for text in re.findall(r'<script type="application/json" id="data-1[1-8]">(.*?)</script>', own, flags=re.S):
        figure = json.loads(text)
        first, second = (b["args"][0]["visible"] for b in figure["layout"]["updatemenus"][0]["buttons"])
        assert [trace["visible"] for trace in figure["data"]] == first
        assert [not shown for shown in first] == second


def test_every_statement_slip_and_choice_is_on_the_page(report: Any, own: str) -> None:
    assert own.count('<span class="verdict') == len(report.result.statements)
    assert own.count("✗ does not hold") == sum(not s.holds for s in report.result.statements)
    assert len(misprints(report.result)) >= 15
    for choice in report.result.choices:
        assert choice.name in own


def test_sizes_and_what_is_reported(report: Any) -> None:
    assert (report.folder / "report.html").stat().st_size < 8e6
    assert sorted(p.name for p in report.folder.iterdir()) == ["report.html", "tables.json"]
    reported = report.reported
    assert (Path(reported["report"]).name, Path(reported["tables"]).name) == ("report.html", "tables.json")
    assert (reported["rows held"], reported["rows missed"], reported["rows open"]) == (108, 4, 24)
    assert re.fullmatch(r"\d+ of \d+ hold", reported["statements"])
    json.dumps(reported, allow_nan=False)
    assert report.steps[-1][0] == report.steps[-1][1]


def test_the_same_reproduction_gives_the_same_files(report: Any, tmp_path: Path) -> None:
    paper.write_result(report.result, tmp_path / "again")
    for name in ("report.html", "tables.json"):
        assert (tmp_path / "again" / name).read_bytes() == (report.folder / name).read_bytes()


@pytest.fixture
def no_work(monkeypatch: pytest.MonkeyPatch) -> None:
    def work(**_: Any) -> None:
        raise AssertionError("work was started before the fault was found")

    monkeypatch.setattr(paper, "reproduce", work)


@pytest.mark.usefixtures("no_work")
def test_a_folder_without_parent_is_refused_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        paper.write_report(tmp_path / "none" / "out")


@pytest.mark.usefixtures("no_work")
def test_a_file_for_a_folder_is_refused_before_the_work(tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.write_text("mine")
    with pytest.raises(InputError, match="not a folder"):
        paper.write_report(taken)
    assert taken.read_text() == "mine"


@pytest.mark.usefixtures("no_work")
def test_a_folder_for_the_page_is_refused_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "out" / "report.html").mkdir(parents=True)
    with pytest.raises(InputError, match="not a file"):
        paper.write_report(tmp_path / "out")


@pytest.mark.usefixtures("no_work")
def test_an_unwritable_folder_is_refused_before_the_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**_: Any) -> None:
        raise PermissionError(13, "Permission denied")

    # Not by mode bits: the super-user may write everywhere.
    monkeypatch.setattr("permway.files.tempfile.TemporaryFile", refuse)
    with pytest.raises(InputError, match="cannot be written: Permission denied"):
        paper.write_report(tmp_path / "out")


def test_no_figure_needs_webgl(report: Any) -> None:
    kinds = set(re.findall(r'"type":"(\w+)"', report.page))
    assert "contour" in kinds
    assert not {kind for kind in kinds if kind == "surface" or kind.endswith(("gl", "3d"))}
