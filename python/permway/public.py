"""Checks, comparisons and diagnoses in one call, of a campaign or of its file."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

from permway.campaign.campaign import Campaign, read_campaign
from permway.errors import InputError

if TYPE_CHECKING:
    from permway.checking.check import Checked
    from permway.diagnosis.clock import Progress as Stages
    from permway.diagnosis.compare import Comparison
    from permway.diagnosis.result import Diagnosis
    from permway.response.core import Progress


def check(campaign: Campaign | str | Path, *, threads: int | None = None) -> Checked:
    """Say in seconds what a campaign's records hold and what is probably stated wrongly; nothing is fitted.

    Parameters
    ----------
    campaign : Campaign or path
    threads : int, optional

    Raises
    ------
    InputError
        If the campaign file cannot be used; what is wrong with a record is in the answer.
    """
    from permway.checking.check import check as run

    return run(_campaign(campaign), threads=threads)


def compare(
    campaign: Campaign | str | Path,
    *,
    raw_only: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """Hold a campaign's records against its model, as stated and recalibrated.

    Parameters
    ----------
    campaign : Campaign or path
    raw_only : bool
        With the nominal values only.
    threads : int, optional
    progress : callable, optional
        Called with (done, total).

    Raises
    ------
    InputError
        If the campaign or a record cannot be used.
    """
    from permway.posterior.compare import compare as run

    return run(_campaign(campaign), raw_only=raw_only, threads=threads, progress=progress)


def diagnose(
    campaign: Campaign | str | Path,
    *,
    ruled_out: Collection[str] = (),
    threads: int | None = None,
    progress: Stages | None = None,
) -> Diagnosis:
    """Say what a campaign's model leaves out; what is probably stated wrongly is in `verdict.blunders`.

    Parameters
    ----------
    campaign : Campaign or path
    ruled_out : collection of str
        Effects of the catalogue that cannot be.
    threads : int, optional
        Processes that share the work.
    progress : callable, optional
        Called with the stage, how much of it is done, and of how much.

    Raises
    ------
    InputError
        If no record can be used, or what is ruled out is not in the catalogue.
    """
    from permway.checking.check import check as run_check
    from permway.posterior.diagnose import diagnose as run

    read = _campaign(campaign)
    checked = run_check(read, threads=threads)
    found = run(read, ruled_out=ruled_out, threads=threads, progress=progress)
    return found.with_blunders(checked)


def _campaign(given: Campaign | str | Path) -> Campaign:
    if isinstance(given, Campaign):
        return given
    if isinstance(given, str | Path):
        return read_campaign(given)
    raise InputError(
        f"must be a campaign or the path of its file, not a {type(given).__name__}",
        where="campaign",
        remedy='as in "campaign.toml"',
    )
