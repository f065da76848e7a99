"""How vibration decays along the track."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from permway.errors import InputError
from permway.laws.base import Reals


def decay_rate(near: ArrayLike, far: ArrayLike, distance_m: float) -> Reals:
    """Decay rate between two places (paper, equation (30)).

    Parameters
    ----------
    near, far : array_like, same shape
        Response at the force and at a distance from it, complex or modulus.
    distance_m : float
        Distance between the two places.

    Returns
    -------
    ndarray of float64
        20 lg(|near| / |far|) / distance, dB/m.

    Raises
    ------
    InputError
        For a distance that is not positive, or a response that is zero or not finite.
    """
    if not (np.isfinite(distance_m) and distance_m > 0.0):
        raise InputError("must be positive", where="distance_m", value=distance_m, remedy="give it in m")
    moduli = [np.abs(np.asarray(r)) for r in (near, far)]
    for name, modulus in zip(("near", "far"), moduli, strict=True):
        if not (np.isfinite(modulus) & (modulus > 0.0)).all():
            raise InputError("a response must be finite and not zero", where=name)
    return np.asarray(20.0 * np.log10(moduli[0] / moduli[1]) / distance_m, dtype=np.float64)
