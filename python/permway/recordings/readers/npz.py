"""NPZ archives as named arrays. Nothing is ever unpickled."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from permway.errors import InputError
from permway.recordings.readers.headers import time_scale
from permway.recordings.readers.stored import Store, Variable, decoded, unread

_MOST_MEMBERS = 10_000
_TICKS = {"D": "d", "h": "h", "m": "min", "s": "s", "ms": "ms", "us": "us", "ns": "ns"}
_KINDS = {"f": "real", "i": "real", "u": "real", "c": "complex", "U": "text", "S": "text"}


@contextmanager
def open_store(source: Path) -> Iterator[Store]:
    """The arrays of an archive, each read when asked for, in part where it can be."""
    with zipfile.ZipFile(source) as archive:
        members = [info for info in archive.infolist() if not info.is_dir()]
        if not members or len(members) > _MOST_MEMBERS:
            raise InputError(
                "holds no array", where=str(source), value=len(members), remedy="write it by numpy.savez"
            )
        variables: dict[str, Variable] = {}
        for info in members:
            name = info.filename.removesuffix(".npy")
            where = f"{source}: '{name}'"
            if name == info.filename:
                raise InputError("is no NumPy array", where=where, remedy="write the archive by numpy.savez")
            if name in variables:
                raise InputError("an array named twice", where=str(source), value=name, remedy="names must differ")
            variables[name] = _variable(archive, info, name, where)
        yield Store(str(source), variables)


def _variable(archive: zipfile.ZipFile, info: zipfile.ZipInfo, name: str, where: str) -> Variable:
    with archive.open(info) as file:
        head = io.BytesIO(file.read(16_384))
    version = np.lib.format.read_magic(head)
    reader = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, fortran, dtype = reader(head)
    start = head.tell()
    if dtype.hasobject:
        return unread(name, "Python objects, which could run code when read: save np.array(names, dtype=str)")
    tick, number = np.datetime_data(dtype) if dtype.kind in "mM" else ("", 1)
    if tick not in _TICKS or not time_scale(name, "s", where)[0]:
        # Dates are times of samples, if they are named so, and never samples.
        tick = ""
    kind = "real" if tick else _KINDS.get(dtype.kind)
    if kind is None:
        return unread(name, f"neither numbers nor texts: {dtype}")
    size = 1
    for length in shape:
        size *= int(length)
    if size * dtype.itemsize != info.file_size - start:
        raise InputError(
            f"{size} values of {dtype.itemsize} bytes announced, {info.file_size - start} bytes there",
            where=where,
            value=shape,
            remedy="the file is cut short or damaged; write it again",
        )

    def read(slices: tuple[slice, ...]) -> NDArray[np.generic]:
        array = _read(archive, info, start, dtype, tuple(shape), fortran, slices)
        if tick:
            # From the first on: since 1970 nanoseconds have more digits than a number of double precision.
            zero = _read(archive, info, start, dtype, tuple(shape), fortran, (slice(0, 1),) * len(shape))
            return np.asarray((array.astype("i8") - zero.astype("i8").ravel()[0]) * float(number))
        if dtype.kind == "S":
            texts: list[bytes] = array.ravel().tolist()
            return np.array([decoded(x) for x in texts], dtype=np.str_).reshape(array.shape)
        return array

    step = float(np.finfo(dtype).eps) if dtype.kind == "f" else 2.0**-52
    # NumPy turns no axes: the order that is documented for frequency responses holds.
    whole = tuple(int(n) for n in shape)
    return Variable(
        name,
        whole,
        kind,
        read,
        step=step,
        item_bytes=dtype.itemsize,
        ordered=True,
        attributes={"units": _TICKS[tick]} if tick else {},
        resolution=1.0 if dtype.kind in "iumM" else 0.0,
    )


def _read(
    archive: zipfile.ZipFile,
    info: zipfile.ZipInfo,
    start: int,
    dtype: np.dtype[np.generic],
    shape: tuple[int, ...],
    fortran: bool,
    slices: tuple[slice, ...],
) -> NDArray[np.generic]:
    """The slice of the slowest axis from the archive, the rest of the slices in memory."""
    slow = len(shape) - 1 if fortran else 0
    if not shape:
        with archive.open(info) as file:
            file.seek(start)
            return np.frombuffer(file.read(dtype.itemsize), dtype=dtype).reshape(())
    first, stop, _ = slices[slow].indices(shape[slow])
    row = dtype.itemsize
    for axis, length in enumerate(shape):
        row *= 1 if axis == slow else length
    with archive.open(info) as file:
        file.seek(start + first * row)
        raw = file.read((stop - first) * row)
    part = tuple(stop - first if axis == slow else length for axis, length in enumerate(shape))
    array = np.frombuffer(raw, dtype=dtype).reshape(part, order="F" if fortran else "C")
    return array[tuple(slice(None) if axis == slow else s for axis, s in enumerate(slices))]
