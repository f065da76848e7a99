"""Writing campaigns that were imported: all of them, after each has been read back whole, or nothing."""

from __future__ import annotations

import errno
import shutil
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from permway.campaign.campaign import Campaign, read_campaign
from permway.errors import InputError
from permway.files import unwritable, write_text
from permway.laws.toml import to_toml
from permway.staged import staged

CAMPAIGN, MODEL = "campaign.toml", "model.toml"


@dataclass(frozen=True)
class Draft:
    """A campaign that is yet to be written.

    Attributes
    ----------
    campaign, model : mapping
        The two files as tables. Records name their files by the last part of the source's path.
    sources : sequence of Path
        Files of the records.
    folder : str
        Of the campaign, below the output; "" for the output itself.
    """

    campaign: Mapping[str, Any]
    model: Mapping[str, Any]
    sources: Sequence[Path]
    folder: str = ""


def write_campaigns(output: Path, drafts: Sequence[Draft], *, copy: bool = True) -> list[Campaign]:
    """Write campaigns beside their place, read all of them with their records, then put them there.

    Parameters
    ----------
    output : Path
        Made if its parent exists. Files of the names written are replaced, others stay.
    drafts : sequence of Draft
    copy : bool
        Whether the records are copied into the folders, which then are complete in themselves; else campaigns
        name them by their whole paths.

    Raises
    ------
    InputError
        For a folder that cannot be written, for a campaign that does not pass its own checks, and for a record
        that cannot be read. Then nothing is left, and what was there before is as it was.
    """
    for draft in drafts:
        _check_names(draft)
    with staged(output) as stage:
        with _named_as_given(stage.folder, output, drafts):
            for draft in drafts:
                folder = stage.folder / draft.folder
                _fill(folder, draft, copy)
                _read_whole(folder / CAMPAIGN, copy)
        for draft in drafts if copy else ():
            _leave_out_same(stage.folder / draft.folder, output / draft.folder, draft.sources)
        stage.place(last=CAMPAIGN)
        return [read_campaign(output / draft.folder / CAMPAIGN, allow_outside=not copy) for draft in drafts]


def _check_names(draft: Draft) -> None:
    """Refuse two files that would be one in the campaign's folder."""
    names = Counter([CAMPAIGN, MODEL, *(source.name for source in draft.sources)])
    twice = next((source for source in draft.sources if names[source.name] > 1), None)
    if twice is not None:
        remedy = "give each file of a campaign its own name"
        raise InputError("there is another file of that name", where=str(twice), remedy=remedy)


def _fill(folder: Path, draft: Draft, copy: bool) -> None:
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from error
    for source in draft.sources if copy else ():
        _copy(source, folder / source.name)
    files = {source.name: source.name if copy else str(source.resolve()) for source in draft.sources}
    table = dict(draft.campaign)
    table["records"] = [
        {**record, **{key: files[record[key]] for key in ("file", "loss_file") if key in record}}
        for record in draft.campaign["records"]
    ]
    if not copy:
        table = {"format": table.pop("format"), "allow_outside": True, **table}
    write_text(folder / MODEL, to_toml(draft.model))
    write_text(folder / CAMPAIGN, to_toml(table))


def _copy(source: Path, target: Path) -> None:
    try:
        shutil.copyfile(source, target)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
            raise unwritable(target, error) from error
        where = str(error.filename or source)
        raise InputError(f"cannot be copied: {error.strerror or error}", where=where) from error


def _read_whole(path: Path, copy: bool) -> None:
    with warnings.catch_warnings():
        # Whoever reads the campaign next is warned of its own place.
        warnings.simplefilter("ignore")
        read_campaign(path, allow_outside=not copy).load()


def _leave_out_same(stage: Path, output: Path, sources: Sequence[Path]) -> None:
    """A record that lies in the campaign's folder already is left alone."""
    for source in sources:
        target = output / source.name
        if target.exists() and source.samefile(target):
            (stage / source.name).unlink()


@contextmanager
def _named_as_given(stage: Path, output: Path, drafts: Sequence[Draft]) -> Iterator[None]:
    """Errors that name the files that were given, or the place where they will be, and not the stage."""
    names = {
        str(stage / draft.folder / source.name): str(source) for draft in drafts for source in draft.sources
    } | {str(stage): str(output)}

    def given(text: str) -> str:
        for name, shown in names.items():
            text = text.replace(name, shown)
        return text

    try:
        yield
    except InputError as error:
        value = given(error.value) if isinstance(error.value, str) else error.value
        raise InputError(
            given(error.what), where=given(error.where), value=value, remedy=given(error.remedy)
        ) from error
