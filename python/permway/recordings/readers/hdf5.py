"""HDF5, NetCDF-4 and MAT 7.3 as named arrays, by h5py. Nothing outside the file is followed."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from permway.errors import InputError
from permway.recordings.readers import hdf5_trial
from permway.recordings.readers.limits import MOST_CHANNELS
from permway.recordings.readers.packed import unpacked
from permway.recordings.readers.stored import MOST_TEXT_BYTES, OBJECT, Store, Variable, decoded, unread

TRIAL_S = 2.0
"""Processor time that going through a file may take, s; and a second more for every :data:`BYTES_PER_S` of it."""

BYTES_PER_S = 10_000_000

_LONGEST_WAIT = 20.0
"""How long a trial may last, as a multiple of its processor time: machines are busy."""

_MOST_OBJECTS = 100_000
_HIDDEN = ("#refs#", "#subsystem#")
_NETCDF = {
    "_Netcdf4Dimid",
    "_Netcdf4Coordinates",
    "_NCProperties",
    "CLASS",
    "NAME",
    "DIMENSION_LIST",
    "REFERENCE_LIST",
}


@contextmanager
def open_store(source: Path, *, group: str | None = None) -> Iterator[Store]:
    """The arrays of a file, or of one group in it, each read in part when asked for.

    Arrays in groups are named by their path, without a group that all are in.
    """
    with h5py.File(source, "r") as file:
        root: Any = file
        if group is not None:
            root = file.get(group)
            if not isinstance(root, h5py.Group):
                raise InputError(
                    "there is no such group", where=str(source), value=group, remedy=f"it has {list(file)[:12]}"
                )
        found = _datasets(root, source)
        common = _common_group(list(found))
        variables: dict[str, Variable] = {}
        for path, data in found.items():
            variable = _variable(data, path[len(common) :], f"{source}: '{path}'")
            if variable is not None:
                variables[variable.name] = variable
        attributes = dict(_attributes(root))
        if common:
            attributes |= _attributes(root[common.rstrip("/")])
        yield Store(str(source), variables, attributes)


def check_sound(source: Path) -> None:
    """Go through a file in a process of its own, which can be ended if the HDF5 library does not come to an end.

    Raises
    ------
    InputError
        For a file on which the library hangs or crashes, or whose texts take more memory than texts do.
    """
    seconds = TRIAL_S + source.stat().st_size / BYTES_PER_S
    command = [sys.executable, "-P", hdf5_trial.__file__, str(source), str(MOST_TEXT_BYTES), str(round(seconds))]
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=_LONGEST_WAIT * seconds,
            check=False,
        ).returncode
    except subprocess.TimeoutExpired:
        done = -signal.SIGTERM
    if done == hdf5_trial.TOO_LARGE:
        what = "its texts or attributes take more memory than texts do"
        raise InputError(what, where=str(source), remedy="the file is damaged; export it again")
    if done < 0:
        what = "damaged: the HDF5 library hangs or crashes on it"
        raise InputError(what, where=str(source), remedy="export it again")


def _datasets(root: Any, source: Path) -> dict[str, Any]:
    found: dict[str, Any] = {}
    pending = [("", root)]
    seen: set[int] = set()
    count = 0
    while pending:
        prefix, group = pending.pop(0)
        for name in group:
            if name in _HIDDEN or not isinstance(group.get(name, getlink=True), h5py.HardLink):
                continue
            count += 1
            if count > _MOST_OBJECTS:
                raise InputError("more objects than can be", where=str(source), value=count)
            item = group[name]
            if isinstance(item, h5py.Group) and "MATLAB_sparse" in item.attrs:
                continue
            if isinstance(item, h5py.Group):
                address = h5py.h5o.get_info(item.id).addr
                if address not in seen:
                    seen.add(address)
                    pending.append((f"{prefix}{name}/", item))
            elif isinstance(item, h5py.Dataset):
                found[f"{prefix}{name}"] = item
    return found


def _common_group(paths: list[str]) -> str:
    heads = {path.rpartition("/")[0] for path in paths}
    return f"{heads.pop()}/" if len(heads) == 1 and "" not in heads else ""


def _variable(data: Any, name: str, where: str) -> Variable | None:
    """A dataset as a variable, None if it is nothing to read: a scale without values, a truth value, a struct."""
    attributes = _attributes(data)
    matlab = str(attributes.get("MATLAB_class", ""))
    if data.external or data.is_virtual:
        return unread(name, "its values lie in another file: copy them into one")
    if data.shape is None or b"This is a netCDF dimension but not a netCDF variable" in _raw_name(data):
        return None
    kind = _kind(data.dtype)
    if "MATLAB_empty" in data.attrs and matlab not in ("char", "cell"):
        return None
    if matlab == "char":
        return Variable(name, (_rows(data),), "text", lambda _: _characters(data), attributes)
    if matlab in ("struct", "logical", "function_handle") or matlab.startswith("containers"):
        return None
    if matlab == "cell":
        return Variable(name, (int(data.size),), "text", lambda _: _cells(data, where), attributes)
    if "MATLAB_object_decode" in data.attrs or (matlab and kind is None):
        return unread(name, OBJECT)
    if kind is None:
        return unread(name, f"neither numbers nor texts ({data.dtype}): save plain arrays and texts")
    if data.size and kind != "text" and data.id.get_storage_size() == 0:
        return unread(name, f"announced, but never written ({data.shape}): record it again")
    # MATLAB counts its axes from the fastest one, HDF5 from the slowest.
    turned = bool(matlab) and len(data.shape) > 1

    def read(slices: tuple[slice, ...]) -> NDArray[np.generic]:
        part = data[slices[::-1] if turned else slices] if data.shape else data[()]
        plain = _plain(np.asarray(part), kind)
        return plain.transpose() if turned else plain

    step = float(np.finfo(data.dtype).eps) if data.dtype.kind == "f" else 2.0**-52
    order = -1 if turned else 1
    shape = tuple(int(n) for n in data.shape)[::order]
    variable = Variable(
        name,
        shape,
        kind,
        read,
        attributes,
        _axes(data)[::order],
        step,
        data.dtype.itemsize,
        ordered=bool(matlab),
        resolution=1.0 if data.dtype.kind in "iu" else 0.0,
    )
    return unpacked(variable, where, fill=None if kind != "real" else _fill(data))


def _fill(data: Any) -> float | None:
    """What the file writes where nothing was written, if that is no plain zero."""
    fill = data.fillvalue
    return None if fill is None or not np.isfinite(fill) or fill == 0 else float(fill)


def _kind(dtype: np.dtype[np.generic]) -> str | None:
    if dtype.names is not None:
        return "complex" if _complex_fields(dtype) is not None else None
    if dtype.kind in "fiu":
        return "real"
    if dtype.kind == "c":
        return "complex"
    texts = dtype.kind in "SU" or h5py.check_string_dtype(dtype) is not None
    return "text" if texts else None


def _complex_fields(dtype: np.dtype[np.generic]) -> tuple[str, str] | None:
    names = tuple(dtype.names or ())
    pairs = (("real", "imag"), ("r", "i"), ("re", "im"))
    return next((pair for pair in pairs if tuple(name.lower() for name in names) == pair), None) and (
        names[0],
        names[1],
    )


def _plain(array: NDArray[np.generic], kind: str) -> NDArray[np.generic]:
    if kind == "complex" and array.dtype.names is not None:
        real, imag = array.dtype.names
        fields: Any = array
        return np.asarray(fields[real] + 1j * fields[imag])
    if kind == "text":
        flat = [decoded(x) if isinstance(x, bytes) else str(x) for x in array.ravel()]
        return np.array(flat, dtype=str).reshape(array.shape)
    return array


def _rows(data: Any) -> int:
    """Rows of MATLAB's characters: its first axis, which is the last here."""
    return 1 if "MATLAB_empty" in data.attrs or data.ndim < 2 else max(int(data.shape[-1]), 1)


def _characters(data: Any) -> NDArray[np.str_]:
    """Rows of characters."""
    if "MATLAB_empty" in data.attrs:
        return np.array([""])
    if data.size > 64 * MOST_CHANNELS:
        raise InputError("more characters than names have", where=str(data.name), value=data.shape)
    codes = np.asarray(data[()]).reshape(-1, _rows(data))
    return np.array(["".join(chr(int(code)) for code in row).rstrip() for row in codes.transpose()])


def _cells(data: Any, where: str) -> NDArray[np.str_]:
    texts = []
    for index, reference in enumerate(np.ravel(data[()])):
        item = data.file[reference]
        if not isinstance(item, h5py.Dataset) or _text(item.attrs.get("MATLAB_class")) != "char":
            raise InputError(
                "a cell array may hold texts only", where=f"{where}{{{index + 1}}}", remedy="save plain arrays"
            )
        texts.append(str(_characters(item)[0]))
    return np.array(texts, dtype=str)


def _axes(data: Any) -> tuple[str, ...]:
    """Names of the axes: of attached scales, or of a NetCDF dimension that is its own variable."""
    names = []
    for axis, dim in enumerate(data.dims):
        label = dim.label
        if not label and len(dim):
            label = dim[0].name.rpartition("/")[2]
        if not label and data.is_scale and axis == 0:
            label = data.name.rpartition("/")[2]
        names.append(str(label))
    return tuple(names) if all(names) else ()


def _attributes(item: Any) -> dict[str, object]:
    found: dict[str, object] = {}
    for key in item.attrs:
        if key in _NETCDF or len(found) > 1000:
            continue
        value = item.attrs[key]
        found[key] = _text(value) if isinstance(value, bytes | np.bytes_ | str) else value
    return found


def _raw_name(data: Any) -> bytes:
    value = data.attrs.get("NAME", b"") if "NAME" in data.attrs else b""
    return value if isinstance(value, bytes) else bytes(str(value), "utf-8")


def _text(value: object) -> str:
    return decoded(value) if isinstance(value, bytes) else str(value)


def is_group(source: Path, name: str) -> bool:
    """Whether a name is that of a group in the file."""
    with h5py.File(source, "r") as file:
        return isinstance(file.get(name, getlink=True), h5py.HardLink) and isinstance(file.get(name), h5py.Group)
