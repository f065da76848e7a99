"""Laws made of laws: in series, in parallel, scaled, and storage from one with loss from another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.laws.base import Law
from permway.records import Number

if TYPE_CHECKING:
    from permway.laws import AnyLaw


class _Two(Law):
    """Two laws under one roof."""

    first: AnyLaw
    second: AnyLaw

    @property
    def needs_temperature(self) -> bool:
        """Whether either of the two does."""
        return self.first.needs_temperature or self.second.needs_temperature

    def _both(self, omega: Reals, temperature_C: Reals | None) -> tuple[Complexes, Complexes]:
        return self.first._at(omega, temperature_C), self.second._at(omega, temperature_C)

    def _reach(self, temperature_C: float | None) -> tuple[float, float]:
        return _common_reach(self.first, self.second, temperature_C)

    def _caveats(self) -> tuple[str, ...]:
        return self.first._caveats() + self.second._caveats()


class Series(_Two):
    """Two laws one after the other, k1 k2 / (k1 + k2).

    Parameters
    ----------
    first, second : AnyLaw
        N/m or Pa, both the same.
    """

    type: Literal["series"] = "series"

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        first, second = self._both(omega, temperature_C)
        total = first + second
        if np.any(total == 0.0):
            raise InputError(
                "the two stiffnesses in series cancel, their sum is zero",
                where="series",
                remedy="check the signs of the parameters",
            )
        return first * second / total

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        # Zeros of k1 + k2 stay out of the right half plane only if both are passive, which is not known here.
        return None, ""


class Parallel(_Two):
    """Two laws side by side, k1 + k2.

    Parameters
    ----------
    first, second : AnyLaw
        N/m or Pa, both the same.
    """

    type: Literal["parallel"] = "parallel"

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        first, second = self._both(omega, temperature_C)
        return first + second

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        answers = [self.first._causal_by_structure(), self.second._causal_by_structure()]
        faults = [why for known, why in answers if known is False]
        if len(faults) == 1:
            return False, faults[0]
        return (True, "both parts are causal") if all(known for known, _ in answers) else (None, "")

    def _static(self) -> float | None:
        first, second = self.first._static(), self.second._static()
        return None if first is None or second is None else first + second


class Scaled(Law):
    """A law times a number, factor (1 + i eta).

    Parameters
    ----------
    law : AnyLaw
        N/m or Pa.
    factor : float
        Dimensionless, or m to make a stiffness of a modulus.
    loss_factor : float
        Dimensionless; kept as the attribute `eta`: a constant loss of all of it, which no causal law has.
    """

    type: Literal["scaled"] = "scaled"
    law: AnyLaw
    factor: Number
    # The alias is what users write; the bare name belongs to the method every law has.
    eta: Number = Field(default=0.0, alias="loss_factor")

    @property
    def needs_temperature(self) -> bool:
        """Whether the scaled law does."""
        return self.law.needs_temperature

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        return self.factor * (1.0 + 1j * self.eta) * self.law._at(omega, temperature_C)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        if self.eta != 0.0 and self.factor != 0.0:
            return False, "scaled with a constant loss, which no causal law has"
        return self.law._causal_by_structure()

    def _static(self) -> float | None:
        static = self.law._static()
        return None if static is None else self.factor * static

    def _reach(self, temperature_C: float | None) -> tuple[float, float]:
        return self.law._reach(temperature_C)

    def _caveats(self) -> tuple[str, ...]:
        return self.law._caveats()


class StorageLossPair(Law):
    """Storage of one law with the loss of another, as the paper takes them (equations (24), (25), Table 1).

    Two separate fits are no material: unless the two are one and the same law, storage and loss do not
    satisfy Kramers and Kronig's relations, and `check` reports it.

    Parameters
    ----------
    storage_law : AnyLaw
        Gives the real part, N/m or Pa.
    loss_law : AnyLaw
        Gives the imaginary part, N/m or Pa.
    """

    type: Literal["storage_loss_pair"] = "storage_loss_pair"
    storage_law: AnyLaw
    loss_law: AnyLaw

    @property
    def needs_temperature(self) -> bool:
        """Whether either of the two does."""
        return self.storage_law.needs_temperature or self.loss_law.needs_temperature

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        storage = self.storage_law._at(omega, temperature_C).real
        return storage + 1j * self.loss_law._at(omega, temperature_C).imag

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        if self.storage_law == self.loss_law:
            return self.storage_law._causal_by_structure()
        return None, ""

    def _static(self) -> float | None:
        return self.storage_law._static()

    def _reach(self, temperature_C: float | None) -> tuple[float, float]:
        return _common_reach(self.storage_law, self.loss_law, temperature_C)

    def _caveats(self) -> tuple[str, ...]:
        notes = self.storage_law._caveats() + self.loss_law._caveats()
        if self.storage_law != self.loss_law:
            notes += ("storage and loss come from two separate laws: the pair is not one material",)
        return notes


def _common_reach(first: Law, second: Law, temperature_C: float | None) -> tuple[float, float]:
    lows, highs = zip(first._reach(temperature_C), second._reach(temperature_C), strict=True)
    return max(lows), min(highs)
