"""What a check advises works: its text, put into the campaign, leaves nothing to advise."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import permway
import pytest
from permway.checking.blunder import Blunder
from permway.cli import app
from permway.errors import InputError
from permway.laws.toml import to_toml
from permway.recordings.ratio import ratio_of
from tabled import Rows, tabled
from typer.testing import CliRunner


def checked(path: Path) -> tuple[Blunder, ...]:
    return permway.check(path).blunders


def applied(path: Path, remedy: str) -> None:
    """The remedy's text as a user would put it into the file, the first of alternatives."""
    remedy = re.split(r"; or | \(or ", remedy)[0]
    mine, _, of_record = remedy.partition("in the record ")
    table = tomllib.loads(path.read_text("utf-8"))
    sensors, forces = (re.findall(r'"([^"]+)"', mine.partition(":")[0]) for _ in range(2))
    if mine.startswith("all forces"):
        forces = [one["name"] for one in table["forces"]]
    for one in (*table["sensors"], *table["forces"]):
        if one["name"] in (sensors if mine.startswith("sensors") else forces):
            for key, value in re.findall(r'(unit|quantity) = ("[^"]+")', mine):
                one[key] = tomllib.loads(f"{key} = {value}")[key]
            for gain in re.findall(r"chain = \{ gain = ([^ ]+) \}", mine):
                one["chain"] = {"gain": float(gain)}
    if of_record:
        table["records"][0]["unit"] = tomllib.loads(of_record.split(", for the file")[0])["unit"]
    path.write_text(to_toml(table))


def one_sensor(factor: float) -> Callable[[Rows], Rows]:
    def change(rows: Rows) -> Rows:
        for row in rows:
            if row["sensor"] == "d":
                row |= {key: f"{float(row[key]) * factor:.8g}" for key in ("real", "imag")}
        return rows

    return change


@pytest.mark.parametrize("unit", [None, "(m/s2)/N"])
@pytest.mark.parametrize(
    "how",
    [{"scale": 1.0 / 9.80665}, {"scale": 1e3}, {"scale": 25.4}, {"rows": one_sensor(1.0 / 9.80665)}],
    ids=["g", "thousand", "inches", "one sensor in g"],
)
def test_a_unit_that_is_advised_is_read(tmp_path: Path, how: dict[str, Any], unit: str | None) -> None:
    path = tabled(tmp_path, unit=unit, **how)
    (found,) = checked(path)
    assert found.kind == "factor"
    applied(path, found.remedy)
    assert checked(path) == ()


def test_where_the_file_states_a_unit_the_record_has_to(tmp_path: Path) -> None:
    (found,) = checked(tabled(tmp_path, scale=1.0 / 9.80665))
    assert (
        'unit = "g", not "m/s2", and in the record unit = "(g)/N", for the file states \'(m/s2)/N\''
        in found.remedy
    )


def test_a_file_in_g_over_pounds_is_read_in_them(tmp_path: Path) -> None:
    scale = 4.4482216152605 / 9.80665

    def stated(table: dict[str, Any]) -> None:
        for sensor in table["sensors"]:
            sensor["unit"] = "g"
        for force in table["forces"]:
            force["unit"] = "lbf"

    assert checked(tabled(tmp_path, unit="g/lbf", scale=scale, stated=stated)) == ()
    assert ratio_of("g/lbf") == ("acceleration", "g", "lbf")
    # As it was begun before: the header says how it is, and no other unit of the same numbers is advised first.
    with pytest.raises(InputError) as caught:
        permway.read_campaign(tabled(tmp_path, unit="g/lbf", scale=scale)).load()
    assert caught.value.remedy.startswith(
        'sensor: quantity = "acceleration", unit = "g", force point: unit = "lbf"'
    )


def test_a_unit_that_no_sensor_has_is_brought_to_one_that_has(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        permway.read_campaign(tabled(tmp_path, unit="(cm/s2)/N")).load()
    assert caught.value.remedy == (
        "no sensor and force point have this unit: in a copy of the file multiply by 0.01 and state (m/s2)/N"
    )


def exchanged(sensor: str | None) -> Callable[[Rows], Rows]:
    def change(rows: Rows) -> Rows:
        for row in rows:
            if sensor in (None, row["sensor"]):
                row["real"], row["imag"] = row["imag"], row["real"]
        return rows

    return change


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(
    ("sensor", "where"), [(None, "records.blows"), ("d", "records.blows: deck@3"), ("r", "records.blows: rail@6")]
)
def test_real_and_imaginary_part_exchanged_are_reported(
    tmp_path: Path, sensor: str | None, where: str, seed: int
) -> None:
    (found,) = checked(tabled(tmp_path, rows=exchanged(sensor), seed=seed))
    assert (found.kind, found.where) == ("exchanged", where)
    assert "real and imaginary part have changed places" in found.what
    assert "exchange them in" in found.remedy
    assert found.log_odds is not None
    assert found.log_odds > 5.0


def test_frequencies_in_radians_per_second_are_asked_of(tmp_path: Path) -> None:
    def in_rad(rows: Rows) -> Rows:
        for row in rows:
            row["f"] *= 2.0 * np.pi
        return rows

    found = next(one for one in checked(tabled(tmp_path, rows=in_rad)) if one.kind == "model")
    assert found.asked
    size = re.search(r"scatter by (\d+) dB: the model does not resemble", found.what)
    assert size is not None
    assert int(size[1]) >= 10
    assert "-0 dB" not in found.what
    for asked in ("rad/s", "stiffness", "places", "which model"):
        assert asked in found.remedy


def test_a_stiffness_in_another_unit_is_not_called_a_fault_of_the_records(tmp_path: Path) -> None:
    path = tabled(tmp_path)
    model = tomllib.loads((path.parent / "model.toml").read_text("utf-8"))
    model["line"]["laws"]["pad"]["stiffness"] *= 1e-6
    (path.parent / "model.toml").write_text(to_toml(model))
    found = checked(path)
    assert found[0].kind == "model"
    assert "stiffness" in found[0].remedy
    assert all(one.asked and one.log_odds is None for one in found)


def test_a_model_that_fits_is_not_asked_of(tmp_path: Path) -> None:
    assert checked(tabled(tmp_path)) == ()


def test_sensors_that_were_never_placed_are_asked_of(tmp_path: Path) -> None:
    def stated(table: dict[str, Any]) -> None:
        for one in (*table["sensors"], *table["forces"]):
            one |= {"body": "rail", "x_m": 0.0}

    places = [one for one in checked(tabled(tmp_path, stated=stated)) if one.kind == "place"]
    assert [one.what for one in places] == [
        "2 sensors at x = 0 m of rail: is that so?",
        "3 points at x = 0 m of rail: is that so?",
    ]
    assert all(one.asked for one in places)


def test_where_no_record_can_be_read_the_status_is_of_wrong_input(tmp_path: Path) -> None:
    path = tabled(tmp_path)
    (tmp_path / "frf.csv").write_text("nothing of the kind\n")
    done = CliRunner().invoke(app, ["check", str(path), "--no-picture"])
    assert done.exit_code == 2
    assert "blunders" in done.stdout
    (again := tmp_path / "again").mkdir()
    assert CliRunner().invoke(app, ["check", str(tabled(again)), "--no-picture"]).exit_code == 0
