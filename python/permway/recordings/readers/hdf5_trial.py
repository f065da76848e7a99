"""Goes through an HDF5 file in a process of its own: a damaged one can keep the HDF5 library busy for ever.

Run as a script by :func:`permway.recordings.readers.hdf5.check_sound`, with the file's name, the most bytes that
its texts may take, and seconds of processor time. Whatever the reader then does with structure, attributes and
texts has been done here before; of numbers the first and the last are read. Raising is no matter, for the reader
states it better: what counts is that this comes to an end, without a crash, and within its memory.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np

MOST_MEMORY = 3 * 2**30
TOO_LARGE = 3
"""Exit status for texts or attributes that are larger than they may be."""


class _TooLarge(BaseException):
    pass


@contextlib.contextmanager
def _quietly() -> Iterator[None]:
    """Go on after whatever one part of the file raises, but for want of memory."""
    try:
        yield
    except MemoryError:
        raise
    except Exception:  # noqa: BLE001 - the library's own kinds are many
        return


class Trial:
    """What is left of the bytes that texts and attributes may take.

    Parameters
    ----------
    most : int
    longest : int
        Most that one text can take: no more than the file.
    """

    def __init__(self, most: int, longest: int) -> None:
        self._left = most
        self._together = max(1, min(1000, most // max(longest, 1)))

    def spend(self, size: int) -> None:
        """Take some of it.

        Raises
        ------
        _TooLarge
            If that is more than is left.
        """
        self._left -= size
        if self._left < 0:
            raise _TooLarge

    def texts(self, array: Any) -> None:
        """Spend what an array takes, its texts of any length with it."""
        values = np.asarray(array)
        long = sum(len(x) for x in values.ravel() if isinstance(x, bytes | str)) if values.dtype == object else 0
        self.spend(values.nbytes + long)

    def everything(self, root: Any) -> None:
        """All that hard links lead to."""
        pending, seen = [root], set[int]()
        while pending:
            with _quietly():
                self.group(pending.pop(), pending, seen)

    def group(self, group: Any, pending: list[Any], seen: set[int]) -> None:
        """What is in a group; groups in it are left for later."""
        self.attributes(group)
        for name in group:
            with _quietly():
                if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                    continue
                item = group[name]
                address = h5py.h5o.get_info(item.id).addr
                if address in seen:
                    continue
                seen.add(address)
                if isinstance(item, h5py.Group):
                    pending.append(item)
                elif isinstance(item, h5py.Dataset):
                    self.dataset(item)

    def attributes(self, item: Any) -> None:
        """All attributes, sizes first."""
        for key in item.attrs:
            with _quietly():
                size = item.attrs.get_id(key).get_storage_size()
                if size > MOST_MEMORY // 8:
                    raise _TooLarge
                self.texts(item.attrs[key])

    def dataset(self, data: Any) -> None:
        """Attributes and axes, then texts as a whole, and numbers at both ends."""
        self.attributes(data)
        for dim in data.dims:
            with _quietly():
                str(dim.label)
                str(dim[0].name if len(dim) else "")
        if data.shape is None or data.external or data.is_virtual:
            return
        count = int(np.prod([float(n) for n in data.shape])) if data.shape else 1
        if data.dtype.kind in "OSU":
            self.spend(count * data.dtype.itemsize)
            rows = range(0, data.shape[0], self._together) if data.shape else [0]
            for first in rows:
                self.row(data, data[first : first + self._together] if data.shape else data[()])
        elif count and data.shape:
            with _quietly():
                data[tuple(0 for _ in data.shape)]
                data[tuple(n - 1 for n in data.shape)]

    def row(self, data: Any, values: Any) -> None:
        """Texts, or references to what holds them."""
        self.texts(values)
        for reference in np.ravel(values):
            if isinstance(reference, h5py.Reference) and reference:
                with _quietly():
                    target = data.file[reference]
                    if isinstance(target, h5py.Dataset) and target.size:
                        self.spend(target.size * target.dtype.itemsize)
                        target[()]


def _main(path: str, most: int, seconds: int) -> int:
    with contextlib.suppress(ImportError):
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        with h5py.File(path, "r") as file, _quietly():
            Trial(most, Path(path).stat().st_size).everything(file)
    except (_TooLarge, MemoryError):
        return TOO_LARGE
    except OSError:
        return 0
    return 0


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])))
