"""A disk that is full: one clear error, status 2, nothing half-written. A limit on files' size plays its part."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from permway.demo.run import campaign_files
from permway.study import read_study, run_study

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="limits of a process")

LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_FSIZE, ({bytes}, {bytes}))
from permway.cli import main
main()
"""
MODEL = """
[frequencies]
from_Hz = 1.0
to_Hz = 1000.0
points = POINTS
[line]
bodies = { block = { type = "mass", mass_kg = 100.0 } }
laws = { spring = { type = "hysteretic", stiffness = 4e6, loss_factor = 0.1 } }
joints = [{ between = ["block", "ground"], law = "spring", at = [0.0] }]
[[forces]]
body = "block"
x_m = 0.0
[[sensors]]
body = "block"
x_m = 0.0
"""


def limited(size: int, *arguments: object, folder: Path) -> str:
    """What a command states that may write files of so many bytes at most."""
    command = [sys.executable, "-c", LIMITED.format(bytes=size), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, cwd=folder)
    assert (done.returncode, done.stdout) == (2, ""), done.stderr
    assert done.stderr.count("\n") == 1, done.stderr
    assert done.stderr.startswith("permway: ")
    return done.stderr


def all_files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def test_solve(tmp_path: Path) -> None:
    """Nothing is written, and an older answer stays."""
    (tmp_path / "model.toml").write_text(MODEL.replace("POINTS", "4000"))
    (tmp_path / "older.nc").write_bytes(b"older")
    for name in ("answer.nc", "older.nc"):
        stated = limited(50_000, "solve", "model.toml", "-o", name, folder=tmp_path)
        assert f"{name}: cannot be written" in stated
    assert (tmp_path / "older.nc").read_bytes() == b"older"
    assert all_files(tmp_path) == {"model.toml", "older.nc"}


def test_sweep_goes_on_when_there_is_room_again(tmp_path: Path) -> None:
    (tmp_path / "model.toml").write_text(MODEL.replace("POINTS", "500"))
    axis = '[axes.loss]\npath = "line.laws.spring.loss_factor"\nvalues = [0.1, 0.2, 0.3]\n'
    (tmp_path / "study.toml").write_text('model = "model.toml"\n' + axis)
    stated = limited(8_000, "sweep", "study.toml", "-o", "out", folder=tmp_path)
    assert "cannot be written" in stated
    assert all_files(tmp_path / "out") == {".lock", "study.json"}
    done = run_study(read_study(tmp_path / "study.toml"), tmp_path / "out", threads=1)
    assert (done.computed, done.failed) == (3, {})


def test_demo(tmp_path: Path) -> None:
    assert len(campaign_files()["hammer_+12C.mat"]) > 10_000
    stated = limited(10_000, "demo", "-o", "demo", "--no-open", folder=tmp_path)
    assert "hammer_+12C.mat: cannot be written" in stated
    assert not any(name.endswith(".part") for name in all_files(tmp_path))
