"""What a diagnosis has found so far, so that one that was stopped goes on where it was.

A search is the same steps in the same order for the same campaign, code and libraries. Each long step writes what
it found into a file of its own, and a later run reads it instead of taking the step again, if all that the step
depends on is the same to the last bit.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import platform
import zipfile
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import fields, is_dataclass, replace
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, Protocol, TypeVar, cast

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.errors import InputError
from permway.files import write_bytes
from permway.posterior.hyper import Hyper

FOLDER = "unfinished"
"""Of the steps, beside what will be written."""

DIGEST = "digest"
"""Name of the array that says what a step was given."""

LIBRARIES = ("numpy", "scipy")
"""Whose arithmetic a step's numbers are."""

Arrays = Mapping[str, np.ndarray]


class _Trial(Protocol):
    """What is kept of a :class:`permway.posterior.beam.Trial`."""

    z: Reals
    hyper: Hyper
    bend: Reals | None
    objective: float
    log_evidence: float


Item = TypeVar("Item")
Table = TypeVar("Table")


def key_of(campaign: Campaign, ruled_out: Collection[str] = ()) -> str:
    """Of all that a diagnosis depends on: code, libraries, campaign, model, every record, what is ruled out."""
    sha = hashlib.sha256(repr((_made_by(), sorted(set(ruled_out)))).encode())
    sha.update(campaign.stated.model_dump_json().encode())
    sha.update(campaign.model.model_dump_json().encode())
    for record in campaign.stated.records:
        for name in (record.file, record.loss_file):
            # What cannot be read is reported by its reader.
            with contextlib.suppress(OSError):
                if name is not None:
                    with (campaign.folder / name).open("rb") as file:
                        sha.update(hashlib.file_digest(file, "sha256").digest())
    return sha.hexdigest()


@cache
def _made_by() -> tuple[str, ...]:
    """The package's own files by their content, for a version may have many; libraries and machine by names."""
    sha = hashlib.sha256()
    root = Path(__file__).parents[1]
    for path in sorted(p for p in root.rglob("*") if p.suffix in (".py", ".so", ".pyd")):
        sha.update(str(path.relative_to(root)).encode())
        sha.update(path.read_bytes())
    libraries = (f"{name} {version(name)}" for name in LIBRARIES)
    return sha.hexdigest(), platform.python_version(), platform.machine(), *libraries


class Journal:
    """Steps in a folder, in their order.

    Parameters
    ----------
    folder : Path
        Made if its parent exists; taken away when all is done.
    key : str
        Of all that the steps depend on, see :func:`key_of`.

    Attributes
    ----------
    recalled : int
        Steps that were not taken again.
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
        sha = hashlib.sha256(self._digest.encode())
        for one in given:
            sha.update(np.ascontiguousarray(one).tobytes() if isinstance(one, np.ndarray) else repr(one).encode())
        self._digest = sha.hexdigest()
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
            write_bytes(self._path, content.getvalue(), durable=True)

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


def kept_trials(take: Callable[[], list[Item | None]], trials: Sequence[Item]) -> list[Item | None]:
    """Trials that a step refines, from the journal if it holds this step; None for what cannot be solved.

    Parameters
    ----------
    take : callable
        Takes the step.
    trials : sequence of Trial
        As they are before it.
    """
    journal = _CURRENT.get()
    if journal is None:
        return take()
    given = [value for one in trials for value in _arrays(cast(_Trial, one)).values()]
    known = journal.recall("trials", len(trials), *given)
    if known is None:
        found = take()
        there = enumerate(found)
        journal.keep({f"{i}.{n}": v for i, t in there if t for n, v in _arrays(cast(_Trial, t)).items()})
        return found
    return [_refined(one, known, f"{i}.") if f"{i}.z" in known else None for i, one in enumerate(trials)]


def kept_table(take: Callable[[], Table], of: type[Table], *given: object) -> Table:
    """A dataclass of arrays that a step finds, from the journal if it holds this step.

    Parameters
    ----------
    take : callable
        Takes the step.
    of : type
        The dataclass.
    given : objects
        What the step depends on beside the steps before it; see :meth:`Journal.recall`.
    """
    journal = _CURRENT.get()
    if journal is None:
        return take()
    known = journal.recall(of.__name__, *given)
    if known is not None:
        return of(**known)
    found = take()
    assert is_dataclass(found)
    journal.keep({f.name: getattr(found, f.name) for f in fields(found)})
    return found


def _arrays(one: _Trial) -> dict[str, np.ndarray]:
    found = {"z": one.z, "log": one.hyper.log, "fit": np.array([one.objective, one.log_evidence])}
    return found if one.bend is None else {**found, "bend": one.bend}


def _refined(one: Item, known: Arrays, prefix: str) -> Item:
    """A trial with what was found of it; its hypothesis and the names of hyperparameters stay."""
    objective, log_evidence = known[prefix + "fit"].tolist()
    before = cast(Any, one)
    found: Item = replace(
        before,
        z=known[prefix + "z"],
        hyper=Hyper(before.hyper.names, known[prefix + "log"]),
        bend=known.get(prefix + "bend"),
        objective=objective,
        log_evidence=log_evidence,
    )
    return found
