"""How hard a concealed effect is to see: the deviance that no recalibration takes away."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from permway.diagnosis.bases import bases
from permway.diagnosis.clock import Clock
from permway.diagnosis.fit import Fit
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.recalibrate import recalibrate
from permway.errors import InputError
from permway.recordings.campaign import Campaign, read_campaign
from permway.recordings.importers.sheet import import_sheet

Progress = Callable[[str], object]


def deviance(
    campaign: Campaign, twin: Campaign, *, threads: int | None = None, progress: Progress | None = None
) -> float:
    """Deviance between a campaign with an effect and its best recalibrated base, beyond that of its twin.

    The twin has the same parameters, noise and errors of chains, and nothing concealed: what its base leaves is no
    effect. The errors' sizes are learnt from it, where there is nothing else to take for an error.

    Parameters
    ----------
    campaign, twin : Campaign
        Of the same layout, conditions and lines.
    threads : int, optional
        Of the solver.
    progress : callable, optional
        Told in words how far it is.

    Returns
    -------
    float
        Of quadratic forms and priors; about 0 without an effect, and it may come out below.

    Raises
    ------
    InputError
        If no record can be predicted, or the two do not have the same records.
    """

    def told(stage: str, _done: int, _total: int) -> None:
        if progress is not None:
            progress(stage)

    plain, _ = bases(gather(twin, predictable(twin, screened=False).kept, threads=threads), Clock(told))
    datasets = predictable(campaign, screened=False).kept
    there = plain.evidence.selected(plain.evidence.records).datasets
    mine, others = ([d.record.name for d in sets] for sets in (datasets, there))
    if mine != others:
        raise InputError("does not have the records of its twin", where="records", value=mine, remedy=str(others))
    evidence = plain.evidence.of(campaign, datasets)
    fits = [
        recalibrate(evidence, start=start, learn=False, reweigh=False, progress=progress)
        for start in (plain.z, None)
    ]
    return min(_misfit(fit) for fit in fits) - _misfit(plain)


def _misfit(fit: Fit) -> float:
    return fit.chi2 - fit.evidence.log_determinant + fit.prior


def of_folders(campaign: Path, twin: Path) -> float:
    """The same of two measuring teams' folders, imported for the time it takes.

    Raises
    ------
    InputError
        As :func:`deviance`, and from importing.
    """
    with TemporaryDirectory() as place:
        read = []
        for folder, name in ((campaign, "campaign"), (twin, "twin")):
            import_sheet(folder, Path(place) / name)
            read.append(read_campaign(Path(place) / name / "campaign.toml"))
        return deviance(*read, threads=1)
