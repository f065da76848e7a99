"""Laws of springs and dashpots: hysteretic, Kelvin-Voigt, Maxwell, Zener."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from permway.arrays import Complexes, Reals
from permway.laws.base import Law
from permway.records import Number


class Hysteretic(Law):
    """Spring with structural damping, k (1 + i eta) (paper, equation (13)).

    Not causal: a loss that does not depend on frequency asks for a storage that grows as (2/pi) eta
    ln(omega).

    Parameters
    ----------
    stiffness : float
        N/m or Pa.
    loss_factor : float
        Dimensionless; kept as the attribute `eta`.
    """

    type: Literal["hysteretic"] = "hysteretic"
    stiffness: Number
    # The alias is what users write; the bare name belongs to the method every law has.
    eta: Number = Field(default=0.0, alias="loss_factor")

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        return np.full(omega.shape, self.stiffness * (1.0 + 1j * self.eta), dtype=np.complex128)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        if self.eta == 0.0 or self.stiffness == 0.0:
            return True, "a spring without loss"
        return False, (
            "hysteretic: storage and loss are both constant over frequency, which no causal law is "
            "(Kramers-Kronig: storage must grow as (2/pi) * loss * ln(frequency))"
        )

    def _static(self) -> float | None:
        return self.stiffness


class KelvinVoigt(Law):
    """Spring and dashpot side by side, k + i omega c.

    Parameters
    ----------
    stiffness : float
        N/m or Pa.
    damping : float
        N s/m or Pa s.
    """

    type: Literal["kelvin_voigt"] = "kelvin_voigt"
    stiffness: Number
    damping: Number

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        return np.asarray(self.stiffness + 1j * omega * self.damping, dtype=np.complex128)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return True, "a polynomial in i omega"

    def _static(self) -> float | None:
        return self.stiffness


class Maxwell(Law):
    """Spring and dashpot one after the other, i omega c k / (k + i omega c).

    Parameters
    ----------
    stiffness : float
        Limit at high frequency, N/m or Pa; not zero.
    damping : float
        N s/m or Pa s.
    """

    type: Literal["maxwell"] = "maxwell"
    stiffness: Number
    damping: Number

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        flow = 1j * omega * self.damping
        return np.asarray(self.stiffness * flow / (self.stiffness + flow), dtype=np.complex128)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return _relaxation_pole(self.damping * self.stiffness, "damping and stiffness differ in sign")

    def _static(self) -> float | None:
        return 0.0


class Zener(Law):
    """Standard linear solid, (k0 + k1 i omega tau) / (1 + i omega tau).

    Parameters
    ----------
    relaxed, unrelaxed : float
        Limits at low and at high frequency, N/m or Pa.
    relaxation_time_s : float
        tau, in seconds.
    """

    type: Literal["zener"] = "zener"
    relaxed: Number
    unrelaxed: Number
    relaxation_time_s: Number

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        turn = 1j * omega * self.relaxation_time_s
        # Written so that neither limit overflows.
        rise = (self.unrelaxed - self.relaxed) * turn / (1.0 + turn)
        return np.asarray(self.relaxed + rise, dtype=np.complex128)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return _relaxation_pole(self.relaxation_time_s, "the relaxation time is negative")

    def _static(self) -> float | None:
        return self.relaxed


def _relaxation_pole(sign: float, fault: str) -> tuple[bool | None, str]:
    """A single pole at s = -1/tau lies in the stable half plane when tau is not negative."""
    if sign >= 0.0:
        return True, "its only pole lies in the stable half plane"
    return False, f"{fault}: the pole lies in the unstable half plane"
