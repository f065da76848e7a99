"""The site stays readable: its size, the README's, and no history in either."""

from __future__ import annotations

import json
import re
import sys
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
README_LINES, README_WORDS = 120, 1600
SITE_WORDS = 45_000
SUMMARY_BYTES = 20_000
# A short or a whole commit: base 16, with a letter and a digit, and no mantissa with its exponent.
_HASH = re.compile(r"(?<![\w.])(?=[0-9a-f]*[a-f])(?=[0-9a-f]*\d)(?:[0-9a-f]{7,12}|[0-9a-f]{40})(?![\w+-])")


@pytest.fixture(scope="module", autouse=True)
def beside():
    before = list(sys.path)
    sys.path.insert(0, str(DOCS))
    yield
    sys.path[:] = before


def test_the_readme_is_short() -> None:
    text = (ROOT / "README.md").read_text("utf-8")
    assert len(text.splitlines()) <= README_LINES
    assert len(text.split()) <= README_WORDS


def test_the_site_is_short() -> None:
    counts = import_module("count_words").words()
    assert counts["catalogue.md"] > 1000, "the catalogue counts with its effects"
    assert sum(counts.values()) <= SITE_WORDS, counts


def test_no_page_names_a_commit() -> None:
    assert _HASH.search("since b291bce")
    counter = import_module("count_words")
    found = {page.name: _HASH.findall(counter.text(page)) for page in counter.pages()}
    assert not {name: hashes for name, hashes in found.items() if hashes}


def test_links_of_the_readme_lead_somewhere() -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", (ROOT / "README.md").read_text("utf-8"))
    assert len(targets) > 10
    assert not [target for target in targets if "://" not in target and not (ROOT / target).exists()]


def test_the_page_of_results_is_that_of_the_committed_run() -> None:
    made = import_module("make_challenge")
    assert made.SUMMARY.stat().st_size <= SUMMARY_BYTES
    summary = json.loads(made.SUMMARY.read_text("utf-8"))
    assert made.condense(summary) == summary
    assert made.page(summary) == (DOCS / "challenge.md").read_text("utf-8")
    assert all((DOCS / "images" / f"{name}.png").is_file() for name in made.pictures(summary))


def test_the_page_of_small_campaigns_is_that_of_the_committed_runs() -> None:
    made = import_module("make_baseline")
    assert made.SUMMARY.stat().st_size <= SUMMARY_BYTES
    assert made.page() == (DOCS / "baseline.md").read_text("utf-8")


def test_the_readme_and_the_page_of_small_campaigns_state_the_same() -> None:
    """Counts of the status table against the committed runs."""
    summary = json.loads(import_module("make_baseline").SUMMARY.read_text("utf-8"))
    lines = [line for line in (ROOT / "README.md").read_text("utf-8").splitlines() if line.startswith("| ")]

    def counted(part: str, group: str, name: str, column: str) -> str:
        (row,) = [r for r in summary[part]["rows"] if (r["group"], r["name"]) == (group, name)]
        return f"{row[column][0]:g}/{row[column][1]:g}"

    for what, part, group, name, column in (
        ("nothing missing: a false alarm", "posterior", "all", "", "called"),
        ("deviance above 200", "posterior", "deviance", "over 200", "class"),
        ("deviance 50 to 200", "posterior", "deviance", "50 to 200", "class"),
        ("a false name", "posterior", "all", "", "false_name"),
        ("0.9 or more that are true", "posterior", "all", "", "sure"),
        ("contain the true value", "posterior", "all", "", "effect"),
        ("weak pads", "posterior_fixture", "all", "", "first"),
    ):
        (line,) = [one for one in lines if what in one]
        assert counted(part, group, name, column) in line, what
