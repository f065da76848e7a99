"""Is a law passive, is it causal? Stated over a band, with the worst place and the reason.

Passive: no energy comes out, Im k >= 0, and the stiffness at rest is not negative (k/(i omega) is then
positive real).

Causal: storage and loss obey Kramers and Kronig. Two tests are made. The first is the structure of the
closed form (poles, branch points, growth) where it is known. The second is numerical: with u = ln(omega),

    E'(u) - E'(u0) = -(1/pi) P int E''(v) [coth(v - u) - coth(v - u0)] dv,

once subtracted at u0, so that any growth slower than omega^2 converges and a static stiffness drops out.
The kernel falls off as exp(-2 |v - u|): what lies outside the interval integrated over matters only near
its ends. A closed form is integrated well beyond the band (`_DECADES_ABOVE` decades up cost a relative
error of 10^-6 for a dashpot's growth). A table ends where it ends; its loss is then continued on both sides
by a power of frequency between -1 (a Debye peak falling) and +1 (a dashpot), and only what no such
continuation explains is called a violation: without a bound on the tails nothing measured over a finite
band is ever acausal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError
from permway.laws.base import Law

_PER_DECADE = 40
_DECADES_BELOW = 4.0
_DECADES_ABOVE = 7.0
_TAIL_DECADES = 7.0
_TOLERANCE = 1e-3
"""Violation of Kramers-Kronig over the largest loss. Quadrature leaves 1e-5 on causal forms, at worst."""
_TABLE_TOLERANCE = 0.10
"""The same for tables, whose loss is known to some per cent at best."""
_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class LawCheck:
    """What can be stated about a law over a band.

    Attributes
    ----------
    band_Hz : (float, float)
        The band looked at.
    passive, causal : bool
        The two verdicts.
    reasons : tuple of str
        Why a verdict is negative; empty if both are positive.
    caveats : tuple of str
        What else to know: parameters outside their physical range, negative storage, limits of the test.
    worst_loss, worst_loss_Hz : float
        Lowest imaginary part met (N/m or Pa) and where.
    kramers_kronig, kramers_kronig_Hz : float
        Largest violation over the largest loss in the band, and where.
    """

    band_Hz: tuple[float, float]
    passive: bool
    causal: bool
    reasons: tuple[str, ...]
    caveats: tuple[str, ...]
    worst_loss: float
    worst_loss_Hz: float
    kramers_kronig: float
    kramers_kronig_Hz: float


def check_law(law: Law, band_Hz: tuple[float, float], temperature_C: float | None = None) -> LawCheck:
    """Check a law over a band.

    Parameters
    ----------
    law : Law
        Any law.
    band_Hz : (float, float)
        Lowest and highest frequency, Hz.
    temperature_C : float, optional
        Needed by a law that depends on temperature.

    Returns
    -------
    LawCheck
        Verdicts with reasons.

    Raises
    ------
    InputError
        For an empty band, a missing temperature, or a band outside a tabulated law.
    """
    low, high = band_Hz
    if not (0.0 < low < high < np.inf):
        raise InputError(
            "a band is (lowest, highest) with 0 < lowest < highest",
            where="band_Hz",
            value=band_Hz,
            remedy="give two finite frequencies in Hz",
        )
    frequency = np.geomspace(low, high, max(int(_PER_DECADE * np.log10(high / low)) + 1, 20))
    value = law.complex(frequency, temperature_C)
    reasons: list[str] = []
    caveats = list(law._caveats())

    worst = int(np.argmin(value.imag))
    static = law._static()
    passive = bool(value.imag[worst] >= -_ROUNDING * np.abs(value).max())
    if not passive:
        reasons.append(f"not passive: loss is {value.imag[worst]:.3g} at {frequency[worst]:.3g} Hz")
    if static is not None and static < 0.0:
        passive = False
        reasons.append(f"not passive: stiffness at rest is negative ({static:.3g})")
    softest = int(np.argmin(value.real))
    if value.real[softest] < 0.0:
        caveats.append(f"storage is negative, {value.real[softest]:.3g} at {frequency[softest]:.3g} Hz")

    violation, where, tabulated = kramers_kronig(law, band_Hz, temperature_C)
    tolerance = _TABLE_TOLERANCE if tabulated else _TOLERANCE
    known, why = law._causal_by_structure()
    causal = known if known is not None else violation <= tolerance
    if known is False:
        reasons.append(f"not causal: {why}")
    elif not causal:
        reasons.append(
            f"not causal: storage departs from what its loss demands (Kramers-Kronig) by {violation:.2g} of "
            f"the largest loss, at {where:.3g} Hz"
        )
    elif violation > tolerance:
        caveats.append(
            f"Kramers-Kronig violated numerically by {violation:.2g} at {where:.3g} Hz, though causal in form"
        )
    if tabulated:
        caveats.append("causality of a table is judged up to any loss outside it that varies as f^-1 to f^+1")
    return LawCheck(
        band_Hz=(low, high),
        passive=passive,
        causal=bool(causal),
        reasons=tuple(reasons),
        caveats=tuple(dict.fromkeys(caveats)),
        worst_loss=float(value.imag[worst]),
        worst_loss_Hz=float(frequency[worst]),
        kramers_kronig=violation,
        kramers_kronig_Hz=where,
    )


def kramers_kronig(
    law: Law, band_Hz: tuple[float, float], temperature_C: float | None = None
) -> tuple[float, float, bool]:
    """Largest violation of Kramers-Kronig in a band.

    Parameters
    ----------
    law : Law
        Any law.
    band_Hz : (float, float)
        Lowest and highest frequency, Hz.
    temperature_C : float, optional
        Needed by a law that depends on temperature.

    Returns
    -------
    violation : float
        Departure of the storage from the transform of the loss, over the largest loss in the band.
    frequency_Hz : float
        Where it is largest.
    limited : bool
        Whether the law ends near the band, so that bounded tails had to stand in for it.
    """
    low, high = band_Hz
    reach_low, reach_high = law._reach(temperature_C)
    limited = reach_low > 0.0 or np.isfinite(reach_high)
    below, above = low * 10.0**-_DECADES_BELOW, high * 10.0**_DECADES_ABOVE
    # Sources lie half a step beside the targets: the rule of alternate points takes the principal value.
    step = np.log(10.0) / _PER_DECADE
    targets = np.arange(np.log(low), np.log(high), step)
    if len(targets) < 3:
        step = np.log(high / low) / 3.0
        targets = np.arange(4) * step + np.log(low)
    first = np.ceil((np.log(max(below, reach_low)) - targets[0]) / step - 0.5) if reach_low > 0.0 else None
    start = first if first is not None else np.floor((np.log(below) - targets[0]) / step)
    top = np.log(min(above, reach_high))
    stop = np.floor((top - targets[0]) / step - 0.5)
    sources = targets[0] + (np.arange(start, stop + 1) + 0.5) * step
    loss = _evaluate(law, sources, temperature_C).imag
    value = _evaluate(law, targets, temperature_C)

    middle = len(targets) // 2
    predicted = _transform(targets, middle, sources, loss, step)
    spread = predicted, predicted
    if limited:
        spread = _with_tails(
            targets, middle, sources, loss, step, predicted, reach_low > 0.0, np.isfinite(reach_high)
        )
    storage = value.real - value.real[middle]
    excess = np.maximum(storage - np.maximum(*spread), np.minimum(*spread) - storage)
    inside = slice(1, -1) if limited else slice(None)
    scale = max(np.abs(value.imag).max(), _ROUNDING * np.abs(value).max(), np.finfo(float).tiny)
    at = int(np.argmax(np.where(np.isfinite(excess), excess, np.inf)[inside])) + (1 if limited else 0)
    worst = float(excess[at] / scale) if np.isfinite(excess[at]) else np.inf
    return max(worst, 0.0), float(np.exp(targets[at])), bool(limited)


def _evaluate(law: Law, log_frequency: Reals, temperature_C: float | None) -> np.ndarray:
    with np.errstate(over="ignore", invalid="ignore"):
        return law.complex(np.exp(log_frequency), temperature_C)


def _transform(targets: Reals, middle: int, sources: Reals, loss: Reals, step: float) -> Reals:
    """E'(u) - E'(u0) from the loss at `sources`, u0 being target number `middle`."""
    kernel = 1.0 / np.tanh(sources - targets[:, None])
    return np.asarray(-(kernel - kernel[middle]) @ loss * step / np.pi)


def _with_tails(
    targets: Reals,
    middle: int,
    sources: Reals,
    loss: Reals,
    step: float,
    predicted: Reals,
    cut_low: bool,
    cut_high: bool,
) -> tuple[Reals, Reals]:
    """Least and greatest prediction when the loss beyond the ends goes as f^-1 to f^+1."""
    low, high = predicted.copy(), predicted.copy()
    away = (np.arange(int(_TAIL_DECADES * np.log(10.0) / step)) + 1.0) * step
    for cut, edge, sign in ((cut_low, 0, -1.0), (cut_high, -1, 1.0)):
        if not cut:
            continue
        # Fading fastest and growing fastest; whatever lies between has its transform between theirs.
        bounds = [
            _transform(targets, middle, sources[edge] + sign * away, loss[edge] * np.exp(rate * away), step)
            for rate in (-1.0, 1.0)
        ]
        low += np.minimum(*bounds)
        high += np.maximum(*bounds)
    return low, high
