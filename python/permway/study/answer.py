"""The answer of one case: a file's bytes, or why there are none. Runs wherever cases are computed."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import xarray as xr

from permway import _core
from permway.errors import InputError, PermwayError
from permway.formats.model_file import model_from_dict
from permway.problem.model import Model
from permway.problem.solve import solve
from permway.response.receptance import Progress
from permway.study.netcdf import to_netcdf


@dataclass(frozen=True)
class CaseResult:
    """What came of a case.

    Attributes
    ----------
    content : bytes
        The case's NetCDF file; empty for a failed case.
    error : str
        Why it failed; "" if it did not.
    notes : tuple of str
        Warnings met on the way.
    """

    content: bytes = b""
    error: str = ""
    notes: tuple[str, ...] = ()


def answer(
    model: Callable[[], Model],
    keep: Sequence[str] | None,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> CaseResult:
    """Compute a case; what goes wrong with it is data.

    Parameters
    ----------
    model : callable
        Makes the case's model.
    keep : sequence of str, optional
        Variables to keep.
    threads, progress
        As in :func:`permway.problem.solve.solve`.
    """
    try:
        data = select(solve(model(), threads=threads, progress=progress), keep)
        return CaseResult(content=to_netcdf(data))
    except PermwayError as error:
        return CaseResult(error=str(error))
    except Exception as error:  # noqa: BLE001 - one case's fault must not end the sweep
        return CaseResult(error=f"{type(error).__name__}: {error}")


def answer_with_notes(
    model: Callable[[], Model],
    keep: Sequence[str] | None,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> CaseResult:
    """As :func:`answer`, with the warnings. Not for several threads at once: they share the filters."""
    with warnings.catch_warnings(record=True) as met:
        warnings.simplefilter("always")
        got = answer(model, keep, threads=threads, progress=progress)
    return CaseResult(got.content, got.error, tuple(dict.fromkeys(str(note.message) for note in met)))


def answer_text(text: str, keep: Sequence[str] | None, version: str) -> CaseResult:
    """As :func:`answer`, of a model written as JSON: all that a machine elsewhere needs."""
    if version != _core.__version__:
        return CaseResult(
            error=f"the worker has permway {_core.__version__}, the client {version}: install the same"
        )
    return answer(lambda: model_from_dict(json.loads(text)), keep, threads=1)


def select(data: xr.Dataset, keep: Sequence[str] | None) -> xr.Dataset:
    """The variables to keep, with their coordinates.

    Raises
    ------
    InputError
        For a variable that the answer does not have.
    """
    if keep is None:
        return data
    for i, name in enumerate(keep):
        if name not in data.data_vars:
            raise InputError(
                "the answer has no such variable",
                where=f"keep[{i}]",
                value=name,
                remedy=f"it has {', '.join(sorted(map(str, data.data_vars)))}",
            )
    return data[list(keep)]
