"""The page: complete, self-contained, and refused before the work if it cannot be written."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from permway.errors import InputError
from permway.paper import report as paper
from permway.paper.misprints import misprints
from plotly.offline import get_plotlyjs

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
