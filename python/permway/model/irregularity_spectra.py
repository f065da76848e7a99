"""What every irregularity spectrum is: density over wavenumber, its conversion to hertz, its checks."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import PositiveFloat

from permway.arrays import Reals, check_frequency, real_numbers
from permway.errors import InputError
from permway.records import FrozenModel

Conversion = Literal["per_hertz", "wavenumber_density_called_per_hertz"]

FASTEST_M_PER_S = 150.0
"""Speeds above this (540 km/h) are taken for a speed in km/h by mistake."""

EDGE = 1e-9
"""Relative slack at the ends of a valid range, for wavelengths that went through 2 pi and back."""


class RangeWarning(UserWarning):
    """A closed-form spectrum was asked for wavelengths its source does not cover."""


class Irregularity(FrozenModel, ABC):
    """What excites: the vertical profile of the running surface as a one-sided density.

    Parameters
    ----------
    scale : float
        Factor on the density: 1 for the source's own level, 2 to read a source as two-sided.
    """

    scale: PositiveFloat = 1.0

    @property
    @abstractmethod
    def valid_wavelength_m(self) -> tuple[float, float]:
        """Shortest and longest wavelength (m) that the source covers."""

    @abstractmethod
    def _density(self, wavenumber: Reals) -> Reals:
        """One-sided density, m^2/(rad/m), before `scale`."""

    def outside_range(self, wavenumber_rad_per_m: ArrayLike) -> NDArray[np.bool_]:
        """Mark the wavenumbers whose wavelength the source does not cover.

        Parameters
        ----------
        wavenumber_rad_per_m : array_like, any shape
            Wavenumbers 2 pi / wavelength, rad/m, finite and above zero.

        Returns
        -------
        ndarray of bool
            Shape of the input.

        Raises
        ------
        InputError
            For a wavenumber that is not finite and positive.
        """
        wavelength = 2.0 * np.pi / check_wavenumber(wavenumber_rad_per_m)
        shortest, longest = self.valid_wavelength_m
        return np.asarray((wavelength < shortest * (1.0 - EDGE)) | (wavelength > longest * (1.0 + EDGE)))

    def wavenumber_density(self, wavenumber_rad_per_m: ArrayLike) -> Reals:
        """One-sided density over wavenumber.

        Parameters
        ----------
        wavenumber_rad_per_m : array_like, any shape
            Wavenumbers 2 pi / wavelength, rad/m, finite and above zero.

        Returns
        -------
        ndarray of float64
            m^2/(rad/m), shape of the input. Its integral over wavenumber is the variance.

        Raises
        ------
        InputError
            For a wavenumber that is not finite and positive; from a table, for one outside it.

        Warns
        -----
        RangeWarning
            Once per call, from a closed form used outside `valid_wavelength_m`.
        """
        return self._density_or_warn(check_wavenumber(wavenumber_rad_per_m))

    def density(
        self,
        frequency_Hz: ArrayLike,
        speed_m_per_s: float,
        conversion: Conversion = "per_hertz",
    ) -> Reals:
        """One-sided density over frequency of the profile met at a constant speed.

        Parameters
        ----------
        frequency_Hz : array_like, any shape
            Finite and above zero.
        speed_m_per_s : float
            Speed of the train V.
        conversion : {"per_hertz", "wavenumber_density_called_per_hertz"}
            "per_hertz": S_f(f) = S(W) 2 pi / V at W = 2 pi f / V, which keeps the variance. The other one
            hands S(W) on unchanged, as the paper does, V/(2 pi) times too large for a density per hertz.

        Returns
        -------
        ndarray of float64
            m^2/Hz (the other conversion: m^2/(rad/m)), shape of `frequency_Hz`.

        Raises
        ------
        InputError
            For a frequency or speed that is not finite and positive, a speed that looks like km/h, an
            unknown conversion; from a table, for a wavelength outside it.

        Warns
        -----
        RangeWarning
            As :meth:`wavenumber_density`.
        """
        speed = check_speed(speed_m_per_s)
        if conversion not in get_args(Conversion):
            raise InputError(
                "unknown conversion",
                where="conversion",
                value=conversion,
                remedy="use " + " or ".join(f'"{name}"' for name in get_args(Conversion)),
            )
        density = self._density_or_warn(2.0 * np.pi * check_frequency(frequency_Hz) / speed)
        return density * (2.0 * np.pi / speed) if conversion == "per_hertz" else density

    def _density_or_warn(self, wavenumber: Reals) -> Reals:
        outside = self.outside_range(wavenumber)
        if outside.any():
            self._meet_outside(wavenumber, outside)
        return np.asarray(self.scale * self._density(wavenumber))

    def _meet_outside(self, wavenumber: Reals, outside: NDArray[np.bool_]) -> None:
        wavelengths = 2.0 * np.pi / wavenumber[outside]
        shortest, longest = self.valid_wavelength_m
        warnings.warn(
            f"{type(self).__name__} covers wavelengths from {shortest:g} to {longest:g} m; "
            f"{wavelengths.size} value(s) from {wavelengths.min():.4g} to {wavelengths.max():.4g} m "
            "lie outside and are the closed form extrapolated",
            RangeWarning,
            stacklevel=4,
        )


def check_wavenumber(wavenumber_rad_per_m: ArrayLike) -> Reals:
    """Wavenumbers as float64, refused with index and value unless finite and positive."""
    wavenumber = real_numbers(wavenumber_rad_per_m, "wavenumber_rad_per_m")
    bad = ~(np.isfinite(wavenumber) & (wavenumber > 0.0))
    if bad.any():
        index = tuple(int(axis[0]) for axis in np.nonzero(bad)) if wavenumber.ndim else ()
        raise InputError(
            "a wavenumber must be finite and above 0 rad/m",
            where="wavenumber_rad_per_m" + (f"{list(index)}" if index else ""),
            value=float(wavenumber[index]),
            remedy="2 pi over the wavelength in metres",
        )
    return wavenumber


def check_speed(speed_m_per_s: float) -> float:
    """A speed as a float, refused unless finite, positive and credible in m/s."""
    try:
        speed = float(real_numbers(speed_m_per_s, "speed_m_per_s"))
    except TypeError as error:
        raise InputError("not a number", where="speed_m_per_s", value=speed_m_per_s) from error
    if not np.isfinite(speed) or speed <= 0.0:
        raise InputError(
            "a speed must be finite and above 0 m/s",
            where="speed_m_per_s",
            value=speed_m_per_s,
            remedy="give the train's speed in m/s (350 km/h is 97.22 m/s)",
        )
    if speed > FASTEST_M_PER_S:
        raise InputError(
            f"a speed above {FASTEST_M_PER_S:g} m/s ({3.6 * FASTEST_M_PER_S:g} km/h) looks like km/h",
            where="speed_m_per_s",
            value=speed_m_per_s,
            remedy=f"divide by 3.6: {speed / 3.6:.2f} m/s",
        )
    return speed
