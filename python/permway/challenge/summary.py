"""Shares of right and wrong verdicts by tier and difficulty, with their intervals."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from scipy.stats import beta

from permway.challenge.score import DIFFICULTY, FOUND, Scored


def interval(hits: int, of: int, width: float = 0.9) -> tuple[float, float]:
    """Clopper and Pearson's interval of a share."""
    tail = 0.5 * (1.0 - width)
    low = 0.0 if hits == 0 else float(beta.ppf(tail, hits, of - hits + 1))
    high = 1.0 if hits == of else float(beta.ppf(1.0 - tail, hits + 1, of - hits))
    return low, high


def summary(scored: Iterable[Scored]) -> list[dict[str, Any]]:
    """A row for each tier, of which the weighed ones by how hard they are: shares with their 90 % intervals."""
    rows = []
    order = {name: index for index, name in enumerate(DIFFICULTY)}
    all_cases = sorted(scored, key=lambda s: (s.tier, order.get(s.group.split(", ")[-1], -1)))
    for group in dict.fromkeys(s.group for s in all_cases):
        mine = [s for s in all_cases if s.group == group]
        row: dict[str, Any] = {"tier": mine[0].tier, "group": group, "cases": len(mine)}
        alarms = [s.status in FOUND for s in mine]
        row["called"] = share(alarms)
        for key in ("found", "placed", "family", "in_class", "all_found", "mechanics"):
            values = [v for s in mine if (v := getattr(s, key)) is not None]
            if values:
                row[key] = share(values)
        row["false_name"] = share([s.false_name for s in mine])
        row["harmed"] = share([s.harmed for s in mine])
        covered = [c for s in mine for c in s.covered]
        if covered:
            row["covered"] = share(covered)
        gained = [s.gain_dB for s in mine if s.gain_dB is not None]
        if gained:
            row["gain_dB"] = round(float(np.median(gained)), 2)
        took = [s.seconds for s in mine if np.isfinite(s.seconds)]
        if took:
            row["seconds"] = round(float(np.median(took)), 1)
        rows.append(row)
    return rows


def share(values: Sequence[bool]) -> str:
    """Hits of all in words, with the 90 % interval of their share."""
    hits, of = sum(values), len(values)
    low, high = interval(hits, of)
    return f"{hits}/{of} ({100.0 * low:.0f} to {100.0 * high:.0f} %)"
