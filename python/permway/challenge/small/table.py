"""One table of a suite of small campaigns: shares with their 90 % intervals, by what makes a campaign hard."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from permway.challenge.calibration import PROBABILITIES
from permway.challenge.score import NOVEL
from permway.challenge.small.judge import SURE, Judged
from permway.challenge.small.passages_drawn import PASSAGES
from permway.challenge.summary import interval

DEVIANCES = (0.0, 15.0, 50.0, 200.0, float("inf"))
"""Ends of the classes of deviance."""

CHANGES_DB = (0.0, 0.1, 0.5, float("inf"))
"""Ends of the classes of what effects change: clean campaigns show less than an engineer would look for."""

WORST = 30
"""Cases that are listed."""

Count = list[float]
"""Hits, of how many, and the 90 % interval of the share in per cent."""

COLUMNS: dict[str, Callable[[Judged], bool | None]] = {
    "called": lambda j: j.called if j.kind == "null" else None,
    "found": lambda j: j.found,
    "placed": lambda j: j.placed,
    "first": lambda j: j.first,
    "class": lambda j: j.in_class,
    "false_name": lambda j: j.false_name,
    "insufficient": lambda j: j.insufficient,
}
"""Of campaigns with a verdict."""

SEVERAL: dict[str, Callable[[Judged], Sequence[bool]]] = {
    "sure": lambda j: j.sure,
    "nominal": lambda j: j.nominal,
    "effect": lambda j: j.effect,
}
"""Of which a campaign has several: names stated with 0.9 or more that are true, and intervals that hold."""


def table(found: Sequence[Judged]) -> dict[str, Any]:
    """Rows by kind, deviance, roughness, layout, maker and family; reliability; costs; the worst cases."""
    rows = [_row("all", "", found)]
    for group, key in _GROUPS.items():
        names = sorted({name for j in found if (name := key(j))}, key=_order)
        rows += [_row(group, name, [j for j in found if key(j) == name]) for name in names]
    return {"rows": rows, "reliability": _reliability(found), "worst": _worst(found)}


def _class(value: float | None, ends: Sequence[float], unit: str = "") -> str:
    """The class of a value, by its name; "" of none."""
    if value is None:
        return ""
    low, high = next(pair for pair in pairwise(ends) if value < pair[1])
    return f"over {low:g}{unit}" if np.isinf(high) else f"{low:g} to {high:g}{unit}"


_GROUPS: dict[str, Callable[[Judged], str]] = {
    "tier": lambda j: j.tier,
    "kind": lambda j: j.kind if j.tier == "small" else "",
    "concealed": lambda j: j.truth if j.tier == PASSAGES else "",
    "deviance": lambda j: _class(j.deviance, DEVIANCES),
    "change": lambda j: _class(j.change_dB, CHANGES_DB, " dB"),
    "errors": lambda j: "rough" if j.rough else "smooth",
    "layout": lambda j: j.layout,
    "maker": lambda j: j.maker,
    "family": lambda j: j.family,
}


def _order(name: str) -> tuple[float, str]:
    """Classes of deviance by their number, all else by the alphabet."""
    number = name.removeprefix("over ").split(" ")[0]
    return (float(number) + name.startswith("over "), "") if number[:1].isdigit() else (0.0, name)


def _row(group: str, name: str, found: Sequence[Judged]) -> dict[str, Any]:
    answered = [j for j in found if not j.failure]
    row: dict[str, Any] = {"group": group, "name": name, "cases": len(found)}
    failed = {kind: sum(j.failure == kind for j in found) for kind in ("no parameters", "time", "other")}
    row["failed"] = {kind: count for kind, count in failed.items() if count}
    for key, of in COLUMNS.items():
        values = [v for j in answered if (v := of(j)) is not None]
        if values:
            row[key] = _count(values)
    for key, each in SEVERAL.items():
        values = [v for j in answered for v in each(j)]
        if values:
            row[key] = _count(values)
    seconds = [j.seconds for j in found if np.isfinite(j.seconds)]
    if seconds:
        row["seconds"] = [round(float(np.median(seconds)), 1), round(max(seconds), 1)]
        row["peak_MB"] = round(max(j.peak_MB for j in found if np.isfinite(j.peak_MB)))
    return row


def _count(values: Sequence[bool]) -> Count:
    low, high = interval(sum(values), len(values))
    return [sum(values), len(values), round(100.0 * low), round(100.0 * high)]


def _reliability(found: Iterable[Judged]) -> list[dict[str, Any]]:
    """Of all names, "novel" left out, by the probability that was stated: how many are true."""
    claims = [c for j in found for c in j.claims if c.name != NOVEL]
    rows = []
    for low, high in pairwise(PROBABILITIES):
        mine = [c for c in claims if low <= c.probability < high or c.probability == high == 1.0]
        if mine:
            stated = round(float(np.mean([c.probability for c in mine])), 3)
            rows.append({"from": low, "to": high, "stated": stated, "true": _count([c.true for c in mine])})
    return rows


def _worst(found: Iterable[Judged]) -> list[dict[str, Any]]:
    """False names and false alarms, then what was not found at its place, then what failed; strongest first."""

    def badness(j: Judged) -> tuple[int, float]:
        size = j.deviance or 0.0
        if j.false_name or (j.called and j.kind == "null"):
            return 0, -max((c.probability for c in j.claims if not c.true), default=0.0)
        if j.failure:
            return 2, -size
        return (1, -size) if j.found is not None and not (j.placed and j.in_class) else (3, 0.0)

    ranked = sorted((j for j in found if badness(j)[0] < 3), key=badness)
    kinds: dict[int, int] = {}
    rows: list[dict[str, Any]] = []
    for j in ranked:
        rank = badness(j)[0]
        kinds[rank] = kinds.get(rank, 0) + 1
        # Of each kind some, or one kind would fill the list.
        if kinds[rank] <= WORST // 2 and len(rows) < WORST:
            row: dict[str, Any] = {"case": j.name, "truth": j.truth}
            row |= {"deviance": None if j.deviance is None else round(j.deviance, 1)}
            rows.append({**row, "verdict": j.named or j.failure or j.status})
    return rows


HEADS = {
    "cases": "cases",
    "failed": "failed",
    "called": "called (nothing missing)",
    "found": "found",
    "placed": "place",
    "first": "first name right",
    "class": "class of three holds it",
    "false_name": "false name",
    "insufficient": "right but insufficient",
    "sure": f"names of {SURE:g} true",
    "nominal": "nominal parameters in 90 %",
    "effect": "effect's parameters in 90 %",
    "seconds": "s, median (worst)",
}
"""Columns of the page."""


def markdown(found: dict[str, Any], *, groups: Sequence[str] | None = None) -> str:
    """The table as a page shows it.

    Parameters
    ----------
    found : dict
        As :func:`table` gives it, or `score.json`.
    groups : sequence of str, optional
        Which rows: "all", "tier", "kind", "concealed", "deviance", "change", "errors", "layout", "maker",
        "family"; all by default.
    """
    lines = [f"| | {' | '.join(HEADS.values())} |", f"|---|{'---|' * len(HEADS)}"]
    for row in found["rows"]:
        if groups is None or row["group"] in groups:
            name = row["group"] if not row["name"] else f"{row['group']}: {row['name']}"
            lines.append(f"| {name} | {' | '.join(_cell(key, row.get(key)) for key in HEADS)} |")
    return "\n".join(lines) + "\n"


def _cell(key: str, value: Any) -> str:
    if value is None:
        return ""
    if key == "failed":
        return ", ".join(f"{count} {kind}" for kind, count in value.items()) or "0"
    if key == "seconds":
        return f"{value[0]:g} ({value[1]:g})"
    if isinstance(value, list):
        hits, of, low, high = value
        return f"{hits}/{of} ({low:.0f} to {high:.0f} %)"
    return str(value)


def reliability_markdown(found: dict[str, Any]) -> str:
    """What was stated against what is true."""
    lines = ["| probability stated | mean | true |", "|---|---|---|"]
    for row in found["reliability"]:
        lines.append(f"| {row['from']:g} to {row['to']:g} | {row['stated']:g} | {_cell('true', row['true'])} |")
    return "\n".join(lines) + "\n"


def worst_markdown(found: dict[str, Any]) -> str:
    """The worst cases by the names of their folders."""
    lines = ["| case | concealed | deviance | stated |", "|---|---|---|---|"]
    for row in found["worst"]:
        deviance = "" if row["deviance"] is None else f"{row['deviance']:g}"
        lines.append(f"| {row['case']} | {row['truth']} | {deviance} | {row['verdict']} |")
    return "\n".join(lines) + "\n"


def as_json(scores: dict[str, Any]) -> str:
    """JSON of a line to a row, which is small and still can be compared line by line."""
    parts = []
    for key, value in scores.items():
        if isinstance(value, list):
            rows = ",\n ".join(json.dumps(row, separators=(",", ":")) for row in value)
            parts.append(f'"{key}": [\n {rows}\n]')
        else:
            parts.append(f'"{key}": {json.dumps(value)}')
    return "{\n" + ",\n".join(parts) + "\n}\n"
