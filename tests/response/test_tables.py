"""Datasets as pandas tables and CSV."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pandas as pd
import permway
import pytest
from permway.errors import InputError

LINE = permway.slab_track_viaduct_32m()
PLACES = [permway.Place(body=body, x_m=16.0) for body in ("rail", "girder")]


@pytest.fixture(scope="module")
def data():
    return permway.receptance(LINE, [10.0, 50.0, 90.0], forces=PLACES[:1], sensors=PLACES, temperature_C=20.0)


def test_a_row_for_each_combination_and_units_in_the_names(data) -> None:
    frame = permway.to_frame(data)
    assert len(frame) == 3 * 2 * 1
    assert list(frame.columns)[:3] == ["frequency [Hz]", "sensor", "force"]
    assert list(frame.columns)[-2:] == ["receptance.re [m/N]", "receptance.im [m/N]"]
    assert "sensor_x [m]" in frame.columns
    row = frame[(frame["frequency [Hz]"] == 50.0) & (frame["sensor"] == "girder@16")].iloc[0]
    value = data["receptance"].sel(frequency=50.0, sensor="girder@16").item()
    assert complex(row["receptance.re [m/N]"], row["receptance.im [m/N]"]) == value


def test_one_variable_and_real_numbers(data) -> None:
    frame = permway.to_frame(abs(data["receptance"].isel(sensor=0, force=0)).rename("modulus"))
    assert frame["modulus [m/N]"].to_numpy() == pytest.approx(np.abs(data["receptance"].values[:, 0, 0]))


def test_csv_reads_back(data, tmp_path: Path) -> None:
    path = permway.write_csv(data, tmp_path / "table.csv")
    again = pd.read_csv(io.StringIO(path.read_text()))
    frame = permway.to_frame(data)
    assert list(again.columns) == list(frame.columns)
    assert again["receptance.im [m/N]"].to_numpy() == pytest.approx(frame["receptance.im [m/N]"], rel=1e-8)


def test_what_has_no_common_dimension_is_asked_back(data) -> None:
    more = data.assign(joint_force=("joint", np.zeros(4)))
    with pytest.raises(InputError, match=r"no dimensions in common with .*receptance"):
        permway.to_frame(more)
    assert len(permway.to_frame(more[["joint_force"]])) == 4


@pytest.mark.parametrize("given", ["answer.nc", None, np.zeros(3)])
def test_what_is_no_dataset_is_refused(given) -> None:
    with pytest.raises(InputError, match="must be a Dataset"):
        permway.to_frame(given)


def test_a_folder_that_is_not_there(data, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be written"):
        permway.write_csv(data, tmp_path / "none" / "table.csv")
