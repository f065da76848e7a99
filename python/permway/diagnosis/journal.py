"""What a diagnosis has found so far, so that one that was killed goes on where it was.

A diagnosis is the same steps in the same order for the same records and seed. Each long step writes what it
found into a file of its own, and a later run reads it instead of taking the step again, if it was given the same.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import zipfile
from collections.abc import Collection, Iterator, Mapping
from contextvars import ContextVar
from pathlib import Path

import numpy as np

from permway._core import __version__
from permway.campaign.campaign import Campaign
from permway.errors import InputError
from permway.files import write_bytes

Arrays = Mapping[str, np.ndarray]

DIGEST = "digest"
"""Name of the array that says what a step was given."""


FOLDER = "unfinished"
"""Of the steps, beside what will be written."""


def key_of(campaign: Campaign, seed: int, ruled_out: Collection[str] = ()) -> str:
    """Of all that a diagnosis depends on: version, campaign file, model, every record, seed, what is ruled out."""
    said = hashlib.sha256(f"{__version__} {seed} {sorted(set(ruled_out))}".encode())
    said.update(campaign.stated.model_dump_json().encode())
    said.update(campaign.model.model_dump_json().encode())
    for record in campaign.stated.records:
        for name in (record.file, record.loss_file):
            # What cannot be read is told of by its reader.
            with contextlib.suppress(OSError):
                if name is not None:
                    with (campaign.folder / name).open("rb") as file:
                        said.update(hashlib.file_digest(file, "sha256").digest())
    return said.hexdigest()


class Journal:
    """Steps in a folder, in their order.

    Parameters
    ----------
    folder : Path
        Made if its parent exists; taken away when all is done.
    key : str
        Of all that the steps depend on.
    """

    def __init__(self, folder: Path, key: str) -> None:
        self.folder, self._digest, self._step = folder, key, 0
        self.recalled = 0
        folder.mkdir(exist_ok=True)

    def recall(self, *given: object) -> Arrays | None:
        """What the next step found in an earlier run; None if it has to be taken.

        Parameters
        ----------
        given : objects
            What the step depends on beside the steps before it; arrays count by their bytes, others by their repr.
        """
        self._step += 1
        said = hashlib.sha256(self._digest.encode())
        for one in given:
            said.update(np.ascontiguousarray(one).tobytes() if isinstance(one, np.ndarray) else repr(one).encode())
        self._digest = said.hexdigest()
        try:
            # What was cut short, or is another's, is no step of ours.
            with np.load(io.BytesIO(self._path.read_bytes()), allow_pickle=False) as file:
                found = dict(file)
        except (OSError, ValueError, EOFError, TypeError, zipfile.BadZipFile):
            return None
        if str(found.pop(DIGEST, "")) != self._digest:
            return None
        self.recalled += 1
        return found

    def keep(self, found: Arrays) -> None:
        """Write what the step found that was asked for last; where there is no room, it is not kept."""
        content = io.BytesIO()
        np.savez(content, allow_pickle=False, **{DIGEST: np.array(self._digest)}, **found)
        with contextlib.suppress(InputError):
            write_bytes(self._path, content.getvalue())

    @property
    def _path(self) -> Path:
        return self.folder / f"step-{self._step:04d}.npz"

    def close(self) -> None:
        """Take the folder away: what was found is written elsewhere."""
        with contextlib.suppress(OSError):
            for path in [*self.folder.glob("step-*.npz"), *self.folder.glob(".step-*.part")]:
                path.unlink()
            self.folder.rmdir()


_CURRENT: ContextVar[Journal | None] = ContextVar("journal", default=None)


@contextlib.contextmanager
def silent() -> Iterator[None]:
    """Within it nothing is kept: for the parts of what is kept as a whole."""
    token = _CURRENT.set(None)
    try:
        yield
    finally:
        _CURRENT.reset(token)


def current() -> Journal | None:
    """The journal that steps are written into, if there is one."""
    return _CURRENT.get()


@contextlib.contextmanager
def keeping(folder: Path, key: str) -> Iterator[Journal]:
    """Within it, long steps are kept.

    Raises
    ------
    InputError
        If the folder cannot be made.
    """
    try:
        journal = Journal(folder, key)
    except OSError as error:
        raise InputError(
            f"cannot be made: {error.strerror or error}", where=str(folder), remedy="name another folder"
        ) from error
    token = _CURRENT.set(journal)
    try:
        yield journal
    finally:
        _CURRENT.reset(token)
