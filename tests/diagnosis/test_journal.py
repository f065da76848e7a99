"""A diagnosis that is stopped and begun again."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from permway.campaign.campaign import Campaign, read_campaign
from permway.demo.run import campaign_files
from permway.diagnosis.diagnose import diagnose
from permway.diagnosis.journal import Journal, keeping, key_of


class StoppedError(Exception):
    """By the user, at a stage."""


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    folder = tmp_path_factory.mktemp("demo")
    for name, content in campaign_files().items():
        (folder / name).write_bytes(content)
    return read_campaign(folder / "campaign.toml")


def test_what_was_found_is_taken_up_again_and_the_verdict_is_the_same(campaign: Campaign, tmp_path: Path) -> None:
    stages: list[str] = []

    def stop(stage: str, _done: int, _total: int) -> None:
        stages.append(stage)
        if stage == "hold out":
            raise StoppedError

    key = key_of(campaign, 0)
    with keeping(tmp_path / "unfinished", key), pytest.raises(StoppedError):
        diagnose(campaign, threads=1, progress=stop)
    assert {"recalibrate", "screen", "nulls", "learn"} <= set(stages)
    kept = sorted(p.name for p in (tmp_path / "unfinished").iterdir())
    assert len(kept) > 5
    stages.clear()
    with keeping(tmp_path / "unfinished", key) as journal:
        again = diagnose(campaign, threads=1, progress=lambda stage, _d, _t: stages.append(stage))
        assert journal.recalled == len(kept)
        journal.close()
    # Nothing was screened a second time but what comes after.
    assert stages.count("screen") == stages.count("nulls") == 0
    assert not (tmp_path / "unfinished").exists()
    whole = diagnose(campaign, threads=1)
    assert again.verdict.model_dump_json() == whole.verdict.model_dump_json()


def test_another_record_or_seed_is_another_diagnosis(campaign: Campaign, tmp_path: Path) -> None:
    key = key_of(campaign, 0)
    assert key == key_of(campaign, 0)
    assert key != key_of(campaign, 1)
    copy = tmp_path / "copy"
    copy.mkdir()
    for path in campaign.folder.iterdir():
        (copy / path.name).write_bytes(path.read_bytes())
    other = read_campaign(copy / "campaign.toml")
    assert key_of(other, 0) == key
    record = other.path(other.stated.records[0])
    record.write_bytes(record.read_bytes() + b" ")
    assert key_of(other, 0) != key


def test_steps_are_recalled_in_their_order_for_what_they_were_given(tmp_path: Path) -> None:
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
    assert Journal(tmp_path / "steps", "other key").recall("step", np.array([1.0])) is None


def test_a_step_that_was_cut_short_or_is_no_file_of_ours_is_taken_again(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "steps", "key")
    journal.recall("step")
    journal.keep({"found": np.arange(1000.0)})
    (path,) = (tmp_path / "steps").iterdir()
    whole = path.read_bytes()
    for content in (whole[: len(whole) // 2], b"", json.dumps({}).encode(), b"\x80\x04."):
        path.write_bytes(content)
        assert Journal(tmp_path / "steps", "key").recall("step") is None
