"""What every law is: a complex dynamic stiffness or modulus over frequency, and its checks."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from permway.arrays import Complexes, Reals, check_frequency, check_temperature
from permway.errors import InputError
from permway.records import FrozenModel, type_name

if TYPE_CHECKING:
    from permway.laws.checks import LawCheck


class Law(FrozenModel, ABC):
    """A linear viscoelastic law k(omega, T) under exp(+i omega t).

    The value is a stiffness (N/m) or a modulus (Pa), whichever its parameters are given in. A positive
    imaginary part is dissipation.
    """

    @property
    def needs_temperature(self) -> bool:
        """Whether the law cannot be evaluated without a temperature."""
        return False

    def complex(self, frequency_Hz: ArrayLike, temperature_C: ArrayLike | None = None) -> Complexes:
        """Complex dynamic stiffness (N/m) or modulus (Pa).

        Parameters
        ----------
        frequency_Hz : array_like, any shape
            Frequencies in Hz, finite and above zero.
        temperature_C : array_like, optional
            Temperature in degrees Celsius: a number, or an array that broadcasts against the frequencies.
            Ignored by a law that does not depend on it.

        Returns
        -------
        ndarray of complex128
            Shape of `frequency_Hz` (broadcast with `temperature_C` if that is an array).

        Raises
        ------
        InputError
            For a frequency that is not finite and positive, and a temperature that is needed and missing.
        """
        frequency = check_frequency(frequency_Hz)
        temperature = check_temperature(temperature_C)
        if temperature is None and self.needs_temperature:
            raise InputError(
                f"the law '{type_name(type(self))}' depends on temperature and none was given",
                where="temperature_C",
                remedy="give a temperature in degrees Celsius",
            )
        if temperature is None or not self.needs_temperature:
            value = self._at(2.0 * np.pi * frequency, None)
        else:
            frequency, temperature = np.broadcast_arrays(frequency, temperature)
            value = self._at(2.0 * np.pi * frequency, temperature)
        return np.asarray(value, dtype=np.complex128)

    def storage(self, frequency_Hz: ArrayLike, temperature_C: ArrayLike | None = None) -> Reals:
        """Real part of :meth:`complex`: what is stored. N/m or Pa."""
        return np.asarray(self.complex(frequency_Hz, temperature_C).real)

    def loss(self, frequency_Hz: ArrayLike, temperature_C: ArrayLike | None = None) -> Reals:
        """Imaginary part of :meth:`complex`: what is dissipated. N/m or Pa."""
        return np.asarray(self.complex(frequency_Hz, temperature_C).imag)

    def loss_factor(self, frequency_Hz: ArrayLike, temperature_C: ArrayLike | None = None) -> Reals:
        """Loss over storage, tan delta (paper, equation (26)). Dimensionless."""
        value = self.complex(frequency_Hz, temperature_C)
        return np.asarray(value.imag / value.real)

    def check(self, band_Hz: tuple[float, float], temperature_C: float | None = None) -> LawCheck:
        """Say whether the law is passive and causal over a band.

        Parameters
        ----------
        band_Hz : (float, float)
            Lowest and highest frequency in Hz.
        temperature_C : float, optional
            Needed by a law that depends on temperature.

        Returns
        -------
        LawCheck
            See :class:`permway.laws.checks.LawCheck`.
        """
        from permway.laws.checks import check_law

        return check_law(self, band_Hz, temperature_C)

    @abstractmethod
    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        """Value at circular frequencies (rad/s), inputs already checked."""

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        """Causality read off the closed form: (known answer or None, why)."""
        return None, ""

    def _static(self) -> float | None:
        """Stiffness at rest if the closed form has one; it must not be negative in a passive law."""
        return None

    def _reach(self, temperature_C: float | None) -> tuple[float, float]:
        """Frequencies at which the law can be evaluated."""
        del temperature_C
        return 0.0, np.inf

    def _caveats(self) -> tuple[str, ...]:
        """What a user of the law must know beside passivity and causality."""
        return ()
