"""Writes docs/challenge.md and its pictures: run `python docs/make_challenge.py [SCORE.json]`.

SCORE.json is what `permway challenge suite` leaves in its folder. What the page shows of it is kept in
docs/challenge.json, which replaces the run before. Without an argument the page is written anew from there.
"""

from __future__ import annotations

import json
import math
import re
import sys
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

DOCS = Path(__file__).parent
SUMMARY = DOCS / "challenge.json"

GROUPS = {
    "null": "nothing missing",
    "single": "one effect",
    "twin": "near-degenerate",
    "multiple": "several",
    "outside": "outside",
    "nonlinear": "nonlinear",
    "graded": "faded",
}
"""What a tier of the challenge conceals, in the order of the table."""

COLUMNS = {
    "called": "reported",
    "placed": "place",
    "family": "family",
    "in_class": "in the class",
    "false_name": "false name",
}
"""Figures of the table."""

AT_LEAST = {
    "single, easy": {"called": 0.98, "placed": 0.97, "family": 0.95},
    "single, medium": {"called": 0.90, "placed": 0.85, "family": 0.75},
    "graded, medium": {"called": 0.90, "placed": 0.85, "family": 0.75},
    "graded, hard": {"called": 0.60, "placed": 0.60, "family": 0.45},
    "twin, easy": {"in_class": 0.95},
    "multiple, easy": {"in_class": 0.95},
    "outside, easy": {"placed": 0.80, "mechanics": 0.70},
    "nonlinear, easy": {"called": 0.90},
}
AT_MOST = {
    "null": {"called": 0.025},
    "twin, easy": {"false_name": 0.05},
    "outside, easy": {"false_name": 0.05},
}
"""Bars of the table, as shares of the cases."""

MOST_HARMED = 0.01
ALL_FOUND = 0.75
STATED_TRUE = 0.95
COVERED = (0.85, 0.95)

RIVAL_BARS = {"placed": "right place", "family": "right family", "false_name": "false name"}

HEAD = """# Challenge results of the first method

Campaigns in which effects were concealed, diagnosed and scored. The campaigns come from finite elements that
share no code with the solver. [The guide](how-to/challenge.md) says how to repeat this.

**These figures are of a first method. `permway diagnose` now uses [another](baseline.md).**

The [deviance](glossary.md) says how clearly an effect stands out after the best recalibration of the nominal
model. Below 15 an effect is too small, and the right answer is "the data do not decide". It is hard to find from
15, medium from 50, and easy from 200.

Each cell is a count of cases. In brackets stands the bar that was set for it. **Bold** misses the bar.
"""

LEGEND = """
- *Near-degenerate*: one effect that looks much like another. *Several*: two or three effects. *Outside*:
  mechanics that the catalogue does not have. *Nonlinear*: friction, or wheels that leave the rail. *Faded*: one
  weak effect.
- *Reported*: the verdict says that something is missing or wrong.
- *Place*: the stated place is right.
- *Family*: the name, or a name of the same family, is right. Outside the catalogue: the mechanics is right.
- *In the class*: the true effect (of several, the strongest) is among the names that the verdict leaves open.
"""


def condense(scores: dict[str, Any]) -> dict[str, Any]:
    """Keep what the page shows of a suite's scores: a few kilobytes, without single cases.

    Parameters
    ----------
    scores : mapping
        `score.json` of a suite, or `docs/challenge.json`.
    """
    kept = ("seed", "tiers", "power", "reliability", "rivals")
    parameters = scores["parameters"]
    if isinstance(parameters, list):
        parameters = {key: sum(row[key] for row in parameters) for key in ("campaigns", "inside")}
    columns = {
        "rival",
        "tier",
        "group",
        "cases",
        "seconds",
        "covered",
        "harmed",
        "all_found",
        "mechanics",
        *COLUMNS,
    }
    found = {key: scores.get(key, []) for key in kept}
    for part in ("tiers", "rivals"):
        found[part] = [{key: cell for key, cell in row.items() if key in columns} for row in scores.get(part, [])]
    return {**found, "parameters": parameters}


def count(cell: str) -> tuple[int, int]:
    """Read "3/4 (25 to 99 %)" as 3 of 4."""
    match = re.match(r"(\d+)/(\d+)", cell)
    assert match, cell
    return int(match[1]), int(match[2])


def page(summary: dict[str, Any]) -> str:
    """The page as Markdown.

    Parameters
    ----------
    summary : mapping
        See :func:`condense`.
    """
    titles = " | ".join(COLUMNS.values())
    lines = [
        HEAD,
        f"| concealed | | cases | {titles} | median time, s |",
        f"|---|---|---:|{'---:|' * len(COLUMNS)}---:|",
    ]
    order = list(GROUPS)
    for row in sorted(summary["tiers"], key=lambda r: order.index(r["tier"])):
        lines += _rows(row)
    lines += [LEGEND, *_sentences(summary), ""]
    lines += [
        "![Share of effects found, placed and named, by deviance](images/challenge-power.png)",
        "",
        "![Share of stated names that are true, by stated probability](images/challenge-probability.png)",
        "",
        "Vertical lines are 90 % intervals (Clopper and Pearson).",
        "",
    ]
    if summary["rivals"]:
        shared = sum(row["cases"] for row in summary["rivals"] if row["rival"] == "permway")
        lines += [
            f"Simpler methods had {shared} of the campaigns, with the same model, parameters and catalogue:",
            "",
            "![Right places, right families and false names, by method](images/challenge-rivals.png)",
            "",
        ]
    lines += ["```sh", f"permway challenge suite -o suite --seed {summary['seed']} --workers 2", "```", ""]
    return "\n".join(lines)


def _rows(row: dict[str, Any]) -> list[str]:
    """A group's line of the table; of several effects a second one, for all of them."""
    group = row["group"]
    _, _, ease = group.partition(", ")
    cells = []
    for key in COLUMNS:
        least, most = AT_LEAST.get(group, {}).get(key), AT_MOST.get(group, {}).get(key)
        shown = row.get(key)
        if key == "family" and "mechanics" in row:
            shown, least = row["mechanics"], AT_LEAST.get(group, {}).get("mechanics")
        if key == "false_name" and row["tier"] == "null":
            shown = None  # The same count as "reported".
        cells.append("" if shown is None else _cell(count(shown), least=least, most=most))
    lines = [f"| {GROUPS[row['tier']]} | {ease} | {row['cases']} | {' | '.join(cells)} | {row['seconds']:.0f} |"]
    if "all_found" in row:
        found = count(row["all_found"])
        filler = " |" * (len(COLUMNS) - 1)
        lines.append(f"| ... all of them | {ease} | {found[1]} | {_cell(found, least=ALL_FOUND)} |{filler} |")
    return lines


def _cell(found: tuple[int, int], *, least: float | None = None, most: float | None = None) -> str:
    number, of = found
    share = number / of
    missed = (least is not None and share < least) or (most is not None and share > most)
    text = f"**{number}**" if missed else f"{number}"
    if least is not None:
        text += f" (≥\u00a0{_percent(least)})"
    if most is not None:
        text += f" (≤\u00a0{_percent(most)})"
    return text


def _percent(share: float) -> str:
    return f"{100.0 * share:g}\u00a0%"


def _rounded(number: int, of: int, digits: int = 0) -> str:
    return f"{100 * number / of:.{digits}f} %"


def _sentences(summary: dict[str, Any]) -> list[str]:
    """What concerns all groups together."""
    sure = summary["reliability"][-1]
    assert sure["from"] == 0.9
    covered = [count(row["covered"]) for row in summary["tiers"] if "covered" in row]
    inside, of = (sum(row[i] for row in covered) for i in (0, 1))
    low, high = COVERED
    nominal = summary["parameters"]
    harmed, cases = (sum(count(row["harmed"])[i] for row in summary["tiers"]) for i in (0, 1))
    return [
        "All campaigns together:",
        "",
        f"- Of {sure['claims']} names stated with a probability of 0.9 or more, {sure['true']['count']} are true "
        f"({_rounded(sure['true']['count'], sure['claims'])}; bar {_percent(STATED_TRUE)}).",
        f"- Of {of} 90 % intervals of an effect's parameters, {inside} hold the truth ({_rounded(inside, of)}; "
        f"bar {100 * low:g} to {_percent(high)}).",
        f"- In {harmed} of {cases} campaigns the amended model predicts records that were left out of the fit "
        f"worse than the nominal one ({_rounded(harmed, cases, 1)}; bar {_percent(MOST_HARMED)}).",
        f"- Of {nominal['campaigns']} 90 % intervals of nominal parameters, {nominal['inside']} hold the truth "
        f"({_rounded(nominal['inside'], nominal['campaigns'])}).",
    ]


def pictures(summary: dict[str, Any]) -> dict[str, Figure]:
    """Power by deviance, stated against true probability, and rivals; by the name of the file.

    Parameters
    ----------
    summary : mapping
        See :func:`condense`.
    """
    found = {"challenge-power": _power(summary["power"]), "challenge-probability": _worth(summary["reliability"])}
    if summary["rivals"]:
        found["challenge-rivals"] = _rivals(summary["rivals"])
    return found


def _panel(width: float = 7.0, height: float = 3.6) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots()
    axes.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _power(rows: list[dict[str, Any]]) -> Figure:
    figure, axes = _panel()
    for shift, (key, text) in enumerate(
        (("found", "found"), ("placed", "right place"), ("family", "right family"))
    ):
        at = [index + 0.18 * (shift - 1) for index in range(len(rows))]
        _shares(axes, at, [row[key] for row in rows], text)
    axes.set_xticks(range(len(rows)), [f"{_range(row)}\nn = {row['cases']}" for row in rows], fontsize=9)
    axes.set(xlabel="deviance of the concealed effect", ylabel="share of cases", ylim=(-0.02, 1.02))
    axes.legend(fontsize=9, frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3)
    return figure


def _worth(claims: list[dict[str, Any]]) -> Figure:
    figure, axes = _panel(5.0)
    axes.plot([0, 1], [0, 1], color="0.7", linewidth=1)
    _shares(axes, [r["mean"] for r in claims], [r["true"] for r in claims], "")
    for row in claims:
        share = row["true"]["count"] / row["claims"]
        right = row["mean"] < 0.5
        offset, side = ((6, 6), "left") if right else ((-6, 6), "right")
        axes.annotate(
            f"n = {row['claims']}",
            (row["mean"], share),
            offset,
            textcoords="offset points",
            fontsize=9,
            ha=side,
        )
    axes.set(xlabel="stated probability of a name", ylabel="share that is true")
    axes.set(xlim=(-0.02, 1.02), ylim=(-0.02, 1.02))
    return figure


def _rivals(rows: list[dict[str, Any]]) -> Figure:
    rows = [row for row in rows if row["tier"] != "null"]
    figure, axes = _panel(7.0, 4.2)
    height = 0.8 / len(RIVAL_BARS)
    for shift, (key, text) in enumerate(RIVAL_BARS.items()):
        counts = [count(row[key])[0] for row in rows]
        bars = axes.barh([i + (shift - 1) * height for i in range(len(rows))], counts, height * 0.9, label=text)
        axes.bar_label(bars, padding=3, fontsize=9)
    axes.set_yticks(range(len(rows)), [row["rival"] for row in rows])
    axes.invert_yaxis()
    axes.set(xlabel=f"cases, of {rows[0]['cases']} with something concealed", xlim=(0, rows[0]["cases"]))
    axes.legend(fontsize=9, frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3)
    return figure


def _shares(axes: Axes, at: list[float], shares: list[dict[str, float]], label: str) -> None:
    """Draw shares with their 90 % intervals; none of nothing."""
    kept = [(x, row, row["count"] / row["of"]) for x, row in zip(at, shares, strict=True) if row["of"]]
    reach = [
        [max(0.0, share - row["low"]) for _, row, share in kept],
        [max(0.0, row["high"] - share) for _, row, share in kept],
    ]
    axes.errorbar(
        [x for x, _, _ in kept],
        [share for _, _, share in kept],
        reach,
        fmt="o",
        markersize=5,
        linewidth=1,
        label=label,
    )


def _range(row: dict[str, Any]) -> str:
    low, high = (None if end is None else _short(end) for end in (row["from"], row["to"]))
    if low is None:
        return f"below {high}"
    return f"from {low}" if high is None else f"{low} to {high}"


def _short(value: float) -> str:
    """Thousands as powers of ten."""
    return f"{value:g}" if value < 1000.0 else f"$10^{{{round(math.log10(value))}}}$"


def main() -> None:
    """Take over a suite's scores, if given; write page and pictures."""
    source = Path(sys.argv[1]) if len(sys.argv) > 1 else SUMMARY
    summary = condense(json.loads(source.read_text("utf-8")))
    SUMMARY.write_text(json.dumps(summary, indent=1) + "\n", "utf-8")
    (DOCS / "challenge.md").write_text(page(summary), "utf-8")
    for name, figure in pictures(summary).items():
        figure.savefig(DOCS / "images" / f"{name}.png", dpi=130, metadata={"Software": None})


if __name__ == "__main__":
    main()
