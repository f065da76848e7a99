"""`permway diagnose`, as a user calls it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from permway.diagnosis.catalogue._interval import weakened
from permway.diagnosis.verdict import Verdict
from simulated import simulate


def test_it_leaves_a_page_a_verdict_and_a_model(tmp_path: Path) -> None:
    path = simulate(tmp_path / "c", 41, amend=lambda c: weakened(c, "pad", 6.0, 1.2, 0.05)).path
    out = tmp_path / "out"
    command = [sys.executable, "-m", "permway", "diagnose", str(path), "-o", str(out), "--json"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    verdict = Verdict.read(out / "verdict.json")
    assert json.loads(ended.stdout.splitlines()[-1])["status"] == verdict.status == "named"
    (effect,) = verdict.effects
    assert effect.name == "fastener_loss"
    assert effect.place.x == (5.4, 6.6)
    factor = effect.parameters["factor"]
    assert factor.low is not None
    assert factor.high is not None
    assert factor.low <= 0.05 <= factor.high
    assert all(gain.gain_nats > 0.0 for gain in verdict.held_out.values())
    assert "fastener_loss" in (out / "report.html").read_text(encoding="utf-8")
    assert (out / "amended.toml").is_file()
