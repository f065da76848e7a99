"""A first look at many changes of the recalibrated model: one solution each, to choose where to start."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import linalg

from permway.campaign.campaign import Campaign
from permway.diagnosis.fit import Fit
from permway.diagnosis.side_by_side import SMALL, each
from permway.errors import InputError, SolveError


class Glance:
    """What changes of the recalibrated model gain while its parameters move linearly.

    Parameters
    ----------
    fit : Fit
        The recalibrated base, with effects in it or not.
    apart : sequence of str
        Parameters that do not move.
    """

    def __init__(self, fit: Fit, apart: Sequence[str] = ()) -> None:
        self._fit = fit
        self._solved = fit.evidence.predicted(fit.campaign)
        self._whitener = fit.evidence.whitener
        moving = np.array([f.name not in apart for f in fit.free], dtype=bool)
        self._z, self._jacobian = fit.z[moving], fit.jacobian[:, moving]
        self._reduced = self._whitener.reduce(self._jacobian)
        normal = (self._jacobian.T @ self._jacobian - self._reduced.T @ self._reduced) / fit.heat
        self._factor = linalg.cho_factor(normal + np.eye(self._z.size))

    def objectives(self, campaigns: Sequence[Campaign]) -> list[float]:
        """Of several, side by side."""
        return each(self.objective, campaigns, threads=self._fit.evidence.threads, least=SMALL)

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
        slope = (self._jacobian.T @ deviations - self._reduced.T @ reduced) / fit.heat + self._z
        return square - float(slope @ linalg.cho_solve(self._factor, slope))
