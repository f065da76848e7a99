"""Many datasets of one structure as NetCDF: the structure is written once, then filled.

Writing it anew takes h5netcdf ten times as long as filling it, and longer than a small case takes to compute.
"""

from __future__ import annotations

import io
import pickle
from collections import OrderedDict
from threading import Lock
from typing import Any

import h5py
import xarray as xr

from permway.problem.solve import netcdf_bytes

MOST_STRUCTURES = 8

_structures: OrderedDict[bytes, bytes] = OrderedDict()
_lock = Lock()


def to_netcdf(data: xr.Dataset) -> bytes:
    """A dataset as the content of a NetCDF file, as :func:`permway.problem.solve.write_dataset` writes it.

    The same dataset gives the same numbers, names and attributes; within a process, the same bytes.
    """
    values = {str(name): v.values for name, v in data.data_vars.items() if v.dtype.kind in "fc"}
    empty = data.drop_attrs(deep=False).assign({name: xr.zeros_like(data[name]) for name in values})
    # In memory: a process that is killed leaves nothing behind.
    content = io.BytesIO(_structure(empty))
    with h5py.File(content, "r+") as file:
        for name, array in values.items():
            file[name][()] = array
        for key, value in data.attrs.items():
            file.attrs[key] = value
    return content.getvalue()


def _structure(empty: xr.Dataset) -> bytes:
    key = pickle.dumps([_described(name, v) for name, v in empty.variables.items()])
    with _lock:
        if key in _structures:
            _structures.move_to_end(key)
            return _structures[key]
    content = netcdf_bytes({"": empty})
    with _lock:
        _structures[key] = content
        while len(_structures) > MOST_STRUCTURES:
            _structures.popitem(last=False)
    return content


def _described(name: object, variable: xr.Variable) -> list[Any]:
    values = variable.values
    content = values.tolist() if values.dtype == object else values.tobytes()
    return [str(name), variable.dims, values.shape, values.dtype.str, content, sorted(variable.attrs.items())]
