"""A suite: its order, what it leaves alone, and what it writes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path

import pytest
from permway.challenge import suite as module
from permway.challenge.pool import processes
from permway.challenge.run import FAILED, VERDICT
from permway.challenge.suite import CASES, run_suite, suite_of
from permway.errors import InputError, SolveError


def test_every_beginning_has_of_each_tier_its_share() -> None:
    everything = suite_of(700000)
    assert Counter(one.tier for one in everything) == CASES
    assert len({one.name for one in everything}) == sum(CASES.values())
    assert len({one.seed for one in everything}) == sum(CASES.values())
    for count in (12, 35, 100):
        started = Counter(one.tier for one in everything[:count])
        for tier, whole in CASES.items():
            assert abs(started[tier] - count * whole / sum(CASES.values())) <= 1.0


def always(_: Path) -> Callable[[Path], float]:
    return lambda _: 77.0


def never(_: Path) -> Callable[[Path], float]:
    raise SolveError("no such model")


def finished(folder: Path, count: int) -> None:
    """Campaigns of a suite that were made and diagnosed before."""
    for one in suite_of(1)[:count]:
        verdict = folder / "verdicts" / one.name
        (verdict / "campaign").mkdir(parents=True)
        (verdict / VERDICT).write_text('{"status": "recalibrated", "effects": [], "held_out": {}}')
        (folder / "truth").mkdir(exist_ok=True)
        truth = {"effects": [], "seed": one.seed, "tier": one.tier}
        (folder / "truth" / f"{one.name}.json").write_text(json.dumps(truth))


def test_what_is_there_is_left_alone_and_only_what_was_asked_for_is_done(tmp_path: Path) -> None:
    finished(tmp_path, 3)
    seen: list[tuple[int, int]] = []
    done = run_suite(tmp_path, 1, always, cases=3, progress=lambda *at: seen.append(at))
    assert done == {"verdicts": 3, "failed": 0}
    assert seen == [(1, 3), (2, 3), (3, 3)]
    assert not list(tmp_path.glob("*/sheet.json"))


def test_a_folder_of_another_suite_is_refused(tmp_path: Path) -> None:
    finished(tmp_path, 2)
    with pytest.raises(InputError, match="of another suite"):
        run_suite(tmp_path, 100000, always, cases=2)


def interrupted(jobs: list[Future[None]]) -> None:
    """Hand out hours of work, and stop once the first has started."""
    with processes(1) as pool:
        jobs += [pool.submit(time.sleep, 3600.0) for _ in range(5)]
        while not jobs[0].running():
            time.sleep(0.01)
        raise KeyboardInterrupt


def test_on_an_interrupt_nothing_goes_on() -> None:
    """Not the job that runs, and none of those that wait; without that this test would take hours."""
    jobs: list[Future[None]] = []
    with pytest.raises(KeyboardInterrupt):
        interrupted(jobs)
    assert all(job.cancelled() or job.exception() is not None for job in jobs)


def test_on_sigterm_workers_and_commands_end_and_begin_nothing_more(tmp_path: Path) -> None:
    """A pool with jobs that wait, whose worker runs a command that would write a file after a while."""
    late = "import pathlib, sys, time; pathlib.Path(sys.argv[1]).touch(); time.sleep(3); "
    late += "pathlib.Path(sys.argv[1] + '.late').touch()"
    script = tmp_path / "script.py"
    script.write_text(
        "import os, pathlib, subprocess, sys\n"
        "from permway.challenge.pool import processes\n"
        "def work(index):\n"
        f"    folder = pathlib.Path({str(tmp_path)!r})\n"
        "    (folder / f'worker.{os.getpid()}').touch()\n"
        f"    subprocess.run([sys.executable, '-c', {late!r}, str(folder / f'job{{index}}')])\n"
        "if __name__ == '__main__':\n"
        "    with processes(1) as pool:\n"
        "        for job in [pool.submit(work, index) for index in range(4)]:\n"
        "            job.result()\n"
    )
    parent = subprocess.Popen([sys.executable, str(script)])
    while not (tmp_path / "job0").exists():
        assert parent.poll() is None
        time.sleep(0.05)
    parent.send_signal(signal.SIGTERM)
    assert parent.wait(4.0) == 128 + signal.SIGTERM
    time.sleep(4.0)
    # The pool had given the worker its next job beforehand.
    assert sorted(path.name for path in tmp_path.glob("job*")) == ["job0"]
    (worker,) = tmp_path.glob("worker.*")
    with pytest.raises(ProcessLookupError):
        os.kill(int(worker.suffix[1:]), 0)


def test_what_cannot_be_weighed_is_kept_with_its_reason(tmp_path: Path) -> None:
    finished(tmp_path, 1)
    one = suite_of(1)[0]
    truth = tmp_path / "truth" / f"{one.name}.json"
    truth.write_text(json.dumps({"effects": [{"id": "x"}], "seed": 3, "tier": "single"}))
    assert not module._one(tmp_path, one, 1, never)
    assert "no such model" in (tmp_path / "verdicts" / one.name / FAILED).read_text()
