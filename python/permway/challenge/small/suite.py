"""The suite of small campaigns: made, diagnosed, scored; what is there is left as it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import as_completed
from functools import partial
from pathlib import Path

from permway.challenge.pool import processes
from permway.challenge.small.diagnose import LIMIT_S, diagnose_all
from permway.challenge.small.fixture import FIXTURE, fixture_names, make_fixture
from permway.challenge.small.make import make_small, name_of
from permway.challenge.small.passages import CASES as OF_PASSAGES
from permway.challenge.small.passages import make_passages
from permway.challenge.small.passages import name_of as name_of_passages
from permway.challenge.small.passages_drawn import PASSAGES
from permway.challenge.suite import DONE, Spread, files_of
from permway.errors import InputError, SolveError

TIERS = ("small", FIXTURE, PASSAGES)
"""Tiers of this suite."""

CASES = 1000
"""Small campaigns of a suite, unless others are asked for."""

EACH = 10
"""Campaigns of one piece of work that goes elsewhere, lost with a machine at most. Importing the method takes as
long as a third of a diagnosis."""

Progress = Callable[[str, int, int], object]


def names_of(tiers: Sequence[str], seed: int, cases: int | None) -> list[str]:
    """Folders of a suite's campaigns.

    Raises
    ------
    InputError
        For a tier that is none of these.
    """
    found: list[str] = []
    for tier in tiers:
        if tier not in TIERS:
            raise InputError("is no tier of this suite", where="--tiers", value=tier, remedy=str(list(TIERS)))
        if tier == FIXTURE:
            found += fixture_names()[:cases]
        elif tier == PASSAGES:
            found += [name_of_passages(seed, index) for index in range(OF_PASSAGES if cases is None else cases)]
        else:
            found += [name_of(seed, index) for index in range(CASES if cases is None else cases)]
    return found


def run_small(
    folder: Path,
    tiers: Sequence[str],
    seed: int,
    *,
    cases: int | None = None,
    workers: int = 1,
    method: str | None = None,
    limit_s: float = LIMIT_S,
    spread: Spread | None = None,
    progress: Progress | None = None,
) -> list[str]:
    """Make and diagnose the campaigns of a suite; their names.

    Parameters
    ----------
    folder : Path
        Gets campaigns, `truth/`, `weights/` and `verdicts/`.
    tiers : sequence of str
        Of :data:`TIERS`.
    seed : int
    cases : int, optional
        Of each tier; by default 1,000 small ones, all 40 of the fixture, and 40 with passages.
    workers : int
        Processes.
    method : str, optional
        See :func:`permway.challenge.small.diagnose.interpreter_of`.
    limit_s : float
        Processor time of each diagnosis.
    spread : callable, optional
        See :data:`permway.challenge.suite.Spread`; of this installation's method alone.
    progress : callable, optional
        Called with the stage, campaigns done and how many there are.

    Raises
    ------
    SolveError
        If work that went elsewhere failed there; what came back is kept.
    """
    folder = Path(folder)
    names = names_of(tiers, seed, cases)
    if spread is not None:
        _elsewhere(folder, names, limit_s, spread, progress)
        return names
    missing = [name for name in names if not (folder / "truth" / f"{name}.json").is_file()]
    if missing:
        with processes(workers) as pool:
            jobs = [pool.submit(made, folder, name) for name in missing]
            for done, job in enumerate(as_completed(jobs), start=1):
                job.result()
                if progress is not None:
                    progress("making", done, len(missing))
    diagnose_all(
        [(folder / name / "campaign.toml", folder / "verdicts" / name) for name in names],
        method=method,
        workers=workers,
        limit_s=limit_s,
        progress=None if progress is None else lambda done, of: progress("diagnosing", done, of),
    )
    return names


def made(folder: Path, name: str) -> str:
    """Make the campaign of that name."""
    tier, *rest = name.split("-")
    if tier == FIXTURE:
        return make_fixture(name, folder)
    seed, index = rest
    return (make_passages if tier == PASSAGES else make_small)(int(seed), int(index), folder)


def _elsewhere(
    folder: Path, names: Sequence[str], limit_s: float, spread: Spread, progress: Progress | None
) -> None:
    """Make and diagnose on other machines what has no verdict and no failure yet."""
    left = [name for name in names if not _done(folder, name)]
    parts = [left[first : first + EACH] for first in range(0, len(left), EACH)]
    jobs = (
        (part[0], [path for name in part for path in files_of(folder, name)], partial(_whole, part, limit_s))
        for part in parts
    )
    sizes, done, failures = {part[0]: len(part) for part in parts}, len(names) - len(left), []
    folder.mkdir(exist_ok=True)
    for name, outcome in spread(folder, jobs, DONE):
        done += sizes[name]
        if outcome.error:
            failures.append(f"{name}: {outcome.error}")
        if progress is not None:
            progress("made and diagnosed", done, len(names))
    if failures:
        raise SolveError(f"{len(failures)} pieces of work failed, call again to repeat them; {failures[0]}")


def _done(folder: Path, name: str) -> bool:
    verdicts = folder / "verdicts" / name
    judged = (verdicts / "verdict.json").is_file() or (verdicts / "failed.txt").is_file()
    return judged and (folder / "truth" / f"{name}.json").is_file()


def _whole(names: Sequence[str], limit_s: float, folder: Path) -> None:
    for name in names:
        made(folder, name)
    diagnose_all([(folder / n / "campaign.toml", folder / "verdicts" / n) for n in names], limit_s=limit_s)
