"""`permway doctor --bench`: what it states, by injected or tiny measurements; no time is asserted."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import permway.cli.bench as bench_module
import pytest
from permway.cli.bench import FREQUENCIES, REFERENCE, Timed, bench, lines, score, small_campaign, time_lines
from permway.cli.commands import app

TINY = dict.fromkeys(FREQUENCIES, 8)


def as_the_reference(factor: float) -> list[Timed]:
    return [Timed(name, 3.0 * us, us * factor) for name, us in REFERENCE["us_per_frequency"].items()]


def test_every_line_is_timed_with_one_thread_and_with_all() -> None:
    timed = time_lines(2, frequencies=TINY, rounds=1)
    assert (
        [each.line for each in timed] == list(FREQUENCIES) == list(lines()) == list(REFERENCE["us_per_frequency"])
    )
    assert all(each.one_us > 0.0 and each.all_us > 0.0 for each in timed)


def test_a_slow_machine_does_one_round(monkeypatch: pytest.MonkeyPatch) -> None:
    swept = []
    monkeypatch.setattr("permway.response.receptance.receptance", lambda *_, threads, **__: swept.append(threads))
    time_lines(4, frequencies=TINY, rounds=9, enough_s=-1.0)
    assert swept == [1, 4] * 3


def test_the_score_counts_cores_of_the_reference() -> None:
    seconds = REFERENCE["diagnosis_s"]
    assert score(as_the_reference(1.0), seconds) == pytest.approx(1.0, rel=1e-12)
    assert score(as_the_reference(0.5), seconds / 2.0) == pytest.approx(2.0, rel=1e-12)
    # One of four parts, sixteen times as slow, halves it.
    assert score(as_the_reference(1.0), 16.0 * seconds) == pytest.approx(0.5, rel=1e-12)


def test_what_it_states() -> None:
    asked: list[int] = []
    stated = bench(time_all=lambda threads: as_the_reference(1.0), diagnose_it=asked.append)
    assert set(stated) == {
        *("bench", "small_diagnosis_s", "score", "score_is", "reference"),
        *("load_average", "busy"),
    }
    assert [row["gain"] for row in stated["bench"]] == pytest.approx([3.0] * 3)
    assert len(asked) == 1
    json.dumps(stated, allow_nan=False)


def test_the_command_prints_a_table_and_json(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        bench_module.bench,
        "__kwdefaults__",
        {"time_all": lambda _: as_the_reference(0.5), "diagnose_it": lambda _: "named"},
    )
    app(["doctor", "--bench", "--json"], prog_name="permway", standalone_mode=False)
    stated = json.loads(capsys.readouterr().out)
    assert {"vectors", "threads", "bench", "score"} <= set(stated)
    app(["doctor", "--bench"], prog_name="permway", standalone_mode=False)
    shown = capsys.readouterr().out
    assert "one thread, us" in shown
    assert all(name in shown for name in FREQUENCIES)


def test_the_small_campaign_is_the_same_each_time(tmp_path: Path) -> None:
    read = [small_campaign(tmp_path / name) for name in "ab"]
    (first,), (second,) = (campaign.load() for campaign in read)
    assert np.array_equal(first.data["frf"].values, second.data["frf"].values)
    assert first.data["frf"].shape == (1, 2, 20)
    assert [f.name for f in read[0].stated.parameters] == ["pad.k", "pad.eta"]
