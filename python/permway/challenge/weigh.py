"""How hard each campaign of a challenge is: weighed against its control, in which nothing is concealed."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from concurrent.futures import Future, as_completed
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from permway.challenge.case import Case, draw, write
from permway.challenge.pool import processes
from permway.errors import InputError

Progress = Callable[[int, int], object]
Against = Callable[[Path], Callable[[Path], float]]
"""From the folder of a control, as `write` writes it, to the deviance of folders of campaigns with effects."""

WEIGHTS = "weights"


def control_of(case: Case) -> Case:
    """The same line, train, noise and errors, and nothing concealed."""
    return replace(case, effects=())


def weigh(
    folder: Path, against: Against, *, workers: int = 1, progress: Progress | None = None
) -> dict[str, float]:
    """Weigh every campaign with a concealed effect that has not been weighed yet.

    Parameters
    ----------
    folder : Path
        As :func:`permway.challenge.make.make` made it; gets `weights/<case>.json`.
    against : callable
        What an effect does to the records and no recalibration takes away, against a control without it.
    workers : int
        Processes.
    progress : callable, optional
        Called with campaigns done and how many there are.

    Returns
    -------
    dict of str to float
        Deviance by campaign, of all that are weighed.

    Raises
    ------
    InputError
        If the folder holds no truth.
    """
    folder = Path(folder)
    truths = sorted((folder / "truth").glob("*.json"))
    if not truths:
        raise InputError("holds no truth", where=str(folder), remedy="permway challenge make")
    known = weights(folder)
    todo = [path.stem for path in truths if path.stem not in known and json.loads(path.read_text())["effects"]]
    with processes(workers) as pool:
        jobs: list[Future[float | None]] = [pool.submit(weigh_one, folder, name, against) for name in todo]
        for done, job in enumerate(as_completed(jobs), start=1):
            job.result()
            if progress is not None:
                progress(done, len(todo))
    return weights(folder)


def weigh_one(folder: Path, name: str, against: Against) -> float | None:
    """Weigh one campaign, if it conceals anything and has not been weighed: its deviance."""
    kept = folder / WEIGHTS / f"{name}.json"
    if kept.is_file():
        return float(json.loads(kept.read_text())["deviance"])
    truth = json.loads((folder / "truth" / f"{name}.json").read_text())
    if not truth["effects"]:
        return None
    found, *each = _weighed(folder / name, truth["seed"], truth["tier"], against)
    keep(folder, name, found, each)
    return found


def keep(folder: Path, name: str, deviance: float, each: Sequence[float] = ()) -> None:
    """Write what a campaign weighs, and what each of several effects does alone."""
    kept = folder / WEIGHTS / f"{name}.json"
    kept.parent.mkdir(parents=True, exist_ok=True)
    whole(kept, json.dumps({"deviance": deviance, "each": list(each)}) + "\n")


def whole(path: Path, text: str) -> None:
    """Write a file whole or not at all."""
    beside = path.with_name(path.name + ".part")
    beside.write_text(text, encoding="utf-8")
    beside.replace(path)


def weights(folder: Path) -> dict[str, float]:
    """What is weighed of a challenge, by campaign."""
    return {
        path.stem: float(json.loads(path.read_text())["deviance"])
        for path in sorted((Path(folder) / WEIGHTS).glob("*.json"))
    }


def weights_of_each(folder: Path) -> dict[str, list[float]]:
    """What each effect weighs alone, in the order of the truth, of the campaigns that conceal several."""
    found = {path.stem: json.loads(path.read_text()) for path in (Path(folder) / WEIGHTS).glob("*.json")}
    return {name: kept["each"] for name, kept in found.items() if kept.get("each")}


def _weighed(folder: Path, seed: int, tier: str, against: Against) -> list[float]:
    """All effects together, and each alone where there are several."""
    case = draw(seed, tier)  # type: ignore[arg-type]  # draw refuses what is no tier
    with TemporaryDirectory() as place:
        control = Path(place) / "control"
        write(control_of(case), control)
        deviance = against(control)
        found = [deviance(folder)]
        for index, effect in enumerate(case.effects if len(case.effects) > 1 else ()):
            alone = Path(place) / f"alone-{index}"
            write(replace(case, effects=(effect,)), alone)
            found.append(deviance(alone))
        return found
