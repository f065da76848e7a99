"""Writes the page of a diagnosis, `report.html`."""

from __future__ import annotations

from pathlib import Path

from permway.diagnosis.result import Diagnosis
from permway.files import prepare_folder, write_text

PAGE = "report.html"


def write_report(diagnosis: Diagnosis, folder: Path, *, dpi: int = 140) -> Path:
    """Write the page, which holds its pictures and needs nothing from outside.

    Parameters
    ----------
    diagnosis : Diagnosis
    folder : Path
        Made if its parent exists.
    dpi : int
        Of the pictures.

    Returns
    -------
    Path
        Of the page.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    # Drawing is slow to import.
    from permway.report.diagnosis.verdict_page import render_verdict, verdict_pictures
    from permway.report.readout import drawn

    folder = prepare_folder(Path(folder), (PAGE,))
    return write_text(folder / PAGE, render_verdict(diagnosis, drawn(verdict_pictures(diagnosis), dpi)))
