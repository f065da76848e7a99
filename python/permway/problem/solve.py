"""A model's whole answer as one dataset, and the file that holds it."""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5netcdf
import xarray as xr

from permway.errors import InputError, must_be
from permway.files import write_bytes
from permway.problem.model import Model
from permway.response.passby.run import passby
from permway.response.rails import both_rails
from permway.response.receptance import Progress, receptance
from permway.response.train import train_response

_REMEDY = "as in solve(read_model(path)); a line alone is solved by permway.receptance"


def solve(model: Model, *, threads: int | None = None, progress: Progress | None = None) -> xr.Dataset:
    """Receptances, a train's spectra if there is one, and its passage if that is asked for.

    Parameters
    ----------
    model : Model
    threads : int, optional
        By default all processors.
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    xarray.Dataset
        See :func:`permway.response.receptance.receptance`, :func:`permway.response.rails.both_rails` and
        :func:`permway.response.train.train_response`; of a passage the variables of
        :func:`permway.response.passby.run.passby`, as `passby_history` and so on.

    Raises
    ------
    InputError, SolveError
        As those two.
    """
    if not isinstance(model, Model):
        remedy = f"as in solve(read_model({str(model)!r}))" if isinstance(model, str | os.PathLike) else _REMEDY
        raise InputError(f"must be a Model, not a {type(model).__name__}", where="model", remedy=remedy)
    frequency = model.frequencies.array()
    parts = []
    # First, for its complaints come late.
    passage = _passage(model, threads, progress) if model.passby is not None else None
    if model.train is not None and model.irregularity is not None:
        parts.append(
            train_response(
                model.line,
                model.train,
                model.irregularity,
                frequency,
                sensors=model.sensors,
                temperature_C=model.temperature_C,
                conversion=model.conversion,
                formulation=model.formulation,
                threads=threads,
                progress=progress,
            )
        )
    if model.forces:
        options: dict[str, Any] = {
            "forces": model.forces,
            "sensors": model.sensors,
            "temperature_C": model.temperature_C,
            "formulation": model.formulation,
            "threads": threads,
            "progress": progress,
        }
        if model.roll is not None:
            parts.append(both_rails(model.line, model.roll, frequency, **options))
        else:
            parts.append(receptance(model.line, frequency, **options))
    if passage is not None:
        parts.append(passage)
    data = xr.merge(parts, combine_attrs="drop_conflicts", join="exact")
    data.attrs = {
        **parts[-1].attrs,
        **parts[0].attrs,
        "title": model.title,
        "model": model.model_dump_json(by_alias=True),
    }
    return data


def _passage(model: Model, threads: int | None, progress: Progress | None) -> xr.Dataset:
    """The passage with names that stand beside the others', its frequencies among them."""
    assert model.passby is not None
    assert model.train is not None
    settings = model.passby.model_dump(exclude={"dynamic", "seed"})
    random = model.passby.dynamic and model.irregularity is not None
    data = passby(
        model.line,
        model.train,
        sensors=model.sensors,
        irregularity=model.irregularity if random else None,
        seed=model.passby.seed if random else None,
        temperature_C=model.temperature_C,
        formulation=model.formulation,
        threads=threads,
        progress=progress,
        **settings,
    )
    names = {str(name): f"passby_{name}" for name in data.data_vars}
    renamed = data.rename({**names, "frequency": "passby_frequency"})
    renamed.attrs = {f"passby_{name}": value for name, value in data.attrs.items()}
    return renamed


LARGEST_IN_MEMORY = 2**30
"""Bytes of a dataset that is made a file in memory first."""


def netcdf_bytes(groups: Mapping[str, xr.Dataset]) -> bytes:
    """Datasets as the content of one NetCDF file, by group; "" is the root.

    Made in memory: the HDF5 library crashes where it finds the disk full, and a process that is killed leaves no
    temporary file behind.
    """
    made = io.BytesIO()
    with h5netcdf.File(made, "w", invalid_netcdf=True) as file:
        for group, data in groups.items():
            data.dump_to_store(xr.backends.H5NetCDFStore(file, group=group or None, mode="a"))
    return made.getvalue()


def write_dataset(data: xr.Dataset, path: str | Path) -> Path:
    """Write a dataset as NetCDF, whole or not at all.

    Complex variables are stored as HDF5 compound numbers, which xarray with h5netcdf reads back.

    Raises
    ------
    InputError
        If the place cannot be written.
    """
    must_be(data, xr.Dataset, "data", remedy="as in write_dataset(data, path)")
    must_be(path, (str, Path), "path")
    path = Path(path)
    if data.nbytes < LARGEST_IN_MEMORY:
        return write_bytes(path, netcdf_bytes({"": data}))
    temporary = None
    try:
        # In the same folder, for only within one file system is a rename a single step.
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
        with os.fdopen(handle, "wb") as file:
            if hasattr(os, "posix_fallocate"):
                os.posix_fallocate(file.fileno(), 0, data.nbytes + 2**20)
        data.to_netcdf(temporary, engine="h5netcdf", invalid_netcdf=True)
        # mkstemp's files are for the user alone; a dataset is as public as any other file.
        Path(temporary).chmod(0o666 & ~_umask())
        os.replace(temporary, path)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"cannot be written: {reason}", where=str(path), remedy="name a file in a folder that exists"
        ) from error
    finally:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)
    return path


def _umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
