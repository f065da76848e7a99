"""NetCDF of the classic format as named arrays, by scipy."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import io

from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.packed import DEFAULT_FILL, unpacked
from permway.recordings.readers.stored import Store, Variable, decoded, unread


@contextmanager
def open_store(source: Path, *, max_bytes: int = MOST_BYTES) -> Iterator[Store]:
    """The arrays of a classic NetCDF file, which is read as a whole; characters along a last axis are texts."""
    check_size(source.stat().st_size, str(source), max_bytes=max_bytes, item=1)
    # Not mapped: a map that outlives the file is scipy's warning, and arrays are copied here anyway.
    with io.netcdf_file(str(source), "r", mmap=False) as file:
        variables = {name: _variable(name, file.variables[name], source) for name in file.variables}
        yield Store(str(source), variables, _attributes(file))


def _variable(name: str, found: Any, source: Path) -> Variable:
    array = np.asarray(found.data)
    if array.dtype.kind == "S":
        texts = np.array([decoded(b"".join(row)) for row in array.reshape(-1, array.shape[-1])])
        return Variable(name, texts.shape, "text", lambda slices: np.asarray(texts[slices]))
    if array.dtype.kind not in "fiu":
        return unread(name, f"neither numbers nor texts: {array.dtype}")
    plain = array.astype(array.dtype.newbyteorder("="))

    def read(slices: tuple[slice, ...]) -> NDArray[np.generic]:
        return np.asarray(plain[slices])

    step = float(np.finfo(plain.dtype).eps) if plain.dtype.kind == "f" else 2.0**-52
    raw = Variable(name, plain.shape, "real", read, _attributes(found), tuple(found.dimensions), step)
    raw = replace(raw, resolution=1.0 if plain.dtype.kind in "iu" else 0.0)
    fill = DEFAULT_FILL.get("f" if plain.dtype.kind == "f" else plain.dtype.str[1:])
    return unpacked(raw, f"{source}: '{name}'", fill=fill)


def _attributes(item: Any) -> dict[str, object]:
    table = dict(item._attributes)
    return {key: decoded(value) if isinstance(value, bytes) else value for key, value in table.items()}
