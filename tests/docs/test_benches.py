"""Tables of the benches: those of the page are those of the committed results, and what a side lacks is a dash."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

BENCHES = Path(__file__).parents[2] / "benches"


@pytest.fixture(scope="module", autouse=True)
def beside() -> Iterator[None]:
    before = list(sys.path)
    sys.path.insert(0, str(BENCHES))
    yield
    sys.path[:] = before


@pytest.mark.parametrize("name", ["waits", "sizes"])
def test_the_page_shows_the_committed_results(name: str) -> None:
    made = import_module(name)
    page, report = (BENCHES / "README.md").read_text("utf-8"), json.loads((BENCHES / f"{name}.json").read_text())
    assert made.placed(page, made.MARKS, made.table(report)) == page


def report(before: list[dict[str, Any]] | None, core: str, load: float) -> dict[str, Any]:
    after = [{"s": s, "processor_s": 0.5 * s, "own_s": 2.0 * s} for s in (1.0, 9.0, 2.0)]
    side = {"version": "0.1.0", "python": "3.11.2"}
    return {
        "machine": {"processor": "one", "cores": 2, "instructions": []},
        "sides": {"before": {**side, "name": "a", "core": "1"}, "after": {**side, "name": "b", "core": core}},
        "parts": {
            part: {"before": before, "after": after, "load_average": load} for part in ("solve", "irregular")
        },
    }


def test_medians_and_ratios() -> None:
    text = import_module("waits").table(report([{"s": 6.0, "processor_s": 1.5, "own_s": 2.0}], "2", 0.3))
    assert "| 6 | 2 | 3.00 | 1.5 | 1 | 1.50 |" in text
    assert "|  |  |  | 2.000 | 4.000 | 0.50 |" in text
    assert "same compiled core" not in text
    assert "busy" not in text


def test_what_a_side_lacks_is_a_dash_and_a_busy_machine_is_reported() -> None:
    text = import_module("waits").table(report(None, "1", 4.0))
    assert "| - | 2 | - | - | 1 | - |" in text
    assert "same compiled core" in text
    assert "busy" in text


def test_only_what_is_between_the_marks_changes() -> None:
    placed = import_module("waits").placed
    assert placed("a <b> old </b> c", ("<b>", "</b>"), "new") == "a <b>\n\nnew\n\n</b> c"
    with pytest.raises(SystemExit, match="<b>"):
        placed("a <b> no end", ("<b>", "</b>"), "new")


def test_the_exponent_of_a_square() -> None:
    exponents = import_module("sizes").exponents
    assert exponents([1, 3, 9], [2.0, 18.0, 162.0]) == pytest.approx((2.0, 2.0), rel=1e-12)
    assert exponents([1, 2, 4], [1.0, 1.0, 2.0])[1] == pytest.approx(1.0, rel=1e-12)
