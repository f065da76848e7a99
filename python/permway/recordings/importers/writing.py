"""Writing a campaign's folder: the files of records, the model file, and last the campaign file."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from permway.errors import InputError
from permway.files import prepare_folder, write_text
from permway.laws.toml import to_toml
from permway.recordings.campaign import Campaign, read_campaign


def write_campaign(
    folder: Path,
    *,
    campaign: Mapping[str, Any],
    model: Mapping[str, Any],
    sources: Sequence[Path],
    copy: bool = True,
) -> Campaign:
    """Write a campaign, and read it back.

    Parameters
    ----------
    folder : Path
        Made if its parent exists. Files of the names written are replaced.
    campaign, model : mapping
        The two files as tables. Records name their files by the last part of the source's path, or with `copy` off
        get its whole path.
    sources : sequence of Path
        Files of the records.
    copy : bool
        Whether the records are copied into the folder, which then is complete in itself.

    Raises
    ------
    InputError
        For a folder that cannot be written, and for a campaign that does not pass its own checks.
    """
    prepare_folder(folder, ["campaign.toml", "model.toml", *(source.name for source in sources if copy)])
    files = {source.name: source.name if copy else str(source.resolve()) for source in sources}
    if copy:
        for source in sources:
            _copy(source, folder / source.name)
    table = dict(campaign)
    table["records"] = [
        {**record, **{key: files[record[key]] for key in ("file", "loss_file") if key in record}}
        for record in campaign["records"]
    ]
    if not copy:
        table = {"format": table.pop("format"), "allow_outside": True, **table}
    write_text(folder / "model.toml", to_toml(model))
    write_text(folder / "campaign.toml", to_toml(table))
    return read_campaign(folder / "campaign.toml", allow_outside=not copy)


def _copy(source: Path, target: Path) -> None:
    """Copy a file whole or not at all; a file onto itself is left alone."""
    temporary = None
    try:
        if target.exists() and source.samefile(target):
            return
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.", suffix=".part")
        os.close(handle)
        shutil.copyfile(source, temporary)
        Path(temporary).chmod(0o644)
        os.replace(temporary, target)
    except OSError as error:
        where = str(error.filename or source)
        raise InputError(f"cannot be copied: {error.strerror or error}", where=where) from error
    finally:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)
