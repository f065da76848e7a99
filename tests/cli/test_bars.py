"""Bars of long commands: what they say on a terminal."""

from __future__ import annotations

import io
import re
import sys
import time

import pytest
from permway.cli.output import stage_bar


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_stage_states_the_time_spent_and_what_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setenv("TERM", "xterm")
    with stage_bar("diagnosing", False) as progress:
        progress("reading", 0, 0)
        time.sleep(0.15)
        for done in range(12):
            progress("effects", done, 40)
            time.sleep(0.15)
    text = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", shown.getvalue())
    assert "diagnosing: reading" in text
    # 28 more steps of 0.15 s, and a second for what else the machine does.
    left = re.findall(r"diagnosing: effects .*0:00:0\d, left of this 0:00:(\d\d)", text)
    assert left
    assert 2 <= int(left[-1]) <= 30


def test_nothing_where_nobody_looks(capsys: pytest.CaptureFixture[str]) -> None:
    with stage_bar("diagnosing", True) as progress:
        progress("reading", 1, 2)
    assert capsys.readouterr().err == ""
