"""How much less a parameter is known than its fit says, by how it moves when records are left out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.fit import Fit
from permway.diagnosis.heldout import Gain


def unsteady(fit: Fit, found: Sequence[Gain]) -> Reals:
    """Variance of the parameters (p,) beyond the fit's own: what they move by more than they should.

    If the model is right, the fit to the rest differs from that to all by the difference of their variances in the
    mean square (Hausman 1978). What moves more, because a law is not quite the true one, is no better known.

    Parameters
    ----------
    fit : Fit
        To all records.
    found : sequence of Gain
        Of it as the amended model, part by part.
    """
    own, more = np.diag(fit.covariance), np.zeros(fit.z.size)
    for gain in found:
        should = np.maximum(gain.sigma**2 - own, 0.0)
        more = np.maximum(more, (gain.z - fit.z) ** 2 - should)
    return more
