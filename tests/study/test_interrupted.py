"""Killed and interrupted sweeps: whole files only, and the same numbers when resumed."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr
from permway.study import open_study, read_study, run_study

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals")

CASES = 400
# In processes from the second case on, so that those are killed and interrupted too.
SWEEP = "from permway.study import local; local.START_S = {start_s}; from permway.cli import main; main()"


def start(study, folder, *, start_s, threads=2, **options):
    command = [sys.executable, "-c", SWEEP.format(start_s=start_s), "sweep", str(study), "-o", str(folder)]
    return subprocess.Popen([*command, "--threads", str(threads)], text=True, start_new_session=True, **options)


def whole_files(folder):
    return {path.name: path.read_bytes() for path in folder.glob("case-*.nc")} if folder.is_dir() else {}


def wait_for(folder, count, sweep):
    end = time.monotonic() + 40.0
    while len(list(folder.glob("case-*.nc"))) < count and sweep.poll() is None and time.monotonic() < end:
        time.sleep(0.01)


@pytest.fixture(scope="module")
def undisturbed(study_in, tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed")
    path = study_in(folder, CASES // 2)
    run_study(read_study(path), folder / "out", threads=1)
    return path, whole_files(folder / "out")


def test_killed_at_any_time_and_resumed(undisturbed, tmp_path):
    path, expected = undisturbed
    folder, chance = tmp_path / "out", random.Random(4)
    kills = 0
    for round_ in range(5):
        sweep = start(path, folder, start_s=1e9 if round_ % 2 else 0.0)
        # Somewhere in the start, or when some further cases are there.
        wait_for(folder, len(whole_files(folder)) + chance.choice([0, 2, 5, 9]), sweep)
        time.sleep(chance.uniform(0.0, 0.2))
        if sweep.poll() is None:
            kills += 1
            os.kill(sweep.pid, signal.SIGKILL)
        sweep.wait(timeout=30)
        there = whole_files(folder)
        assert all(expected[name] == content for name, content in there.items())
    assert kills >= 4
    assert len(there) > 0
    done = run_study(read_study(path), folder, threads=1)
    assert (done.failed, done.already_there) == ({}, len(there))
    assert whole_files(folder) == expected
    assert {p.name for p in folder.iterdir()} - set(expected) == {".lock", "study.json"}
    xr.testing.assert_identical(open_study(folder).compute(), open_study(path.parent / "out").compute())


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="looks for processes in /proc")
def test_processes_do_not_outlive_the_sweep(study_file, tmp_path):
    sweep = start(study_file(500), tmp_path / "out", start_s=0.0)
    wait_for(tmp_path / "out", 3, sweep)
    tasks = Path(f"/proc/{sweep.pid}/task/{sweep.pid}/children")
    children = [Path(f"/proc/{child}") for child in tasks.read_text().split()]
    assert len(children) >= 2
    os.kill(sweep.pid, signal.SIGKILL)
    sweep.wait(timeout=30)
    end = time.monotonic() + 10.0
    while any(alive(child) for child in children) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(alive(child) for child in children)


def alive(process):
    """Whether a process runs on; one that only waits to be reaped does not."""
    try:
        return (process / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize(("start_s", "threads"), [(0.0, 2), (1e9, 1)], ids=["processes", "loop"])
def test_ctrl_c(start_s, threads, undisturbed, tmp_path):
    """As from a terminal, which sends it to the whole group of processes."""
    path, expected = undisturbed
    folder = tmp_path / "out"
    sweep = start(path, folder, start_s=start_s, threads=threads, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    wait_for(folder, 5, sweep)
    pressed = time.monotonic()
    os.killpg(sweep.pid, signal.SIGINT)
    out, err = sweep.communicate(timeout=30)
    assert time.monotonic() - pressed < 1.0
    assert (sweep.returncode, out, err) == (130, "", "permway: interrupted\n")
    there = whole_files(folder)
    assert 5 <= len(there) < CASES
    assert {p.name for p in folder.iterdir()} == {".lock", "study.json", *there}
    done = run_study(read_study(path), folder, threads=1)
    assert done.already_there == len(there)
    assert whole_files(folder) == expected
