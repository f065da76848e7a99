"""A first look at many changes of the recalibrated model: one solution each, to choose where to start."""

from __future__ import annotations

import numpy as np
from scipy import linalg

from permway.diagnosis.fit import Fit
from permway.errors import InputError, SolveError
from permway.recordings.campaign import Campaign


class Glance:
    """What changes of the recalibrated model gain while its parameters move linearly.

    Parameters
    ----------
    fit : Fit
        The recalibrated base.
    """

    def __init__(self, fit: Fit) -> None:
        self._fit = fit
        self._solved = fit.evidence.predicted(fit.campaign)
        self._whitener = fit.evidence.whitener
        self._reduced = self._whitener.reduce(fit.jacobian)
        normal = (fit.jacobian.T @ fit.jacobian - self._reduced.T @ self._reduced) / fit.heat
        self._factor = linalg.cho_factor(normal + np.eye(fit.z.size))

    def objective(self, campaign: Campaign) -> float:
        """The least heated objective over linear moves of the base; infinite if the model cannot be solved."""
        fit = self._fit
        try:
            solved = fit.evidence.predicted(campaign, self._solved)
            deviations = fit.evidence.deviations(solved.datasets)
        except (InputError, SolveError):
            return np.inf
        if not np.isfinite(deviations).all():
            return np.inf
        reduced = self._whitener.reduce(deviations)
        square = float(deviations @ deviations - reduced @ reduced) / fit.heat
        slope = (fit.jacobian.T @ deviations - self._reduced.T @ reduced) / fit.heat + fit.z
        return square - float(slope @ linalg.cho_solve(self._factor, slope))
