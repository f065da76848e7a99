"""`permway decay-rate` and `permway insertion-loss`: what they print, write and draw."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import permway
import pytest
from permway.cli import app
from permway.errors import InputError
from typer.testing import CliRunner

TRACK = """
[frequencies]
from_Hz = 20.0
to_Hz = 300.0
step_Hz = 2.0
[line]
preset = "ballasted_b91_60e1"
[line.options]
sleepers = 101
pad = { type = "hysteretic", stiffness = STIFFNESS, loss_factor = 0.2 }
[[forces]]
body = "rail"
x_m = 30.3
[[sensors]]
body = "sleeper[51]"
x_m = 30.0
name = "sleeper"
"""


def model(folder: Path, name: str, stiffness: float) -> Path:
    path = folder / f"{name}.toml"
    path.write_text(TRACK.replace("STIFFNESS", str(stiffness)))
    return path


def run(*arguments: object) -> dict:
    result = CliRunner().invoke(app, [*map(str, arguments), "--json"])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_decay_rate(tmp_path: Path) -> None:
    path = model(tmp_path, "soft", 1.0e8)
    stated = run(
        "decay-rate", path, "--at", 10.3, "--from", 250, "--to", 1000, "-o", tmp_path / "r.csv", "--plot", tmp_path
    )
    data = permway.track_decay_rate(permway.read_model(path).line, at_m=10.3, from_Hz=250.0, to_Hz=1000.0)
    assert [one["decay_rate_dB_per_m"] for one in stated["bands"]] == pytest.approx(data["decay_rate"].values)
    assert {one["note"] for one in stated["bands"]} <= {"", "upper bound"}
    assert pd.read_csv(stated["table"])["decay_rate [dB/m]"].to_numpy() == pytest.approx(data["decay_rate"].values)
    assert Path(stated["picture"]).read_bytes().startswith(b"\x89PNG")
    with pytest.raises(InputError, match=r"give at_m between 0 and 20\.4"):
        run("decay-rate", path, "--at", 50)


def test_insertion_loss(tmp_path: Path) -> None:
    both = [model(tmp_path, "stiff", 6.0e8), model(tmp_path, "soft", 6.0e7)]
    stated = run("insertion-loss", *both, "-o", tmp_path / "loss.csv", "--plot", tmp_path)
    data = permway.insertion_loss(*(permway.solve(permway.read_model(path)) for path in both))
    loss = data["insertion_loss"].values.reshape(-1)
    assert [one["sleeper / rail@30.3"] for one in stated["bands"]] == pytest.approx(loss, abs=0.006)
    assert loss[-1] < 0.0, "the rail resonates on soft pads near 250 Hz"
    assert pd.read_csv(stated["table"])["insertion_loss [dB]"].to_numpy() == pytest.approx(loss, rel=1e-6)
    assert Path(stated["picture"]).name == "insertion-loss.png"
