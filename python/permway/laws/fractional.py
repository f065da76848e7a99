"""Laws of fractional order: springpot, fractional Kelvin-Voigt and Zener, Havriliak-Negami, FVMP."""

from __future__ import annotations

from typing import Literal, TypeVar

import numpy as np
from pydantic import model_validator

from permway.arrays import Complexes, Reals
from permway.laws.base import Law
from permway.records import Number


def power(omega: Reals, order: float) -> Complexes:
    """(i omega)^order on the principal branch; exact phase order * 90 degrees."""
    turn = np.exp(0.5j * np.pi * order)
    return np.asarray(omega**order * turn, dtype=np.complex128)


class Springpot(Law):
    """One fractional element, c (i omega)^order; loss factor tan(order pi/2) at all frequencies.

    Parameters
    ----------
    coefficient : float
        N s^order / m or Pa s^order.
    order : float
        Between 0 (spring) and 1 (dashpot) in a passive law.
    """

    type: Literal["springpot"] = "springpot"
    coefficient: Number
    order: Number

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        return self.coefficient * power(omega, self.order)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return True, "a power of i omega is analytic in the right half plane"


class FractionalKelvinVoigt(Law):
    """Spring and springpot side by side, k + c (i omega)^order.

    Parameters
    ----------
    stiffness : float
        N/m or Pa.
    coefficient : float
        N s^order / m or Pa s^order.
    order : float
        Between 0 and 1 in a passive law.
    """

    type: Literal["fractional_kelvin_voigt"] = "fractional_kelvin_voigt"
    stiffness: Number
    coefficient: Number
    order: Number

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        return self.stiffness + self.coefficient * power(omega, self.order)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return True, "a power of i omega is analytic in the right half plane"

    def _static(self) -> float | None:
        return self.stiffness if self.order > 0.0 else None


class FractionalZener(Law):
    """Zener's solid with a springpot for its dashpot.

    k = (k0 + k1 (i omega tau)^order) / (1 + (i omega tau)^order). Four parameters; Bagley and Torvik, J.
    Rheol. 30 (1986) 133.

    Parameters
    ----------
    relaxed, unrelaxed : float
        Limits at low and at high frequency, N/m or Pa.
    relaxation_time_s : float
        tau, in seconds, above zero.
    order : float
        Between 0 and 1 in a passive law; 1 is Zener's.
    """

    type: Literal["fractional_zener"] = "fractional_zener"
    relaxed: Number
    unrelaxed: Number
    relaxation_time_s: Number
    order: Number

    @model_validator(mode="after")
    def _time_is_positive(self) -> FractionalZener:
        return _positive_time(self)

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        turn = power(omega * self.relaxation_time_s, self.order)
        return self.relaxed + (self.unrelaxed - self.relaxed) * (1.0 - 1.0 / (1.0 + turn))

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return _fractional_pole(self.order, 1.0)

    def _static(self) -> float | None:
        return self.relaxed if self.order > 0.0 else None


class HavriliakNegami(Law):
    """Fractional Zener with a skew peak, k1 + (k0 - k1) / (1 + (i omega tau)^order)^skew.

    Five parameters; Havriliak and Negami, Polymer 8 (1967) 161, written for a modulus. Skew 1 is the
    fractional Zener.

    Parameters
    ----------
    relaxed, unrelaxed : float
        Limits at low and at high frequency, N/m or Pa.
    relaxation_time_s : float
        tau, in seconds, above zero.
    order, skew : float
        0 < order < 1 and 0 < order * skew <= 1 in a passive law.
    """

    type: Literal["havriliak_negami"] = "havriliak_negami"
    relaxed: Number
    unrelaxed: Number
    relaxation_time_s: Number
    order: Number
    skew: Number

    @model_validator(mode="after")
    def _time_is_positive(self) -> HavriliakNegami:
        return _positive_time(self)

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        turn = power(omega * self.relaxation_time_s, self.order)
        return self.unrelaxed + (self.relaxed - self.unrelaxed) * (1.0 + turn) ** (-self.skew)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        return _fractional_pole(self.order, 1.0)

    def _static(self) -> float | None:
        return self.relaxed if self.order > 0.0 else None


class FVMP(Law):
    """Fractional Voigt and Maxwell in parallel (paper, equation (23)).

    The transform of (23) with c2 = mu2/eta2 is k = mu1 + eta1 s^gamma + mu2 s^beta / (c2 + s^alpha), s = i
    omega; its real and imaginary parts are (24) and (25). Orders are free, so that Table 1 of the paper
    (alpha 1.754, beta 2.813) can be written down; `check` states what it does to the physics.

    Parameters
    ----------
    mu1, mu2 : float
        Elastic parameters, N/m or Pa.
    eta1, eta2 : float
        Viscosities; eta2 is not zero.
    alpha, beta, gamma : float
        Orders. Passive at all frequencies with non-negative parameters and 0 < alpha <= beta < 1, 0 < gamma
        < 1.
    """

    type: Literal["fvmp"] = "fvmp"
    mu1: Number
    eta1: Number
    mu2: Number
    eta2: Number
    alpha: Number
    beta: Number
    gamma: Number

    @model_validator(mode="after")
    def _ratio_exists(self) -> FVMP:
        if self.eta2 == 0.0:
            raise ValueError("eta2 must not be zero: c2 = mu2/eta2 has no value; set mu2 to zero instead")
        return self

    def _at(self, omega: Reals, temperature_C: Reals | None) -> Complexes:
        c2 = self.mu2 / self.eta2
        voigt = self.mu1 + self.eta1 * power(omega, self.gamma)
        if self.mu2 == 0.0:
            return np.asarray(voigt)
        maxwell = self.mu2 * power(omega, self.beta) / (c2 + power(omega, self.alpha))
        return np.asarray(voigt + maxwell)

    def _causal_by_structure(self) -> tuple[bool | None, str]:
        if self.mu2 == 0.0:
            return True, "a power of i omega is analytic in the right half plane"
        return _fractional_pole(self.alpha, self.mu2 / self.eta2)

    def _static(self) -> float | None:
        fades = self.gamma > 0.0 and (self.mu2 == 0.0 or min(self.alpha, self.beta) > 0.0)
        return self.mu1 if fades else None

    def _caveats(self) -> tuple[str, ...]:
        notes = []
        for name in ("alpha", "beta", "gamma"):
            order = getattr(self, name)
            if not 0.0 <= order <= 1.0:
                notes.append(f"order {name} = {order:g} is outside 0 to 1: no spring-dashpot network has it")
        if self.mu2 != 0.0 and self.beta > 1.0 + self.alpha:
            notes.append("beta - alpha > 1: grows faster than a dashpot at high frequency, storage turns negative")
        if self.mu2 != 0.0 and self.beta < self.alpha:
            notes.append("beta < alpha: the fractional Maxwell branch alone feeds energy in at high frequency")
        return tuple(notes)


_Timed = TypeVar("_Timed", FractionalZener, HavriliakNegami)


def _positive_time(law: _Timed) -> _Timed:
    # A fractional power of a negative time has no meaning.
    if law.relaxation_time_s <= 0.0:
        raise ValueError(f"relaxation_time_s must be above zero, not {law.relaxation_time_s:g}")
    return law


def _fractional_pole(order: float, ratio: float) -> tuple[bool | None, str]:
    """Zeros of ratio + s^order: right half plane unless ratio > 0 and |order| < 2."""
    if ratio <= 0.0:
        return False, "the ratio c2 = mu2/eta2 is not positive: a pole on the positive real axis"
    if abs(order) < 1.0:
        return True, "no pole on the principal sheet, only the branch cut along the negative axis"
    if abs(order) < 2.0:
        return True, "its poles lie in the stable half plane"
    return False, f"order {order:g} is not below 2: poles in the unstable half plane"
