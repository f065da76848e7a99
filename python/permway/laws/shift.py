"""Shift factors: how far temperature moves a law along the frequency axis."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, model_validator

from permway.arrays import ABSOLUTE_ZERO_C, Reals, check_temperature
from permway.errors import InputError
from permway.records import FloatTuple, FrozenModel, Number

GAS_CONSTANT = 8.31446261815324
"""J/(mol K), exact in the SI of 2019."""


CLOSEST_K, HOTTEST_C, MOST_DECADES = 1e-3, 3000.0, 100.0
"""Of a shift known at some temperatures: what lies beyond is a mistake, and overflows between them."""


class Shift(FrozenModel, ABC):
    """A shift factor alpha_T: the law at temperature T and frequency f is the reference law at alpha_T f."""

    def log10_factor(self, temperature_C: ArrayLike) -> Reals:
        """Decimal logarithm of alpha_T.

        Parameters
        ----------
        temperature_C : array_like
            Degrees Celsius.

        Returns
        -------
        ndarray of float64
            Shape of `temperature_C`; zero at the shift's reference, positive when colder.

        Raises
        ------
        InputError
            At a temperature the shift does not reach.
        """
        temperature = check_temperature(temperature_C)
        assert temperature is not None
        return np.asarray(self._log10(temperature), dtype=np.float64)

    @abstractmethod
    def _log10(self, temperature_C: Reals) -> Reals:
        """Decimal logarithm at temperatures already checked."""


class WLF(Shift):
    """Williams, Landel and Ferry's shift, log10 alpha = -c1 (T - Tr) / (c2 + T - Tr).

    J. Am. Chem. Soc. 77 (1955) 3701.

    Parameters
    ----------
    c1 : float
        Dimensionless.
    c2_K : float
        Kelvin, above zero.
    reference_temperature_C : float
        Tr, degrees Celsius.
    """

    type: Literal["wlf"] = "wlf"
    c1: Number
    c2_K: Number
    reference_temperature_C: Number

    @model_validator(mode="after")
    def _slope_has_a_sign(self) -> WLF:
        if self.c2_K <= 0.0:
            raise ValueError(f"c2_K must be above zero, not {self.c2_K:g}")
        return self

    def _log10(self, temperature_C: Reals) -> Reals:
        above = temperature_C - self.reference_temperature_C
        if np.any(self.c2_K + above <= 0.0):
            singular = self.reference_temperature_C - self.c2_K
            raise InputError(
                f"at or below the singular temperature {singular:g} degC of this WLF shift",
                where="temperature_C",
                value=float(np.min(temperature_C)),
                remedy="stay above it, or use an Arrhenius or a free shift in the cold",
            )
        return np.asarray(-self.c1 * above / (self.c2_K + above))


class Arrhenius(Shift):
    """Thermally activated, log10 alpha = E/(R ln 10) (1/T - 1/Tr) with T in kelvin.

    Parameters
    ----------
    activation_energy_J_per_mol : float
        E.
    reference_temperature_C : float
        Tr, degrees Celsius.
    """

    type: Literal["arrhenius"] = "arrhenius"
    activation_energy_J_per_mol: Number
    reference_temperature_C: Number

    @model_validator(mode="after")
    def _reference_exists(self) -> Arrhenius:
        if self.reference_temperature_C <= ABSOLUTE_ZERO_C:
            raise ValueError("reference_temperature_C must be above -273.15 degC")
        return self

    def _log10(self, temperature_C: Reals) -> Reals:
        inverse = 1.0 / (temperature_C - ABSOLUTE_ZERO_C)
        reference = 1.0 / (self.reference_temperature_C - ABSOLUTE_ZERO_C)
        scale = self.activation_energy_J_per_mol / (GAS_CONSTANT * np.log(10.0))
        return np.asarray(scale * (inverse - reference))


class WLFArrhenius(Shift):
    """Williams, Landel and Ferry's shift above a transition, Arrhenius' below it, joined without a step.

    Below the glass transition the structure is frozen, and WLF, which runs to a singularity there, no longer
    holds (Ferry, Viscoelastic Properties of Polymers, 3rd ed., 1980, chapter 11). log10 alpha is zero at the
    transition Tg; above, -c1 (T - Tg) / (c2 + T - Tg), below, E/(R ln 10) (1/T - 1/Tg) with T in kelvin.

    Parameters
    ----------
    c1 : float
        Dimensionless, for the transition as reference.
    c2_K : float
        Kelvin, above zero, for the transition as reference.
    transition_C : float
        Tg, degrees Celsius.
    activation_energy_J_per_mol : float
        E below the transition.
    """

    type: Literal["wlf_arrhenius"] = "wlf_arrhenius"
    c1: Number
    c2_K: Number
    transition_C: Number
    activation_energy_J_per_mol: Number

    @model_validator(mode="after")
    def _parts_exist(self) -> WLFArrhenius:
        if self.c2_K <= 0.0:
            raise ValueError(f"c2_K must be above zero, not {self.c2_K:g}")
        if self.transition_C <= ABSOLUTE_ZERO_C:
            raise ValueError("transition_C must be above -273.15 degC")
        return self

    def _log10(self, temperature_C: Reals) -> Reals:
        above = np.maximum(temperature_C - self.transition_C, 0.0)
        below = np.minimum(temperature_C, self.transition_C) - ABSOLUTE_ZERO_C
        scale = self.activation_energy_J_per_mol / (GAS_CONSTANT * np.log(10.0))
        frozen = scale * (1.0 / below - 1.0 / (self.transition_C - ABSOLUTE_ZERO_C))
        return np.asarray(frozen - self.c1 * above / (self.c2_K + above))


class Free(Shift):
    """A shift factor known at some temperatures, monotone in between (Fritsch and Carlson's cubic).

    Parameters
    ----------
    temperatures_C : tuple of float, shape (n,)
        Strictly increasing, at least two, degrees Celsius.
    log10_shift : tuple of float, shape (n,)
        Decimal logarithm of alpha_T there.

    Raises
    ------
    InputError
        On evaluation outside the temperatures given: it refuses to extrapolate.
    """

    type: Literal["free"] = "free"
    temperatures_C: FloatTuple
    log10_shift: FloatTuple

    @model_validator(mode="after")
    def _columns_fit(self) -> Free:
        if len(self.temperatures_C) != len(self.log10_shift):
            raise ValueError(f"{len(self.temperatures_C)} temperatures but {len(self.log10_shift)} shift factors")
        if len(self.temperatures_C) < 2:
            raise ValueError("a free shift needs at least two temperatures")
        if not np.all(np.diff(self.temperatures_C) > 0.0):
            raise ValueError("temperatures_C must increase strictly")
        closest, hottest = float(np.diff(self.temperatures_C).min()), self.temperatures_C[-1]
        if closest < CLOSEST_K:
            raise ValueError(f"temperatures_C must be {CLOSEST_K:g} K apart or more, not {closest:g}")
        if hottest > HOTTEST_C:
            raise ValueError(f"temperatures_C must be at most {HOTTEST_C:g}, not {hottest:g}")
        farthest = max(self.log10_shift, key=abs)
        if abs(farthest) > MOST_DECADES:
            raise ValueError(f"log10_shift must be within {MOST_DECADES:g} decades of frequency, not {farthest:g}")
        return self

    def _log10(self, temperature_C: Reals) -> Reals:
        low, high = self.temperatures_C[0], self.temperatures_C[-1]
        outside = (temperature_C < low) | (temperature_C > high)
        if outside.any():
            raise InputError(
                f"outside the free shift, known from {low:g} to {high:g} degC; it does not extrapolate",
                where="temperature_C",
                value=float(np.atleast_1d(temperature_C)[np.atleast_1d(outside)][0]),
                remedy="measure there, or identify a WLF or an Arrhenius shift",
            )
        # It takes a third of a second to import, which most models do not need.
        from scipy.interpolate import PchipInterpolator

        return np.asarray(PchipInterpolator(self.temperatures_C, self.log10_shift)(temperature_C))


AnyShift = Annotated[WLF | Arrhenius | WLFArrhenius | Free, Field(discriminator="type")]
"""Any shift, distinguished by its `type`."""
