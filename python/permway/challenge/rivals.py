"""Answers of simpler methods on a challenge's campaigns, kept as verdicts are."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import as_completed
from pathlib import Path
from typing import Any

from permway.challenge.pool import processes
from permway.challenge.run import ruled_out
from permway.challenge.weigh import whole
from permway.errors import InputError

ANSWERS = "rivals"

Progress = Callable[[int, int], object]
Ask = Callable[[Path, Sequence[str]], Mapping[str, Any]]
"""From a campaign file, and what the catalogue has to do without, to the answer of each rival."""


def answered(folder: Path, ask: Ask, *, workers: int = 1, progress: Progress | None = None) -> int:
    """Let rivals answer on every campaign that was run and that they have not answered on.

    Parameters
    ----------
    folder : Path
        As :func:`permway.challenge.run.run` left it; gets `rivals/RIVAL/CASE/verdict.json`.
    ask : callable
    workers : int
        Processes.
    progress : callable, optional
        Called with campaigns done and how many there are.

    Returns
    -------
    int
        Campaigns that have answers.

    Raises
    ------
    InputError
        If nothing was run.
    """
    folder = Path(folder)
    campaigns = {p.parent.parent.name: p for p in sorted(folder.glob("verdicts/*/campaign/campaign.toml"))}
    if not campaigns:
        raise InputError("holds no campaign that was run", where=str(folder), remedy="permway challenge run")
    todo = [name for name in campaigns if not _there(folder, name)]
    with processes(workers) as pool:
        jobs = [pool.submit(answer, folder, name, ask) for name in todo]
        for done, job in enumerate(as_completed(jobs), start=1):
            job.result()
            if progress is not None:
                progress(done, len(todo))
    return len(campaigns)


def answer(folder: Path, name: str, ask: Ask) -> None:
    """Let rivals answer on one campaign that was run, unless they have."""
    if _there(folder, name):
        return
    campaign = folder / "verdicts" / name / "campaign" / "campaign.toml"
    for rival, said in ask(campaign, ruled_out(folder, name)).items():
        target = folder / ANSWERS / rival / name
        target.mkdir(parents=True, exist_ok=True)
        whole(target / "verdict.json", json.dumps(said, indent=1) + "\n")


def _there(folder: Path, name: str) -> bool:
    return any(folder.glob(f"{ANSWERS}/*/{name}/verdict.json"))
