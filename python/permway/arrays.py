"""Arrays of numbers: their types, and what is refused of real numbers, frequencies and temperatures."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from permway.errors import InputError

Reals = NDArray[np.float64]
Complexes = NDArray[np.complex128]

ABSOLUTE_ZERO_C = -273.15

COLDEST_C, HOTTEST_C = -100.0, 150.0
"""Temperatures of a track, degC: what lies beyond is in kelvin. At half of the upper rails in the sun are near it,
at twice of it 293 K is taken for degrees; no line is in use at half of the lower."""


def real_numbers(values: ArrayLike, where: str) -> Reals:
    """Real numbers as float64; numpy by itself would drop an imaginary part with a mere warning.

    Parameters
    ----------
    values : array_like
        Finite or not.
    where : str
        The argument's name.

    Raises
    ------
    InputError
        For complex numbers, whatever their imaginary parts, and for what is no array of numbers.
    """
    try:
        array = np.asarray(values)
        if any_complex(array):
            raise InputError("must be real, not complex", where=where, value=values, remedy=_REAL)
        if array.dtype.kind in "US" or (array.dtype == object and any(isinstance(v, str) for v in array.flat)):
            what = "not a number or an array of numbers"
            raise InputError(what, where=where, value=values, remedy="give numbers, without quotation marks")
        return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("not a number or an array of numbers", where=where, value=values) from error


def any_complex(array: np.ndarray) -> bool:
    """Whether an array is complex, or is one of objects that has a complex number among them."""
    return np.iscomplexobj(array) or (array.dtype == object and any(np.iscomplexobj(v) for v in array.flat))


def is_real(value: object) -> bool:
    """Whether something is one real number of Python or numpy, which a truth value is not."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


_REAL = "give its real part, or its modulus, if that is what is meant"


def check_frequency(frequency_Hz: ArrayLike) -> Reals:
    """Frequencies as float64, refused with index and value unless finite and positive."""
    frequency = real_numbers(frequency_Hz, "frequency_Hz")
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
    temperature = real_numbers(temperature_C, "temperature_C")
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


def check_track_temperature(temperature_C: float | None) -> None:
    """Refuse a temperature that no track has, as files of models and campaigns do."""
    # What is no number is refused by the laws that need one.
    if is_real(temperature_C) and temperature_C is not None and not COLDEST_C <= temperature_C <= HOTTEST_C:
        what = "is no temperature of a track: give degrees Celsius, not kelvin"
        raise InputError(what, where="temperature_C", value=temperature_C)


def _first(values: Reals, bad: NDArray[np.bool_]) -> tuple[str, float]:
    index = tuple(int(axis[0]) for axis in np.nonzero(bad)) if values.ndim else ()
    where = "[" + ", ".join(map(str, index)) + "]" if index else ""
    return where, float(values[index])
