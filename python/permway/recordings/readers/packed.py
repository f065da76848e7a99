"""Packed numbers and missing values, as the conventions of NetCDF write them.

Source: CF Metadata Conventions 1.11, sections 2.5.1 and 8.1; NetCDF User's Guide, appendix A.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from permway.errors import InputError
from permway.recordings.readers.stored import Variable

_MISSING = ("_FillValue", "missing_value")
_KEYS = {"scale_factor", "add_offset", "valid_min", "valid_max", "valid_range", "_Unsigned", *_MISSING}

DEFAULT_FILL = {"f": 9.969209968386869e36, "i2": -32767, "i4": -2147483647, "i8": -9223372036854775806}
"""What the NetCDF library writes where nothing was written."""


def unpacked(variable: Variable, where: str, *, fill: float | None = None) -> Variable:
    """A variable whose numbers are the packed ones times `scale_factor` plus `add_offset`, missing ones NaN.

    Parameters
    ----------
    variable : Variable
    where : str
        For messages.
    fill : float, optional
        What the format itself writes where nothing was written.
    """
    found = {key: value for key, value in variable.attributes.items() if key in _KEYS}
    if variable.kind != "real" or not (found or fill is not None):
        return variable
    scale, offset = _number(found, "scale_factor", 1.0, where), _number(found, "add_offset", 0.0, where)
    missing = [x for key in _MISSING for x in _numbers(found, key, where)]
    if fill is not None and "_FillValue" not in found:
        missing.append(fill)
    low, high = _valid(found, where)
    unsigned = str(found.get("_Unsigned", "")).lower() == "true"

    def read(slices: tuple[slice, ...]) -> NDArray[np.generic]:
        raw = np.asarray(variable.read(slices))
        if unsigned and raw.dtype.kind == "i":
            raw = raw.view(raw.dtype.str.replace("i", "u"))
        bad = np.zeros(raw.shape, dtype=bool)
        for value in missing:
            # In the packed numbers' own precision: 9.96921e36 as a single is not the double of that name.
            same = raw == raw.dtype.type(value) if raw.dtype.kind == "f" or float(value).is_integer() else None
            bad |= False if same is None else same
        with np.errstate(invalid="ignore"):
            bad |= (raw < low) | (raw > high)
        plain = raw.astype(np.float64)
        values = plain if (scale, offset) == (1.0, 0.0) else plain * scale + offset
        values[bad] = np.nan
        return values

    return replace(variable, read=read, resolution=abs(scale) if scale != 1.0 else variable.resolution)


def _valid(found: dict[str, object], where: str) -> tuple[float, float]:
    both = _numbers(found, "valid_range", where)
    if len(both) == 2:
        return both[0], both[1]
    return _number(found, "valid_min", -np.inf, where), _number(found, "valid_max", np.inf, where)


def _numbers(found: dict[str, object], key: str, where: str) -> list[float]:
    if key not in found:
        return []
    try:
        return [float(x) for x in np.ravel(np.asarray(found[key]))]
    except (TypeError, ValueError):
        raise InputError("must be a number", where=f"{where}: {key}", value=found[key]) from None


def _number(found: dict[str, object], key: str, default: float, where: str) -> float:
    values = _numbers(found, key, where)
    if key in found and (len(values) != 1 or not np.isfinite(values[0])):
        raise InputError("must be one finite number", where=f"{where}: {key}", value=found[key])
    if key == "scale_factor" and values == [0.0]:
        raise InputError("must not be 0", where=f"{where}: {key}", value=0.0)
    return values[0] if values else default
