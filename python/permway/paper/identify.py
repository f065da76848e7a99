"""The pad that makes the paper's tables come out: free at each temperature, and by one law for all three.

The paper prints neither the pad's stiffness nor its shift factors (Table 4 is lost), so both are identified from
tables 5 and 7 and from the minima of the total flexibility. Tables 6 (which hardly depends on the pad) and 8
(which is open) take no part.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import Bounds, differential_evolution, least_squares

from permway.arrays import Reals
from permway.laws import (
    FVMP,
    TFDV,
    WLF,
    AnyLaw,
    Arrhenius,
    FractionalKelvinVoigt,
    FractionalZener,
    Hysteretic,
    Parallel,
    Springpot,
)
from permway.paper.conventions import FREQUENCY_HZ
from permway.paper.pad_layer import PadLayer
from permway.paper.printed import PRINTED, TEMPERATURES_C
from permway.paper.readings import MINIMUM_BAND_HZ, PEAK_BAND_HZ, extremum

REFERENCE_C = 20.0
SEED = 2021
STARTS = 5
_WEIGHTS = {"force": 0.01, "wheelset": 0.02, "Hz": 1.0}
BAND_HZ = FREQUENCY_HZ[(FREQUENCY_HZ >= 30.0) & (FREQUENCY_HZ <= 150.0)]
"""Frequencies on which the pads are identified."""


@dataclass(frozen=True)
class Family:
    """A form of law and shift, with the box its parameters are sought in.

    Attributes
    ----------
    name : str
    build : callable
        Parameters to law. Stiffnesses enter by their decimal logarithm, so that they stay positive.
    box : sequence of (low, high)
    nested : callable, optional
        Parameters of "spring and two springpots, WLF" to nearly the same law in this form: one more start.
    """

    name: str
    build: Callable[[Reals], AnyLaw]
    box: Sequence[tuple[float, float]]
    nested: Callable[[Reals], Reals] | None = None


def _tfdv(law: AnyLaw, shift: WLF | Arrhenius) -> TFDV:
    return TFDV(law=law, shift=shift, reference_temperature_C=REFERENCE_C, vertical="paper")


def _wlf(p: Reals) -> WLF:
    return WLF(c1=float(p[0]), c2_K=float(p[1]), reference_temperature_C=REFERENCE_C)


def _fvmp(p: Reals) -> FVMP:
    mu1, eta1, mu2, c2 = (float(10.0**v) for v in p[:4])
    # alpha as a share of beta: 0 < alpha <= beta < 1 keeps the law passive.
    beta = float(p[5])
    return FVMP(mu1=mu1, eta1=eta1, mu2=mu2, eta2=mu2 / c2, alpha=float(p[4]) * beta, beta=beta, gamma=float(p[6]))


_WLF_BOX = ((2.0, 30.0), (100.0, 500.0))
_FVMP_BOX = ((7.0, 7.9), (3.0, 7.5), (0.0, 9.0), (-1.0, 3.0), (0.01, 0.98), (0.1, 0.98), (0.05, 0.95))
TWO_SPRINGPOTS = "spring and two springpots, WLF"


def _as_fvmp(p: Reals) -> Reals:
    """Two springpots as an FVMP: with alpha near 0 its second branch is a springpot of mu2 / (c2 + 1)."""
    c2 = 0.2
    return np.array([p[0], p[1], p[3] + math.log10(1.0 + c2), math.log10(c2), 0.01, p[4], p[2], p[5], p[6]])


FAMILIES: tuple[Family, ...] = (
    Family(
        "spring and springpot, WLF",
        lambda p: _tfdv(
            FractionalKelvinVoigt(
                stiffness=float(10.0 ** p[0]), coefficient=float(10.0 ** p[1]), order=float(p[2])
            ),
            _wlf(p[3:]),
        ),
        ((7.0, 7.9), (3.0, 8.0), (0.05, 0.95), *_WLF_BOX),
    ),
    Family(
        "fractional Zener, WLF",
        lambda p: _tfdv(
            FractionalZener(
                relaxed=float(10.0 ** p[0]),
                unrelaxed=float(10.0 ** p[0] * (1.0 + 10.0 ** p[1])),
                relaxation_time_s=float(10.0 ** p[2]),
                order=float(p[3]),
            ),
            _wlf(p[4:]),
        ),
        ((7.0, 7.9), (-1.0, 5.0), (-16.0, -3.0), (0.05, 0.95), *_WLF_BOX),
    ),
    Family(
        TWO_SPRINGPOTS,
        lambda p: _tfdv(
            Parallel(
                first=FractionalKelvinVoigt(
                    stiffness=float(10.0 ** p[0]), coefficient=float(10.0 ** p[1]), order=float(p[2])
                ),
                second=Springpot(coefficient=float(10.0 ** p[3]), order=float(p[4])),
            ),
            _wlf(p[5:]),
        ),
        ((7.0, 7.9), (3.0, 8.0), (0.05, 0.6), (0.0, 6.0), (0.5, 0.98), *_WLF_BOX),
    ),
    Family("FVMP, WLF (TFDV)", lambda p: _tfdv(_fvmp(p), _wlf(p[7:])), (*_FVMP_BOX, *_WLF_BOX), _as_fvmp),
    Family(
        "FVMP, Arrhenius",
        lambda p: _tfdv(
            _fvmp(p),
            Arrhenius(activation_energy_J_per_mol=float(p[7]) * 1e3, reference_temperature_C=REFERENCE_C),
        ),
        (*_FVMP_BOX, (20.0, 250.0)),
    ),
)
PAPERS_FAMILY = "FVMP, WLF (TFDV)"
"""The paper's own form of law, equation (27)."""


@dataclass(frozen=True)
class Fit:
    """A law identified from the tables.

    Attributes
    ----------
    family : str
    law : law
        Complex stiffness of one fastener, N/m.
    cost : float
        Half the sum of squares of the residuals, in units of 1 % in force, 2 % in wheelset density, 1 Hz.
    parameters : ndarray
        In the family's box.
    """

    family: str
    law: AnyLaw
    cost: float
    parameters: Reals


def residuals(layer: PadLayer, pad: AnyLaw, temperature_C: int) -> Reals:
    """Force, wheelset, their peaks' frequencies and the flexibility's minimum, against print.

    Shape (5,), each over its weight: 1 % in force, 2 % in wheelset density, 1 Hz.
    """
    want = {r.quantity: r.value for r in PRINTED if r.temperature_C == temperature_C}
    curves = layer.curves(pad.complex(layer.frequency, float(temperature_C)))
    f = curves.frequency
    force, wheelset = extremum(f, curves.force, PEAK_BAND_HZ), extremum(f, curves.wheelset, PEAK_BAND_HZ)
    minimum = extremum(f, curves.total, MINIMUM_BAND_HZ, lowest=True)
    return np.array(
        [
            math.log(force.smooth_value / want["force"]) / _WEIGHTS["force"],
            math.log(wheelset.smooth_value / want["wheelset"]) / _WEIGHTS["wheelset"],
            (force.smooth_at_Hz - want["force_peak_Hz"]) / _WEIGHTS["Hz"],
            (wheelset.smooth_at_Hz - want["wheelset_peak_Hz"]) / _WEIGHTS["Hz"],
            (minimum.smooth_at_Hz - want["flexibility_minimum_Hz"]) / _WEIGHTS["Hz"],
        ]
    )


def free_pad(layer: PadLayer, temperature_C: int) -> Hysteretic:
    """Constant stiffness and loss factor that fit the tables at one temperature."""

    def pad(p: Reals) -> Hysteretic:
        return Hysteretic(stiffness=float(np.exp(p[0])), loss_factor=float(np.exp(p[1])))

    def off(p: Reals) -> Reals:
        return residuals(layer, pad(p), temperature_C)

    starts = [np.log([k, eta]) for k in (5e7, 1e8, 2e8) for eta in (0.1, 0.4, 0.7)]
    fits = [least_squares(off, start, diff_step=np.full(2, 1e-4)) for start in starts]
    return pad(min(fits, key=lambda fit: float(fit.cost)).x)


def one_law(
    layer: PadLayer,
    family: Family,
    free: Mapping[int, Hysteretic],
    *,
    simpler: Fit | None = None,
    seed: int = SEED,
) -> Fit:
    """One law and one shift for all three temperatures.

    A genetic search in the box brings the law near the free pads at their peaks; from several such laws a local
    search then fits the tables themselves, and the best is kept.

    Parameters
    ----------
    layer : PadLayer
    family : Family
    free : dict of temperature to Hysteretic
        From :func:`free_pad`.
    simpler : Fit, optional
        Of the family that this one contains.
    seed : int
    """
    peaks = np.array([_peak_Hz(t) for t in TEMPERATURES_C])
    aims = np.array([free[t].complex(f)[()] for t, f in zip(TEMPERATURES_C, peaks, strict=True)])

    def near(p: Reals) -> float:
        law = family.build(p)
        pads = np.array([law.complex(f, float(t))[()] for t, f in zip(TEMPERATURES_C, peaks, strict=True)])
        return float(np.sum(np.abs(np.log(pads / aims)) ** 2))

    def on_tables(p: Reals) -> Reals:
        law = family.build(p)
        return np.concatenate([residuals(layer, law, t) for t in TEMPERATURES_C])

    low, high = (np.array(side) for side in zip(*family.box, strict=True))
    starts = []
    if simpler is not None and family.nested is not None:
        starts.append(family.nested(simpler.parameters))
    for number in range(STARTS):
        # Different seeds end in different valleys: the aims leave the law's shape away from the peaks open.
        starts.append(
            differential_evolution(
                near, Bounds(low, high), seed=seed + number, maxiter=40, popsize=5, polish=False, init="sobol"
            ).x
        )
    best = None
    for start in starts:
        inside = np.clip(start, low + 1e-6 * (high - low), high - 1e-6 * (high - low))
        fit = least_squares(
            on_tables,
            inside,
            bounds=(low, high),
            diff_step=np.full(low.size, 1e-5),
            x_scale=high - low,
            max_nfev=60,
        )
        if best is None or fit.cost < best.cost:
            best = fit
    assert best is not None
    return Fit(family.name, family.build(best.x), float(best.cost), np.asarray(best.x))


def _peak_Hz(temperature_C: int) -> float:
    return next(r.value for r in PRINTED if r.quantity == "force_peak_Hz" and r.temperature_C == temperature_C)
