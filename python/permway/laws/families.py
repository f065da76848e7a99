"""Families of laws as the identification sees them: coordinates, bounds, fast values, and the law itself.

A family's coordinates keep the law passive at all frequencies by construction: moduli and times are
exponentials, an unrelaxed modulus is the relaxed one plus something, orders lie between 0 and 1, and FVMP's
beta lies between alpha and 1 (then s^beta/(c2 + s^alpha) has a non-negative relaxation spectrum).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.laws.base import Law
from permway.laws.elastic import Hysteretic, KelvinVoigt, Zener
from permway.laws.fractional import FVMP, FractionalKelvinVoigt, FractionalZener, HavriliakNegami, Springpot
from permway.laws.prony import Prony

_ORDER = (0.02, 0.98)


@dataclass(frozen=True)
class Scales:
    """What the data span: decimal logarithms of moduli (Pa) and of reduced circular frequencies (rad/s)."""

    lg_low: float
    lg_high: float
    lg_omega_low: float
    lg_omega_high: float

    @property
    def softness(self) -> tuple[float, float]:
        """Bounds of the logarithm of a relaxed modulus."""
        return self.lg_low - 3.0, self.lg_high + 0.5

    @property
    def strength(self) -> tuple[float, float]:
        """Bounds of the logarithm of a relaxing modulus."""
        return self.lg_low - 3.0, self.lg_high + 3.0

    @property
    def faintness(self) -> tuple[float, float]:
        """Bounds of the logarithm of a modulus at a frequency 1/tau that may lie far below the data."""
        return self.lg_low - 8.0, self.lg_high + 3.0

    @property
    def time(self) -> tuple[float, float]:
        """Bounds of the logarithm of a relaxation time, s."""
        return -self.lg_omega_high - 8.0, -self.lg_omega_low + 6.0


@dataclass(frozen=True)
class Family:
    """A family of laws.

    Attributes
    ----------
    name : str
        As given to `identify`.
    bounds : callable
        From `Scales` to a list of (low, high), one per coordinate.
    value : callable
        From coordinates (each of a shape that broadcasts against s) and s = i omega to complex moduli.
    law : callable
        From coordinates to the law.
    parameters : callable
        From coordinates to the law's own parameters by name, in SI.
    kinds : tuple of str
        What each coordinate is: "floor" (modulus at rest), "strength" (a relaxing modulus), "damping",
        "coefficient", "time", "gap" (to the next time), "order", "rise", "loss".
    """

    name: str
    bounds: Callable[[Scales], list[tuple[float, float]]]
    value: Callable[[list[Reals], Complexes], Complexes]
    law: Callable[[Reals], Law]
    parameters: Callable[[Reals], dict[str, float]]
    kinds: tuple[str, ...]

    def shifted(self, x: Reals, lg_shift: float, lg_scale: float) -> Reals:
        """Coordinates of the law k' with k'(f) = 10^lg_scale k(10^lg_shift f).

        Parameters
        ----------
        x : ndarray, shape (d,)
        lg_shift, lg_scale : float
            Decades of frequency and of modulus.
        """
        result = np.array(x, dtype=np.float64)
        order = self.kinds.index("order") if "order" in self.kinds else None
        for index, kind in enumerate(self.kinds):
            if kind in ("floor", "strength", "damping", "coefficient"):
                result[index] += lg_scale
            if kind in ("time", "damping"):
                result[index] += lg_shift
            if kind == "coefficient" and order is not None:
                result[index] += lg_shift * x[order]
        return result


def family(name: str) -> Family:
    """Look a family up by name.

    Parameters
    ----------
    name : str
        One of `FAMILIES`, or "prony:N" (spring and N Maxwell elements), or "maxwell:N" (the same without
        the spring).

    Raises
    ------
    InputError
        For an unknown name.
    """
    kind, _, count = name.partition(":")
    if kind in ("prony", "maxwell"):
        if count.isdigit() and 1 <= int(count) <= 12:
            return _series(name, int(count), spring=kind == "prony")
    elif name in _FAMILIES:
        return _FAMILIES[name]
    raise InputError(
        "not a family of laws that can be identified",
        where="law",
        value=name,
        remedy="use one of " + ", ".join(FAMILIES) + ', "prony:N", "maxwell:N" with N from 1 to 12',
    )


def _simple(
    name: str,
    bounds: Callable[[Scales], list[tuple[float, float]]],
    value: Callable[..., Complexes],
    build: Callable[[dict[str, float]], Law],
    parameters: Callable[..., dict[str, float]],
    kinds: str,
) -> Family:
    return Family(
        name,
        bounds,
        lambda x, s: value(s, *x),
        lambda x: build(parameters(*map(float, x))),
        lambda x: parameters(*map(float, x)),
        tuple(kinds.split()),
    )


def _fractional_zener(s: Complexes, lg_k0: Reals, lg_dk: Reals, lg_tau: Reals, order: Reals) -> Complexes:
    turn = _power(s, lg_tau, order)
    return np.asarray(10.0**lg_k0 + 10.0**lg_dk * turn / (1.0 + turn))


def _havriliak_negami(
    s: Complexes, lg_k0: Reals, lg_dk: Reals, lg_tau: Reals, order: Reals, product: Reals
) -> Complexes:
    turn = _power(s, lg_tau, order)
    return np.asarray(10.0**lg_k0 + 10.0**lg_dk * (1.0 - (1.0 + turn) ** (-product / order)))


def _fvmp(
    s: Complexes,
    lg_mu1: Reals,
    lg_g1: Reals,
    gamma: Reals,
    lg_g2: Reals,
    lg_tau: Reals,
    alpha: Reals,
    rise: Reals,
) -> Complexes:
    # g1 is the Voigt element's modulus at 1/tau, so that strength and order do not trade against each other.
    beta = alpha + (1.0 - alpha) * rise
    branch = 10.0**lg_g2 * _power(s, lg_tau, beta) / (1.0 + _power(s, lg_tau, alpha))
    return np.asarray(10.0**lg_mu1 + 10.0**lg_g1 * _power(s, lg_tau, gamma) + branch)


def _fvmp_parameters(
    lg_mu1: float, lg_g1: float, gamma: float, lg_g2: float, lg_tau: float, alpha: float, rise: float
) -> dict[str, float]:
    beta = alpha + (1.0 - alpha) * rise
    mu2 = 10.0 ** (lg_g2 + lg_tau * (beta - alpha))
    return {
        "mu1": 10.0**lg_mu1,
        "eta1": 10.0 ** (lg_g1 + gamma * lg_tau),
        "mu2": mu2,
        "eta2": mu2 * 10.0 ** (lg_tau * alpha),
        "alpha": alpha,
        "beta": beta,
        "gamma": gamma,
    }


def _power(s: Complexes, lg_tau: Reals, order: Reals) -> Complexes:
    # s = i omega, so the phase is known: cheaper and exact beside a complex power.
    magnitude = 10.0 ** (order * (np.log10(s.imag) + lg_tau))
    return np.asarray(magnitude * np.exp(0.5j * np.pi * order))


def _series(name: str, count: int, *, spring: bool) -> Family:
    """Coordinates: [lg k0,] lg g_1..n, lg tau_1, and the rises from one lg tau to the next."""
    offset = 1 if spring else 0

    def times(x: list[Reals] | Reals) -> list[Reals]:
        return list(np.cumsum([np.asarray(part) for part in x[offset + count :]], axis=0))

    def bounds(scales: Scales) -> list[tuple[float, float]]:
        low, high = scales.time
        softness = [scales.softness] if spring else []
        return softness + [scales.strength] * count + [(low, high)] + [(0.05, high - low)] * (count - 1)

    def value(x: list[Reals], s: Complexes) -> Complexes:
        total = 10.0 ** x[0] + 0.0 * s if spring else 0.0 * s
        for lg_strength, lg_time in zip(x[offset : offset + count], times(x), strict=True):
            turn = s * 10.0**lg_time
            total = total + 10.0**lg_strength * turn / (1.0 + turn)
        return np.asarray(total)

    def law(x: Reals) -> Law:
        return Prony(
            relaxed=float(10.0 ** x[0]) if spring else 0.0,
            strengths=tuple(float(10.0**g) for g in x[offset : offset + count]),
            relaxation_times_s=tuple(float(10.0**t) for t in times(x)),
        )

    def parameters(x: Reals) -> dict[str, float]:
        named = {"relaxed": float(10.0 ** x[0])} if spring else {}
        named |= {f"strengths[{i}]": float(10.0**g) for i, g in enumerate(x[offset : offset + count])}
        return named | {f"relaxation_times_s[{i}]": float(10.0**t) for i, t in enumerate(times(x))}

    kinds = ("floor",) * offset + ("strength",) * count + ("time",) + ("gap",) * (count - 1)
    return Family(name, bounds, value, law, parameters, kinds)


_FAMILIES: dict[str, Family] = {
    member.name: member
    for member in (
        _simple(
            "hysteretic",
            lambda z: [z.softness, (-4.0, 1.0)],
            lambda s, lg_k, lg_eta: 10.0**lg_k * (1.0 + 1j * 10.0**lg_eta) + 0.0 * s,
            lambda p: Hysteretic(**p),
            lambda lg_k, lg_eta: {"stiffness": 10.0**lg_k, "loss_factor": 10.0**lg_eta},
            "floor loss",
        ),
        _simple(
            "kelvin_voigt",
            lambda z: [z.softness, (z.lg_low - 4.0 - z.lg_omega_high, z.lg_high + 2.0 - z.lg_omega_low)],
            lambda s, lg_k, lg_c: 10.0**lg_k + s * 10.0**lg_c,
            lambda p: KelvinVoigt(**p),
            lambda lg_k, lg_c: {"stiffness": 10.0**lg_k, "damping": 10.0**lg_c},
            "floor damping",
        ),
        _simple(
            "springpot",
            lambda z: [(z.lg_low - z.lg_omega_high, z.lg_high - min(z.lg_omega_low, 0.0)), _ORDER],
            lambda s, lg_c, order: 10.0**lg_c * _power(s, np.zeros(()), order),
            lambda p: Springpot(**p),
            lambda lg_c, order: {"coefficient": 10.0**lg_c, "order": order},
            "coefficient order",
        ),
        _simple(
            "springpot_parallel",
            lambda z: [
                z.softness,
                (z.lg_low - 2.0 - z.lg_omega_high, z.lg_high + 1.0 - min(z.lg_omega_low, 0.0)),
                _ORDER,
            ],
            lambda s, lg_k, lg_c, order: 10.0**lg_k + 10.0**lg_c * _power(s, np.zeros(()), order),
            lambda p: FractionalKelvinVoigt(**p),
            lambda lg_k, lg_c, order: {"stiffness": 10.0**lg_k, "coefficient": 10.0**lg_c, "order": order},
            "floor coefficient order",
        ),
        _simple(
            "zener",
            lambda z: [z.softness, z.strength, z.time],
            lambda s, lg_k, lg_d, lg_t: _fractional_zener(s, lg_k, lg_d, lg_t, np.ones(())),
            lambda p: Zener(**p),
            lambda lg_k, lg_d, lg_t: {
                "relaxed": 10.0**lg_k,
                "unrelaxed": 10.0**lg_k + 10.0**lg_d,
                "relaxation_time_s": 10.0**lg_t,
            },
            "floor strength time",
        ),
        _simple(
            "fractional_zener",
            lambda z: [z.softness, z.strength, z.time, _ORDER],
            _fractional_zener,
            lambda p: FractionalZener(**p),
            lambda lg_k, lg_d, lg_t, order: {
                "relaxed": 10.0**lg_k,
                "unrelaxed": 10.0**lg_k + 10.0**lg_d,
                "relaxation_time_s": 10.0**lg_t,
                "order": order,
            },
            "floor strength time order",
        ),
        _simple(
            "havriliak_negami",
            lambda z: [z.softness, z.strength, z.time, _ORDER, _ORDER],
            _havriliak_negami,
            lambda p: HavriliakNegami(**p),
            lambda lg_k, lg_d, lg_t, order, product: {
                "relaxed": 10.0**lg_k,
                "unrelaxed": 10.0**lg_k + 10.0**lg_d,
                "relaxation_time_s": 10.0**lg_t,
                "order": order,
                "skew": product / order,
            },
            "floor strength time order order",
        ),
        _simple(
            "fvmp",
            lambda z: [z.softness, z.faintness, _ORDER, z.strength, z.time, _ORDER, (0.0, 0.98)],
            _fvmp,
            lambda p: FVMP(**p),
            _fvmp_parameters,
            "floor strength order strength time order rise",
        ),
    )
}

FAMILIES = tuple(_FAMILIES)
"""Names of the families, beside "prony:N" and "maxwell:N"."""
