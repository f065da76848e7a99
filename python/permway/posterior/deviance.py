"""How hard a concealed effect is to see: the deviance that no recalibration takes away."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.importers.sheet import import_sheet
from permway.campaign.load import Dataset
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.side_by_side import one_thread_of_blas
from permway.errors import InputError
from permway.posterior.beam import STEPS
from permway.posterior.covariance import Frame
from permway.posterior.fit import Fit, Model
from permway.posterior.fitter import Fitter
from permway.posterior.ordering import LEVELS
from permway.posterior.recalibrated import recalibrated


@one_thread_of_blas()
def against(control: Campaign, *, threads: int | None = None) -> Callable[[Campaign], float]:
    """Deviance between campaigns with an effect and their best recalibrated base, beyond that of their control.

    The control has the same parameters, noise and errors of chains, and nothing concealed: what its base leaves is
    no effect. The hyperparameters are those of the control, where there is nothing else to take for an error.

    Parameters
    ----------
    control : Campaign
    threads : int, optional
        Of the solver.

    Returns
    -------
    callable
        From a campaign of the same layout, conditions and lines to its deviance, of quadratic forms and priors;
        about 0 without an effect, and it may come out below. InputError for other records than the control's.

    Raises
    ------
    InputError
        If no record can be predicted.
    """
    measured = predictable(control, screened=False).kept
    plain = recalibrated(gather(control, measured, threads=threads))
    there = [dataset.record.name for dataset in measured]
    least = _least_square(plain, control, measured)

    @one_thread_of_blas()
    def deviance(campaign: Campaign) -> float:
        datasets = predictable(campaign, screened=False).kept
        mine = [dataset.record.name for dataset in datasets]
        if mine != there:
            raise InputError(
                "does not have the records of its control", where="records", value=mine, remedy=str(there)
            )
        return _least_square(plain, campaign, datasets) - least

    return deviance


def _least_square(plain: Fit, campaign: Campaign, datasets: Sequence[Dataset]) -> float:
    """Quadratic forms and priors of the best fit to a campaign's records, weighed as those of its control are."""
    frame = Frame.of(plain.frame.observations.of(campaign, datasets))
    # What follows the records' own errors is the idealisation, as the control's fit has it.
    fitter = Fitter(frame.with_idealisation(plain.frame.idealisation))
    model = Model(campaign.with_values, plain.model.free)
    near = fitter.begin(model, plain.z, plain.hyper)
    far = fitter.begin(model, np.zeros_like(plain.z), plain.hyper)
    for level, steps in zip(LEVELS, STEPS, strict=False):
        far = fitter.fit(replace(far, hyper=plain.hyper.with_discrepancy(level)), steps=steps)
    fits = [fitter.fit(fit, steps=STEPS[-1]) for fit in (near, replace(far, hyper=plain.hyper))]
    return min(fit.covariance.square(fit.state.residuals) + float(fit.z @ fit.z) for fit in fits)


def against_folder(control: Path) -> Callable[[Path], float]:
    """The same of measuring teams' folders, each imported for the time it takes.

    Raises
    ------
    InputError
        As :func:`against`, and from importing.
    """

    def deviance(folder: Path) -> float:
        with TemporaryDirectory() as place:
            return plain(_imported(folder, Path(place)))

    with TemporaryDirectory() as place:
        plain = against(_imported(control, Path(place)), threads=1)
    return deviance


def _imported(folder: Path, place: Path) -> Campaign:
    import_sheet(folder, place / "campaign")
    return read_campaign(place / "campaign" / "campaign.toml")
