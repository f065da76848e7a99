"""Pictures of solved models."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from permway.errors import InputError
from permway.laws import Hysteretic
from permway.model.irregularity import GermanSato
from permway.model.place import Place
from permway.model.presets import slab_track_viaduct_32m
from permway.paper.conventions import train
from permway.report.response import draw_dataset
from permway.response.receptance import receptance
from permway.response.train import train_response

PNG = b"\x89PNG\r\n\x1a\n"
FREQUENCY = np.array([5.0, 20.0, 60.0, 97.0, 180.0])


@pytest.fixture(scope="module")
def line() -> object:
    return slab_track_viaduct_32m(pad=Hysteretic(stiffness=6e7, loss_factor=0.1), girder="elastic_bearings")


@pytest.fixture(scope="module")
def hammer(line: object) -> xr.Dataset:
    forces = [Place(body="rail", x_m=16.0, name=name) for name in ("rail / mid", "rail: mid")]
    return receptance(line, FREQUENCY, forces=forces, sensors=[Place(body="girder", x_m=16.0), forces[0]])


@pytest.fixture(scope="module")
def passing(line: object) -> xr.Dataset:
    return train_response(line, train(), GermanSato(), FREQUENCY)


def check(paths: list[Path], names: list[str]) -> None:
    assert [p.name for p in paths] == names
    for path in paths:
        assert path.read_bytes().startswith(PNG)
        assert path.stat().st_size > 5_000


def test_a_hammer_test_gives_one_picture_for_each_force(hammer: xr.Dataset, tmp_path: Path) -> None:
    check(draw_dataset(hammer, tmp_path / "new"), ["receptance-rail-mid.png", "receptance-rail-mid-2.png"])


def test_a_train_gives_spectra_flexibilities_and_decay(passing: xr.Dataset, tmp_path: Path) -> None:
    names = ["wheel-rail-force", "vehicle-acceleration", "line-acceleration", "contact-receptance", "decay-rate"]
    check(draw_dataset(passing, tmp_path), [f"{n}.png" for n in names])
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(f"{n}.png" for n in names)


def test_one_frequency_is_drawn_too(passing: xr.Dataset, tmp_path: Path) -> None:
    assert len(draw_dataset(passing.isel(frequency=[2]), tmp_path)) == 5


def test_the_same_data_give_the_same_files(hammer: xr.Dataset, tmp_path: Path) -> None:
    first, second = (draw_dataset(hammer, tmp_path / name) for name in ("a", "b"))
    assert [p.read_bytes() for p in first] == [p.read_bytes() for p in second]


def test_resolution_is_on_request(hammer: xr.Dataset, tmp_path: Path) -> None:
    def width(path: Path) -> int:
        return int.from_bytes(path.read_bytes()[16:20], "big")

    normal, fine = (draw_dataset(hammer, tmp_path / str(dpi), dpi=dpi)[0] for dpi in (150, 300))
    assert width(fine) == 2 * width(normal)


def test_an_unusable_folder_is_refused(hammer: xr.Dataset, tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(InputError, match="not a folder"):
        draw_dataset(hammer, tmp_path / "taken")
    with pytest.raises(InputError, match="no such folder"):
        draw_dataset(hammer, tmp_path / "none" / "here")
