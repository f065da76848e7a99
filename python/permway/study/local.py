"""Cases on this machine: a loop while there is little to do, then a process for each processor.

A small case is mostly Python and HDF5, which hold the interpreter: threads inside the core cannot hide that,
processes can. Starting them costs seconds of processor time, which a small sweep never earns back.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from permway.errors import SolveError
from permway.study.answer import CaseResult, answer_with_notes
from permway.study.file import Study

START_S = 5.0
"""What processes must save to be worth their start."""

MEASURED_S = 1.0
"""How long to measure before judging that."""

MOST_ATTEMPTS = 3
"""Processes that may die over one case before it counts as failed."""

_READY = -1


def solve_locally(study: Study, cases: Sequence[int], threads: int | None) -> Iterator[tuple[int, CaseResult]]:
    """Compute cases, in any order.

    Parameters
    ----------
    study : Study
    cases : sequence of int
        Their indices.
    threads : int, optional
        Processors to use; by default all.

    Yields
    ------
    int, CaseResult
    """
    threads = threads or _processors()
    start, done = time.monotonic(), 0
    while done < len(cases):
        yield cases[done], answer_with_notes(partial(study.model, cases[done]), study.keep, threads=threads)
        done += 1
        spent = time.monotonic() - start
        saved = spent / done * (len(cases) - done) * (1.0 - 1.0 / threads)
        if saved > START_S and spent > min(MEASURED_S, START_S):
            break
    if done < len(cases):
        yield from _Pool(study, cases[done:], threads).answers()


def _processors() -> int:
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class _Worker:
    """A process, and the case that it has under way."""

    def __init__(self, study: Study, threads: int) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process: BaseProcess = context.Process(target=_work, args=(study, theirs, threads), daemon=True)
        # Ctrl-C on a terminal goes to the whole group; a child inherits that it is held back.
        resource_tracker.ensure_running()
        with _held_back():
            self.process.start()
        theirs.close()
        self.case: int | None = None
        self.ready = False

    def kill(self) -> None:
        self.process.kill()
        self.process.join(timeout=5.0)
        self.connection.close()


class _Pool:
    """Processes that are handed one case after another; one that dies is replaced, its case tried again."""

    def __init__(self, study: Study, cases: Sequence[int], threads: int) -> None:
        self._study, self._left = study, deque(cases)
        processes = min(threads, len(cases))
        self._threads = threads // processes
        self._workers: dict[Connection, _Worker] = {}
        self._processes = processes
        self._attempts: dict[int, int] = {}

    def answers(self) -> Iterator[tuple[int, CaseResult]]:
        try:
            for _ in range(self._processes):
                self._start()
            while any(w.case is not None for w in self._workers.values()) or self._left:
                for ended in wait(list(self._workers)):
                    assert isinstance(ended, Connection)
                    yield from self._hear(self._workers[ended])
        finally:
            for worker in self._workers.values():
                worker.kill()

    def _start(self) -> None:
        worker = _Worker(self._study, self._threads)
        self._workers[worker.connection] = worker

    def _hear(self, worker: _Worker) -> Iterator[tuple[int, CaseResult]]:
        try:
            index, got = worker.connection.recv()
        except (EOFError, OSError):
            yield from self._mourn(worker)
            return
        worker.ready, worker.case = True, None
        # The next case is under way before this one is written.
        if self._left:
            worker.case = self._left.popleft()
            with suppress(OSError):
                worker.connection.send(worker.case)
        if index != _READY:
            yield index, got

    def _mourn(self, worker: _Worker) -> Iterator[tuple[int, CaseResult]]:
        del self._workers[worker.connection]
        worker.kill()
        code = worker.process.exitcode
        if not worker.ready:
            raise SolveError(
                f"a process for the cases could not start (exit code {code}); in a script of your own, call from "
                'below `if __name__ == "__main__":`, or use one thread'
            )
        if worker.case is not None:
            attempts = self._attempts[worker.case] = self._attempts.get(worker.case, 0) + 1
            if attempts < MOST_ATTEMPTS:
                self._left.append(worker.case)
            else:
                what = f"the process that computed it died, {attempts} times (exit code {code}): out of memory?"
                yield worker.case, CaseResult(error=what)
        if self._left:
            self._start()


def _work(study: Study, connection: Connection, threads: int) -> None:
    """Answer what comes down the pipe until it, or the process at its other end, is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def watch(_done: int, _total: int) -> None:
        if parent is not None and not parent.is_alive():
            os._exit(1)

    try:
        connection.send((_READY, None))
        while True:
            index = connection.recv()
            got = answer_with_notes(partial(study.model, index), study.keep, threads=threads, progress=watch)
            connection.send((index, got))
    except (EOFError, OSError):
        return


@contextmanager
def _held_back() -> Iterator[None]:
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
