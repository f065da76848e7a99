"""Ctrl-C that arrives in a destructor, where Python drops what is raised."""

import subprocess
import sys
import weakref

import pytest
from permway.interrupt import interruptible

DROPPED = """
import os, signal, time, weakref
from permway.interrupt import interruptible

class Body:
    pass

{how}
# What started the tests may have had Ctrl-C ignored, as a shell does for jobs in the background.
signal.signal(signal.SIGINT, signal.default_int_handler)
try:
    with interruptible():
        drop()
        while True:
            time.sleep(0.001)
except KeyboardInterrupt:
    print("unwound")
"""

DESTRUCTOR = """
def drop():
    Body.__del__ = lambda self: os.kill(os.getpid(), signal.SIGINT)
    body = Body()
    del body
"""

CALLBACK = """
def drop():
    body = Body()
    watch = weakref.ref(body, lambda _: os.kill(os.getpid(), signal.SIGINT))
    del body
"""


@pytest.mark.parametrize("how", [DESTRUCTOR, CALLBACK], ids=["destructor", "callback"])
def test_comes_again(how):
    script = [sys.executable, "-c", DROPPED.format(how=how)]
    ended = subprocess.run(script, timeout=30, capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "unwound\n", "")


def test_other_faults_of_destructors_are_reported(monkeypatch):
    reported = []
    monkeypatch.setattr(sys, "unraisablehook", reported.append)
    before = sys.unraisablehook

    class Body:
        pass

    with interruptible():
        body = Body()
        watch = weakref.ref(body, lambda _: 1 / 0)
        del body
    assert [r.exc_type for r in reported] == [ZeroDivisionError]
    assert sys.unraisablehook is before
    assert watch() is None
