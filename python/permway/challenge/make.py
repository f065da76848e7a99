"""Folders of campaigns and of their truths, for a challenge."""

from __future__ import annotations

from pathlib import Path

from permway.challenge.case import Case, Tier, draw, write, write_truth
from permway.challenge.graded import graded
from permway.challenge.weigh import Against, keep
from permway.errors import InputError


def make(seed: int, cases: int, tier: Tier, out: Path | str, *, against: Against | None = None) -> list[Path]:
    """Write some campaigns of a tier, and their truths in a folder of their own.

    Parameters
    ----------
    seed : int
        Of the first campaign; the others have those that follow.
    cases : int
    tier : Tier
        See :func:`permway.challenge.case.draw`.
    out : Path
        Gets `<tier>-<seed>/` for each campaign, and `truth/<tier>-<seed>.json` with its SHA-256; of the graded
        ones `weights/<tier>-<seed>.json`, too.
    against : callable, optional
        See :func:`permway.challenge.weigh.weigh`; graded effects are faded by it, the others need none.

    Returns
    -------
    list of Path
        The campaigns' folders.

    Raises
    ------
    InputError
        For a seed or a tier that is none, a folder that cannot be made, and graded effects without a deviance.
    """
    folders = []
    truths = Path(out) / "truth"
    for number in range(seed, seed + cases):
        case, weight = _drawn(number, tier, against)
        folder = Path(out) / f"{tier}-{number}"
        write(case, folder)
        truths.mkdir(parents=True, exist_ok=True)
        if weight is not None:
            keep(Path(out), folder.name, weight)
        write_truth(case, truths / f"{folder.name}.json")
        folders.append(folder)
    return folders


def _drawn(seed: int, tier: Tier, against: Against | None) -> tuple[Case, float | None]:
    if tier != "graded":
        return draw(seed, tier), None
    if against is None:
        raise InputError("needs something to weigh effects against", where="tier", value=tier)
    return graded(seed, against)
