"""How vibration decays along the track."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from permway.arrays import Reals, is_real
from permway.errors import InputError


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
    if not is_real(distance_m) or not (np.isfinite(distance_m) and distance_m > 0.0):
        raise InputError("must be positive", where="distance_m", value=distance_m, remedy="give it in m")
    moduli = [_modulus(name, response) for name, response in (("near", near), ("far", far))]
    if moduli[0].shape != moduli[1].shape:
        raise InputError(
            f"shape {moduli[1].shape} does not fit that of near, {moduli[0].shape}",
            where="far",
            remedy="give both at the same frequencies",
        )
    return np.asarray(20.0 * np.log10(moduli[0] / moduli[1]) / distance_m, dtype=np.float64)


def _modulus(name: str, response: ArrayLike) -> Reals:
    try:
        modulus = np.abs(np.asarray(response, dtype=np.complex128))
    except (TypeError, ValueError) as error:
        raise InputError("not numbers", where=name, value=response) from error
    if not (np.isfinite(modulus) & (modulus > 0.0)).all():
        raise InputError("a response must be finite and not zero", where=name)
    return modulus
