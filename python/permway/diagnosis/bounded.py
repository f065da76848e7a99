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
    with it beyond, which may be no better than where they were.

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
    return np.asarray(lsq_linear(factor, target, (low - z, high - z), method="bvls").x)
