"""Killed while it writes: what is there is whole, and what was left is taken away. Sweeps: see `tests/study`."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from permway.challenge.small.make import make_small
from permway.files import LEFT_BEHIND_S, prepare_folder

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals")

KILLED_AT_THE_WORST = """
import os, signal, sys
from pathlib import Path
from permway import files
os.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
files.write_text(Path(sys.argv[1]), "new" * 100_000)
"""


@pytest.mark.parametrize("older", [None, "older"])
def test_killed_between_writing_and_naming(tmp_path: Path, older: str | None) -> None:
    path = tmp_path / "verdict.json"
    if older is not None:
        path.write_text(older)
    done = subprocess.run([sys.executable, "-c", KILLED_AT_THE_WORST, str(path)], timeout=60, check=False)
    assert done.returncode == -signal.SIGKILL
    assert path.exists() == (older is not None)
    assert older is None or path.read_text() == older
    (left,) = (p for p in tmp_path.iterdir() if p != path)
    prepare_folder(tmp_path, ["verdict.json"])
    # It may be another's, at work just now.
    assert left.exists()
    long_ago = time.time() - LEFT_BEHIND_S - 1.0
    os.utime(left, (long_ago, long_ago))
    prepare_folder(tmp_path, ["report.html"])
    assert left.exists()
    prepare_folder(tmp_path, ["verdict.json", "report.html"])
    assert not left.exists()


def test_a_diagnosis_killed_at_work_goes_on_where_it_was(tmp_path: Path) -> None:
    campaign = tmp_path / "made" / make_small(5150004, 0, tmp_path / "made") / "campaign.toml"
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    folder = tmp_path / "diagnosis"
    command = [sys.executable, "-m", "permway", "diagnose", str(campaign), "-o", str(folder)]
    command += ["--threads", "1", "--no-report"]
    environment = {**os.environ, "TMPDIR": str(scratch)}
    process = subprocess.Popen(command, env=environment)
    steps = folder / "unfinished"
    end = time.monotonic() + 90.0
    while not list(steps.glob("step-*.npz")) and time.monotonic() < end:
        time.sleep(0.05)
    assert process.poll() is None
    process.kill()
    process.wait(30)
    assert [path.name for path in folder.iterdir()] == ["unfinished"]
    assert list(scratch.iterdir()) == []
    kept = {path: path.stat().st_mtime_ns for path in steps.glob("step-*.npz")}
    # In the same folder it goes on: what was kept is not written again.
    process = subprocess.Popen(command, env=environment)
    while len(list(steps.glob("step-*.npz"))) <= len(kept) and process.poll() is None:
        time.sleep(0.05)
    assert kept == {path: path.stat().st_mtime_ns for path in kept}
    assert process.wait(240) == 0
    assert (folder / "verdict.json").is_file()
    assert not steps.exists()
    assert list(scratch.iterdir()) == []
