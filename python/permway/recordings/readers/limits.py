"""What is refused before it is read: files that are not there, and sizes that no memory holds."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from permway.errors import InputError

MOST_BYTES = 2**30
"""Most that a record may take in memory, bytes, unless stated otherwise."""

_BY_HAND = ("text", "uff", "wav", "mat", "lvm")

MOST_CHANNELS = 100_000
"""More channels, pairs or columns than this are a damaged header."""


def existing_file(path: str | Path) -> Path:
    """A file that is there, can be opened and holds something.

    Raises
    ------
    InputError
        Otherwise.
    """
    source = Path(path)
    try:
        if source.is_dir():
            raise InputError("is a folder, not a file", where=str(source), remedy="name a file in it")
        with source.open("rb") as file:
            empty = not file.read(1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        what = f"cannot be read: {getattr(error, 'strerror', None) or error}"
        raise InputError(what, where=str(source), remedy="give an existing file") from error
    if empty:
        raise InputError("the file is empty", where=str(source), remedy="give the file as it was recorded")
    return source


def check_size(count: int, where: str, *, max_bytes: int = MOST_BYTES, item: int = 8) -> None:
    """Refuse what would take more memory than allowed, before it is taken.

    Raises
    ------
    InputError
        If `count` items of `item` bytes are more than `max_bytes`.
    """
    if count * item > max_bytes:
        raise InputError(
            f"{count:.4g} values take {count * item / 2**30:.3g} GiB, above the limit of {max_bytes / 2**30:.3g}",
            where=where,
            remedy="read fewer channels, fewer samples, or blocks; raise max_bytes if the file is right",
        )


@contextmanager
def foreign(source: Path, kind: str) -> Iterator[None]:
    """Turn whatever another library raises on a damaged file into one `InputError`.

    Parameters
    ----------
    source : Path
    kind : str
        The format, for the message. Of formats that are read here by hand only the system's faults are turned: any
        other would be a mistake of the reader, not of the file.
    """
    try:
        # Numbers that are none may be met while they are converted; they are reported afterwards, with their
        # place.
        with np.errstate(invalid="ignore", over="ignore"):
            yield
    except InputError:
        raise
    except MemoryError as error:
        what = f"claims more than memory holds: no sound {kind} file"
        raise InputError(what, where=str(source), remedy="record or export it again") from error
    except Exception as error:
        if kind in _BY_HAND:
            raise
        stated = (str(error).splitlines() or [""])[0][:120]
        raise InputError(
            f"cannot be read as {kind}: damaged, cut short or of another format",
            where=str(source),
            value=f"{type(error).__name__}: {stated}",
            remedy="export it again, or say which format it has",
        ) from error
