"""The nominal model alone, recalibrated: what a comparison shows, and what a challenge weighs its campaigns by."""

from __future__ import annotations

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.fit import free_parameters
from permway.diagnosis.observations import Observations
from permway.diagnosis.speeds import begin
from permway.diagnosis.tangent import Problem
from permway.posterior.covariance import Frame
from permway.posterior.fit import Fit, Model
from permway.posterior.fitter import Fitter
from permway.posterior.ordering import LEVELS, annealed, weighed


def first_values(fitter: Fitter, nominal: Model) -> Reals:
    """The priors' centres; of passages speed and time of entry are looked for, within which slopes serve."""
    observations = fitter.frame.observations
    if all(dataset.record.statistic != "passage" for dataset in observations.datasets):
        return np.zeros(len(nominal.free))
    return begin(observations, Problem(observations, nominal.build, nominal.free))


def recalibrated(observations: Observations) -> Fit:
    """The empty set's fit: the discrepancy falls, then records are weighed by what the model predicts.

    Parameters
    ----------
    observations : Observations

    Raises
    ------
    InputError
        If the model cannot be predicted at the stated values.
    """
    fitter = Fitter(Frame.of(observations))
    campaign = observations.campaign
    nominal = Model(campaign.with_values, free_parameters(campaign))
    start = fitter.begin(nominal, first_values(fitter, nominal), fitter.frame.first().with_discrepancy(LEVELS[0]))
    _, (fit,) = weighed(fitter, [annealed(fitter, start)], [()])
    return fit
