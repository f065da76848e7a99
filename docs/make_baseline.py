"""Writes docs/baseline.md: run `python docs/make_baseline.py [PART=SCORE.json ...]`.

PART is `first` or `posterior` (a suite of small campaigns by that method), `first_same` and `posterior_same` (both
on the same), `first_fixture` or `posterior_fixture` (the fixture's suite), or `full` (rows of whole
campaigns by the first method). What the page shows of each is kept in docs/baseline.json. Without an argument
the page is written anew from there.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

from permway.challenge.small.table import markdown, reliability_markdown

DOCS = Path(__file__).parent
SUMMARY = DOCS / "baseline.json"

SHOWN = ("all", "kind", "deviance", "errors", "maker")
"""Groups of rows that are kept."""

WORDS = {
    "first_same": "first",
    "posterior_same": "second",
}
"""Of the table of the same cases."""

METHODS = {
    "first": "The first method",
    "posterior": "The second method: `permway diagnose`",
}

HEAD = """# Results on small campaigns

[Small campaigns](how-to/small-campaigns.md) are random layouts, sensors, errors and effects. Half are made by
finite elements that share no code with the solver. What each column counts is shown there. Shares are hits/cases
with their 90 % intervals.

`permway diagnose` uses the second method. Its campaigns were not used in development: 0 to 162 of the first seed
and 0 to 104 of the second (1,000 were planned). The fixture's seeds were known. The first seed now
draws faults of a run's channels stronger; the first method's rows state too large deviances for them.

With little noise a stiffness change of 0.05 % has a large deviance; it is taken for the model's idealisation.
Of 125 campaigns with a deviance above 50, 39 change responses by less than 0.1 dB: a class of three holds 31 of
these, and 83 of the other 86.

Whole campaigns (seeds as in the last table, and 1250000 on), beside other work: nothing missing, called 0 of 5;
one effect, right name 10 of 12, one false; several, all found in 1 of 3, one false name; wheels that leave the
rail at dips: described, not named; 67 to 1,198 s. An inertance outside the catalogue: stopped after 13 minutes.
"""


def keep(parts: list[str]) -> None:
    """Take what the page shows of some score files."""
    found: dict[str, Any] = json.loads(SUMMARY.read_text()) if SUMMARY.is_file() else {}
    for part in parts:
        name, path = part.split("=", 1)
        scores = json.loads(Path(path).read_text())
        if name == "full":
            found[name] = scores
            continue
        groups = ("all", "deviance") if name in WORDS else SHOWN
        rows = [row for row in scores["rows"] if row["group"] in groups]
        found[name] = {"command": scores["command"], "rows": rows, "reliability": scores["reliability"]}
    lines = [f'"{key}": {json.dumps(value, separators=(",", ":"))}' for key, value in sorted(found.items())]
    SUMMARY.write_text("{\n" + ",\n".join(lines) + "\n}\n")


def page() -> str:
    """The page, from what is kept."""
    found = json.loads(SUMMARY.read_text())
    parts = [HEAD]
    if all(name in found for name in WORDS):
        parts.append("\n## The same cases, both methods\n\n" + _same(found))
    for method, words in METHODS.items():
        if method not in found:
            continue
        # Of the method that is gone the page has what the other is held against; the rest is in the file.
        groups = ["all", "deviance"] if method == "first" else None
        table = markdown(found[method], groups=groups)
        parts.append(f"\n## {words}\n\n`{_command(found[method])}`\n\n{table}")
        if method != "first":
            truth = reliability_markdown(found[method])
            parts.append("\nProbabilities as stated, against how many are true:\n\n" + truth)
        fixture = found.get(f"{method}_fixture")
        if fixture is not None:
            words = "\nThe fixture: three pads about the point struck keep 0.3 or 0.05 of their stiffness,\n"
            words += "twenty seeds each, "
            parts.append(f"{words}`{_command(fixture)}`:\n\n" + markdown(fixture, groups=["all"]))
    if "full" in found:
        parts.append("\n" + _full(found["full"]))
    # An interval stays on one line: in narrow columns it would take three.
    return re.sub(r"\(\d+ to \d+ %\)", lambda interval: interval[0].replace(" ", "\u00a0"), "".join(parts))


def _command(found: dict[str, Any]) -> str:
    """That made it; the option by which the second method was asked for is gone."""
    return str(found["command"]).replace(" --posterior", "")


def _same(found: dict[str, Any]) -> str:
    """Rows of both methods over the same campaigns, one above the other."""
    lines: list[str] = []
    for group in ("all", "deviance"):
        for row in found["first_same"]["rows"]:
            if row["group"] != group:
                continue
            for name, words in WORDS.items():
                mine = [r for r in found[name]["rows"] if (r["group"], r["name"]) == (row["group"], row["name"])]
                table = markdown({"rows": mine}).splitlines()
                lines = lines or table[:2]
                lines += [line.replace("| ", f"| {words}, ", 1) for line in table[2:]]
    return "\n".join(lines) + "\n"


def _full(found: dict[str, Any]) -> str:
    """Whole campaigns by the first method."""
    heads = ["called (nothing missing)", "found", "place", "family", "false name"]
    heads += ["names of 0.9 true", "s, median (worst)"]
    keys = ["called", "found", "place", "family", "false", "names_09"]
    lines = ["## Whole campaigns, the first method\n", found["words"] + "\n"]
    lines += [f"| tier | {' | '.join(heads)} |", f"|---|{'---|' * len(heads)}"]
    for row in found["rows"]:
        cells = ["" if row[key] is None else f"{row[key][0]}/{row[key][1]}" for key in keys]
        seconds = f"{row['seconds_median']:g} ({row['seconds_worst']:g})"
        lines.append(f"| {row['tier']}, {row['first']} to {row['last']} | {' | '.join(cells)} | {seconds} |")
    lines += ["\nCampaigns with no truth in this repository, by `tests/sealed/make.py` of that version:\n"]
    lines += ["| campaign | status | effects, probability | log10 Bayes factor | s |", "|---|---|---|---|---|"]
    for name, status, effects, probabilities, factor, seconds in found["given"]:
        each = ", ".join(f"`{e}` {p:.2f}" for e, p in zip(effects, probabilities, strict=True))
        lines.append(f"| {name} | {status} | {each} | {'' if factor is None else factor} | {seconds} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if sys.argv[1:]:
        keep(sys.argv[1:])
    (DOCS / "baseline.md").write_text(page())
