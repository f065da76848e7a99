"""Diagnoses the embedded campaign, and states what was concealed in it."""

from __future__ import annotations

import json
import webbrowser
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

from permway.files import prepare_folder, write_bytes

CAMPAIGN = ("campaign.toml", "model.toml", "hammer_+12C.mat", "README.md", "truth.json")


def campaign_files() -> dict[str, bytes]:
    """The files of the embedded campaign, by name."""
    place = files("permway.demo") / "campaign"
    return {name: (place / name).read_bytes() for name in CAMPAIGN}


def run(
    folder: str | Path,
    *,
    threads: int | None = None,
    show: bool = False,
    progress: Callable[[str, int, int], None] | None = None,
) -> dict[str, Any]:
    """Lay the campaign into a folder, diagnose it, and write the report beside it.

    Parameters
    ----------
    folder : path
        Made if its parent exists; gets `campaign/` and `diagnosis/`.
    threads : int, optional
        By default all processors.
    show : bool
        Open the report in a browser.
    progress : callable, optional
        Called with the stage, and how much of it is done.

    Returns
    -------
    dict
        What :func:`permway.report.diagnosis.write_diagnosis` returns, and `concealed`: what was put into the
        records.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    from permway.campaign.campaign import read_campaign
    from permway.posterior.diagnose import diagnose
    from permway.report.diagnosis import write_diagnosis

    prepare_folder(Path(folder))
    campaign = prepare_folder(Path(folder) / "campaign", CAMPAIGN)
    output = prepare_folder(Path(folder) / "diagnosis")
    for name, content in campaign_files().items():
        write_bytes(campaign / name, content)
    truth = json.loads((campaign / "truth.json").read_bytes())
    found = write_diagnosis(
        diagnose(read_campaign(campaign / "campaign.toml"), threads=threads, progress=progress), output
    )
    if show:
        webbrowser.open(Path(found["report"]).resolve().as_uri())
    return {"campaign": str(campaign / "campaign.toml"), "concealed": truth["notes"], **found}
