"""A folder's files written aside first, and put in their place all together or not at all."""

from __future__ import annotations

import contextlib
import glob
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from permway.errors import InputError
from permway.files import LEFT_BEHIND_S, check_folder, unwritable

REPLACED = "replaced"
"""Folder of a stage that keeps what stood where its files go."""


class Stage:
    """Where files wait for their place.

    Parameters
    ----------
    aside : Path
        A folder of its own, on the file system of `output`.
    output : Path
        Where they belong.

    Attributes
    ----------
    folder : Path
        To be filled as `output` is to be.
    """

    def __init__(self, aside: Path, output: Path) -> None:
        self.folder, self._replaced, self._output = aside / "new", aside / REPLACED, output
        self._moved: list[tuple[Path, Path]] = []
        self._made: list[Path] = []
        try:
            for path in (self.folder, self._replaced):
                path.mkdir()
        except OSError as error:
            raise unwritable(output, error) from error

    def place(self, *, last: str = "") -> None:
        """Put all files in their place; others that are there stay.

        A folder that is not there yet appears in one step. In one that is, each file is replaced in one step, and
        after an error all are put back.

        Parameters
        ----------
        last : str
            Name of the file that is put after all others.

        Raises
        ------
        InputError
            If a file cannot be moved, or its name is taken by a folder.
        """
        if not self._output.exists():
            self._move(self.folder, self._output)
            return
        for path in sorted(self.folder.rglob("*"), key=lambda path: (path.name == last, path)):
            target = self._output / path.relative_to(self.folder)
            if path.is_dir():
                self._make(target)
                continue
            if target.is_dir():
                raise InputError("is a folder, not a file", where=str(target), remedy="name another folder")
            self._keep(target)
            self._move(path, target)

    def undo(self) -> None:
        """Put everything back as it was."""
        for source, target in reversed(self._moved):
            with contextlib.suppress(FileNotFoundError):
                os.replace(target, source)
        for folder in reversed(self._made):
            with contextlib.suppress(FileNotFoundError):
                folder.rmdir()

    def _move(self, source: Path, target: Path) -> None:
        # Noted before it is done: what was not done is not there to be put back.
        self._moved.append((source, target))
        try:
            os.replace(source, target)
        except OSError as error:
            self._moved.pop()
            raise unwritable(target, error) from error

    def _keep(self, target: Path) -> None:
        """Keep what stands at a place: under a second name, so that the place is never empty."""
        if not os.path.lexists(target):
            return
        kept = self._replaced / str(len(self._moved))
        self._moved.append((target, kept))
        try:
            os.link(target, kept, follow_symlinks=False)
        except (OSError, NotImplementedError):
            # A file system without second names.
            self._moved.pop()
            self._move(target, kept)

    def _make(self, folder: Path) -> None:
        if folder.is_dir():
            return
        self._made.append(folder)
        try:
            folder.mkdir()
        except OSError as error:
            self._made.pop()
            raise unwritable(folder, error) from error


@contextmanager
def staged(output: Path) -> Iterator[Stage]:
    """A stage for a folder; at the end it is gone, and after an error all is as it was.

    Parameters
    ----------
    output : Path
        Made by :meth:`Stage.place` if it is not there.

    Raises
    ------
    InputError
        If the folder cannot be made or written.
    """
    check_folder(output)
    home = output if output.is_dir() else output.parent
    _tidy(home, output.name)
    try:
        aside = Path(tempfile.mkdtemp(dir=home, prefix=f".{output.name}.", suffix=".part"))
    except OSError as error:
        raise unwritable(output, error) from error
    try:
        stage = Stage(aside, output)
        try:
            yield stage
        except BaseException:
            stage.undo()
            raise
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def _tidy(home: Path, name: str) -> None:
    """Take away stages that killed processes left, if nothing was waiting in them to be put back."""
    for aside in home.glob(f".{glob.escape(name)}.*.part"):
        with contextlib.suppress(OSError):
            old = time.time() - aside.stat().st_mtime > LEFT_BEHIND_S
            if old and aside.is_dir() and not any((aside / REPLACED).iterdir()):
                shutil.rmtree(aside)
