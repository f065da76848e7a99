"""Writing a report's files: each whole or not at all, and faults stated before the work."""

from __future__ import annotations

import contextlib
import errno
import glob
import os
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

from permway.errors import InputError

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""What an error's number is where there is no room."""

LEFT_BEHIND_S = 3600.0
"""A part of a file that is older was left by a process that was killed."""


def prepare_folder(folder: Path, names: Iterable[str] = ()) -> Path:
    """Make a folder, and see that files of these names can be written in it.

    Parts of files of these names that a killed process has left there, an hour ago or more, are taken away.

    Parameters
    ----------
    folder : Path
        Made if its parent exists.
    names : iterable of str
        Files that will be written.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    InputError
        If the folder cannot be made or written, or a name in it is taken by a folder.
    """
    check_folder(folder)
    try:
        folder.mkdir(exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise unwritable(folder, error) from error
    for name in names:
        if (folder / name).is_dir():
            raise InputError("is a folder, not a file", where=str(folder / name), remedy="name another folder")
        for part in folder.glob(f".{glob.escape(name)}.*.part"):
            with contextlib.suppress(OSError):
                if time.time() - part.stat().st_mtime > LEFT_BEHIND_S:
                    part.unlink()
    return folder


def check_folder(folder: Path) -> None:
    """See that a folder is there, or that it can be made beside others; nothing is written.

    Raises
    ------
    InputError
        If its parent is not there, or its name is taken by a file.
    """
    if not folder.parent.is_dir():
        raise InputError("there is no such folder", where=str(folder.parent), remedy="make it first")
    if folder.exists() and not folder.is_dir():
        raise InputError("is a file, not a folder", where=str(folder), remedy="name another folder")


def check_output(path: Path, suffixes: tuple[str, ...]) -> None:
    """See, before the work, that a file may be written: its folder is there, and its name states a known format.

    Raises
    ------
    InputError
        If not.
    """
    if path.suffix not in suffixes:
        raise InputError("of what format?", where=str(path), remedy=f"end the name in {' or '.join(suffixes)}")
    if not path.parent.is_dir():
        raise InputError("there is no such folder", where=str(path.parent), remedy="make it first")


def write_bytes(path: Path, content: bytes, *, durable: bool = False) -> Path:
    """Write a file whole or not at all.

    Parameters
    ----------
    path : Path
    content : bytes
    durable : bool
        Also if power fails: the content is on the disk before the name is.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    temporary = None
    try:
        # In the same folder, for only within one file system is a rename a single step.
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            if durable:
                file.flush()
                os.fsync(file.fileno())
        # mkstemp's files are for the user alone; a report is as public as any other file.
        Path(temporary).chmod(0o666 & ~_umask())
        os.replace(temporary, path)
    except OSError as error:
        raise unwritable(path, error) from error
    finally:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)
    return path


def write_text(path: Path, text: str) -> Path:
    """Write a text in UTF-8, whole or not at all. See :func:`write_bytes`."""
    return write_bytes(path, text.encode("utf-8"))


def unwritable(path: Path, error: OSError) -> InputError:
    """What to say of a file or folder that could not be written."""
    remedy = (
        "make room there, or name another place" if error.errno in FULL else "name a place that you may write to"
    )
    return InputError(f"cannot be written: {error.strerror or error}", where=str(path), remedy=remedy)


def _umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
