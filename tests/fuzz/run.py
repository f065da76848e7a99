"""Fuzzing: valid files damaged at random, of which nothing but an `InputError` may come.

    python tests/fuzz/run.py --target readers --inputs 10000

The law for every input: a result, or an `InputError` (of the command line: exit status 2); no other exception, at
most 5 s of processor time, at most 1 GB more memory, no crash. A worker process does the work and is replaced
where it dies or hangs; what broke the law is written to the folder of findings, from where a file goes into
`tests/fuzz/corpus` once it is corrected.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import os
import resource
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

sys.path.extend([str(Path(__file__).parent), str(Path(__file__).parents[1] / "recordings")])

from hypothesis import HealthCheck, Phase, Verbosity, given, seed, settings
from targets import TARGETS, BrokenLawError, Outcome

MOST_S = 5.0
MOST_KB = 1_000_000
PATIENCE_S = 30.0
"""Of processor time: a worker that is silent for so long hangs."""

LOST_S = 1800.0
"""The same of clock, for one that waits for something; machines are busy."""

TOLD_EVERY_S = 30.0
KEPT_OF_A_KIND = 3
BATCH = 5000


def processor_s() -> float:
    """Of this process and of those that it has waited for."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def attempt(target: str, name: str, content: bytes, folder: Path) -> tuple[Outcome, str]:
    """What came of one input, and what to say of it if it broke the law."""
    begin = processor_s()
    try:
        outcome = TARGETS[target].run(name, content, folder)
        stated = ""
    except BrokenLawError as error:
        outcome, stated = "broken", str(error)
    except Exception as error:  # noqa: BLE001 - what any exception would mean is the question
        frames = traceback.extract_tb(error.__traceback__)
        own = [f for f in frames if "permway" in f.filename] or list(frames)
        at = f"{Path(own[-1].filename).name}:{own[-1].lineno}"
        outcome, stated = "broken", f"{type(error).__name__} at {at}: {str(error)[:200]}"
    if processor_s() - begin > MOST_S:
        outcome, stated = "broken", f"slow: {processor_s() - begin:.1f} s {stated}"
    return outcome, stated


def work(target: str, begin: int, inputs: int, random: int, pipe: Connection) -> None:
    """Try inputs, informative each before and after."""
    warnings.simplefilter("ignore")
    base = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with tempfile.TemporaryDirectory(prefix="permway-fuzz-") as place:
        folder = Path(place)

        @seed(random + begin)
        @settings(
            max_examples=inputs,
            database=None,
            deadline=None,
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
            verbosity=Verbosity.quiet,
        )
        @given(TARGETS[target].inputs())
        def every(made: tuple[str, bytes]) -> None:
            nonlocal base
            name, content = made
            pipe.send(("begin", name, content))
            outcome, stated = attempt(target, name, content, folder)
            taken = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            if taken > base + MOST_KB:
                outcome, stated = "broken", f"memory: {(taken - base) / 1e6:.2f} GB {stated}"
                base = taken
            pipe.send(("end", outcome, stated))

        every()
    pipe.send(("done", "", ""))


def keep(found: Path, target: str, name: str, content: bytes, stated: str) -> None:
    """Write a finding and what is wrong with it."""
    found.mkdir(parents=True, exist_ok=True)
    path = found / f"{target}-{hashlib.sha256(content).hexdigest()[:12]}-{name}"
    path.write_bytes(content)
    path.with_name(path.name + ".message").write_text(stated + "\n")


def _received(pipe: Connection, worker: int) -> tuple[str, Any, Any]:
    """The next that a worker states; or that it died, or hangs."""
    begin, spent = time.monotonic(), _spent_s(worker)
    try:
        while not pipe.poll(1.0):
            if _spent_s(worker) - spent > PATIENCE_S or time.monotonic() - begin > LOST_S:
                return "hang", "", ""
        stated: tuple[str, Any, Any] = pipe.recv()
    except EOFError:
        return "died", "", ""
    return stated


def _spent_s(process: int) -> float:
    """Processor time of another process; where the system does not tell, the clock."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return time.monotonic()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def fuzz(target: str, inputs: int, random: int, found: Path, seconds: float) -> dict[str, Any]:
    """Fuzz one target; how many inputs came to what, and the findings by kind."""
    counts: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    begin, done, last = time.monotonic(), 0, 0.0
    context = multiprocessing.get_context("spawn")
    while done < inputs and time.monotonic() - begin < seconds:
        here, there = context.Pipe()
        batch = min(BATCH, inputs - done)
        worker = context.Process(target=work, args=(target, done, batch, random, there), daemon=True)
        worker.start()
        there.close()
        before, now = done, ("", b"")
        while True:
            what, first, second = _received(here, worker.pid or 0)
            if what == "begin":
                now = (first, second)
                continue
            if what == "done":
                break
            outcome, stated = (first, second) if what == "end" else ("broken", f"{what}: exit {worker.exitcode}")
            done += 1
            counts[outcome] += 1
            if outcome == "broken":
                kind = (
                    stated.partition(":")[0] if not stated.startswith(("slow", "memory")) else stated[:6] + now[0]
                )
                kinds[kind] += 1
                if kinds[kind] <= KEPT_OF_A_KIND:
                    keep(found, target, *now, stated)
                    print(f"{target}: {now[0]}: {stated}", file=sys.stderr, flush=True)
            late = time.monotonic() - begin > seconds
            if time.monotonic() - last > TOLD_EVERY_S:
                last = time.monotonic()
                print(f"{target}: {done} of {inputs}, {dict(counts)}", file=sys.stderr, flush=True)
            if what != "end" or late:
                worker.kill()
                break
        worker.join(10.0)
        here.close()
        if done == before:
            raise SystemExit(f"{target}: the worker makes no inputs")
    return {
        "target": target,
        "inputs": done,
        **dict(sorted(counts.items())),
        "kinds": dict(kinds),
        "seconds": round(time.monotonic() - begin),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--inputs", type=int, default=1000, help="of each target")
    parser.add_argument("--target", choices=[*TARGETS, "all"], default="all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=1e9, help="most for each target")
    parser.add_argument("--found", type=Path, default=Path("fuzz-findings"), help="folder for what broke the law")
    parser.add_argument("--json", type=Path, help="file for the account")
    given = parser.parse_args()
    targets = list(TARGETS) if given.target == "all" else [given.target]
    account = [fuzz(t, given.inputs, given.seed, given.found, given.seconds) for t in targets]
    print(json.dumps(account, indent=1))
    if given.json is not None:
        given.json.write_text(json.dumps(account, indent=1) + "\n")
    sys.exit(1 if any(one.get("broken") for one in account) else 0)


if __name__ == "__main__":
    main()
