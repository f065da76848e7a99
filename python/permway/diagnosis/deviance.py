"""How hard a concealed effect is to see: the deviance that no recalibration takes away."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from permway.campaign.campaign import Campaign, read_campaign
from permway.campaign.importers.sheet import import_sheet
from permway.diagnosis.bases import bases
from permway.diagnosis.clock import Clock
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.recalibrate import recalibrate
from permway.errors import InputError

Progress = Callable[[str], object]


def against(
    twin: Campaign, *, threads: int | None = None, progress: Progress | None = None
) -> Callable[[Campaign], float]:
    """Deviance between campaigns with an effect and their best recalibrated base, beyond that of their twin.

    The twin has the same parameters, noise and errors of chains, and nothing concealed: what its base leaves is no
    effect. The errors' sizes are learnt from it, where there is nothing else to take for an error.

    Parameters
    ----------
    twin : Campaign
    threads : int, optional
        Of the solver.
    progress : callable, optional
        Told in words how far it is.

    Returns
    -------
    callable
        From a campaign of the same layout, conditions and lines to its deviance, of quadratic forms and priors;
        about 0 without an effect, and it may come out below. InputError for other records than the twin's.

    Raises
    ------
    InputError
        If no record can be predicted.
    """

    def told(stage: str, _done: int, _total: int) -> None:
        if progress is not None:
            progress(stage)

    plain, _ = bases(gather(twin, predictable(twin, screened=False).kept, threads=threads), Clock(told))
    there = [d.record.name for d in plain.evidence.selected(plain.evidence.records).datasets]

    def deviance(campaign: Campaign) -> float:
        datasets = predictable(campaign, screened=False).kept
        mine = [d.record.name for d in datasets]
        if mine != there:
            raise InputError(
                "does not have the records of its twin", where="records", value=mine, remedy=str(there)
            )
        evidence = plain.evidence.of(campaign, datasets)
        fits = [
            recalibrate(evidence, start=start, learn=False, reweigh=False, progress=progress)
            for start in (plain.z, None)
        ]
        return min(_misfit(fit) for fit in fits) - _misfit(plain)

    return deviance


def _misfit(fit: Fit) -> float:
    return fit.chi2 - fit.evidence.log_determinant + fit.prior


def against_folder(twin: Path) -> Callable[[Path], float]:
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
        plain = against(_imported(twin, Path(place)), threads=1)
    return deviance


def _imported(folder: Path, place: Path) -> Campaign:
    import_sheet(folder, place / "campaign")
    return read_campaign(place / "campaign" / "campaign.toml")
