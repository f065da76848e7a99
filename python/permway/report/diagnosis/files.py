"""Everything that a diagnosis leaves in a folder: verdict, amended model, page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from permway.diagnosis.result import Diagnosis
from permway.diagnosis.verdict import UNPROVED
from permway.errors import InputError
from permway.files import prepare_folder, write_text
from permway.formats.model_writing import model_table
from permway.laws.toml import to_toml
from permway.report.diagnosis.writing import PAGE, write_report

VERDICT, AMENDED = "verdict.json", "amended.toml"


def write_diagnosis(diagnosis: Diagnosis, folder: Path, *, page: bool = True) -> dict[str, Any]:
    """Write the verdict, the amended model, and the page.

    Without an effect that passed every bar the model is that of the campaign, recalibrated; its parameters are
    then `recalibrated.before` of the verdict, else `recalibrated.after`.

    Parameters
    ----------
    diagnosis : Diagnosis
    folder : Path
        Made if its parent exists.
    page : bool
        Whether to write the page, which takes the longest.

    Returns
    -------
    dict
        What there is, for people and machines.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    folder = prepare_folder(Path(folder), (VERDICT, AMENDED, PAGE))
    verdict = diagnosis.verdict
    found: dict[str, Any] = {}
    if verdict.blunders:
        found["blunders"] = [f"{one.where}: {one.what}; {one.remedy}" for one in verdict.blunders]
    found |= {
        "verdict": verdict.sentence,
        "status": verdict.status,
        "effects": [
            {"name": e.name or " or ".join(m.name for m in e.class_) or "not named", "place": e.place.label}
            for e in verdict.effects
        ],
        "seconds": {stage: round(seconds, 1) for stage, seconds in diagnosis.seconds.items()},
    }
    fit = diagnosis.base if diagnosis.amended is None or verdict.status in UNPROVED else diagnosis.amended
    write_text(folder / VERDICT, verdict.to_json())
    found["verdict file"] = str(folder / VERDICT)
    try:
        write_text(folder / AMENDED, to_toml(model_table(fit.campaign.model)))
        found["amended model"] = str(folder / AMENDED)
    except InputError as error:
        found["amended model"] = f"not written: {error}"
    if page:
        found["report"] = str(write_report(diagnosis, folder))
    return found
