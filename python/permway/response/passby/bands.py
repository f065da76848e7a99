"""One-third octaves of a spectrum of finite energy (IEC 61260-1, base ten)."""

from __future__ import annotations

import numpy as np

from permway.arrays import Reals
from permway.errors import InputError

REFERENCES = {"displacement": 1e-12, "velocity": 1e-9, "acceleration": 1e-6}
"""Reference values of levels in m, m/s and m/s2 (ISO 1683)."""

_HALF = 10.0**0.05


def one_third_octaves(lowest_Hz: float, highest_Hz: float) -> tuple[Reals, Reals, Reals]:
    """Middles and edges of the bands 10^(n/10) Hz that lie wholly within a range.

    Returns
    -------
    (ndarray, ndarray, ndarray)
        Exact middle, lower and upper edge, Hz; empty if no band fits.
    """
    if not 0.0 < lowest_Hz < highest_Hz:
        raise InputError("must lie above 0 and below the highest", where="lowest_Hz", value=lowest_Hz)
    slack = 1e-9
    first = int(np.ceil(10.0 * np.log10(lowest_Hz) + 0.5 - slack))
    last = int(np.floor(10.0 * np.log10(highest_Hz) - 0.5 + slack))
    middle = 10.0 ** (np.arange(first, last + 1) / 10.0)
    return middle, middle / _HALF, middle * _HALF


def band_energy(energy: Reals, step_Hz: float, lower_Hz: Reals, upper_Hz: Reals) -> Reals:
    """Integral of a one-sided energy density over bands.

    Parameters
    ----------
    energy : ndarray, shape (..., F)
        At 0, step, 2 step, ...; each line stands for half a step on either side, 0 for the half above it.
    step_Hz : float
    lower_Hz, upper_Hz : ndarray, shape (B,)

    Returns
    -------
    ndarray, shape (..., B)
    """
    edges = (np.arange(energy.shape[-1] + 1) - 0.5) * step_Hz
    edges[0] = 0.0
    total = np.cumsum(energy * np.diff(edges), axis=-1)
    total = np.concatenate([np.zeros((*energy.shape[:-1], 1)), total], axis=-1)
    flat = total.reshape(-1, total.shape[-1])
    values = [np.interp(upper_Hz, edges, row) - np.interp(lower_Hz, edges, row) for row in flat]
    return np.asarray(values).reshape(*energy.shape[:-1], lower_Hz.size)
