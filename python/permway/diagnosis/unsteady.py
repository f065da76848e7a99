"""How much less a parameter is known than its fit says: by records left out, and by octaves that disagree."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import stats

from permway.arrays import Reals
from permway.diagnosis.fit import WIDTH, Fit
from permway.diagnosis.heldout import Gain

FEWEST_OCTAVES = 6
"""With fewer, next to nothing is told of how they disagree."""


def unsteady(fit: Fit, found: Sequence[Gain]) -> Reals:
    """Variance of the parameters (p,) beyond the fit's own: what parts tell, or octaves, whichever is more."""
    return np.maximum(by_parts(fit, found), by_octaves(fit))


def by_parts(fit: Fit, found: Sequence[Gain]) -> Reals:
    """What parameters move by more than they should when records are left out, squared (p,).

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


def by_octaves(fit: Fit) -> Reals:
    """What octaves pull parameters by beyond what noise and smooth errors do, as a variance (p,).

    If the model is right, what an octave's records pull a parameter by has the variance that its slopes say. Where
    idealisations differ, neighbouring lines err alike and one octave pulls against another: what records add to
    the variance is then as much larger as the squares of their pulls are (after Liang and Zeger 1986; with few
    octaves Student's quantiles, Cameron and Miller 2015).

    Parameters
    ----------
    fit : Fit
        To all records.
    """
    hertz = fit.evidence.rows.frequency_Hz
    octaves, octave_of = np.unique(np.floor(np.log2(hertz)), return_inverse=True)
    own, count = np.diag(fit.covariance), octaves.size
    if count < FEWEST_OCTAVES:
        return np.zeros(own.size)
    covariance, reduce = fit.covariance, fit.evidence.whitener.reduce
    pulls, expected = np.zeros((count, own.size)), np.zeros(own.size)
    for index in range(count):
        slopes = fit.jacobian * (octave_of == index)[:, None]
        pulls[index] = fit.clean @ slopes / fit.heat
        # Smooth errors reach from octave to octave: of a right model, too, pulls add up to more than the whole.
        expected += _spread(slopes, reduce(slopes), covariance) / fit.heat
    # At the best fit they pull against the prior together, which is no disagreement.
    moves = (pulls - pulls.mean(axis=0)) @ covariance
    wider = (float(stats.t.ppf(stats.norm.cdf(WIDTH), count - 1)) / WIDTH) ** 2 * count / (count - 1.0)
    apart = np.sum(moves**2, axis=0) / np.maximum(expected, np.finfo(float).tiny)
    told = _spread(fit.jacobian, reduce(fit.jacobian), covariance) / fit.heat
    return np.asarray(told * np.maximum(wider * apart - 1.0, 0.0))


def _spread(slopes: Reals, reduced: Reals, covariance: Reals) -> Reals:
    """Variance of what deviations with these slopes move the parameters by, (p,)."""
    information = slopes.T @ slopes - reduced.T @ reduced
    return np.asarray(np.einsum("ij,jk,ki->i", covariance, information, covariance))
