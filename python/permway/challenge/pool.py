"""Processes that work on campaigns side by side, and end when they have to."""

from __future__ import annotations

import os
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
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_of_a_group_of_its_own)
    # Handlers belong to the main thread.
    main = threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGTERM, _exit) if main else None
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


def _exit(*_: object) -> None:
    sys.exit(128 + signal.SIGTERM)


def _of_a_group_of_its_own() -> None:
    """Make a worker end on SIGTERM with all commands that it runs.

    An exception would not do: the pool would hand it on as the job's, and have the worker begin with the next.
    """
    if hasattr(os, "setpgrp"):
        os.setpgrp()
        signal.signal(signal.SIGTERM, _end_group)


def _end_group(*_: object) -> None:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    os.killpg(0, signal.SIGTERM)
    os._exit(128 + signal.SIGTERM)
