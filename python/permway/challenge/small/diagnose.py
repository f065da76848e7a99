"""Diagnoses small campaigns, many to a process: importing a method takes longer than most of its verdicts."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue

from permway.challenge.small import alone
from permway.challenge.weigh import whole
from permway.errors import InputError

LIMIT_S = 120.0
"""Processor time of one diagnosis, s: forty times what one should take. Above it a campaign counts as failed. At
half of it a few more of a hundred do; at twice it few fewer, and a suite may take an hour more."""

EACH = 40
"""Campaigns to a process, which bounds what memory it gathers: at a tenth importing costs a tenth of the time."""

SILENT_S = 20.0 * LIMIT_S
"""Wall time without an answer after which a process is taken for dead: the machine may have much else to do."""

Progress = Callable[[int, int], object]


def interpreter_of(method: str | None) -> list[str]:
    """The command that runs a script where a method is installed.

    Parameters
    ----------
    method : str, optional
        An executable `permway`, or a command that ends in `-m permway`, as
        "env PYTHONPATH=elsewhere/python python -m permway"; by default this installation.

    Raises
    ------
    InputError
        If it is neither.
    """
    if method is None:
        return [sys.executable]
    words = shlex.split(method)
    if words[-2:] == ["-m", "permway"] and len(words) > 2:
        return words[:-2]
    path = Path(words[0]) if len(words) == 1 else Path()
    try:
        first = path.read_bytes()[:200].split(b"\n")[0].decode("utf-8", "replace") if path.is_file() else ""
    except OSError:
        first = ""
    if first.startswith("#!"):
        return shlex.split(first[2:])
    raise InputError(
        "is no installation of permway",
        where="--diagnose",
        value=method,
        remedy="give the script `permway` of its environment, or a command that ends in `-m permway`",
    )


def diagnose_all(
    jobs: Sequence[tuple[Path, Path]],
    *,
    method: str | None = None,
    workers: int = 1,
    limit_s: float = LIMIT_S,
    progress: Progress | None = None,
) -> None:
    """Diagnose campaigns that have neither verdict nor failure yet.

    Parameters
    ----------
    jobs : sequence of (campaign.toml, output folder)
    method : str, optional
        See :func:`interpreter_of`.
    workers : int
        Processes.
    limit_s : float
        Processor time of each.
    progress : callable, optional
        Called with campaigns done and how many there are.
    """
    command = interpreter_of(method)
    waiting: SimpleQueue[tuple[Path, Path]] = SimpleQueue()
    done = 0
    for job in jobs:
        if (job[1] / "verdict.json").is_file() or (job[1] / "failed.txt").is_file():
            done += 1
        else:
            waiting.put(job)
    finished: SimpleQueue[BaseException | None] = SimpleQueue()
    running: list[_Process] = []
    stop = threading.Event()

    def work() -> None:
        try:
            process = None
            while not stop.is_set():
                try:
                    campaign, out = waiting.get_nowait()
                except Empty:
                    break
                if process is None or process.left == 0:
                    if process is not None:
                        process.end()
                    process = _Process(command, limit_s, own=method is None)
                    running.append(process)
                if not process.answered(campaign, out):
                    process = None
                finished.put(None)
            if process is not None:
                process.end()
        except BaseException as error:  # noqa: BLE001 handed to the thread that waits
            finished.put(error)

    threads = [threading.Thread(target=work, daemon=True) for _ in range(workers)]
    left = len(jobs) - done
    for thread in threads:
        thread.start()
    try:
        while left:
            try:
                # A wait without end would not be interrupted everywhere.
                error = finished.get(timeout=0.5)
            except Empty:
                continue
            if error is not None:
                raise error
            left, done = left - 1, done + 1
            if progress is not None:
                progress(done, len(jobs))
    finally:
        stop.set()
        if left:
            for process in running:
                process.kill()
    for thread in threads:
        thread.join()


class _Process:
    """An interpreter that diagnoses one campaign after the other."""

    def __init__(self, command: Sequence[str], limit_s: float, *, own: bool) -> None:
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        if not own:
            # Of this installation; another's is in its own command.
            environment.pop("PYTHONPATH", None)
        self.left = EACH
        self._process = subprocess.Popen(
            [*command, "-P", str(Path(alone.__file__)), f"{limit_s:g}"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env=environment,
            # Ctrl-C goes to all of a terminal's group: this one is ended by whoever began it.
            start_new_session=True,
        )

    def answered(self, campaign: Path, out: Path) -> bool:
        """Have a campaign diagnosed; whether the process lives on."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self.left -= 1
        timer = threading.Timer(SILENT_S, self.kill)
        timer.start()
        try:
            self._process.stdin.write(f"{campaign.absolute()}\t{out.absolute()}\n")
            self._process.stdin.flush()
            answer = self._process.stdout.readline()
        except (BrokenPipeError, ValueError):
            answer = ""
        finally:
            timer.cancel()
        if answer or self._killed:
            return bool(answer)
        self.end()
        out.mkdir(parents=True, exist_ok=True)
        whole(out / "failed.txt", f"ProcessDied: the interpreter ended with status {self._process.returncode}\n")
        return False

    _killed = False

    def end(self) -> None:
        """Let it end by itself."""
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            with suppress(BrokenPipeError):
                pipe.close()
        self._process.wait()

    def kill(self) -> None:
        """End it now."""
        self._killed = True
        self._process.kill()
        self._process.wait()
