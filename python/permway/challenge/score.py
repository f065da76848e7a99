"""Verdicts compared with truths: detection, place, family, class, parameters, held-out gain, by tier."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from permway.challenge.parameters import in_catalogue
from permway.challenge.weigh import weights, weights_of_each
from permway.errors import InputError

FOUND = ("named", "ambiguous", "described", "located", "measurement")
"""Statuses that call something missing or at fault."""

FITS = ("recalibrated", "outside_tolerance")
"""Statuses of a model that fits without any effect."""

DIFFICULTY = {"easy": 200.0, "medium": 50.0, "hard": 15.0, "too small": -np.inf}
"""Least deviance against the best recalibrated base; too small is what the records do not decide."""

NOVEL = "novel"
"""The name of what no catalogue has."""

NEAR_M = 1.5
"""How far from a true place an interval may end and still be there, unless the place has its own `near_m`."""

WORSE = 3.0
"""Nats, by which records that were left out become less probable where a model predicts them worse: odds of 20 to
1. Of 154 amended models of small campaigns four are worse; at half of it 19 are, at twice one."""


@dataclass(frozen=True)
class Claim:
    """A name of a verdict, how probable it states that is, and whether it is so."""

    name: str
    probability: float
    true: bool


@dataclass(frozen=True)
class Scored:
    """One campaign.

    Attributes
    ----------
    name, tier, status : str
    truth : tuple of str
        Identifiers of what was concealed, or its mechanics in words.
    stated : tuple of str
        Names of the effects, or their classes.
    found, placed, family, in_class, false_name : bool or None
        Of the strongest concealed effect; None where that does not apply.
    all_found : bool or None
        Whether each of several effects that the records constrain is found: at its place, and named or classed.
    mechanics : bool or None
        Whether the words that describe an effect of no catalogue say its mechanics.
    covered : tuple of bool
        Of each parameter that truth and verdict both name, whether the 90 % interval holds it.
    harmed : bool
        Whether the amended model predicts what was held out worse.
    seconds : float
    deviance : float or None
        Against the best recalibrated base, if it was weighed.
    gain_dB : float or None
        By which records that were left out are predicted better, the median of all ways to leave some out.
    claims : tuple of Claim
        All names of all effects, "novel" among them.
    concealed_family, named_family : str
        Of the strongest concealed effect, and of what is named in its place, or what the verdict is instead.
    """

    name: str
    tier: str
    status: str
    truth: tuple[str, ...]
    named: tuple[str, ...]
    found: bool | None
    placed: bool | None
    family: bool | None
    in_class: bool | None
    false_name: bool
    covered: tuple[bool, ...]
    harmed: bool
    seconds: float
    deviance: float | None = None
    all_found: bool | None = None
    mechanics: bool | None = None
    gain_dB: float | None = None
    claims: tuple[Claim, ...] = ()
    concealed_family: str = ""
    named_family: str = ""

    @property
    def group(self) -> str:
        """Tier, and how hard it is if it was weighed."""
        if self.deviance is None:
            return self.tier
        return f"{self.tier}, {next(name for name, least in DIFFICULTY.items() if self.deviance >= least)}"


def score(folder: Path, families: Mapping[str, str], verdicts: Path | None = None) -> list[Scored]:
    """Score all verdicts of a challenge.

    Parameters
    ----------
    folder : Path
        As `run` left it.
    families : mapping of effect to family
        Effects of one family are near-degenerate alternatives.
    verdicts : Path, optional
        Where `CASE/verdict.json` lie; by default in the folder's `verdicts`.

    Raises
    ------
    InputError
        If there is no verdict.
    """
    found, weighed, each = [], weights(folder), weights_of_each(folder)
    for path in sorted((Path(folder) / "truth").glob("*.json")):
        written = (verdicts or Path(folder) / "verdicts") / path.stem / "verdict.json"
        if written.is_file():
            seconds = written.with_name("seconds.json")
            took = sum(json.loads(seconds.read_text()).values()) if seconds.is_file() else float("nan")
            true, verdict = json.loads(path.read_text()), json.loads(written.read_text())
            alone = each.get(path.stem)
            strongest, telling = _strongest_first(true, alone), _telling(true, alone)
            scored = _scored(path.stem, strongest, verdict, families, took, telling)
            found.append(replace(scored, deviance=weighed.get(path.stem)))
    if not found:
        raise InputError("holds no verdict", where=str(folder), remedy="permway challenge run")
    return found


def _strongest_first(truth: Mapping[str, Any], each: Sequence[float] | None) -> dict[str, Any]:
    """A truth with its effects in the order of what each does alone; as drawn, if that was not weighed."""
    effects = list(truth["effects"])
    if each is not None and len(each) == len(effects):
        effects = [effects[i] for i in np.argsort(-np.asarray(each))]
    return {**truth, "effects": effects}


def _telling(truth: Mapping[str, Any], each: Sequence[float] | None) -> int:
    """How many effects the records constrain, each for itself; all, if that was not weighed."""
    least = DIFFICULTY["hard"]
    count = len(truth["effects"])
    return count if each is None or len(each) != count else sum(one >= least for one in each)


def _scored(
    name: str,
    truth: Mapping[str, Any],
    verdict: Mapping[str, Any],
    families: Mapping[str, str],
    seconds: float,
    telling: int,
) -> Scored:
    concealed = list(truth["effects"])
    effects = list(verdict["effects"]) if verdict["status"] in FOUND else []
    harmed = (
        any(g["gain_nats"] < -WORSE for g in verdict["held_out"].values())
        # Where nothing but a place is stated, no amended model is offered.
        if any(e["parameters"] for e in effects)
        else False
    )
    named = tuple(e["name"] or "|".join(m["name"] for m in e["class"]) or "not named" for e in effects)
    ids = tuple(e["id"] or e.get("mechanical") or "unknown" for e in concealed)
    known = {families.get(e["id"], e.get("family")) for e in concealed if e["id"]}
    # What is named and not in the catalogue, as by screening, is its own family.
    false = any(e["name"] and families.get(e["name"], e["name"]) not in known for e in effects)
    if not concealed:
        flags: tuple[bool | None, ...] = (None, None, None, None)
    else:
        first = concealed[0]
        flags = (
            bool(effects),
            any(_there(first["place"], e["place"], first.get("domain"), e["domain"]) for e in effects),
            any(
                first["id"] and families.get(e["name"] or "", e["name"]) == families.get(first["id"], first["id"])
                for e in effects
            ),
            any(first["id"] in [m["name"] for m in e["class"]] or first["id"] == e["name"] for e in effects)
            if first["id"]
            else None,
        )
    return Scored(
        name=name,
        tier=name.rsplit("-", 1)[0],
        status=str(verdict["status"]),
        truth=ids,
        named=named,
        found=flags[0],
        placed=flags[1],
        family=flags[2],
        in_class=flags[3],
        false_name=false,
        covered=tuple(_covered(concealed, effects)),
        harmed=harmed,
        seconds=float(seconds),
        all_found=all(any(_same(one, e, families) for e in effects) for one in concealed[:telling])
        if telling > 1
        else None,
        mechanics=_described(concealed[0], effects) if concealed and concealed[0].get("words") else None,
        gain_dB=_gained(verdict) if effects else None,
        claims=tuple(_claims(concealed, effects)),
        concealed_family=families.get(concealed[0]["id"], "") if concealed and concealed[0]["id"] else "",
        named_family=_family(concealed, effects, families) or str(verdict["status"]),
    )


def _gained(verdict: Mapping[str, Any]) -> float | None:
    # An amended model that could not be solved without a group has no figure for it.
    held = [g for g in verdict["held_out"].values() if None not in (g.get("db_before"), g.get("db_after"))]
    return float(np.median([g["db_before"] - g["db_after"] for g in held])) if held else None


def _claims(concealed: Sequence[Mapping[str, Any]], effects: Iterable[Mapping[str, Any]]) -> list[Claim]:
    """Every member of every class; "novel" is true where something of no catalogue is concealed."""
    ids = {one["id"] or NOVEL for one in concealed}
    members = [member for effect in effects for member in effect["class"]]
    return [Claim(m["name"], float(m["probability"]), m["name"] in ids) for m in members]


def _family(
    concealed: Sequence[Mapping[str, Any]], effects: Sequence[Mapping[str, Any]], families: Mapping[str, str]
) -> str:
    """Family of the named effect at the first concealed one's place, or of the first; "" if none has a name."""
    named = [e for e in effects if e["name"]]
    if concealed:
        first = concealed[0]
        named.sort(key=lambda e: not _there(first["place"], e["place"], first.get("domain"), e["domain"]))
    return families.get(named[0]["name"], named[0]["name"]) if named else ""


def _same(true: Mapping[str, Any], stated: Mapping[str, Any], families: Mapping[str, str]) -> bool:
    """Whether an effect of the verdict is the concealed one: its place, and its name, its family or its class."""
    names = {stated["name"], *(member["name"] for member in stated["class"])}
    alike = true["id"] in names or families.get(stated["name"] or "", "") == families.get(true["id"], true["id"])
    return alike and _there(true["place"], stated["place"], true.get("domain"), stated["domain"])


def _described(true: Mapping[str, Any], effects: Iterable[Mapping[str, Any]]) -> bool:
    """Whether what is stated at the place of an effect without a name uses one of its words."""
    there = [e for e in effects if _there(true["place"], e["place"], true.get("domain"), e["domain"])]
    # Alternatives state no words.
    laws = [e["law"]["words"] for e in there if not e["name"] and "law" in e]
    return any(word in words for words in laws for word in true["words"])


def _there(true: Mapping[str, Any], stated: Mapping[str, Any], domain: str | None, stated_domain: str) -> bool:
    """Whether the verdict's place is the concealed one: the same domain, and the same stretch or channels."""
    if domain is not None and domain != stated_domain:
        return False
    x = true.get("x_m")
    if x:
        stretch = stated.get("within") or stated.get("x")
        near = float(true.get("near_m", NEAR_M))
        return stretch is not None and stretch[0] - near <= x[-1] and x[0] <= stretch[1] + near
    channels = true.get("channels")
    if isinstance(channels, list) and stated.get("channels"):
        return bool({_channel(name) for name in channels} & {_channel(name) for name in stated["channels"]})
    # "on board", or all of a kind.
    return True


def _channel(name: str) -> str:
    """The same for "rail@42" and "rail@42.0"."""
    body, at, x = name.partition("@")
    return f"{body}@{float(x):g}" if at else name


def _covered(concealed: Iterable[Mapping[str, Any]], effects: Iterable[Mapping[str, Any]]) -> list[bool]:
    found = []
    for effect in concealed:
        named = [e for e in effects if e["name"] and e["name"] == effect["id"]]
        # Of several of one name the one at its place, and of these the first, which is the strongest.
        named.sort(key=lambda e: not _there(effect["place"], e["place"], effect.get("domain"), e["domain"]))
        parameters = named[0]["parameters"] if named else {}
        for key, value in in_catalogue(effect["kind"], effect.get("parameters", {})).items():
            estimate = parameters.get(key)
            if estimate is not None and estimate["low"] is not None:
                found.append(bool(estimate["low"] <= value <= estimate["high"]))
    return found
