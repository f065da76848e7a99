"""Folders of campaigns and of their truths, for a challenge."""

from __future__ import annotations

from pathlib import Path

from permway.challenge.case import Tier, draw, write, write_truth


def make(seed: int, cases: int, tier: Tier, out: Path | str) -> list[Path]:
    """Write some campaigns of a tier, and their truths in a folder of their own.

    Parameters
    ----------
    seed : int
        Of the first campaign; the others have those that follow.
    cases : int
    tier : Tier
        See :func:`permway.challenge.case.draw`.
    out : Path
        Gets `<tier>-<seed>/` for each campaign, and `truth/<tier>-<seed>.json` with its SHA-256.

    Returns
    -------
    list of Path
        The campaigns' folders.

    Raises
    ------
    InputError
        For a seed or a tier that is none, and a folder that cannot be made.
    """
    folders = []
    truths = Path(out) / "truth"
    for number in range(seed, seed + cases):
        case = draw(number, tier)
        folder = Path(out) / f"{tier}-{number}"
        write(case, folder)
        truths.mkdir(parents=True, exist_ok=True)
        write_truth(case, truths / f"{folder.name}.json")
        folders.append(folder)
    return folders
