"""Datasets as tables: pandas frames and CSV."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from permway.errors import InputError, must_be
from permway.files import write_text

if TYPE_CHECKING:
    import pandas as pd


def to_frame(data: xr.Dataset | xr.DataArray) -> pd.DataFrame:
    """A dataset as a pandas table: a row for each combination of its dimensions, a column for each variable.

    Parameters
    ----------
    data : Dataset or DataArray
        Of permway. Variables that lack a dimension of the others are repeated along it.

    Returns
    -------
    pandas.DataFrame
        Dimensions and coordinates first. Units stand in the names, "decay_rate [dB/m]"; a complex variable is two
        columns, "receptance.re [m/N]" and "receptance.im [m/N]".

    Raises
    ------
    InputError
        For what is no dataset, or one whose variables share no dimension: choose some, `data[["name", "other"]]`.
    """
    if isinstance(data, xr.DataArray):
        data = data.to_dataset(name=str(data.name or "value"))
    if not isinstance(data, xr.Dataset):
        raise InputError(
            f"must be a Dataset or one of its variables, not a {type(data).__name__}",
            where="data",
            remedy="take what permway.solve, permway.receptance or permway.modes returns",
        )
    _check_alike(data)
    whole = data.reset_coords()
    for name in [str(name) for name in whole.data_vars]:
        variable = whole[name]
        if np.iscomplexobj(variable):
            parts = {f"{name}.re": variable.real, f"{name}.im": variable.imag}
            whole = whole.drop_vars(name).assign(
                {key: part.assign_attrs(variable.attrs) for key, part in parts.items()}
            )
    frame = whole.to_dataframe().reset_index() if whole.sizes else whole.expand_dims("row").to_dataframe()
    named = {name: _titled(str(name), data, whole) for name in frame.columns}
    ahead = [c for c in frame.columns if c in data.coords]
    return frame[[*ahead, *(c for c in frame.columns if c not in ahead)]].rename(columns=named)


def write_csv(data: xr.Dataset | xr.DataArray, path: str | Path) -> Path:
    """Write a dataset as a table, whole or not at all; columns as in :func:`to_frame`, nine digits.

    Raises
    ------
    InputError
        As :func:`to_frame`, or if the place cannot be written.
    """
    must_be(path, (str, Path), "path")
    return write_text(Path(path), to_frame(data).to_csv(index=False, float_format="%.9g", lineterminator="\n"))


def _check_alike(data: xr.Dataset) -> None:
    """Refuse variables that would be repeated against each other, as `frequency` against `joint`."""
    shapes = {str(name): {str(dim) for dim in variable.dims} for name, variable in data.data_vars.items()}
    largest = max(shapes.values(), key=len, default=set())
    unshared = [name for name, dims in shapes.items() if not dims <= largest]
    if unshared:
        with_it = [name for name in shapes if name not in unshared]
        raise InputError(
            f"has no dimensions in common with {with_it}",
            where=f"data[{unshared[0]!r}]",
            value=sorted(shapes[unshared[0]]),
            remedy=f"make a table of each, as in data[{[unshared[0]]}]",
        )


def _titled(name: str, data: xr.Dataset, whole: xr.Dataset) -> str:
    unit = (data if name in data.variables else whole)[name].attrs.get("units", "")
    return name if unit in ("", "1") else f"{name} [{unit}]"
