"""What verdicts are worth: power by difficulty, probabilities compared with truths, families taken for others."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from permway.challenge.score import Scored
from permway.challenge.summary import interval

DEVIANCES = (-np.inf, 15.0, 50.0, 200.0, 1e3, 1e4, 1e5, np.inf)
"""Ends of the classes of deviance that power is reported for."""

PROBABILITIES = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)
"""Ends of the classes of what verdicts say."""

NAMELESS = "no name"


def power(scored: Iterable[Scored]) -> list[dict[str, Any]]:
    """Cases, and how many are found, placed and named by family, by the deviance of what was concealed.

    Parameters
    ----------
    scored : iterable of Scored
        Those that were weighed and conceal something count.

    Returns
    -------
    list of dict
        `from`, `to` (None for no end), `cases`, and of each figure the count, of how many, and its 90 % interval.
    """
    weighed = [(s, s.deviance) for s in scored if s.deviance is not None and s.found is not None]
    rows = []
    for low, high in pairwise(DEVIANCES):
        mine = [s for s, deviance in weighed if low <= deviance < high]
        if mine:
            row: dict[str, Any] = {"from": _end(low), "to": _end(high), "cases": len(mine)}
            row["found"] = _reported([bool(s.found) for s in mine])
            row["placed"] = _reported([bool(s.placed) for s in mine])
            # What no catalogue holds has no name to be reported.
            row["family"] = _reported([bool(s.family) for s in mine if s.concealed_family])
            rows.append(row)
    return rows


def reliability(scored: Iterable[Scored]) -> list[dict[str, Any]]:
    """Of all names with a probability, by what it was, how many are true.

    Parameters
    ----------
    scored : iterable of Scored

    Returns
    -------
    list of dict
        `from`, `to`, `claims`, `mean` (of what was stated), `true` (the count and its 90 % interval).
    """
    claims = [claim for s in scored for claim in s.claims]
    rows = []
    for low, high in pairwise(PROBABILITIES):
        mine = [c for c in claims if low <= c.probability < high or c.probability == high == 1.0]
        if mine:
            mean = float(np.mean([c.probability for c in mine]))
            reported = _reported([c.true for c in mine])
            rows.append({"from": low, "to": high, "claims": len(mine), "mean": round(mean, 3), "true": reported})
    return rows


def confusion(scored: Iterable[Scored]) -> list[dict[str, Any]]:
    """Families of the strongest concealed effects, and of what is named in their stead.

    Parameters
    ----------
    scored : iterable of Scored

    Returns
    -------
    list of dict
        `concealed`, `cases`, `named` (family or status to count), the most frequent first.
    """
    table: dict[str, dict[str, int]] = {}
    for one in scored:
        if one.found is not None:
            named = table.setdefault(one.concealed_family or NAMELESS, {})
            named[one.named_family] = named.get(one.named_family, 0) + 1
    rows = [
        {"concealed": name, "cases": sum(named.values()), "named": dict(sorted(named.items(), key=_most_first))}
        for name, named in table.items()
    ]
    return sorted(rows, key=lambda row: (-int(row["cases"]), row["concealed"]))


def _most_first(pair: tuple[str, int]) -> tuple[int, str]:
    return -pair[1], pair[0]


def _end(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _reported(values: Sequence[bool]) -> dict[str, float]:
    low, high = interval(sum(values), len(values)) if values else (0.0, 1.0)
    return {"count": sum(values), "of": len(values), "low": round(low, 3), "high": round(high, 3)}
