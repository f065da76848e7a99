"""Diagnoses of campaigns into folders: one, or many, here or on a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from permway import _core
from permway.campaign.campaign import Campaign, read_campaign
from permway.checking.check import check
from permway.diagnosis.clock import Progress as Stages
from permway.errors import InputError, PermwayError
from permway.files import prepare_folder, write_text
from permway.posterior.diagnose import diagnose
from permway.posterior.journal import FOLDER, keeping, key_of
from permway.reading import read_toml
from permway.report.diagnosis import write_diagnosis
from permway.study.cluster import on_cluster
from permway.study.folders import Files, worked_in_folder, write_files

KEY = "diagnosed.txt"
"""File that says of what the diagnosis beside it is: its key, see :func:`permway.posterior.journal.key_of`."""

OUT = "diagnosis"


@dataclass(frozen=True)
class Diagnosed:
    """What came of many campaigns: folders that have a diagnosis, those that had it before, errors by campaign."""

    done: tuple[str, ...]
    already_there: tuple[str, ...]
    failed: Mapping[str, str]


def diagnose_into(
    campaign: Campaign,
    folder: Path,
    *,
    ruled_out: Collection[str] = (),
    page: bool = True,
    threads: int | None = None,
    say: Callable[[str], object] = lambda line: None,
    progress: Callable[[], Any] | None = None,
) -> dict[str, Any]:
    """Check a campaign, diagnose it and write what was found; what was stopped goes on where it was.

    Parameters
    ----------
    campaign : Campaign
    folder : Path
        Made if its parent exists.
    ruled_out : collection of str
        Effects of the catalogue that cannot be.
    page : bool
        Whether to write the page.
    threads : int, optional
    say : callable
        Called with each thing that is probably stated wrongly, before the diagnosis.
    progress : callable, optional
        Makes a context manager whose value is called with stages, while the diagnosis runs.

    Returns
    -------
    dict
        See :func:`permway.report.diagnosis.write_diagnosis`.

    Raises
    ------
    InputError, SolveError
        As :func:`permway.diagnose`.
    """
    folder = prepare_folder(folder)
    checked = check(campaign, threads=threads)
    for blunder in checked.blunders:
        say(f"{'asked' if blunder.asked else 'put right first'}: {blunder.sentence}")
    with keeping(folder / FOLDER, key_of(campaign, ruled_out)) as steps:
        if progress is None:
            found = diagnose(campaign, ruled_out=ruled_out, threads=threads)
        else:
            with progress() as stages:
                found = diagnose(campaign, ruled_out=ruled_out, threads=threads, progress=stages)
        written = write_diagnosis(found.with_blunders(checked), folder, page=page)
        steps.close()
    return written


def diagnose_many(
    campaigns: Sequence[Path],
    folders: Sequence[Path],
    *,
    ruled_out: Collection[str] = (),
    page: bool = True,
    scheduler: str | None = None,
    threads: int | None = None,
    progress: Stages | None = None,
) -> Diagnosed:
    """Diagnose campaigns that have no diagnosis by the same program yet, one failing without the others.

    Parameters
    ----------
    campaigns : sequence of Path
        Campaign files; all that they name lies in their folders.
    folders : sequence of Path
        Of each, where its diagnosis goes.
    ruled_out, page, threads
        As :func:`diagnose_into`; each worker of a cluster uses one thread.
    scheduler : str, optional
        Address of a Dask scheduler; by default this machine computes.
    progress : callable, optional
        Called with "campaigns", how many are done, and of how many.

    Raises
    ------
    InputError
        Before anything is computed, for two campaigns that would write into one folder, and for a campaign that
        cannot be used.
    """
    places = [folder.resolve() for folder in folders]
    for index, place in enumerate(places):
        if place in places[:index]:
            raise InputError("two campaigns would write there", where=str(place), remedy="name them otherwise")
    read = {str(folder): read_campaign(path) for path, folder in zip(campaigns, folders, strict=True)}
    keys = {name: key_of(campaign, ruled_out) for name, campaign in read.items()}
    there = tuple(name for name in read if _key_in(Path(name)) == keys[name])
    left = {name: prepare_folder(Path(name)) for name in read if name not in there}
    done, failed = [], {}
    options = {"ruled_out": tuple(ruled_out), "page": page}
    answers: Iterator[tuple[str, str]] = (
        ((name, _here(read[name], folder, threads, options)) for name, folder in left.items())
        if scheduler is None
        else _there({name: read[name] for name in left}, scheduler, options)
    )
    for name, error in answers:
        if error:
            failed[name] = error
        else:
            write_text(Path(name) / KEY, keys[name])
            done.append(name)
        if progress is not None:
            progress("campaigns", len(there) + len(done) + len(failed), len(read))
    return Diagnosed(tuple(done), there, failed)


def _key_in(folder: Path) -> str:
    try:
        return (folder / KEY).read_text("utf-8")
    except OSError:
        return ""


def _here(campaign: Campaign, folder: Path, threads: int | None, options: Mapping[str, Any]) -> str:
    (folder / KEY).unlink(missing_ok=True)
    try:
        diagnose_into(campaign, folder, threads=threads, **options)
    except PermwayError as error:
        return str(error)
    return ""


def _there(
    campaigns: Mapping[str, Campaign], scheduler: str, options: Mapping[str, Any]
) -> Iterator[tuple[str, str]]:
    items = (
        (name, (partial(_on_worker, campaign.file, options), files_of(campaign), _core.__version__))
        for name, campaign in campaigns.items()
    )
    for name, outcome in on_cluster(worked_in_folder, items, scheduler):
        if not outcome.error:
            _, files = outcome.value
            made = {path.removeprefix(f"{OUT}/"): content for path, content in files.items()}
            (Path(name) / KEY).unlink(missing_ok=True)
            write_files(Path(name), made, ("verdict.json",))
        yield name, outcome.error


def _on_worker(file: str, options: Mapping[str, Any], folder: Path) -> None:
    diagnose_into(read_campaign(folder / file), folder / OUT, threads=1, **options)


def files_of(campaign: Campaign) -> Files:
    """The files that a campaign is read from: its own, the model's, those of laws and of records.

    Raises
    ------
    InputError
        For one that cannot be read.
    """
    names = {campaign.file, campaign.stated.model}
    beside = Path(campaign.stated.model).parent
    laws = _named_files(read_toml(campaign.folder / campaign.stated.model, "name a model file (TOML)"))
    names |= {(beside / name).as_posix() for name in laws}
    for record in campaign.stated.records:
        names |= {name for name in (record.file, record.loss_file) if name is not None}
    try:
        return {name: (campaign.folder / name).read_bytes() for name in sorted(names)}
    except OSError as error:
        where = str(campaign.folder / campaign.file)
        raise InputError(f"names a file that cannot be read: {error}", where=where) from error


def _named_files(table: object) -> Iterator[str]:
    """Of a model's table, what stands under "file", wherever a law is one."""
    if isinstance(table, Mapping):
        for key, part in table.items():
            if key == "file" and isinstance(part, str):
                yield part
            else:
                yield from _named_files(part)
    elif isinstance(table, list):
        for part in table:
            yield from _named_files(part)
