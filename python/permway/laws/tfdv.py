"""A law over frequency and temperature: any law, a shift factor and a vertical factor."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import model_validator

from permway.arrays import ABSOLUTE_ZERO_C, Complexes, Reals, real_numbers
from permway.laws.base import Law
from permway.laws.shift import AnyShift
from permway.records import Number

if TYPE_CHECKING:
    from permway.laws import AnyLaw


class TFDV(Law):
    """Temperature and frequency dependent law (paper, equations (21), (22) and (27)).

    k(f, T) = v(T) law(alpha_T f), with v = rho T / (rho_s T_s) in kelvin ("paper") or 1 ("none"). Shift and
    vertical factor are one at the reference temperature, whatever reference the shift itself was written
    for.

    Parameters
    ----------
    law : AnyLaw
        The law at the reference temperature; it must not itself depend on temperature.
    shift : AnyShift
        Shift factor.
    reference_temperature_C : float
        T_s, degrees Celsius.
    vertical : {"paper", "none"}
        The vertical factor. The entropy of rubber gives it sense in the rubbery state only.
    volume_expansion_per_K : float
        Sets the density, rho/rho_s = 1 / (1 + expansion (T - T_s)); zero leaves the density constant.
    """

    type: Literal["tfdv"] = "tfdv"
    law: AnyLaw
    shift: AnyShift
    reference_temperature_C: Number
    vertical: Literal["paper", "none"] = "paper"
    volume_expansion_per_K: Number = 0.0

    @model_validator(mode="after")
    def _parts_fit(self) -> TFDV:
        if self.reference_temperature_C <= ABSOLUTE_ZERO_C:
            raise ValueError("reference_temperature_C must be above -273.15 degC")
        if self.law.needs_temperature:
            raise ValueError(f"law of type '{self.law.type}' depends on temperature already; shift it once only")
        self.shift.log10_factor(self.reference_temperature_C)
        return self

    @property
    def needs_temperature(self) -> bool:
        """Always: it is what the law is for."""
        return True

    def log10_shift(self, temperature_C: Reals | float) -> Reals:
        """Decimal logarithm of alpha_T relative to the reference temperature; shape of `temperature_C`."""
        return np.asarray(
            self.shift.log10_factor(temperature_C) - self.shift.log10_factor(self.reference_temperature_C)
        )

    def vertical_factor(self, temperature_C: Reals | float) -> Reals:
        """Factor rho T / (rho_s T_s), or one; shape of `temperature_C`."""
        temperature = real_numbers(temperature_C, "temperature_C")
        if self.vertical == "none":
            return np.ones_like(temperature)
        warmer = temperature - self.reference_temperature_C
        kelvin = 1.0 + warmer / (self.reference_temperature_C - ABSOLUTE_ZERO_C)
        return np.asarray(kelvin / (1.0 + self.volume_expansion_per_K * warmer))

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        assert temperature_C is not None
        reduced = omega * 10.0 ** self.log10_shift(temperature_C)
        return self.vertical_factor(temperature_C) * self.law._at(reduced, None)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return self.law._causal_by_structure()

    def _static(self) -> float | None:
        return self.law._static()

    def _reach(self, temperature_C: float | None) -> tuple[float, float]:
        assert temperature_C is not None
        low, high = self.law._reach(None)
        factor = 10.0 ** float(self.log10_shift(temperature_C))
        return low / factor, high / factor

    def _caveats(self) -> tuple[str, ...]:
        return self.law._caveats()
