"""Diagnoses campaigns one after the other, in an interpreter that has permway: this installation, or another.

    python alone.py LIMIT_S

Reads lines `campaign.toml <tab> output folder`, answers each with one line, and ends with its input. It uses only
`read_campaign`, `diagnose` and the verdict's `write`, which every version from b291bce on has, so that a frozen
method can be run on the same campaigns.
"""

from __future__ import annotations

import importlib
import json
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any


class TimeUp(BaseException):
    """The processor time of one campaign is used up; no handler of exceptions in between takes it."""


def main() -> None:
    """Answer line by line."""
    sys.stdin.reconfigure(encoding="utf-8")  # type: ignore[union-attr]
    limit = float(sys.argv[1])
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGPROF, _up)
    # Whatever a library prints must not be taken for an answer.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    for line in sys.stdin:
        campaign, out = line.rstrip("\n").split("\t")
        answers.write(_diagnosed(Path(campaign), Path(out), limit) + "\n")
        answers.flush()


def _up(*_: object) -> None:
    raise TimeUp


def _diagnosed(campaign: Path, out: Path, limit: float) -> str:
    """Write the verdict, or why there is none, and what it cost."""
    read_campaign, diagnose = _reader(), _method()
    out.mkdir(parents=True, exist_ok=True)
    began, processor, failure = time.perf_counter(), _processor(), ""
    _forget_peak()
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        verdict = diagnose(read_campaign(campaign), threads=1).verdict
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        verdict.write(out / "verdict.json")
    except TimeUp:
        failure = f"TimeUp: no verdict after {limit:g} s of processor"
    except Exception as error:  # noqa: BLE001 whatever a method fails with is counted, and reported
        failure = f"{type(error).__name__}: {error}\n{traceback.format_exc(limit=-6)}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    cost = {
        "processor_s": round(_processor() - processor, 3),
        "wall_s": round(time.perf_counter() - began, 3),
        "peak_MB": round(_peak_MB(), 1),
    }
    _whole(out / "cost.json", json.dumps(cost) + "\n")
    _whole(out / "seconds.json", json.dumps({"diagnosis": cost["processor_s"]}) + "\n")
    if failure:
        _whole(out / "failed.txt", failure + "\n")
    return "failed" if failure else "verdict"


def _reader() -> Callable[[Path], Any]:
    """The function that reads a campaign: its module has another name in the frozen version b291bce."""
    try:
        from permway.campaign.campaign import read_campaign
    except ModuleNotFoundError:
        older: Callable[[Path], Any] = importlib.import_module("permway.recordings.campaign").read_campaign
        return older
    return read_campaign


def _method() -> Callable[..., Any]:
    """What `permway diagnose` of that version calls: older ones have another method, in a module of its own."""
    try:
        found: Callable[..., Any] = importlib.import_module("permway.diagnosis.diagnose").diagnose
    except ModuleNotFoundError:
        from permway.posterior.diagnose import diagnose

        return diagnose
    return found


def _whole(path: Path, text: str) -> None:
    beside = path.with_name(path.name + ".part")
    beside.write_text(text, encoding="utf-8")
    beside.replace(path)


def _processor() -> float:
    return sum(sum(resource.getrusage(of)[:2]) for of in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def _forget_peak() -> None:
    """Begin a campaign's own peak of memory, where the system can."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return


def _peak_MB() -> float:
    try:
        status = Path("/proc/self/status").read_text()
        return float(status.split("VmHWM:")[1].split()[0]) / 1024.0
    except (OSError, IndexError):
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


if __name__ == "__main__":
    main()
