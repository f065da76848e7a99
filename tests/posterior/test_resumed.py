"""A diagnosis that is stopped and begun again: the same verdict, and nothing done twice."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.diagnosis.catalogue import entries
from permway.diagnosis.catalogue._interval import weakened
from permway.posterior import beam, cells, screening
from permway.posterior.diagnose import diagnose
from permway.posterior.journal import FOLDER, Journal, keeping, kept_table, kept_trials, key_of
from simulated import simulate

FEW = {"fastener_loss", "sensor_gain"}
"""Effects that are tried, so that it takes a second or two."""

OTHERS = tuple(sorted(set(entries()) - FEW))


class StoppedError(Exception):
    """By the user, before a step."""


class Steps:
    """Counts the long steps that are taken, and stops before one of these."""

    def __init__(self, stop: int | None = None) -> None:
        self.taken, self.stop = 0, stop

    def counted(self, kept: Callable[..., Any]) -> Callable[..., Any]:
        """A journal's function, what it is to take counted."""

        def counting(take: Callable[[], Any], *given: Any) -> Any:
            return kept(lambda: self._take(take), *given)

        return counting

    def _take(self, take: Callable[[], Any]) -> Any:
        if self.taken == self.stop:
            raise StoppedError
        self.taken += 1
        return take()


@pytest.fixture
def counting(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Steps]:
    monkeypatch.setattr(cells, "BESIDE", {})

    def count(stop: int | None = None) -> Steps:
        steps = Steps(stop)
        monkeypatch.setattr(beam, "kept_trials", steps.counted(kept_trials))
        monkeypatch.setattr(screening, "kept_table", steps.counted(kept_table))
        return steps

    return count


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    folder = tmp_path_factory.mktemp("made") / "c"
    return simulate(folder, 41, amend=lambda c: weakened(c, "pad", 6.0, 1.2, 0.3)).campaign


def test_a_stopped_diagnosis_goes_on_and_states_the_same_to_the_last_bit(
    campaign: Campaign, tmp_path: Path, counting: Callable[..., Steps]
) -> None:
    folder, key = tmp_path / FOLDER, key_of(campaign, OTHERS)
    whole = counting()
    verdict = diagnose(campaign, threads=1, ruled_out=OTHERS).verdict
    assert verdict.status == "named"
    half = whole.taken // 2
    assert half > 1
    counting(half)
    with keeping(folder, key), pytest.raises(StoppedError):
        diagnose(campaign, threads=1, ruled_out=OTHERS)
    assert len(list(folder.iterdir())) == half
    after = counting()
    with keeping(folder, key) as journal:
        again = diagnose(campaign, threads=1, ruled_out=OTHERS).verdict
        assert journal.recalled == half
        journal.close()
    assert again.to_json() == verdict.to_json()
    assert after.taken == whole.taken - half
    assert not folder.exists()


def test_another_record_code_or_choice_is_another_diagnosis(
    campaign: Campaign, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key = key_of(campaign)
    assert key == key_of(campaign)
    assert key != key_of(campaign, ("sensor_gain",))
    copy = tmp_path / "copy"
    copy.mkdir()
    for path in campaign.folder.iterdir():
        if path.is_file():
            (copy / path.name).write_bytes(path.read_bytes())
    other = read_campaign(copy / "campaign.toml")
    assert key_of(other) == key
    record = other.path(other.stated.records[0])
    record.write_bytes(record.read_bytes() + b" ")
    assert key_of(other) != key
    monkeypatch.setattr("permway.posterior.journal._made_by", lambda: ("another numpy",))
    assert key_of(campaign) != key


def test_a_step_is_recalled_for_what_it_was_given_only(tmp_path: Path) -> None:
    first = Journal(tmp_path / "steps", "key")
    for value in (1.0, 2.0, 3.0):
        assert first.recall("step", np.array([value])) is None
        first.keep({"found": np.array([10.0 * value])})
    second = Journal(tmp_path / "steps", "key")
    found = second.recall("step", np.array([1.0]))
    assert found is not None
    assert found["found"].tolist() == [10.0]
    # From where it was given something else, nothing that follows is the same step.
    assert second.recall("step", np.array([2.5])) is None
    assert second.recall("step", np.array([3.0])) is None
    assert Journal(tmp_path / "steps", "another").recall("step", np.array([1.0])) is None


@pytest.mark.parametrize("spoil", [lambda b: b[: len(b) // 2], lambda _: b"", lambda b: b[:200] + b"\0" + b[201:]])
def test_a_file_that_is_not_whole_is_no_step(tmp_path: Path, spoil: Callable[[bytes], bytes]) -> None:
    journal = Journal(tmp_path / "steps", "key")
    journal.recall("step")
    journal.keep({"found": np.arange(1.0, 1000.0)})
    (path,) = (tmp_path / "steps").iterdir()
    assert Journal(tmp_path / "steps", "key").recall("step") is not None
    path.write_bytes(spoil(path.read_bytes()))
    assert Journal(tmp_path / "steps", "key").recall("step") is None


@pytest.mark.skipif(sys.platform != "linux", reason="reads the processor time of another process from /proc")
def test_ctrl_c_ends_the_command_at_once_and_the_same_command_goes_on(campaign: Campaign, tmp_path: Path) -> None:
    out = tmp_path / "out"
    steps, printed = out / FOLDER, tmp_path / "printed"
    # A program that is started in the background ignores SIGINT, and what it starts inherits that.
    start = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    start += "from permway.posterior import cells; cells.BESIDE.clear(); import permway.__main__"
    asked = ["diagnose", str(campaign.folder / campaign.file), "-o", str(out), "--no-report"]
    command = [sys.executable, "-c", start, *asked, *(word for name in OTHERS for word in ("--rule-out", name))]
    with printed.open("w") as file:
        process = subprocess.Popen(command, stdout=file, stderr=file)
    while not list(steps.glob("step-*.npz")):
        assert process.poll() is None, printed.read_text()
        time.sleep(0.01)
    used = processor_s(process.pid)
    process.send_signal(signal.SIGINT)
    # It has ended, and what it used can still be read: its own, for its children's counts from their beginning.
    os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
    # Of processor, for others may be busy on this machine.
    assert processor_s(process.pid) - used < 1.0
    assert process.wait() == 130
    assert printed.read_text().splitlines() == ["permway: interrupted"]
    assert not (out / "verdict.json").exists()
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    assert (out / "verdict.json").is_file()
    assert not steps.exists()


def processor_s(process: int) -> float:
    """What a process has used so far, without its children."""
    after_name = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, after_name[11:13])) / os.sysconf("SC_CLK_TCK")
