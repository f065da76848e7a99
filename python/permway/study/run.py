"""Running a study: checked first, then computed, resumable at any time."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from itertools import islice, product
from pathlib import Path

import numpy as np

from permway.errors import InputError, SolveError, must_be
from permway.interrupt import interruptible
from permway.problem.model import Frequencies
from permway.problem.solve import solve
from permway.response.limits import check_threads
from permway.response.receptance import Progress
from permway.study.answer import select
from permway.study.file import Study
from permway.study.local import solve_locally
from permway.study.store import Store

CHECKED_WHOLE = 2000
"""Studies of up to so many cases are checked case by case, larger ones at the ends and along the axes."""

MOST_ALONG_AXIS = 1000
MOST_CORNERS = 256
SAVED_EVERY_S = 10.0


@dataclass(frozen=True)
class Summary:
    """What came of a sweep.

    Attributes
    ----------
    folder : Path
    cases, computed, already_there : int
    failed : dict of int to str
        Errors by case.
    """

    folder: Path
    cases: int
    computed: int
    already_there: int
    failed: dict[int, str]


def run_study(
    study: Study,
    folder: str | Path,
    *,
    scheduler: str | None = None,
    threads: int | None = None,
    fresh: bool = False,
    progress: Progress | None = None,
) -> Summary:
    """Compute all cases of a study that have no file yet.

    Parameters
    ----------
    study : Study
    folder : path
        Where the files go; made if its parent exists.
    scheduler : str, optional
        Address of a Dask scheduler; without it this machine computes.
    threads : int, optional
        Processors to use on this machine; by default all. Beyond a second's work they are processes: a script
        needs the usual guard, `if __name__ == "__main__":`.
    fresh : bool
        Discard what lies there.
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    Summary

    Raises
    ------
    InputError
        Before anything is computed, for a case that is no model, a variable that no answer has, or a folder that
        cannot be used.
    """
    must_be(study, Study, "study", remedy="of a file it is permway.study.read_study(path)")
    check_threads(threads)
    for index in cases_to_check(study):
        study.model(index)
    _probe(study)
    with interruptible(), Store(Path(folder), study, fresh=fresh) as store:
        missing = store.missing()
        total = study.plan.cases
        done = total - len(missing)
        if progress is not None:
            progress(done, total)
        if scheduler is None:
            answers = solve_locally(study, missing, threads)
        else:
            from permway.study.cluster import solve_on_cluster

            answers = solve_on_cluster(study, missing, scheduler)
        reported: set[str] = set()
        saved = time.monotonic()
        with closing(answers):  # type: ignore[type-var]
            for index, got in answers:
                if got.error:
                    store.fail(index, got.error)
                else:
                    store.put(index, got.content)
                for note in set(got.notes) - reported:
                    reported.add(note)
                    warnings.warn(note, stacklevel=2)
                if store.failed and time.monotonic() - saved > SAVED_EVERY_S:
                    store.save()
                    saved = time.monotonic()
                done += 1
                if progress is not None:
                    progress(done, total)
        return Summary(store.folder, total, len(missing) - len(store.failed), total - len(missing), store.failed)


def cases_to_check(study: Study) -> Iterator[int]:
    """Cases whose models are built before the sweep.

    All of them if there are few. Else values of every axis, the others at their first, and corners.
    """
    shape = study.plan.shape
    if study.plan.cases <= CHECKED_WHOLE:
        yield from range(study.plan.cases)
        return
    for dimension, size in enumerate(shape):
        for i in np.unique(np.linspace(0, size - 1, min(size, MOST_ALONG_AXIS)).astype(int)):
            at = [0] * len(shape)
            at[dimension] = int(i)
            yield int(np.ravel_multi_index(at, shape))
    for corner in islice(product(*((0, size - 1) for size in shape)), MOST_CORNERS):
        yield int(np.ravel_multi_index(corner, shape))


def _probe(study: Study) -> None:
    """Solve one case at one frequency: names in `keep` and of axes are compared with what an answer has."""
    model = study.model(0)
    at = Frequencies(values_Hz=(float(model.frequencies.array()[0]),))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            data = solve(model.model_copy(update={"frequencies": at}), threads=1)
    except SolveError:
        return
    select(data, study.keep)
    taken = {*data.dims, *data.variables}
    for dimension in study.plan.dimensions:
        for axis in dimension.axes:
            if axis.name in taken:
                raise InputError(
                    "the answer has a dimension or variable of this name",
                    where=f"axes.{axis.name}",
                    remedy="name the axis otherwise",
                )
