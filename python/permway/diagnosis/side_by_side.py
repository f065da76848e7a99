"""Independent pieces of work, shared between this process and others that are forked from it.

A fork knows all that is known here, and nothing has to be handed to it; what comes back are its results alone.
What it has kept for later is lost with it. Where processes cannot be forked safely (BLAS of macOS, Windows) all is
done here, and so it is with one thread: what comes out is the same.
"""

from __future__ import annotations

import os
import signal
import sys
import warnings
from collections.abc import Callable, Sequence
from contextlib import contextmanager
from multiprocessing import current_process, get_context
from multiprocessing.connection import Connection
from multiprocessing.context import ForkProcess
from typing import TYPE_CHECKING, Any, TypeVar

from threadpoolctl import threadpool_limits

from permway.errors import SolveError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from multiprocessing.sharedctypes import Synchronized

MOST = 8
"""Processes: each writes to some hundred megabytes of what it shares with the others, which are its own then."""

SMALL = 8
"""Items of some milliseconds that are worth a process."""

Item = TypeVar("Item")
Result = TypeVar("Result")

Started = Callable[[int], object]
"""Called with how many items are started."""

_shared = False
"""Whether this process shares its work already, or is such a fork itself."""


def each(
    work: Callable[[Item], Result],
    items: Sequence[Item],
    *,
    threads: int | None,
    least: int = 1,
    progress: Started = lambda started: None,
) -> list[Result]:
    """What `work` makes of each item, in their order.

    Parameters
    ----------
    work : callable
        What it does beside its result is lost, or done; its result can be pickled.
    items : sequence
    threads : int, optional
        Processes, :data:`MOST` at most; by default as many as there are processors for this one.
    least : int
        Items that each process should have: a fork costs some tens of milliseconds.
    progress : callable
        Called with how many are started, whenever one is started here.

    Raises
    ------
    Exception
        The first that a piece of work raises; the other processes are ended.
    SolveError
        If a process ends without a word, as one does that the system stops for its memory.
    """
    others = min(_processors() if threads is None else threads, len(items) // least, MOST) - 1
    # A daemon, as those of multiprocessing's pools are, may have no processes of its own.
    if others < 1 or _shared or sys.platform != "linux" or current_process().daemon:
        found = []
        for index, item in enumerate(items):
            progress(index)
            found.append(work(item))
        return found
    with _sharing():
        return _forked(work, items, others, progress)


@contextmanager
def one_thread_of_blas() -> Iterator[None]:
    """Within it, or of a function that it decorates, BLAS has one thread, as it has in each process.

    Its products here are small: more threads wait for each other longer than they work, and in several processes
    for the processors, too.
    """
    with threadpool_limits(1, user_api="blas"):
        yield


def threads_of_solver(threads: int | None) -> int | None:
    """Of the solver: one while processes share the work."""
    return 1 if _shared else threads


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def _sharing() -> Iterator[None]:
    global _shared
    _shared = True
    try:
        yield
    finally:
        _shared = False


def _forked(work: Callable[[Item], Result], items: Sequence[Item], others: int, progress: Started) -> list[Result]:
    context = get_context("fork")
    started: Synchronized[int] = context.Value("i", 0)
    processes: list[ForkProcess] = []
    ends: list[Connection[Any, Any]] = []
    try:
        for _ in range(others):
            here, there = context.Pipe(duplex=False)
            process = context.Process(target=_serve, args=(work, items, started, there), daemon=True)
            with warnings.catch_warnings():
                # Further threads are those of BLAS, which ends them before a fork.
                warnings.simplefilter("ignore", DeprecationWarning)
                process.start()
            there.close()
            processes.append(process)
            ends.append(here)
        found = _taken(work, items, started, progress)
        for end in ends:
            try:
                theirs, error = end.recv()
            except EOFError:
                raise SolveError(
                    "a process that took part in the work ended before it was done; if memory ran out, "
                    "--threads 1 does all in one"
                ) from None
            if error is not None:
                raise error
            found |= theirs
    finally:
        for process in processes:
            process.kill()
            process.join()
    return [found[index] for index in range(len(items))]


def _taken(
    work: Callable[[Item], Result],
    items: Sequence[Item],
    started: Synchronized[int],
    progress: Started = lambda started: None,
) -> dict[int, Result]:
    """One item after another, until all are taken by somebody."""
    found: dict[int, Result] = {}
    while True:
        with started.get_lock():
            index = started.value
            started.value += 1
        if index >= len(items):
            return found
        progress(index)
        found[index] = work(items[index])


def _serve(
    work: Callable[[Item], Result], items: Sequence[Item], started: Synchronized[int], end: Connection[Any, Any]
) -> None:
    """In a process of its own."""
    # On Ctrl-C the one that waits ends this one, too.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    try:
        end.send((_taken(work, items, started), None))
    except Exception as error:  # noqa: BLE001 - handed on, whatever it is
        end.send(({}, error))
