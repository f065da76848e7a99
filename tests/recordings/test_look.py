"""`permway look`: what a file holds, what is missing, and a part of a campaign file that reads it."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
import pyuff
import written
from permway.campaign.parts import Record
from permway.cli import app
from permway.errors import InputError
from permway.recordings.channel import Point, Sensor
from permway.recordings.look import Asked, look
from permway.recordings.readers import read_frf, read_time
from permway.recordings.readers.hints import Hints
from typer.testing import CliRunner


def pasted(text: str, condition: str = "c") -> tuple[Record, list[Sensor], list[Point]]:
    """The part of a campaign file as a user would complete it, checked as the campaign file checks it."""
    table = tomllib.loads(text.replace('condition = ""', f'condition = "{condition}"'))
    sensors = [Sensor.model_validate({**s, "body": "rail"}) for s in table.get("sensors", [])]
    points = [Point.model_validate({**p, "body": "rail"}) for p in table.get("forces", [])]
    (record,) = table["records"]
    return Record.model_validate(record), sensors, points


@pytest.mark.parametrize("file", [name for name in written.WRITERS if name not in ("a.wav", "columns.mat")])
def test_the_part_of_a_campaign_reads_the_file(file: str, tmp_path: Path) -> None:
    x = written.samples()
    path = tmp_path / file
    written.WRITERS[file](path, x)
    result = look(path)
    assert [row["sampling_Hz"] for row in result["channels"]] == [written.RATE] * 3
    assert not any(row["problem"] for row in result["channels"])
    record, sensors, _ = pasted(result["campaign"])
    units = {label: next(s.unit for s in sensors if s.name == name) for label, name in record.channels.items()}
    read = read_time(
        path, channels=list(record.channels), units=units, sampling_Hz=record.sampling_Hz, hints=record.hints
    )
    np.testing.assert_allclose(read.values, x, rtol=1e-11)
    assert read.sampling_Hz == written.RATE


def test_responses(tmp_path: Path) -> None:
    frequency, values, coherence = written.frf()
    path = tmp_path / "a.npz"
    names = {"sensor": np.array(["r", "d"]), "hammer": np.array(["a", "b", "c"])}
    np.savez(path, f=frequency, frf=values, coh=coherence, unit="(mm/s)/kN", **names)
    result = look(path)
    assert result["responses"]["pairs"] == 6
    assert (result["responses"]["from_Hz"], result["responses"]["step_Hz"]) == (2.0, 0.5)
    record, sensors, points = pasted(result["campaign"])
    assert [(s.quantity, s.unit) for s in sensors] == [("velocity", "mm/s")] * 2
    assert [p.unit for p in points] == ["kN"] * 3
    assert record.averages == 8
    assert set(read_frf(path, responses=list(record.responses)).responses) == {"r", "d"}


def test_lines_above_the_table_are_found_and_stated(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = "".join(f"{i / 512:.9f},{i % 3}\n" for i in range(20))
    path.write_text("Logger 7\nSerial,12\n\nTime [s],acc [mm/s2]\n" + rows)
    with pytest.raises(InputError, match=r"lines 1 to 2 are no part of a table .*header_row = 4"):
        read_time(path)
    result = look(path)
    record, sensors, _ = pasted(result["campaign"])
    assert (record.header_row, sensors[0].unit) == (4, "mm/s2")
    assert read_time(path, hints=record.hints).sampling_Hz == 512.0


@pytest.mark.parametrize("kind", [15, 2411])
@pytest.mark.parametrize(("length", "scale"), [(None, 1.0), (1000.0, 1e-3)])
def test_places_of_nodes(kind: int, length: float | None, scale: float, tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    if length is not None:
        system = pyuff.prepare_164(
            units_code=1,
            units_description="own",
            temp_mode=1,
            length=length,
            force=1.0,
            temp=1.0,
            temp_offset=273.15,
        )
        written.append_uff(path, system)
    place = {1: (2.5, 0.0, -1.0), 2: (-7.25, 1.5, 0.0), 3: (0.125, 0.0, 0.0)}
    if kind == 15:
        x, y, z = (list(map(float, axis)) for axis in zip(*place.values(), strict=True))
        zero = [0] * 3
        nodes = pyuff.prepare_15(node_nums=list(place), def_cs=zero, disp_cs=zero, color=zero, x=x, y=y, z=z)
        written.append_uff(path, nodes)
    else:
        rows = [
            f"{node:10d}{1:10d}{1:10d}{11:10d}\n" + "".join(f"{v:25.16E}" for v in at).replace("E", "D") + "\n"
            for node, at in place.items()
        ]
        with path.open("a") as file:
            file.write("    -1\n  2411\n" + "".join(rows) + "    -1\n")
    run = tmp_path / "run.uff"
    written.uff_time(run, written.samples())
    path.write_bytes(path.read_bytes() + run.read_bytes())
    _, sensors, _ = pasted(look(path)["campaign"])
    assert [s.x_m for s in sensors] == [pytest.approx(at[0] * scale) for at in place.values()]


def test_what_is_missing_is_reported_with_its_key(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time,a\n" + "".join(f"{2 * i},{i % 3}\n" for i in range(20)))
    result = look(path)
    assert any("unit = { time =" in text for text in result["missing"])
    asked = Asked(hints=Hints(unit={"time": "ms", "a": "m/s2"}))
    result = look(path, asked)
    assert result["missing"] == []
    assert pasted(result["campaign"])[0].unit == {"time": "ms", "a": "m/s2"}


def test_a_channel_that_cannot_be_used_does_not_hide_the_others(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("Time [s];a [g];state;b [V]\n0,00;1;on;0,1\n0,25;;off;0,2\n0,50;3;on;0,3\n")
    result = look(path)
    problems = {row["channel"]: row["problem"] for row in result["channels"]}
    assert "the cell is empty" in problems["a"]
    assert "not a number" in problems["state"]
    assert problems["b"] == ""
    assert "no sensor has" in result["campaign"]


def test_the_command(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    written.csv(path, written.samples())
    run = CliRunner().invoke(app, ["look", str(path), "--json"])
    assert run.exit_code == 0
    assert [row["channel"] for row in json.loads(run.stdout)["channels"]] == list(written.NAMES)
    shown = CliRunner().invoke(app, ["look", str(path)])
    assert "[[records]]" in shown.stdout
    assert "axle box" in shown.stdout
    wrong = CliRunner().invoke(app, ["look", str(path), "--unit", "g", "--unit", "m"])
    assert isinstance(wrong.exception, InputError)
