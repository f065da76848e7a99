"""Many datasets of one structure as NetCDF: the structure is written once, then filled.

Writing it anew takes h5netcdf ten times as long as filling it, and longer than a small case takes to compute.
"""

from __future__ import annotations

import pickle
import tempfile
from collections import OrderedDict
from pathlib import Path
from threading import Lock
from typing import Any

import h5py
import xarray as xr

from permway.response.solve import write_dataset

MOST_STRUCTURES = 8

_structures: OrderedDict[bytes, bytes] = OrderedDict()
_lock = Lock()


def to_netcdf(data: xr.Dataset) -> bytes:
    """A dataset as the content of a NetCDF file, as :func:`permway.response.solve.write_dataset` writes it.

    The same dataset gives the same bytes.
    """
    values = {str(name): v.values for name, v in data.data_vars.items() if v.dtype.kind in "fc"}
    empty = data.drop_attrs(deep=False).assign({name: xr.zeros_like(data[name]) for name in values})
    with tempfile.TemporaryDirectory(prefix="permway-") as folder:
        path = Path(folder) / "case.nc"
        path.write_bytes(_structure(empty, path))
        with h5py.File(path, "r+") as file:
            for name, array in values.items():
                file[name][()] = array
            for key, value in data.attrs.items():
                file.attrs[key] = value
        return path.read_bytes()


def _structure(empty: xr.Dataset, path: Path) -> bytes:
    key = pickle.dumps([_described(name, v) for name, v in empty.variables.items()])
    with _lock:
        if key in _structures:
            _structures.move_to_end(key)
            return _structures[key]
    content = write_dataset(empty, path).read_bytes()
    with _lock:
        _structures[key] = content
        while len(_structures) > MOST_STRUCTURES:
            _structures.popitem(last=False)
    return content


def _described(name: object, variable: xr.Variable) -> list[Any]:
    values = variable.values
    content = values.tolist() if values.dtype == object else values.tobytes()
    return [str(name), variable.dims, values.shape, values.dtype.str, content, sorted(variable.attrs.items())]
