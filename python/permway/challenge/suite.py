"""The whole proof: campaigns of all tiers made, diagnosed, weighed and scored."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import as_completed
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from permway.challenge.case import Tier
from permway.challenge.make import make
from permway.challenge.pool import processes
from permway.challenge.run import FAILED, VERDICT, diagnosed, ruled_out, threads_of
from permway.challenge.tiers import number_of
from permway.challenge.weigh import WEIGHTS, Against, weigh_one, whole
from permway.errors import InputError, SolveError

CASES: dict[Tier, int] = {
    "null": 40,
    "single": 60,
    "twin": 20,
    "multiple": 20,
    "outside": 20,
    "nonlinear": 15,
    "graded": 30,
}
"""Campaigns of the whole suite, by tier."""

APART = 1000
"""Between the first seeds of tiers whose numbers follow each other."""

Progress = Callable[[int, int], object]

Spread = Callable[
    [Path, Iterable[tuple[str, Iterable[Path], Callable[[Path], Any]]], tuple[str, ...]], Iterator[tuple[str, Any]]
]
"""Does jobs on other machines. Given the folder; of each job its name, what it needs of the folder, and its work;
and patterns of the files that say that one is done. Yields names, with `value` and `error` of each."""

DONE = (f"*/{VERDICT}", f"*/{FAILED}", "truth/*.json", f"{WEIGHTS}/*.json")
"""Files that say how far a campaign is."""


@dataclass(frozen=True)
class Numbered:
    """A campaign that is yet to be drawn."""

    tier: Tier
    seed: int

    @property
    def name(self) -> str:
        """Of its folder."""
        return f"{self.tier}-{self.seed}"


def suite_of(seed: int) -> list[Numbered]:
    """All campaigns of a suite, tiers so mixed that every beginning has of each its share.

    Parameters
    ----------
    seed : int
        Of the tier of number 0; that of number n begins n thousand later, whatever other tiers there are.
    """
    placed = [
        ((index + 0.5) / count, Numbered(tier, seed + APART * number_of(tier) + index))
        for tier, count in sorted(CASES.items(), key=lambda pair: number_of(pair[0]))
        for index in range(count)
    ]
    return [one for _, one in sorted(placed, key=lambda pair: pair[0])]


def run_suite(
    folder: Path,
    seed: int,
    against: Against,
    *,
    cases: int | None = None,
    workers: int = 1,
    spread: Spread | None = None,
    progress: Progress | None = None,
) -> dict[str, int]:
    """Bring campaigns of a suite to their scores, those first that come first; what is there is left as it is.

    Parameters
    ----------
    folder : Path
        Gets campaigns, truths, verdicts and weights.
    seed : int
    against : callable
        See :func:`permway.challenge.weigh.weigh`.
    cases : int, optional
        How many of them; by default all.
    workers : int
        Campaigns at the same time.
    spread : callable, optional
        Does the work elsewhere; then `workers` counts for nothing.
    progress : callable, optional
        Called with campaigns done and how many there are.

    Returns
    -------
    dict
        How many have a verdict, and how many failed.

    Raises
    ------
    InputError
        If the folder holds campaigns of another suite.
    """
    mine = {one.name for one in suite_of(seed)}
    others = sorted(path.stem for path in (Path(folder) / "truth").glob("*.json") if path.stem not in mine)
    if others:
        raise InputError(
            "is of another suite", where=str(folder), value=others[0], remedy="give a folder of its own"
        )
    chosen = suite_of(seed)[:cases]
    fine = 0
    with closing(_each(Path(folder), chosen, against, workers, spread)) as each:
        for done, good in enumerate(each, start=1):
            fine += good
            if progress is not None:
                progress(done, len(chosen))
    return {"verdicts": fine, "failed": len(chosen) - fine}


def _each(
    folder: Path, chosen: list[Numbered], against: Against, workers: int, spread: Spread | None
) -> Generator[bool]:
    """Whether each campaign came to its verdict, in any order."""
    if spread is None:
        with processes(workers) as pool:
            jobs = [pool.submit(_one, folder, one, threads_of(workers), against) for one in chosen]
            for job in as_completed(jobs):
                yield job.result()
        return
    folder.mkdir(exist_ok=True)
    work = partial(_one, threads=1, against=against)
    elsewhere = ((one.name, files_of(folder, one.name), partial(work, one=one)) for one in chosen)
    for name, outcome in spread(folder, elsewhere, DONE):
        if outcome.error:
            failed = folder / "verdicts" / name / FAILED
            failed.parent.mkdir(parents=True, exist_ok=True)
            whole(failed, f"{outcome.error}\n")
        yield outcome.value is True


def files_of(folder: Path, name: str) -> list[Path]:
    """All that a folder of campaigns holds of one of them."""
    below = [path for part in (name, f"verdicts/{name}") for path in (folder / part).rglob("*")]
    beside = [folder / part / f"{name}.json" for part in ("truth", WEIGHTS)]
    return [path for path in (*below, *beside) if path.is_file()]


def _one(folder: Path, one: Numbered, threads: int, against: Against) -> bool:
    """Make, diagnose and weigh."""
    if not (folder / "truth" / f"{one.name}.json").is_file():
        make(one.seed, 1, one.tier, folder, against=against)
    verdict = folder / "verdicts" / one.name / VERDICT
    if not verdict.is_file():
        without = ruled_out(folder, one.name)
        if not diagnosed(folder / one.name, verdict.parent, threads, without=without):
            return False
    try:
        weigh_one(folder, one.name, against)
    except (InputError, SolveError) as error:
        whole(verdict.with_name(FAILED), f"weighing: {error}\n")
        return False
    return True
