"""One verdict of a small campaign compared with its truth."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from permway.challenge.score import FOUND, NOVEL, Claim, Scored, score
from permway.challenge.small.alike import right_names
from permway.challenge.small.errors import ROUGH_OCTAVES
from permway.errors import InputError

MOST_OF_A_CLASS = 3
"""Members of a class that still answers: of more an engineer has to look everywhere. At 2 a few classes less
count, at 6 those of everything that is near do."""

SURE = 0.9
"""Probability from which a name is meant to be relied on."""


@dataclass(frozen=True)
class Judged:
    """A campaign, its verdict, and what of it is right; None where that does not apply.

    Attributes
    ----------
    name, tier, maker, layout, kind, family : str
        Kind of what is concealed: "null", "outside", "several", "fault" or "single".
    rough : bool
        Whether its calibration errors vary within half an octave.
    deviance, change_dB : float or None
        See :class:`permway.challenge.small.stated.Small`.
    status : str
        Of the verdict; "" if the diagnosis failed.
    failure : str
        "", or "no parameters", "time" or "other".
    called : bool
        Whether something is called missing.
    found, placed, first, in_class : bool or None
        Called where something is; at its place; its name stated first; the name, or a class of at most three,
        holds it.
    false_name : bool
    insufficient : bool or None
        Whether the right name is suspected, and then not called.
    sure : tuple of bool
        Of every name that is stated with 0.9 or more, whether it is true.
    nominal, effect : tuple of bool
        Of every parameter of the model, and of what is concealed: whether its 90 % interval holds the truth.
    claims : tuple of Claim
    stated : str
    truth : str
    seconds, peak_MB : float
    """

    name: str
    tier: str
    maker: str
    layout: str
    kind: str
    family: str
    rough: bool
    deviance: float | None
    change_dB: float | None = None
    status: str = ""
    failure: str = ""
    called: bool = False
    found: bool | None = None
    placed: bool | None = None
    first: bool | None = None
    in_class: bool | None = None
    false_name: bool = False
    insufficient: bool | None = None
    sure: tuple[bool, ...] = ()
    nominal: tuple[bool, ...] = ()
    effect: tuple[bool, ...] = ()
    claims: tuple[Claim, ...] = ()
    named: str = ""
    truth: str = ""
    seconds: float = float("nan")
    peak_MB: float = float("nan")


def judged(folder: Path, names: list[str], families: Mapping[str, str]) -> list[Judged]:
    """All campaigns of these names that were diagnosed, or failed to be.

    Parameters
    ----------
    folder : Path
        As :func:`permway.challenge.small.suite.run_small` left it.
    names : list of str
    families : mapping of effect to family

    Raises
    ------
    InputError
        If none was diagnosed.
    """
    folder = Path(folder)
    try:
        scored = {one.name: one for one in score(folder, families)}
    except InputError:
        # Every single one may have failed.
        scored = {}
    found = []
    for name in names:
        path, out = folder / "truth" / f"{name}.json", folder / "verdicts" / name
        if not path.is_file() or not ((out / "verdict.json").is_file() or (out / "failed.txt").is_file()):
            continue
        truth = json.loads(path.read_text())
        bare = _bare(name, truth, out)
        if name in scored:
            found.append(_judged(bare, truth, json.loads((out / "verdict.json").read_text()), scored[name]))
        else:
            found.append(replace(bare, failure=_failure(truth, (out / "failed.txt").read_text())))
    if not found:
        raise InputError("holds no verdict", where=str(folder), remedy="permway challenge suite --tiers small")
    return found


def _bare(name: str, truth: Mapping[str, Any], out: Path) -> Judged:
    effects = truth["effects"]
    cost = json.loads((out / "cost.json").read_text()) if (out / "cost.json").is_file() else {}
    nan = float("nan")
    return Judged(
        name=name,
        tier=truth["tier"],
        maker=truth["maker"],
        layout=truth["layout"],
        kind=_kind(effects),
        family=_strongest(truth)["family"] if effects else "",
        rough=truth["errors"]["length_octaves"] < ROUGH_OCTAVES,
        deviance=truth.get("deviance") if effects else None,
        change_dB=truth.get("change_dB") if effects else None,
        truth=", ".join(effect["id"] or effect["mechanical"] for effect in effects) or "nothing",
        seconds=float(cost.get("processor_s", nan)),
        peak_MB=float(cost.get("peak_MB", nan)),
    )


def _strongest(truth: Mapping[str, Any]) -> Mapping[str, Any]:
    """The effect that shows most alone."""
    alone = truth.get("linear_deviances") or [0.0]
    found: Mapping[str, Any] = truth["effects"][alone.index(max(alone))]
    return found


def _kind(effects: list[Mapping[str, Any]]) -> str:
    if not effects:
        return "null"
    if len(effects) > 1:
        return "several"
    if effects[0]["id"] is None:
        return "outside"
    return "fault" if effects[0]["domain"] == "measurement" else "single"


def _failure(truth: Mapping[str, Any], text: str) -> str:
    if text.startswith("TimeUp"):
        return "time"
    return "other" if truth["parameters"] else "no parameters"


def _judged(bare: Judged, truth: Mapping[str, Any], verdict: Mapping[str, Any], scored: Scored) -> Judged:
    right = right_names(truth)
    called = verdict["status"] in FOUND
    effects = verdict["effects"]
    something = bool(truth["effects"])
    first = effects[0] if effects else None
    claims = tuple(Claim(c.name, c.probability, c.name in right) for c in scored.claims)
    sure = tuple(c.true for c in claims if c.probability >= SURE and c.name != NOVEL)
    return replace(
        bare,
        status=verdict["status"],
        called=called,
        found=called if something else None,
        placed=scored.placed,
        first=(called and first is not None and first["name"] in right) if something else None,
        in_class=any(_holds(e, right) for e in effects) if something and called else False if something else None,
        false_name=scored.false_name and not any(e["name"] in right for e in effects if e["name"]),
        insufficient=(verdict["status"] == "insufficient" and first is not None and _holds(first, right))
        if something
        else None,
        sure=sure,
        nominal=tuple(_nominal(truth["parameters"], verdict["recalibrated"])),
        effect=scored.covered,
        claims=claims,
        named=", ".join(scored.named) if called else "",
    )


def _holds(effect: Mapping[str, Any], right: set[str]) -> bool:
    members = {member["name"] for member in effect["class"]}
    return effect["name"] in right or (len(members) <= MOST_OF_A_CLASS and bool(members & right))


def _nominal(true: Mapping[str, float], recalibrated: Mapping[str, Any]) -> list[bool]:
    """Of the amended model, or of the base where nothing is called missing."""
    estimates = recalibrated["after"] or recalibrated["before"]
    return [
        bool(estimates[name]["low"] <= value <= estimates[name]["high"])
        for name, value in true.items()
        if name in estimates and estimates[name]["low"] is not None
    ]
