"""All cases of a sweep as one dataset with named dimensions."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from permway.errors import InputError
from permway.study.places import written
from permway.study.plan import Plan, digest
from permway.study.store import plan_of, read_manifest

_OF_ONE_CASE = {"model", "failures", "title"}


def open_study(folder: str | Path) -> xr.Dataset:
    """Open the results of a sweep, done or not.

    With dask installed the variables are read when they are used, a chunk for each case; else they are read here.

    Parameters
    ----------
    folder : path

    Returns
    -------
    xarray.Dataset
        The variables of a case, each with the study's dimensions before its own. `case_status` states "done",
        "failed" or "missing" of every case; those without a file are NaN, and attribute `failed` lists the failed
        ones with their errors as JSON. What sets an axis stands along it as a coordinate.

    Raises
    ------
    InputError
        If the folder holds no sweep, or no case of it is done, or cases do not fit together.
    """
    folder = Path(folder)
    manifest = read_manifest(folder)
    plan = plan_of(manifest, str(folder / "study.json"))
    there = {entry.name for entry in os.scandir(folder)}
    names = [plan.file_name(i) for i in range(plan.cases)]
    done = np.array([name in there for name in names])
    if not done.any():
        raise InputError("no case is done", where=str(folder), remedy="run permway sweep")
    cases = _Cases(
        plan.shape,
        tuple(str(folder / name) if name in there else None for name, _ in zip(names, done, strict=True)),
    )
    # A case that failed once may have been computed since.
    failed = {f["case"]: f for f in manifest["failed"] if not done[f["case"]]}
    status = np.where(done, "done", "missing").astype("<U7")
    status[list(failed)] = "failed"
    title = manifest["title"]
    data = _joined(cases, plan)
    data["case_status"] = (_names(plan), status.reshape(plan.shape))
    data.attrs |= {"title": title, "failed": json.dumps(list(failed.values())), "study": manifest["study"]}
    return data


@dataclass(frozen=True)
class _Cases:
    """Files by index; None where there is none."""

    shape: tuple[int, ...]
    paths: tuple[str | None, ...]

    @property
    def first(self) -> str:
        """The first file there is."""
        return next(path for path in self.paths if path is not None)

    def corners(self) -> list[str]:
        """The first file there is, and those at the ends of the axes."""
        ends = product(*({0, size - 1} for size in self.shape))
        at = [
            self.paths[int(np.ravel_multi_index(end, self.shape))] for _, end in zip(range(64), ends, strict=False)
        ]
        return list(dict.fromkeys([self.first, *(path for path in at if path is not None)]))


def _names(plan: Plan) -> list[str]:
    return [d.name for d in plan.dimensions]


def _joined(cases: _Cases, plan: Plan) -> xr.Dataset:
    corners = {path: _read(path) for path in cases.corners()}
    first = corners.pop(cases.first)
    for path, other in corners.items():
        _check_alike(first, other, path)
    moving = [
        name
        for name in first.coords
        if name not in first.dims and any(not _equal(first, other, name) for other in corners.values())
    ]
    dimensions = _names(plan)
    variables: dict[Any, Any] = {}
    for name, values in _stacked(cases, first, [str(name) for name in [*first.data_vars, *moving]]).items():
        variables[name] = ([*dimensions, *first[name].dims], values, first[name].attrs)
    still = {name: first[name].variable for name in first.coords if name not in moving}
    data = xr.Dataset(variables, coords={**still, **_coordinates(plan)}).set_coords(moving)
    data.attrs = {
        key: value
        for key, value in first.attrs.items()
        if key not in _OF_ONE_CASE
        and all(key in other.attrs and np.array_equal(other.attrs[key], value) for other in corners.values())
    }
    return data


def _coordinates(plan: Plan) -> dict[str, Any]:
    """Along every dimension what its axes set."""
    coordinates: dict[str, Any] = {}
    for dimension in plan.dimensions:
        if len(dimension.axes) > 1 or dimension.name != dimension.axes[0].name:
            coordinates[dimension.name] = np.arange(dimension.size)
        for axis in dimension.axes:
            paths = ", ".join(written(place) for place in axis.places)
            coordinates[axis.name] = (dimension.name, axis.coordinate(), {"sets": paths})
    return coordinates


def _stacked(cases: _Cases, first: xr.Dataset, names: list[str]) -> dict[str, Any]:
    """Variables of all cases: dask arrays of a chunk per case, or, without dask, arrays."""
    try:
        import dask.array
    except ImportError:
        read = [_reader(first, name, 0) for name in names]
        return {
            name: np.stack([one(path) for path in cases.paths]).reshape(*cases.shape, *first[name].shape)
            for name, one in zip(names, read, strict=True)
        }
    arrays = {}
    token = digest(cases.paths)[:16]
    for name in names:
        shape, key = first[name].shape, f"permway-{name}-{token}"
        read_block = _reader(first, name, len(cases.shape))
        graph = {
            (key, *at, *(0 for _ in shape)): (read_block, path)
            for at, path in zip(np.ndindex(cases.shape), cases.paths, strict=True)
        }
        chunks = [*((1,) * size for size in cases.shape), *((size,) for size in shape)]
        kind = _kind(first[name].dtype)
        arrays[name] = dask.array.Array(graph, key, chunks, dtype=kind)  # type: ignore[no-untyped-call]
    return arrays


def _reader(first: xr.Dataset, name: str, dimensions: int) -> Callable[[str | None], np.ndarray[Any, Any]]:
    """What reads a variable of one case, with so many dimensions of length one before its own."""
    variable = first[name]
    labels = {str(dim): first[dim].values for dim in variable.dims if dim in first.coords}
    return partial(
        _block, name=name, labels=labels, shape=variable.shape, kind=_kind(variable.dtype), dimensions=dimensions
    )


def _kind(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """A type that holds the values and knows a missing one."""
    return np.result_type(dtype, np.float64) if dtype.kind in "biufc" else np.dtype(object)


def _missing(shape: tuple[int, ...], kind: np.dtype[Any]) -> np.ndarray[Any, Any]:
    nothing: object = {"c": complex(np.nan, np.nan), "f": np.nan}.get(kind.kind)
    return np.full(shape, nothing, dtype=kind)


def _block(
    path: str | None,
    *,
    name: str,
    labels: dict[str, np.ndarray[Any, Any]],
    shape: tuple[int, ...],
    kind: np.dtype[Any],
    dimensions: int,
) -> np.ndarray[Any, Any]:
    whole = (1,) * dimensions + shape
    if path is None:
        return _missing(whole, kind)
    try:
        # Ten times as fast as through xarray; the structure is known from the first case.
        with h5py.File(path, "r") as file:
            for dim, expected in labels.items():
                if not np.array_equal(_content(file[dim]), expected):
                    raise _unlike(dim, path)
            values = _content(file[name])
    except (OSError, KeyError) as error:
        raise _unreadable(path, error) from error
    if values.shape != shape:
        raise _unlike(name, path)
    return values.astype(kind, copy=False).reshape(whole)


def _content(stored: Any) -> np.ndarray[Any, Any]:
    return np.asarray(stored.asstr()[()] if h5py.check_string_dtype(stored.dtype) else stored[()])


def _read(path: str) -> xr.Dataset:
    try:
        with xr.open_dataset(path, engine="h5netcdf") as data:
            return data.load()
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot be read: {error}", where=path, remedy="delete it and run the study again"
        ) from error


def _equal(first: xr.Dataset, other: xr.Dataset, name: Hashable) -> bool:
    return np.array_equal(first[name].values, other[name].values)


def _check_alike(first: xr.Dataset, other: xr.Dataset, path: str) -> None:
    for name in first.dims:
        if name not in other.dims or not _equal(first, other, name):
            raise _unlike(name, path)


def _unlike(name: Hashable, path: str) -> InputError:
    return InputError(
        f"cases differ in {name}: they make no one dataset",
        where=path,
        remedy="give places a name, and all cases the same frequencies; or open the files one by one",
    )


def _unreadable(path: str, error: Exception) -> InputError:
    return InputError(f"cannot be read: {error}", where=path, remedy="delete it and run the study again")
