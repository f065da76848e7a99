"""The page on `check` states the rates of the committed run."""

from __future__ import annotations

import json
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def test_the_page_states_the_rates_of_the_committed_run() -> None:
    page = " ".join((DOCS / "check.md").read_text("utf-8").split())
    found = json.loads((DOCS / "check.json").read_text("utf-8"))
    reported, wrong, of = (sum(row[key] for row in found["blunders"]) for key in ("reported", "wrong", "of"))
    assert (
        f"Of {found['campaigns']} small campaigns of a fresh seed {found['false_alarms']} were doubted wrongly"
        in page
    )
    assert f"of {found['turned'][1]} turned sensors in them {found['turned'][0]} were reported" in page
    assert f"Of {of} blunders put into them {reported} were reported rightly, {wrong} by another name" in page
