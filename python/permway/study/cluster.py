"""Work on a Dask cluster: a function and its arguments go out, what it returns comes back. No disk is shared."""

from __future__ import annotations

import asyncio
import itertools
import time
import uuid
from collections import deque
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar

from permway import _core
from permway.errors import InputError, PermwayError, SolveError
from permway.study.answer import CaseResult, answer_text
from permway.study.file import Study

CONNECT_S = 10.0
"""How long to wait for the scheduler, and then for a first worker."""

AGAIN_S = 120.0
"""How long to look for a scheduler that was lost, and then for a worker: both may be started anew by hand."""

MOST_LOSSES = 3
"""Schedulers that may be lost one after the other with nothing done in between."""

FEWEST_UNDER_WAY, MOST_UNDER_WAY = 8, 2000
"""Bounds on the items that are out at a time; between them three for each thread of the cluster."""

Name = TypeVar("Name", bound=Hashable)


@dataclass(frozen=True)
class Outcome:
    """What came of an item: what the function returned, or why it did not."""

    value: Any = None
    error: str = ""


class _LostError(Exception):
    """The scheduler no longer knows what it was given."""


def on_cluster(
    work: Callable[..., Any], items: Iterable[tuple[Name, Sequence[Any]]], address: str
) -> Iterator[tuple[Name, Outcome]]:
    """Have a function called on a cluster, once for each item, in any order; each item comes back once.

    An item whose worker is lost is given to another; one that takes several workers with it has failed. If the
    scheduler is lost, what was out is given to one that answers at the same address within :data:`AGAIN_S`. So the
    function may be called more than once for an item: it must change nothing but what it returns.

    Parameters
    ----------
    work : callable
        That workers can import, or that can be pickled.
    items : iterable of (name, arguments)
        Taken as the cluster has room; names are distinct.
    address : str
        The scheduler's, as in "tcp://10.0.0.1:8786".

    Yields
    ------
    name, Outcome

    Raises
    ------
    InputError
        Without `distributed`, or if there is no scheduler at the address, or no worker.
    SolveError
        If the scheduler is lost on the way, and none is found again.
    """
    try:
        import distributed as library
    except ImportError as error:
        raise InputError(
            "needs the package distributed", where="scheduler", remedy="pip install 'permway[dask]'"
        ) from error
    distributed: Any = library
    waiting, under_way, losses = iter(items), dict[Name, Sequence[Any]](), 0
    client = _connected(distributed, address)
    try:
        while True:
            try:
                for answered in _answers(distributed, client, work, waiting, under_way):
                    losses = 0
                    yield answered
                return
            except _LostError:
                losses += 1
                _close(client)
                client = _again(distributed, address, losses)
    finally:
        _close(client)


def _connected(distributed: Any, address: str) -> Any:
    try:
        client = distributed.Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"no scheduler answers: {str(error) or type(error).__name__}", where="scheduler", value=address
        ) from error
    try:
        client.wait_for_workers(1, timeout=CONNECT_S)
    except TimeoutError as error:
        _close(client)
        raise InputError("the scheduler has no worker", where="scheduler", value=address) from error
    return client


def _again(distributed: Any, address: str, losses: int) -> Any:
    """A client of the scheduler that takes the place of one that was lost."""
    end = time.monotonic() + AGAIN_S
    while losses <= MOST_LOSSES and time.monotonic() < end:
        try:
            return _connected(distributed, address)
        except InputError:
            time.sleep(0.5)
    raise SolveError("the scheduler was lost; run the same again to go on")


def _close(client: Any) -> None:
    with suppress(OSError, TimeoutError):
        client.close(timeout=0.5)


def _answers(
    distributed: Any,
    client: Any,
    work: Callable[..., Any],
    waiting: Iterator[tuple[Name, Sequence[Any]]],
    under_way: dict[Name, Sequence[Any]],
) -> Iterator[tuple[Name, Outcome]]:
    """What comes of all that is under way or waits; what is under way stays so until it is answered."""
    run, count = uuid.uuid4().hex, itertools.count()
    bound = min(max(FEWEST_UNDER_WAY, 3 * sum(client.nthreads().values())), MOST_UNDER_WAY)
    names: dict[str, Name] = {}
    # Without the results: where the scheduler is lost while one is fetched, `as_completed` would wait for ever.
    ended = distributed.as_completed(loop=client.loop)

    def submit(name: Name, given: Sequence[Any]) -> None:
        key = f"permway-{next(count)}-{name}-{run}"
        names[key] = name
        under_way[name] = given
        ended.add(client.submit(work, *given, key=key, pure=False))

    for name, given in list(under_way.items()):
        submit(name, given)
    while True:
        while len(under_way) < bound and (item := next(waiting, None)) is not None:
            submit(*item)
        if not under_way:
            return
        future = next(ended)
        outcome = _outcome(future)
        name = names.pop(future.key)
        del under_way[name]
        future.release()
        yield name, outcome


def _outcome(future: Any) -> Outcome:
    """What came of an item that has ended."""
    try:
        if future.status == "finished":
            return Outcome(future.result())
        if future.status == "error":
            return Outcome(error=_stated(future.exception()))
    except (OSError, asyncio.CancelledError, CancelledError) as error:
        # Of the way to the scheduler, or its memory of the item.
        raise _LostError from error
    except Exception as error:  # noqa: BLE001 - it took workers with it while it was fetched, or cannot be read
        return Outcome(error=_stated(error))
    raise _LostError


def _stated(error: BaseException) -> str:
    return str(error) if isinstance(error, PermwayError) else f"{type(error).__name__}: {error}"


def solve_on_cluster(study: Study, cases: Sequence[int], address: str) -> Iterator[tuple[int, CaseResult]]:
    """Compute cases of a study on a cluster, in any order: models go out as text, files come back as bytes.

    Parameters
    ----------
    study : Study
    cases : sequence of int
        Their indices.
    address : str
        See :func:`on_cluster`.

    Yields
    ------
    int, CaseResult

    Raises
    ------
    InputError, SolveError
        As :func:`on_cluster`.
    """
    unmade: deque[tuple[int, CaseResult]] = deque()

    def models() -> Iterator[tuple[int, Sequence[Any]]]:
        for index in cases:
            try:
                text = study.model(index).model_dump_json(by_alias=True, exclude_none=True)
            except PermwayError as error:
                unmade.append((index, CaseResult(error=str(error))))
                continue
            yield index, (text, study.keep, _core.__version__)

    for index, outcome in on_cluster(answer_text, models(), address):
        yield from _taken(unmade)
        yield index, CaseResult(error=outcome.error) if outcome.error else outcome.value
    yield from _taken(unmade)


def _taken(answers: deque[tuple[int, CaseResult]]) -> Iterator[tuple[int, CaseResult]]:
    while answers:
        yield answers.popleft()
