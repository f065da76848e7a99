"""Reading files that anyone may have written: none larger than it may be, none out of the folder it belongs to."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from permway.errors import InputError

LARGEST_TOML = 16 * 2**20
"""Bytes of a model, a campaign, a study or a law."""

LARGEST_TABLE = 32 * 2**20
"""Bytes of a table that is read as a whole; its cells take some thirty times as much in memory."""


def read_bytes(path: Path, most: int, *, where: str | None = None, remedy: str = "give an existing file") -> bytes:
    """The content of a file.

    Parameters
    ----------
    path : Path
    most : int
        Bytes that it may have.
    where : str, optional
        How errors name it; by default its path.
    remedy : str
        What to do where it cannot be read.

    Raises
    ------
    InputError
        If it cannot be read, or is larger.
    """
    where = where or str(path)
    try:
        with path.open("rb") as file:
            content = file.read(most + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(f"cannot be read: {reason}", where=where, remedy=remedy) from error
    except MemoryError as error:
        raise InputError("is larger than memory", where=where, remedy=remedy) from error
    if len(content) > most:
        raise InputError(f"is larger than {most / 2**20:g} MiB", where=where, remedy=remedy)
    return content


def read_toml(path: Path, remedy: str, *, where: str | None = None) -> dict[str, Any]:
    """The table of a TOML file.

    Raises
    ------
    InputError
        As :func:`read_bytes`; for a file that is not text in UTF-8, or not TOML.
    """
    where = where or str(path)
    content = read_bytes(path, LARGEST_TOML, where=where, remedy=remedy)
    try:
        return tomllib.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise InputError(
            "is not text in UTF-8", where=f"{where}, byte {error.start}", remedy="save it as UTF-8"
        ) from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not TOML: {error}", where=where) from error


def inside(name: object, folder: Path, *, where: str, of: str, remedy: str, outside: bool = False) -> Path:
    """The path of a file that another file names.

    Parameters
    ----------
    name : str
        As the file states it.
    folder : Path
        Of the file that names it.
    where : str
        The place in that file.
    of : str
        What the folder is, for the message.
    remedy : str
        What to do about a name that leads out of the folder.
    outside : bool
        Whether it may lead out of the folder.

    Raises
    ------
    InputError
        For what is no name; for a name that leads out of the folder: by "..", from the root, or by a link; and for
        what is there but no plain file: a pipe would be waited for, a device read for ever.
    """
    if not isinstance(name, str) or not name or "\0" in name:
        raise InputError("must be the name of a file", where=where, value=name)
    path = folder / name
    try:
        within = path.resolve().is_relative_to(folder.resolve())
        plain = not path.exists() or path.is_file() or path.is_dir()
    except (OSError, RuntimeError) as error:
        raise InputError(f"cannot be followed: {error}", where=where, value=name) from error
    if not (within or outside):
        raise InputError(f"lies outside {of} folder", where=where, value=name, remedy=remedy)
    if not plain:
        raise InputError("is no plain file", where=where, value=name, remedy="name a file on disc")
    return path
