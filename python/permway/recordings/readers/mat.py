"""MAT files of version 5 (to -v7) as named arrays, by scipy."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import io

from permway.errors import InputError
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.store import Store, Variable

_NUMBERS = {"double", "single", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"}
_OPAQUE = {"object", "function", "opaque", "unknown"}


@contextmanager
def open_store(source: Path, *, max_bytes: int = MOST_BYTES) -> Iterator[Store]:
    """The numbers and texts of a MAT file; a variable is read as a whole, when it is asked for."""
    directory = io.whosmat(str(source))
    if not directory:
        raise InputError("holds no variable", where=str(source), remedy="save it again")
    variables: dict[str, Variable] = {}
    for name, shape, kind in directory:
        where = f"{source}: '{name}'"
        if kind in _OPAQUE:
            raise InputError(
                "an object, which is not read", where=where, value=kind, remedy="save plain arrays and texts"
            )
        if name in variables:
            raise InputError("a variable named twice", where=str(source), value=name)
        check_size(int(np.prod([float(n) for n in shape])), where, max_bytes=max_bytes)
        if kind in ("struct", "sparse", "logical"):
            continue
        variables[name] = _variable(source, name, kind, where)
    yield Store(str(source), variables)


def _variable(source: Path, name: str, kind: str, where: str) -> Variable:
    loaded = io.loadmat(str(source), variable_names=[name], chars_as_strings=True, struct_as_record=True)
    if name not in loaded:
        raise InputError("announced but not there", where=where, remedy="save the file again")
    array = np.asarray(loaded[name])
    if kind == "cell":
        array = _texts(array, where)
    form = "text" if array.dtype.kind == "U" else "complex" if array.dtype.kind == "c" else "real"
    if array.dtype.kind not in "fiucU":
        raise InputError(
            "neither numbers nor texts", where=where, value=str(array.dtype), remedy="save plain arrays"
        )

    def read(slices: tuple[slice, ...]) -> NDArray[np.generic]:
        return np.asarray(array[slices])

    step = float(np.finfo(array.dtype).eps) if array.dtype.kind == "f" else 2.0**-52
    return Variable(name, array.shape, form, read, step=step)


def _texts(cells: NDArray[np.generic], where: str) -> NDArray[np.str_]:
    """A cell array of texts."""
    texts = []
    for index, cell in enumerate(np.ravel(cells)):
        part = np.asarray(cell)
        if part.dtype.kind != "U" or part.size > 1:
            what = "a cell array may hold texts only"
            raise InputError(
                what, where=f"{where}{{{index + 1}}}", value=str(part.dtype), remedy="save plain arrays"
            )
        texts.append(str(part.ravel()[0]) if part.size else "")
    return np.array(texts, dtype=str)
