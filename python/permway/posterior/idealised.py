"""What the idealisation of a model may do to its residuals: stiffness and mass vary a little over frequency.

Two discretisations of one structure differ by some tenths of a per cent, smoothly over frequency and in all
records alike. That is a change of the structure, and no new error of each line.
"""

from __future__ import annotations

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.fit import free_parameters
from permway.posterior.fit import Fit

SIZE = 0.003
"""Of a stiffness or a mass, as a ratio, one standard deviation: as discretisations differ."""

SHOWN = 0.01
"""Square of an error of unit variance, in standard deviations, below which it is left out: it would change evidence
by less than 0.005 nats."""

STEP = 1e-3
"""Of a parameter, in standard deviations, for the ratio by which it changes."""


def idealised(fit: Fit) -> Reals:
    """Columns of unit variance: each nominal parameter, changed in proportion to octaves and to their square.

    Parameters
    ----------
    fit : Fit
        Whose slopes say what a parameter does.

    Returns
    -------
    ndarray, shape (n, at most 2 p)
    """
    octaves = np.log2(fit.frame.evidence.rows.frequency_Hz)
    low, high = float(octaves.min()), float(octaves.max())
    x = (2.0 * octaves - low - high) / max(high - low, 1e-9)
    found = []
    nominal = free_parameters(fit.frame.evidence.campaign)
    for index, one in enumerate(nominal):
        z = float(fit.z[index])
        value, beyond = one.value(z), one.value(z + STEP)
        if not value > 0.0 or not beyond > 0.0 or beyond == value:
            continue
        by_ratio = fit.jacobian[:, index] * STEP / float(np.log(beyond / value))
        found.extend([SIZE * by_ratio * x, SIZE * by_ratio * (1.5 * x**2 - 0.5)])
    if not found:
        return np.zeros((octaves.size, 0))
    # Turned, errors of unit variance stay such; most combinations of them do not show.
    columns = np.column_stack(found)
    roots = fit.covariance.roots(columns)
    shown, turn = np.linalg.eigh(roots.times(roots))
    return np.asarray(columns @ turn[:, shown > SHOWN])
