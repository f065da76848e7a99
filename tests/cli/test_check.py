"""`permway check`, and what `permway diagnose` and Python say of blunders first."""

from __future__ import annotations

import copy
import json
import subprocess
import sys
from pathlib import Path

import permway
import pytest
from permway.diagnosis.verdict import Verdict
from permway.laws.toml import to_toml
from simulated import CAMPAIGN, simulate


def run(*words: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "permway", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=240)


@pytest.fixture(scope="module")
def in_g(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign whose sensors are stated to read g, and one of whose tolerances is in percent."""
    path = simulate(tmp_path_factory.mktemp("in-g"), 7).path
    campaign = copy.deepcopy(CAMPAIGN)
    for sensor in campaign["sensors"]:
        sensor["unit"] = "g"
    campaign["parameters"][0]["tolerance_2sigma"] = 5
    path.write_text(to_toml(campaign))
    return path


def test_it_states_what_was_read_and_what_to_write(in_g: Path) -> None:
    done = run("check", in_g)
    assert (done.returncode, done.stderr) == (0, "")
    first, second, *_ = done.stdout.splitlines()
    assert first.startswith("blunders  records.blows: levels are 9.80665 times what the model states (+19.8 dB)")
    assert first.endswith('; sensors "rail@6", "deck@3": unit = "m/s2", not "g"')
    assert "asked: parameters.pad.k: tolerance_2sigma = 5 is 500 %" in second
    row = next(line.split() for line in done.stdout.splitlines() if line.strip().startswith("blows"))
    assert row[:7] == ["blows", "frf", "2", "3", "97", "8", "200"]
    assert (in_g.parent / "check" / "check.png").read_bytes().startswith(b"\x89PNG")


def test_an_honest_campaign_has_no_blunders(tmp_path: Path) -> None:
    done = run("check", simulate(tmp_path, 7).path, "--json", "--no-picture")
    stated = json.loads(done.stdout)
    assert stated["blunders"] == []
    assert [row["record"] for row in stated["records"]] == ["blows"]
    assert abs(stated["records"][0]["level_dB"]) < 3.0
    assert not (tmp_path / "check").exists()


def test_a_diagnosis_reports_blunders_first(in_g: Path, tmp_path: Path) -> None:
    done = run("diagnose", in_g, "-o", tmp_path / "out", "--no-report")
    assert done.returncode == 0
    assert done.stderr.startswith("permway: put right first: records.blows: levels are 9.80665 times")
    assert done.stdout.startswith("blunders ")
    verdict = Verdict.read(tmp_path / "out" / "verdict.json")
    assert [(one.kind, one.asked) for one in verdict.blunders] == [("factor", False), ("tolerance", True)]
    assert verdict.sentence.startswith("Put right first: records.blows: levels are 9.80665 times")


def test_python_has_the_same(in_g: Path) -> None:
    checked = permway.check(in_g)
    assert [one.kind for one in checked.found] == ["factor"]
    assert permway.read_campaign(in_g).stated.sensors[0].unit == "g"
    with pytest.raises(permway.InputError, match="must be a campaign or the path"):
        permway.diagnose(3)  # type: ignore[arg-type]
