"""Cases on a Dask cluster: models go out as text, files come back as bytes. No disk is shared."""

from __future__ import annotations

import uuid
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

from permway import _core
from permway.errors import InputError, PermwayError, SolveError
from permway.study.answer import CaseResult, answer_text
from permway.study.file import Study

CONNECT_S = 10.0
"""How long to wait for the scheduler, and then for a first worker."""

FEWEST_UNDER_WAY, MOST_UNDER_WAY = 8, 2000
"""Bounds on the cases that are out at a time; between them three for each thread of the cluster."""


def solve_on_cluster(study: Study, cases: Sequence[int], address: str) -> Iterator[tuple[int, CaseResult]]:
    """Compute cases on a cluster, in any order.

    A case whose worker is lost is computed again by another; one that takes several workers with it has failed.

    Parameters
    ----------
    study : Study
    cases : sequence of int
        Their indices.
    address : str
        The scheduler's, as in "tcp://10.0.0.1:8786".

    Yields
    ------
    int, CaseResult

    Raises
    ------
    InputError
        Without `distributed`, or if there is no scheduler at the address, or no worker.
    SolveError
        If the scheduler is lost on the way.
    """
    try:
        import distributed as library
    except ImportError as error:
        raise InputError(
            "needs the package distributed", where="scheduler", remedy="pip install 'permway[dask]'"
        ) from error
    distributed: Any = library
    try:
        client = distributed.Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"no scheduler answers: {str(error) or type(error).__name__}", where="scheduler", value=address
        ) from error
    try:
        try:
            client.wait_for_workers(1, timeout=CONNECT_S)
        except TimeoutError as error:
            raise InputError("the scheduler has no worker", where="scheduler", value=address) from error
        yield from _answers(distributed, client, study, cases)
    finally:
        with suppress(OSError, TimeoutError):
            client.close(timeout=0.5)


def _answers(
    distributed: Any, client: Any, study: Study, cases: Sequence[int]
) -> Iterator[tuple[int, CaseResult]]:
    run = uuid.uuid4().hex
    bound = min(max(FEWEST_UNDER_WAY, 3 * sum(client.nthreads().values())), MOST_UNDER_WAY)
    waiting = iter(cases)
    under_way: dict[Any, int] = {}
    ended = distributed.as_completed(loop=client.loop, with_results=True, raise_errors=False)

    def submit(count: int) -> Iterator[tuple[int, CaseResult]]:
        for _ in range(count):
            index = next(waiting, None)
            if index is None:
                return
            try:
                text = study.model(index).model_dump_json(by_alias=True, exclude_none=True)
            except PermwayError as error:
                yield index, CaseResult(error=str(error))
                continue
            key = f"permway-case-{index}-{run}"
            future = client.submit(answer_text, text, study.keep, _core.__version__, key=key, pure=False)
            under_way[key] = index
            ended.add(future)

    yield from submit(bound)
    while under_way:
        future, result = next(ended)
        index = under_way.pop(future.key)
        status = future.status
        future.release()
        yield from submit(1)
        if status == "finished":
            yield index, result
        elif status == "error":
            yield index, CaseResult(error=_stated(result))
        else:
            raise SolveError("the scheduler was lost; run the study again to go on")


def _stated(result: Any) -> str:
    error = result[1] if isinstance(result, tuple) and len(result) > 1 else result
    return f"{type(error).__name__}: {error}"
