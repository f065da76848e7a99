"""The nominal model alone, recalibrated: what a comparison shows, and what a challenge weighs its campaigns by."""

from __future__ import annotations

import numpy as np

from permway.diagnosis.evidence import Evidence
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.speeds import begin
from permway.diagnosis.tangent import Problem
from permway.posterior.covariance import Frame
from permway.posterior.fit import Fit, Fitter, Model
from permway.posterior.ordering import LEVELS, annealed, weighed


def recalibrated(evidence: Evidence) -> Fit:
    """The empty set's fit: the discrepancy falls, then records are weighed by what the model predicts.

    Parameters
    ----------
    evidence : Evidence

    Raises
    ------
    InputError
        If the model cannot be predicted at the stated values.
    """
    fitter = Fitter(Frame.of(evidence))
    campaign = evidence.campaign
    nominal = Model(campaign.with_values, free_parameters(campaign))
    z = np.zeros(len(nominal.free))
    if any(dataset.record.statistic == "passage" for dataset in evidence.datasets):
        # Slopes serve only near the speed and the time of entry.
        z = begin(evidence, Problem(evidence, nominal.build, nominal.free))
    start = fitter.begin(nominal, z, fitter.frame.first().with_discrepancy(LEVELS[0]))
    _, (fit,) = weighed(fitter, [annealed(fitter, start)], [()])
    return fit
