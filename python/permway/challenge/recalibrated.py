"""Recalibrated parameters against the true ones: a prediction that is wrong shows in the same one everywhere."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from permway.challenge.score import FITS, Scored

WIDTH = 1.6449
"""Standard deviations to either end of a 90 % interval."""


@dataclass(frozen=True)
class Pull:
    """One parameter of one campaign.

    Attributes
    ----------
    case, parameter : str
    sigmas : float
        True value less the recalibrated one, in standard deviations of what is stated about it; of logarithms
        where all is above zero.
    inside : bool
        Whether the 90 % interval holds the true value.
    """

    case: str
    parameter: str
    sigmas: float
    inside: bool


def pulls(folder: Path, scored: Iterable[Scored], verdicts: Path | None = None) -> list[Pull]:
    """Of campaigns where nothing is missing, or what is was named and nothing else: there what is fitted is right.

    Parameters
    ----------
    folder : Path
        As `run` left it.
    scored : iterable of Scored
    verdicts : Path, optional
        Where `CASE/verdict.json` lie; by default in the folder's `verdicts`.
    """
    found = []
    for one in scored:
        right = one.status in FITS if one.found is None else one.family and one.all_found in (None, True)
        if not right or one.false_name:
            continue
        true = json.loads((Path(folder) / "truth" / f"{one.name}.json").read_text())
        verdict = json.loads(((verdicts or Path(folder) / "verdicts") / one.name / "verdict.json").read_text())
        displaced = verdict.get("recalibrated", {}).get("before" if one.found is None else "after", {})
        for name, value in _by_name(true.get("parameters", {})):
            estimate = displaced.get(name)
            if estimate is not None and estimate.get("low") is not None:
                found.append(_pull(one.name, name, value, estimate))
    return found


def _by_name(parameters: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """True values by the names of a campaign's parameters; large campaigns have them by part."""
    for name, value in parameters.items():
        if isinstance(value, Mapping):
            yield from ((f"{name}.{key}", float(one)) for key, one in value.items())
        else:
            yield name, float(value)


def _pull(case: str, parameter: str, true: float, estimate: Mapping[str, Any]) -> Pull:
    low, value, high = (float(estimate[key]) for key in ("low", "value", "high"))
    inside = low <= true <= high
    if min(low, true) > 0.0:
        low, value, high, true = (float(np.log(one)) for one in (low, value, high, true))
    return Pull(case, parameter, (true - value) * 2.0 * WIDTH / max(high - low, 1e-300), inside)


def by_parameter(found: Iterable[Pull]) -> list[dict[str, Any]]:
    """A row for each parameter, the one whose pulls lean most first: campaigns, how many hold it, mean, scatter.

    `leaning` is the mean over its standard error: beyond 3 or so the prediction is wrong, not the campaign.
    """
    kept = list(found)
    rows = []
    for name in dict.fromkeys(p.parameter for p in kept):
        mine = np.array([p.sigmas for p in kept if p.parameter == name])
        rows.append(
            {
                "parameter": name,
                "campaigns": int(mine.size),
                "inside": sum(p.inside for p in kept if p.parameter == name),
                "mean": round(float(mine.mean()), 2),
                "rms": round(float(np.sqrt(np.mean(mine**2))), 2),
                "leaning": round(float(mine.mean() * np.sqrt(mine.size)), 1),
            }
        )
    return sorted(rows, key=lambda row: -abs(row["leaning"]))
