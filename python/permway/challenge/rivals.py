"""Answers of simpler methods on a challenge's campaigns, kept as verdicts are."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from permway.challenge.weigh import whole
from permway.errors import InputError

ANSWERS = "rivals"

Progress = Callable[[int, int], object]
Ask = Callable[[Path], Mapping[str, Any]]
"""From a campaign file to the answer of each rival."""


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
    there = {p.parent.name for p in folder.glob(f"{ANSWERS}/*/*/verdict.json")}
    todo = {name: path for name, path in campaigns.items() if name not in there}
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        jobs = {pool.submit(ask, path): name for name, path in todo.items()}
        for done, job in enumerate(as_completed(jobs), start=1):
            for rival, answer in job.result().items():
                target = folder / ANSWERS / rival / jobs[job]
                target.mkdir(parents=True, exist_ok=True)
                whole(target / "verdict.json", json.dumps(answer, indent=1) + "\n")
            if progress is not None:
                progress(done, len(todo))
    return len(campaigns)
