"""Processes that work on campaigns side by side, and end when they are told to."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context


@contextmanager
def processes(workers: int) -> Iterator[ProcessPoolExecutor]:
    """A pool of processes; on Ctrl-C, SIGTERM or any error, what waits is dropped and what runs is ended.

    Left to itself a pool would first finish everything that was given to it.

    Parameters
    ----------
    workers : int
    """
    others = set(active_children())
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_end_when_told)
    # Handlers belong to the main thread.
    before = _end_when_told() if threading.current_thread() is threading.main_thread() else None
    try:
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for child in set(active_children()) - others:
            child.terminate()
        raise
    finally:
        if before is not None:
            signal.signal(signal.SIGTERM, before)
    pool.shutdown()


def _end_when_told() -> signal._HANDLER:
    """Make SIGTERM an exit of Python's, on which the commands that run below are ended, too."""
    return signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
