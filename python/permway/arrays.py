"""Arrays of numbers: their types, and what is refused of frequencies and temperatures."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from permway.errors import InputError

Reals = NDArray[np.float64]
Complexes = NDArray[np.complex128]

ABSOLUTE_ZERO_C = -273.15


def check_frequency(frequency_Hz: ArrayLike) -> Reals:
    """Frequencies as float64, refused with index and value unless finite and positive."""
    frequency = _as_floats(frequency_Hz, "frequency_Hz")
    bad = ~(np.isfinite(frequency) & (frequency > 0.0))
    if bad.any():
        where, value = _first(frequency, bad)
        raise InputError(
            "a frequency must be finite and above 0 Hz",
            where=f"frequency_Hz{where}",
            value=value,
            remedy="leave 0 Hz out; for the static limit take a low frequency",
        )
    return frequency


def check_temperature(temperature_C: ArrayLike | None) -> Reals | None:
    """Temperatures as float64, refused unless finite and above absolute zero."""
    if temperature_C is None:
        return None
    temperature = _as_floats(temperature_C, "temperature_C")
    bad = ~(np.isfinite(temperature) & (temperature > ABSOLUTE_ZERO_C))
    if bad.any():
        where, value = _first(temperature, bad)
        raise InputError(
            "a temperature must be finite and above -273.15 degC",
            where=f"temperature_C{where}",
            value=value,
            remedy="give degrees Celsius",
        )
    return temperature


def _as_floats(values: ArrayLike, name: str) -> Reals:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("not a number or an array of numbers", where=name, value=values) from error


def _first(values: Reals, bad: NDArray[np.bool_]) -> tuple[str, float]:
    index = tuple(int(axis[0]) for axis in np.nonzero(bad)) if values.ndim else ()
    where = "[" + ", ".join(map(str, index)) + "]" if index else ""
    return where, float(values[index])
