"""Files filled into a structure read back as those written at once."""

import numpy as np
import pytest
import xarray as xr
from permway.formats.model_file import model_from_dict
from permway.problem.solve import solve, write_dataset
from permway.study import netcdf


def opened(content, path):
    path.write_bytes(content)
    with xr.open_dataset(path, engine="h5netcdf") as data:
        return data.load()


@pytest.fixture
def with_train(model):
    model["train"] = {"vehicle": {"preset": "crh380a", "share": 0.5}, "centre_m": 0.9, "speed_m_per_s": 90.0}
    model["irregularity"] = {"type": "german_sato"}
    return solve(model_from_dict(model), threads=1)


def test_every_bit_is_kept(with_train, tmp_path):
    data = with_train
    write_dataset(data, tmp_path / "at_once.nc")
    at_once = opened((tmp_path / "at_once.nc").read_bytes(), tmp_path / "at_once.nc")
    for values in (data.copy(), data * 2.0 + 1e-300, data * np.nan):
        values.attrs = {**data.attrs, "title": str(float(abs(values["receptance"]).sum()))}
        for name in data.data_vars:
            values[name].attrs = data[name].attrs
        xr.testing.assert_identical(opened(netcdf.to_netcdf(values), tmp_path / "filled.nc"), values)
    filled = opened(netcdf.to_netcdf(data), tmp_path / "filled.nc")
    xr.testing.assert_identical(filled, at_once)
    assert {n: v.encoding.get("_FillValue") is None for n, v in filled.variables.items()} == {
        n: v.encoding.get("_FillValue") is None for n, v in at_once.variables.items()
    }


def test_the_same_bytes_whatever_was_written_before(with_train):
    data = with_train
    netcdf._structures.clear()
    first = netcdf.to_netcdf(data)
    moved = data.assign_coords(sensor_x=("sensor", [1.0, 2.0], {"units": "m"}))
    for _ in range(2):
        assert netcdf.to_netcdf(moved) != first
        assert netcdf.to_netcdf(data * 3.0) != first
        assert netcdf.to_netcdf(data) == first


def test_no_more_structures_are_kept_than_stated(with_train):
    for x in range(2 * netcdf.MOST_STRUCTURES):
        netcdf.to_netcdf(with_train.assign_coords(sensor_x=("sensor", [0.0, x], {"units": "m"})))
    assert len(netcdf._structures) == netcdf.MOST_STRUCTURES
