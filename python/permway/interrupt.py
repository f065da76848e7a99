"""Ctrl-C that arrives while a destructor runs: Python reports what is raised there, and drops it."""

from __future__ import annotations

import _thread
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

AGAIN_S = 0.01
"""How much later it comes again: when the destructor has ended."""


@contextmanager
def interruptible() -> Iterator[None]:
    """Within it, a KeyboardInterrupt that a destructor or a weak reference's callback drops comes again.

    Other exceptions of destructors are reported as before. Off the main thread it does nothing.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    report = sys.unraisablehook

    def again(unraisable: sys.UnraisableHookArgs) -> None:
        if not issubclass(unraisable.exc_type, KeyboardInterrupt):
            report(unraisable)
            return
        timer = threading.Timer(AGAIN_S, _thread.interrupt_main)
        timer.daemon = True
        timer.start()

    sys.unraisablehook = again
    try:
        yield
    finally:
        sys.unraisablehook = report
