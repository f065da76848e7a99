"""Tables of responses side by side, one hit point a file, as labs export them: `permway new` knows the point."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import permway
import pytest
from permway.errors import InputError
from permway.laws.toml import to_toml
from permway.recordings.readers import read_frf
from permway.recordings.readers.hints import Hints
from permway.recordings.skeleton import write_skeleton
from simulated import BLOWS, CAMPAIGN, FREQUENCY, MODEL, simulate


@pytest.mark.parametrize(
    ("label", "body", "x_m"),
    [
        ("A1 rail 9,10 m", '"rail"', "9.1"),
        ("A4 Sleeper 11.70", '"sleeper"', "11.7"),
        ("mobility_rail_7.8", '"rail"', "7.8"),
        ("Hit 07.80m", '"rail"', "7.8"),
        ("A1 -2.5 m", '"rail"', "-2.5"),
        # A number that may count sensors, another unit, a part of a larger number.
        ("A1 rail 2", '"rail"', "0.0"),
        ("gauge 10 mm", '"rail"', "0.0"),
        ("run_144m", '"rail"', "0.0"),
    ],
)
def test_a_place_in_a_label_is_proposed(tmp_path: Path, label: str, body: str, x_m: str) -> None:
    (tmp_path / "a.csv").write_text(
        f"f [Hz];{label} Real [(m/s2)/N];{label} Imag [(m/s2)/N]\n1;1;2\n2;3;4\n3;5;6\n"
    )
    write_skeleton(tmp_path)
    sensor = (tmp_path / "campaign.toml").read_text("utf-8").partition("[[forces]]")[0]
    assert re.findall(r"^# (?:body|x_m) = (\S+)", sensor, re.MULTILINE) == [body, x_m]


@pytest.mark.parametrize("body", ["beam", "deck", "girder", "rail", "sleeper"])
def test_a_place_in_a_file_name_is_proposed_and_the_model_begins_with_its_body(tmp_path: Path, body: str) -> None:
    head = f"Frequency [Hz],{body}@4 Real [(m/s2)/N],{body}@4 Imag [(m/s2)/N]"
    for x in ("3", "2.5"):
        (tmp_path / f"{body}_{x}.csv").write_text(f"{head}\n1,1,2\n2,3,4\n3,5,6\n")
    write_skeleton(tmp_path)
    points = (tmp_path / "campaign.toml").read_text("utf-8").partition("[[forces]]")[2]
    found = re.findall(r"^# (?:body|x_m) = (\S+)", points, re.MULTILINE)
    assert found == [f'"{body}"', "2.5", f'"{body}"', "3"]
    path = tmp_path / "model.toml"
    with pytest.raises(InputError, match="missing"):
        permway.read_model(path)
    answers = re.sub(r"^# (?!option|question|from)(\S+ = )", r"\1", path.read_text("utf-8"), flags=re.MULTILINE)
    path.write_text(answers, "utf-8")
    alone = body in ("beam", "deck", "girder")
    line = permway.read_model(path).line
    assert list(line.bodies) == [body if alone else "rail"]
    assert [(beam.start, beam.stop) for _, beam in line.beams()] == [(0.0, 20.0 if alone else 36.0)]


@pytest.mark.parametrize("name", ["", "rail@9 "])
def test_files_of_one_response_each_have_points_of_their_own(tmp_path: Path, name: str) -> None:
    for point in ("p10.5", "p12"):
        head = f"Frequency [Hz],{name}Real [(m/s2)/N],{name}Imag [(m/s2)/N],{name}Coherence"
        (tmp_path / f"{point}.csv").write_text(f"{head}\n1,1,2,0.9\n2,3,4,0.9\n3,5,6,0.9\n")
    stated = write_skeleton(tmp_path)
    table = tomllib.loads((tmp_path / "campaign.toml").read_text("utf-8"))
    assert [one["name"] for one in table["forces"]] == ["hit p10.5", "hit p12"]
    # One sensor where the columns name it; where nothing does, it may be another in each file.
    assert [one["name"] for one in table["sensors"]] == ([name.strip()] if name else ["p10.5", "p12"])
    assert stated["records"] == 2
    for record in table["records"]:
        hints = Hints(pairs={name: (read, struck) for name, (read, struck) in record["pairs"].items()})
        read = read_frf(tmp_path / record["file"], hints=hints)
        assert ([*read.responses], [*read.references]) == (record["responses"], [*record["references"]])


def test_a_file_of_one_hit_point_names_it(tmp_path: Path) -> None:
    (dataset,) = simulate(tmp_path / "made", 5).campaign.load()
    folder = tmp_path / "exports"
    folder.mkdir()
    frf, coherence = dataset.data["frf"].values, dataset.data["coherence"].values
    sensors, points = dataset.names("sensor"), dataset.names("force")
    for j, point in enumerate(points):
        head = ["Frequency [Hz]"]
        for name in sensors:
            head += [f"{name} Real [(m/s2)/N]", f"{name} Imag [(m/s2)/N]", f"{name} Coherence"]
        rows = [",".join(head)]
        for k, f in enumerate(FREQUENCY):
            cells = [f"{f:g}"]
            for i in range(len(sensors)):
                cells += [f"{frf[i, j, k].real:.6g}", f"{frf[i, j, k].imag:.6g}", f"{coherence[i, j, k]:.6f}"]
            rows.append(",".join(cells))
        (folder / f"{point}.csv").write_text("\n".join(rows) + "\n")
    write_skeleton(folder)
    path = folder / "campaign.toml"
    table = tomllib.loads(path.read_text("utf-8"))
    assert {p["name"] for p in table["forces"]} == {f"hit {point}" for point in points}
    assert [r["responses"] for r in table["records"]] == [sensors] * len(points)
    # Answered as an engineer would.
    at = {s["name"]: s for s in CAMPAIGN["sensors"]} | {f"hit {p['name']}": p for p in CAMPAIGN["forces"]}
    for one in (*table["sensors"], *table["forces"]):
        one |= {key: at[one["name"]][key] for key in ("body", "x_m")}
    for record in table["records"]:
        record["averages"] = BLOWS
    table["conditions"][0]["temperature_C"] = 12.0
    path.write_text(to_toml(table))
    (folder / "model.toml").write_text(to_toml(MODEL))
    checked = permway.check(path)
    assert [one.where for one in checked.blunders] == ["parameters"]
    assert len(checked.records) == len(points)
