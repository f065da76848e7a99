"""Pages that scripts write hold what the scripts compute: cheap rows of the validation, all of the performance."""

from __future__ import annotations

import sys
from importlib import import_module
from itertools import islice
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module", autouse=True)
def beside():
    before = list(sys.path)
    sys.path.insert(0, str(DOCS))
    yield
    sys.path[:] = before


def test_the_validation_page_holds_what_is_computed() -> None:
    made = import_module("make_validation")
    page = (DOCS / "validation.md").read_text("utf-8")
    rows = {
        (cells[0], cells[1], cells[3]): cells[4]
        for line in page.splitlines()
        if line.startswith("| ") and len(cells := [c.strip() for c in line.strip("|").split("|")]) == 7
    }
    found = [*islice(made.beams(), 5), *made.vehicles()]
    assert len(found) == 19
    for case in found:
        printed = rows[case.case, case.quantity, case.printed]
        # Printed with two digits more than the source has, four at least.
        assert case.ours == pytest.approx(float(printed), rel=5e-4)
        assert case.row().split("|")[4].strip() == case.printed


def test_the_performance_page_is_that_of_the_committed_results() -> None:
    assert import_module("make_performance").page() == (DOCS / "performance.md").read_text("utf-8")


def test_the_page_of_measured_pairs_is_that_of_the_committed_runs() -> None:
    assert import_module("make_pairs").page() == (DOCS / "pairs.md").read_text("utf-8")
