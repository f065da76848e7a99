"""What is refused of records, spectra and numbers before anything is estimated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from permway.arrays import Complexes, Reals, is_real, real_numbers
from permway.errors import InputError


def check_positive(value: float, where: str, remedy: str = "") -> float:
    """A finite number above zero."""
    if not is_real(value):
        raise InputError("must be a number", where=where, value=value, remedy=remedy)
    if not (np.isfinite(value) and value > 0.0):
        raise InputError("must be finite and above zero", where=where, value=value, remedy=remedy)
    return float(value)


def check_level(level: float) -> float:
    """A probability of coverage, 0.95 and the like."""
    if not 0.0 < check_positive(level, "level") < 1.0:
        raise InputError("must lie between 0 and 1", where="level", value=level, remedy="0.95 is 95 %")
    return float(level)


def check_finite(values: Complexes | Reals, where: str, *, offset: int = 0) -> None:
    """Refuse NaN and infinity with their index; `offset` shifts the last one."""
    bad = ~np.isfinite(values)
    if bad.any():
        index = [int(place) for place in np.argwhere(bad)[0]]
        value = values[tuple(index)]
        if index:
            index[-1] += offset
        place = f"[{', '.join(map(str, index))}]" if index else ""
        raise InputError(
            f"not finite ({int(bad.sum())} such value(s) here)",
            where=where + place,
            value=complex(value) if np.iscomplexobj(values) else float(value),
            remedy="cut the record there, or mark the channel as faulty; nothing is repaired",
        )


def as_reals(values: ArrayLike, where: str, *, ndim: int | None = None) -> Reals:
    """Finite real numbers of a given number of dimensions."""
    array = np.array(real_numbers(values, where))
    if ndim is not None and array.ndim != ndim:
        raise InputError(f"must have {ndim} dimension(s)", where=where, value=f"shape {array.shape}")
    check_finite(array, where)
    return array


def as_complexes(values: ArrayLike, where: str) -> Complexes:
    """Finite complex numbers."""
    try:
        array = np.asarray(values, dtype=np.complex128)
    except (TypeError, ValueError) as error:
        raise InputError("not numbers", where=where, value=values) from error
    check_finite(array, where)
    return array


def check_names(names: Sequence[str] | None, count: int) -> list[str]:
    """Names of the channels, each once; numbers where none are given."""
    if names is None:
        return [str(i) for i in range(count)]
    given = [str(name) for name in names]
    if len(given) != count:
        raise InputError(f"{len(given)} name(s) for {count} channel(s)", where="channels", remedy="give one each")
    for name in given:
        if given.count(name) > 1:
            raise InputError("a channel named twice", where="channels", value=name, remedy="names must differ")
    return given


def check_units(units: str | Sequence[str] | None, count: int) -> list[str]:
    """One unit for each channel; "" where none is given."""
    given = [units] * count if isinstance(units, str) else list(units or [""] * count)
    if len(given) != count:
        raise InputError(f"{len(given)} unit(s) for {count} channel(s)", where="units", remedy="give one each")
    return given


def variable(data: xr.Dataset, name: str, where: str) -> xr.DataArray:
    """A variable that a dataset must hold."""
    if not isinstance(data, xr.Dataset) or name not in data:
        raise InputError(f"has no `{name}`", where=where, remedy="give a dataset of permway.recordings.estimates")
    return data[name]


def attribute(data: xr.Dataset, name: str, where: str) -> float:
    """A number that a dataset must carry as an attribute."""
    if name not in data.attrs:
        raise InputError(f"has no attribute `{name}`", where=where, remedy="give it, or estimate it again")
    return float(data.attrs[name])
