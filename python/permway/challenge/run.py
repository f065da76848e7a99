"""Runs the diagnosis on a challenge's campaigns as a user would: by its commands, one process for each."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from permway.errors import InputError

VERDICT, FAILED = "verdict.json", "failed.txt"
LONGEST_S = 3600.0

Progress = Callable[[int, int], object]


def run(
    folder: Path, *, workers: int = 1, report: bool = False, progress: Progress | None = None
) -> dict[str, int]:
    """Diagnose every campaign of a folder that has no verdict yet.

    Parameters
    ----------
    folder : Path
        As :func:`permway.challenge.make.make` made it.
    workers : int
        Campaigns at the same time, each on its share of the processors.
    report : bool
        Whether to write each one's page as well.
    progress : callable, optional
        Called with campaigns done and how many there are.

    Returns
    -------
    dict
        How many have a verdict, and how many failed.

    Raises
    ------
    InputError
        If the folder holds no campaign.
    """
    folder = Path(folder)
    cases = sorted(p.parent for p in folder.glob("*/sheet.json"))
    if not cases:
        raise InputError("holds no campaign", where=str(folder), remedy="permway challenge make")
    results = folder / "verdicts"
    results.mkdir(exist_ok=True)
    threads = threads_of(workers)
    done = 0

    def one(case: Path) -> bool:
        nonlocal done
        out = results / case.name
        fine = (out / VERDICT).is_file() or diagnosed(
            case, out, threads, without=ruled_out(folder, case.name), report=report
        )
        done += 1
        if progress is not None:
            progress(done, len(cases))
        return fine

    with ThreadPoolExecutor(workers) as pool:
        fine = list(pool.map(one, cases))
    return {"verdicts": sum(fine), "failed": len(fine) - sum(fine)}


def threads_of(workers: int) -> int:
    """Each worker's share of the processors."""
    return max(1, (os.cpu_count() or 1) // workers)


def ruled_out(folder: Path, name: str) -> list[str]:
    """What the catalogue has to do without in one campaign: all that its truth states beforehand."""
    truth = folder / "truth" / f"{name}.json"
    if not truth.is_file():
        return []
    return [str(one) for one in json.loads(truth.read_text()).get("ruled_out", [])]


def diagnosed(case: Path, out: Path, threads: int, *, without: Sequence[str] = (), report: bool = False) -> bool:
    """Import and diagnose one campaign; what went wrong is kept beside where the verdict would be."""
    out.mkdir(parents=True, exist_ok=True)
    campaign = out / "campaign"
    commands = []
    if not (campaign / "campaign.toml").is_file():
        commands.append(["import", "sheet", str(case), "-o", str(campaign), "--json"])
    page = [] if report else ["--no-report"]
    page += [word for name in without for word in ("--rule-out", name)]
    commands.append(
        ["diagnose", str(campaign / "campaign.toml"), "-o", str(out), "--threads", str(threads), "--json", *page]
    )
    for command in commands:
        ended = _called(command)
        if ended.returncode != 0:
            (out / FAILED).write_text(f"permway {' '.join(command)}\n{ended.stderr[-4000:]}")
            return False
    (out / FAILED).unlink(missing_ok=True)
    output = json.loads(ended.stdout.splitlines()[-1])
    (out / "seconds.json").write_text(json.dumps(output.get("seconds", {})))
    return True


def _called(command: Sequence[str]) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.run(
        [sys.executable, "-m", "permway", *command],
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
        env=environment,
        check=False,
    )
