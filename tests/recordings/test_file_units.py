"""Units that files state of their channels: who corrects a sensor is asked to correct these, too."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from campaigns import tables, write
from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.load import load_record
from permway.checking.change import Ratio
from permway.checking.file_units import file_units
from permway.checking.words import Files, _unit
from permway.errors import InputError


def run_with(folder: Path, **stated: object) -> Campaign:
    """The small campaign, its run in a file whose header says m/s2 and g."""
    campaign, model = tables()
    campaign["records"] = campaign["records"][1:]
    campaign["records"][0] |= stated.pop("record", {})
    next(one for one in campaign["sensors"] if one["name"] == "axle").update(stated)
    path = write(folder, campaign, model)
    samples = np.random.default_rng(3).normal(size=(2, 5000))
    lines = ["axle [m/s2],floor [g]", *(f"{a!r},{b!r}" for a, b in samples.T.tolist())]
    (folder / "run.csv").write_text("\n".join(lines) + "\n")
    return read_campaign(path)


def test_what_a_run_s_header_states_is_known_by_sensor(tmp_path: Path) -> None:
    campaign = run_with(tmp_path)
    assert file_units(campaign, campaign.stated.records[0]) == {"axle": "m/s2", "floor": "g"}


def test_what_cannot_be_read_states_nothing(tmp_path: Path) -> None:
    campaign = run_with(tmp_path)
    (tmp_path / "run.csv").write_text("")
    assert file_units(campaign, campaign.stated.records[0]) == {}


def test_the_advice_for_a_channel_is_read(tmp_path: Path) -> None:
    campaign = run_with(tmp_path)
    record = campaign.stated.records[0]
    files = Files(record, file_units(campaign, record))
    _, remedy = _unit(Ratio(9.80665), [campaign.sensor("axle")], (), files, whole=False)
    sensor, _, of_record = remedy.partition(", and in the record ")
    assert sensor == 'sensors "axle": unit = "g", not "m/s2"'
    # The half alone is what was refused.
    with pytest.raises(InputError, match="was stated to be in 'g'"):
        load_record(run_with(tmp_path, unit="g"), record)
    stated = tomllib.loads(of_record.partition(", for the file")[0])
    right = run_with(tmp_path, unit="g", record=stated)
    power = load_record(right, right.stated.records[0]).data["psd"].values[0]
    before = run_with(tmp_path)
    assert power == pytest.approx(load_record(before, before.stated.records[0]).data["psd"].values[0] * 9.80665**2)
