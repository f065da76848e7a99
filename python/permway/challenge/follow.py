"""What a verdict advises to measure next is measured, and it is seen whether that distinguishes the rivals."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np

from permway.challenge.case import SLOW_OR_FAST, WARMER_K, Case, Tier, draw, write, write_truth
from permway.challenge.run import VERDICT
from permway.challenge.score import FITS, FOUND
from permway.challenge.weigh import whole
from permway.errors import InputError

FOLLOWED, ADVICE = "followed", "advice"
"""Folder of the campaigns that were measured again, and in it that of what was advised."""

NOTHING = "recalibrated"
"""The rival of a suspicion: that nothing is missing."""


@dataclass(frozen=True)
class Advice:
    """A measurement beside those that were made.

    Attributes
    ----------
    kind : str
        "sensor", "blows", "repeat", "temperature", "speed".
    body : str
        Of a sensor, or of blows.
    value : float
        The place, m; how many times the blows; the temperature, degC; the speed, km/h.
    """

    kind: Literal["sensor", "blows", "repeat", "temperature", "speed"]
    body: str = ""
    value: float = float("nan")


Read = Callable[[Path, str], Advice]
"""From a campaign file, and the words of a verdict, to what they ask for."""


@dataclass(frozen=True)
class Separated:
    """One campaign before and after.

    Attributes
    ----------
    name : str
        Of the campaign.
    measurement : str
        What was advised.
    rivals : tuple of str
        The two that it should distinguish.
    truth : tuple of str
        Identifiers of what was concealed, or that nothing was.
    after : tuple of str
        Names, or classes, of the new verdict; its status if it names nothing.
    apart : bool
        Whether the new verdict states one of them and not the other, in any class.
    right : bool or None
        Whether that is the true one; None where neither is.
    """

    name: str
    measurement: str
    rivals: tuple[str, ...]
    truth: tuple[str, ...]
    after: tuple[str, ...]
    apart: bool
    right: bool | None


def measured_again(case: Case, advice: Advice) -> Case:
    """The same line, train and effects, with all that was measured and what is advised.

    Parameters
    ----------
    case : Case
    advice : Advice

    Raises
    ------
    InputError
        For a kind that is none.
    """
    tests, chain = case.tests, case.chain
    random = np.random.default_rng([case.seed, 8])
    match advice.kind:
        case "sensor":
            tests = replace(tests, sensors=(*tests.sensors, (advice.body, advice.value)))
        case "blows":
            tests = replace(tests, points=(*tests.points, (advice.body, advice.value)))
        case "repeat":
            tests = replace(tests, blows=round(advice.value * tests.blows))
        case "temperature":
            made = len(tests.temperatures_C)
            warmer = round(WARMER_K * float(random.standard_normal()), 3)
            tests = replace(tests, temperatures_C=(*tests.temperatures_C, advice.value))
            chain = replace(chain, warmer_C=(*chain.warmer_C[:made], warmer))
        case "speed":
            made = len(tests.speeds_kmh)
            faster = round(1.0 + float(random.uniform(-SLOW_OR_FAST, SLOW_OR_FAST)), 5)
            tests = replace(tests, speeds_kmh=(*tests.speeds_kmh, round(advice.value, 3)))
            chain = replace(chain, speed=(*chain.speed[:made], faster))
        case _:
            raise InputError("is no measurement that can be made", where="advice", value=advice.kind)
    return replace(case, tests=tests, chain=chain)


def follow(folder: Path, read: Read) -> list[Path]:
    """Make the campaigns of all verdicts that advise a measurement once more, with the first that they advise.

    Parameters
    ----------
    folder : Path
        As :func:`permway.challenge.run.run` left it; gets `followed`, a challenge of its own.
    read : callable

    Returns
    -------
    list of Path
        The new campaigns' folders, those that were there among them.

    Raises
    ------
    InputError
        If no verdict advises a measurement, or a truth is not there.
    """
    folder = Path(folder)
    made = []
    for name, verdict in _advised(folder):
        out = folder / FOLLOWED
        new, file = out / name, out / ADVICE / f"{name}.json"
        made.append(new)
        if file.is_file():
            continue
        words = verdict["next"][0]["measurement"]
        advice = read(folder / "verdicts" / name / "campaign" / "campaign.toml", words)
        tier, seed = name.rsplit("-", 1)
        truth = folder / "truth" / f"{name}.json"
        if not truth.is_file():
            raise InputError("is not there", where=str(truth), remedy="keep truths beside what is followed")
        share = json.loads(truth.read_text()).get("share", 1.0)
        # What was faded is as far from none as it was.
        drawn = draw(int(seed), cast(Tier, tier))
        case = measured_again(drawn if share == 1.0 else drawn.faded(share), advice)
        write(case, new)
        for place in ("truth", ADVICE):
            (out / place).mkdir(parents=True, exist_ok=True)
        write_truth(case, out / "truth" / f"{name}.json")
        found = {"measurement": words, "separates": verdict["next"][0]["separates"], **asdict(advice)}
        whole(file, json.dumps(found, indent=1) + "\n")
    if not made:
        raise InputError(
            "no verdict advises a measurement",
            where=str(folder),
            remedy="records must leave something open: permway challenge make --tier sparse",
        )
    return made


def _advised(folder: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    for path in sorted(folder.glob(f"verdicts/*/{VERDICT}")):
        verdict = json.loads(path.read_text())
        if verdict["next"]:
            yield path.parent.name, verdict


def separated(folder: Path) -> list[Separated]:
    """Hold the verdicts on campaigns that were measured again against the rivals before, and the truths.

    Parameters
    ----------
    folder : Path
        As for :func:`follow`.
    """
    found = []
    for file in sorted((Path(folder) / FOLLOWED / ADVICE).glob("*.json")):
        path = file.parent.parent / "verdicts" / file.stem / VERDICT
        if path.is_file():
            truth = json.loads((file.parent.parent / "truth" / file.name).read_text())
            found.append(_judged(file.stem, json.loads(file.read_text()), truth, json.loads(path.read_text())))
    return found


def _judged(name: str, advice: dict[str, Any], truth: dict[str, Any], verdict: dict[str, Any]) -> Separated:
    rivals = tuple(advice["separates"])
    true = tuple(str(one["id"]) for one in truth["effects"]) or (NOTHING,)
    called = verdict["effects"] if verdict["status"] in FOUND else []
    classes = [{m["name"] for m in effect["class"]} | {effect["name"]} - {None} for effect in called]
    if verdict["status"] in FITS:
        classes = [{NOTHING}]
    left = {one for found in classes for one in found} & set(rivals)
    known = set(true) & set(rivals)
    return Separated(
        name=name,
        measurement=advice["measurement"],
        rivals=rivals,
        truth=true,
        after=tuple("|".join(sorted(one)) or "not named" for one in classes) or (verdict["status"],),
        apart=len(left) == 1,
        right=left == known if known else None,
    )
