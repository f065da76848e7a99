"""Work on files of a folder, done on a Dask cluster: the files go out, and come back, as bytes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any

from permway import _core
from permway.errors import InputError
from permway.files import write_bytes
from permway.study.cluster import Outcome, on_cluster

Files = Mapping[str, bytes]
"""Content by path in the folder, with slashes."""

Work = Callable[[Path], Any]
"""Called with a folder; what it leaves there is its work, what it returns comes back too."""

Job = tuple[str, Iterable[Path], Work]
"""Name, those files of the folder that the work needs, and the work."""


def worked_in_folder(work: Work, files: Files, version: str) -> tuple[Any, Files]:
    """Do work in a folder of its own, on whatever machine: what it returns, and the files that are new or changed.

    Raises
    ------
    InputError
        If this machine has another version of permway than the one that asks.
    """
    if version != _core.__version__:
        raise InputError(
            f"the worker has permway {_core.__version__}, the client {version}",
            where="scheduler",
            remedy="install the same",
        )
    with TemporaryDirectory(prefix="permway-") as place:
        folder = Path(place)
        for name, content in files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        returned = work(folder)
        left = {path.relative_to(folder).as_posix(): path.read_bytes() for path in _files(folder)}
    return returned, {name: content for name, content in left.items() if files.get(name) != content}


def on_cluster_in_folder(
    address: str, folder: Path, jobs: Iterable[Job], last: Sequence[str]
) -> Iterator[tuple[str, Outcome]]:
    """Have work on files of a folder done on a cluster; what it makes of them is written here.

    Of a job that has come back, the files whose presence says that it is done are written after all others. What
    is stopped at any time leaves jobs that are done and others that are not, for which it may be called again.

    Parameters
    ----------
    address : str
        See :func:`permway.study.cluster.on_cluster`.
    folder : Path
    jobs : iterable of (name, files, work)
        Distinct names; no two write the same file.
    last : sequence of str
        Patterns of the paths that say that a job is done.

    Yields
    ------
    name, Outcome
        With what the work returned, in any order.

    Raises
    ------
    InputError, SolveError
        As `on_cluster`, and if a file cannot be written.
    """

    def given() -> Iterator[tuple[str, Sequence[Any]]]:
        for name, files, work in jobs:
            content = {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}
            yield name, (work, content, _core.__version__)

    for name, outcome in on_cluster(worked_in_folder, given(), address):
        if outcome.error:
            yield name, outcome
            continue
        returned, files = outcome.value
        write_files(folder, files, last)
        yield name, Outcome(returned)


def write_files(folder: Path, files: Files, last: Sequence[str]) -> None:
    """Write files into a folder, those that match a pattern of `last` after all others.

    Raises
    ------
    InputError
        If one cannot be written.
    """
    for path in sorted(files, key=partial(_rank, last)):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        write_bytes(folder / path, files[path])


def _rank(last: Sequence[str], path: str) -> int:
    return any(PurePosixPath(path).match(pattern) for pattern in last)


def _files(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())
