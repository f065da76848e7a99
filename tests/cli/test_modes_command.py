"""`permway modes`: what it lists, writes and draws."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from permway.cli import app
from permway.errors import InputError
from typer.testing import CliRunner

MODEL = """
[frequencies]
from_Hz = 2.0
to_Hz = 60.0
step_Hz = 1.0
[line.bodies.deck]
type = "beam"
youngs_modulus_Pa = 3.4e10
second_moment_m4 = 1.2
density_kg_per_m3 = 2500.0
area_m2 = 4.0
loss_factor = 0.04
intervals_m = [[0.0, 24.0]]
ends = "pinned"
[[forces]]
body = "deck"
x_m = 6.0
[[sensors]]
body = "deck"
x_m = 6.0
"""
FIRST_HZ = np.pi / (2.0 * 24.0**2) * np.sqrt(3.4e10 * 1.2 / 1.0e4) * (1.0 + 0.04**2) ** 0.25

_N = np.arange(1, 60)
ROOTS = (_N * np.pi / 24.0) ** 2 * np.sqrt(3.4e10 * 1.2 / 1.0e4)
MODES = np.sin(_N * np.pi * 6.0 / 24.0) * np.sin(_N * np.pi * 12.0 / 24.0)
"""Of the beam: circular natural frequencies, and the modes struck at 6 m and read at 12 m."""


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "model.toml"
    path.write_text(MODEL)
    return path


def run(*arguments: object) -> dict:
    result = CliRunner().invoke(app, ["modes", *map(str, arguments), "--json"])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_it_lists_the_model_s_band(model: Path) -> None:
    stated = run(model)
    assert stated["band_Hz"] == [2.0, 60.0]
    found = [one["frequency_Hz"] for one in stated["modes"]]
    assert found == pytest.approx(FIRST_HZ * np.array([1.0, 4.0, 9.0]), rel=1e-7)
    first = stated["modes"][0]
    assert (first["moves_most"], first["damping_ratio"]) == ("deck@12", pytest.approx(0.02, rel=1e-3))
    assert first["modal_mass_kg"] == pytest.approx(0.5 * 24.0 * 1.0e4, rel=1e-5)
    assert stated["notes"] == []


def test_it_writes_and_draws(model: Path, tmp_path: Path) -> None:
    stated = run(model, "--to", 25, "-o", tmp_path / "modes.csv", "--plot", tmp_path / "pictures")
    table = pd.read_csv(stated["table"])
    assert table["natural_frequency [Hz]"].to_numpy() == pytest.approx(FIRST_HZ * np.array([1.0, 4.0]), rel=1e-7)
    (picture,) = stated["pictures"]
    assert Path(picture).read_bytes().startswith(b"\x89PNG")
    stated = run(model, "--to", 25, "-o", tmp_path / "modes.nc")
    with xr.open_dataset(stated["dataset"], engine="h5netcdf") as data:
        assert data["shape"].dtype == np.complex128


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--from", "80"], "from low to high"),
        (["-o", "modes.xlsx"], r"end the name in .csv or .nc"),
        (["-o", "/nowhere/at/all.csv"], "no such folder"),
    ],
)
def test_wrong_input(model: Path, arguments: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        run(model, *arguments)


def test_operating_shapes_of_the_first_force(model: Path) -> None:
    page = model.with_name("shapes.html")
    words = ["operating-shapes", str(model), "--at", "30", "--at", f"{FIRST_HZ:.4f}", "-o", str(page), "--json"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    first, second = json.loads(done.output)["shapes"]
    assert first["frequency_Hz"] == pytest.approx(FIRST_HZ, rel=1e-4)
    assert (first["force"], first["moves_most"]) == ("deck@6", "deck@12")
    # Of the middle: a quarter of a period, and 1.2 degrees by the higher modes, which follow at once.
    modal = MODES / (ROOTS**2 * (1.0 + 0.04j) - (2.0 * np.pi * first["frequency_Hz"]) ** 2)
    assert first["after_force_deg"] == pytest.approx(-np.rad2deg(np.angle(modal.sum())), abs=0.01)
    assert first["greatest_m_per_N"] == pytest.approx(abs(modal.sum()) * 2.0 / (1.0e4 * 24.0), rel=1e-4)
    assert second["frequency_Hz"] == 30.0
    text = page.read_text("utf-8")
    assert text.count('<figure class="shape">') == 2
    assert "All motion is vertical" in text


def test_operating_shapes_ask_for_a_force_that_is_there(model: Path) -> None:
    words = ["operating-shapes", str(model), "--at", "30", "--force", "rail", "-o", str(model.with_name("a.nc"))]
    error = CliRunner().invoke(app, words).exception
    assert isinstance(error, InputError)
    assert "deck@6" in str(error)
    done = CliRunner().invoke(app, [*words[:4], *words[6:]])
    assert done.exit_code == 0, done.output
    with xr.open_dataset(model.with_name("a.nc"), engine="h5netcdf") as data:
        assert data["shape"].dims == ("frequency", "force", "place")
