"""A damped Newton step between limits."""

from __future__ import annotations

import numpy as np
from scipy import linalg
from scipy.optimize import lsq_linear

from permway.arrays import Reals


def bounded_step(normal: Reals, slope: Reals, z: Reals, low: Reals, high: Reals, damping: float) -> Reals:
    """The step to the least of a quadratic form, its diagonal damped, that stays between limits.

    A parameter that would leave stays at its limit, and the others go where they do best with it there (Stark and
    Parker 1995, Computational Statistics 10): were it clipped after the step, they would be where they do best
    with it beyond, which may be no better than where they were. One whose limits are equal stays where it is.

    Parameters
    ----------
    normal : ndarray, shape (p, p)
        Curvature, positive definite.
    slope : ndarray, shape (p,)
        At `z`, half of it as `normal` is.
    z, low, high : ndarray, shape (p,)
        Values and limits, `z` between them.
    damping : float

    Returns
    -------
    ndarray, shape (p,)
    """
    damped = normal + damping * np.diag(np.diag(normal))
    factor = linalg.cholesky(damped)
    target = -linalg.solve_triangular(factor, slope, trans="T")
    shift = np.asarray(linalg.solve_triangular(factor, target))
    if np.all(z + shift >= low) and np.all(z + shift <= high):
        return shift
    free = low < high
    if not free.all():
        shift = np.where(free, 0.0, np.clip(z, low, high) - z)
        if free.any():
            held = (damped @ shift + slope)[free]
            shift[free] = bounded_step(normal[np.ix_(free, free)], held, z[free], low[free], high[free], damping)
        return shift
    return np.asarray(lsq_linear(factor, target, (low - z, high - z), method="bvls").x)
