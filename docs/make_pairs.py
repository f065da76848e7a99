"""Writes docs/pairs.md: run `python docs/make_pairs.py`.

docs/pairs.json holds what was expected of each pair before any was run, and what `benches/pairs` found.
"""

from __future__ import annotations

import json
from pathlib import Path

DOCS = Path(__file__).parent
SUMMARY = DOCS / "pairs.json"

COLUMNS = {
    "pair": "pair",
    "concealed": "concealed",
    "expected": "expected",
    "said": "said",
    "class": "class",
    "before": "dB before",
    "after": "dB after",
    "right": "right",
}
"""Keys of a row, and heads of the table."""

HEAD = """\
# Measured pairs

Recordings by others, whose cause is known: a model is stated from one state, and held against a record of another.
What was expected was written down before the first run.

"""


def page() -> str:
    """The whole page."""
    rows = json.loads(SUMMARY.read_text("utf-8"))
    lines = [_line(COLUMNS.values()), _line("---" for _ in COLUMNS)]
    lines += [_line(str(row.get(key, "")) for key in COLUMNS) for row in rows]
    return HEAD + "\n".join(lines) + "\n"


def _line(cells: object) -> str:
    return "| " + " | ".join(cells) + " |"  # type: ignore[arg-type]


if __name__ == "__main__":
    (DOCS / "pairs.md").write_text(page(), "utf-8")
