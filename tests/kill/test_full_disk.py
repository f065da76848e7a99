"""A disk without room: one error that says so, and nothing half-written; what was there stays."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

resource = pytest.importorskip("resource", reason="limits of files' sizes")

EXAMPLES = Path(__file__).parents[2] / "examples"

LIMITED = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
from permway.cli import main
sys.argv[:2] = ["permway"]
main()
"""


def run(room: int, *command: str) -> subprocess.CompletedProcess[str]:
    """A command that may write no file of more bytes."""
    return subprocess.run(
        [sys.executable, "-c", LIMITED, str(room), *command],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def left(folder: Path) -> list[str]:
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file() and p.name != ".lock")


@pytest.mark.parametrize(
    "command",
    [
        ["solve", str(EXAMPLES / "hammer.toml"), "-o", "{}/response.nc"],
        ["sweep", str(EXAMPLES / "study-sample.toml"), "-o", "{}"],
    ],
    ids=lambda command: command[0],
)
def test_no_room_is_reported_and_leaves_nothing(tmp_path: Path, command: list[str]) -> None:
    ended = run(512, *(part.format(tmp_path) for part in command))
    assert ended.returncode == 2, ended.stderr
    assert "make room there, or name another place" in ended.stderr
    assert "Traceback" not in ended.stderr
    assert left(tmp_path) == []


def test_what_was_there_before_stays(tmp_path: Path) -> None:
    target = tmp_path / "response.nc"
    command = ["solve", str(EXAMPLES / "hammer.toml"), "-o", str(target)]
    assert run(100_000_000, *command).returncode == 0
    whole = target.read_bytes()
    assert len(whole) > 4096
    assert run(4096, *command).returncode == 2
    assert target.read_bytes() == whole
    assert left(tmp_path) == ["response.nc"]


def test_a_sweep_that_ran_out_of_room_goes_on_when_there_is_some(tmp_path: Path) -> None:
    """Manifest and log fit; cases do not."""
    command = ["sweep", str(EXAMPLES / "study-sample.toml"), "-o", str(tmp_path)]
    ended = run(12_000, *command)
    assert ended.returncode != 0
    assert "Traceback" not in ended.stderr
    assert not list(tmp_path.glob("*.part"))
    assert run(100_000_000, *command).returncode == 0
    assert len(list(tmp_path.glob("*.nc"))) >= 16
