"""The folder of a sweep: a manifest and one file per case, each whole or not there."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from permway import _core
from permway.errors import InputError
from permway.files import prepare_folder, write_bytes, write_text
from permway.study.axes import Axis
from permway.study.file import Study
from permway.study.plan import Dimension, Plan

MANIFEST = "study.json"
LOCK = ".lock"


class Store:
    """A sweep's folder, held by one process at a time.

    Parameters
    ----------
    folder : Path
        Made if its parent exists.
    study : Study
    fresh : bool
        Discard the results of another study, or of this one, that lie there.

    Raises
    ------
    InputError
        If the folder cannot be written, is in use, or holds the results of another study.
    """

    def __init__(self, folder: Path, study: Study, *, fresh: bool = False) -> None:
        self.folder, self.study = prepare_folder(folder, [MANIFEST]), study
        self.failed: dict[int, str] = {}
        self._lock = self._take()
        try:
            self._open(fresh)
        except BaseException:
            self._lock.close()
            raise

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.save()
        finally:
            self._lock.close()

    def missing(self) -> list[int]:
        """Cases that have no file yet."""
        there = {entry.name for entry in os.scandir(self.folder)}
        plan = self.study.plan
        return [i for i in range(plan.cases) if plan.file_name(i) not in there]

    def put(self, index: int, content: bytes) -> None:
        """Write a case's file."""
        write_bytes(self.folder / self.study.plan.file_name(index), content)

    def fail(self, index: int, error: str) -> None:
        """Note a failed case; the manifest has it once it is saved."""
        self.failed[index] = error

    def save(self) -> None:
        """Write the manifest."""
        plan = self.study.plan
        failed = [{"case": i, "set": plan.stated(i), "error": e} for i, e in sorted(self.failed.items())]
        content = {
            "format": 1,
            "permway_version": _core.__version__,
            "study": plan.hash(),
            "title": self.study.title,
            "base": plan.base,
            "keep": self.study.keep,
            "cases": plan.cases,
            "dimensions": [
                {"name": d.name, "axes": [[a.name, a.places, a.rows, a.labels] for a in d.axes]}
                for d in plan.dimensions
            ],
            "failed": failed,
        }
        write_text(self.folder / MANIFEST, json.dumps(content, indent=1 if plan.cases < 1000 else None))

    def _take(self) -> IO[bytes]:
        file = (self.folder / LOCK).open("wb")
        if sys.platform != "win32":
            import fcntl

            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                file.close()
                raise InputError(
                    "another sweep is writing here",
                    where=str(self.folder),
                    remedy="wait for it, or name another folder",
                ) from error
        return file

    def _open(self, fresh: bool) -> None:
        if (self.folder / MANIFEST).exists():
            try:
                found = read_manifest(self.folder)["study"]
            except InputError:
                if not fresh:
                    raise
                found = None
            if fresh:
                for path in self.folder.glob("case-*.nc"):
                    path.unlink()
            elif found != self.study.plan.hash():
                raise InputError(
                    "holds the results of another study, or of another version of permway",
                    where=str(self.folder),
                    remedy="name another folder with -o, or discard them with --fresh",
                )
        # Left by a process that was killed.
        for pattern in (".case-*.part", f".{MANIFEST}.*.part"):
            for path in self.folder.glob(pattern):
                path.unlink(missing_ok=True)
        self.save()


def read_manifest(folder: Path) -> dict[str, Any]:
    """Read a sweep's manifest.

    Raises
    ------
    InputError
        If the folder has none, or it is not one.
    """
    path = folder / MANIFEST
    try:
        content = json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(
            f"cannot be read: {error.strerror}", where=str(path), remedy="name a folder that permway sweep wrote"
        ) from error
    except ValueError as error:
        raise InputError(f"is not JSON: {error}", where=str(path)) from error
    if not isinstance(content, dict) or content.get("format") != 1 or not isinstance(content.get("study"), str):
        raise InputError("is no manifest of a sweep", where=str(path))
    return content


def plan_of(manifest: dict[str, Any], where: str) -> Plan:
    """The plan that a manifest describes.

    Raises
    ------
    InputError
        If it was changed by hand.
    """
    try:
        plan = Plan(tuple(_dimension(d) for d in manifest["dimensions"]), manifest["base"])
        if plan.hash() == manifest["study"]:
            return plan
    except (KeyError, TypeError, ValueError, IndexError):
        pass
    raise InputError("was changed: its hash does not fit", where=where, remedy="run the study again")


def _dimension(table: dict[str, Any]) -> Dimension:
    axes = []
    for name, places, rows, labels in table["axes"]:
        of_rows = tuple(tuple(row) for row in rows)
        axes.append(Axis(name, tuple(tuple(p) for p in places), of_rows, tuple(labels) if labels else None))
    return Dimension(table["name"], tuple(axes))
