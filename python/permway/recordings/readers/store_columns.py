"""The channels among named arrays: the columns of a table, and arrays of one axis."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from permway.arrays import Reals
from permway.errors import InputError
from permway.recordings.readers.headers import time_scale
from permway.recordings.readers.limits import MOST_CHANNELS
from permway.recordings.readers.stored import Store, Variable

_CHANNEL_AXES = {"channels", "channel", "channel_names", "names", "labels", "sensors", "sensor"}


@dataclass(frozen=True)
class Column:
    """One channel.

    Attributes
    ----------
    name : str
    unit : str or None
        As found.
    samples : int
    read : callable
        From rows of its array, first sample and the one after the last, to values, shape (row, sample).
    row : int or None
        In the table that it is a column of; None for an array of its own.
    attributes : mapping
        Of its array.
    folder : str
        The group or struct that its array is in.
    counts : bool
        Whether its numbers are whole by their type, as a converter's are.
    """

    name: str
    unit: str | None
    samples: int
    read: Callable[[list[int], int, int], NDArray[np.generic]]
    row: int | None
    attributes: Mapping[str, object] = field(default_factory=dict)
    folder: str = ""
    counts: bool = False

    @property
    def in_table(self) -> bool:
        """Whether it is a column of a table."""
        return self.row is not None


def rank(variable: Variable) -> int:
    """Axes that are longer than one."""
    return sum(length > 1 for length in variable.shape)


def columns_of(
    store: Store, data: list[Variable], names: tuple[str, ...] | None, times: int | None
) -> list[Column]:
    """The channels of a table, if there is one among the arrays, and of those with one axis.

    Parameters
    ----------
    names : sequence of str or None
        Of the table's channels.
    times : int or None
        Number of times.

    Raises
    ------
    InputError
        If which axis of the table counts the channels cannot be determined.
    """
    table = next((variable for variable in data if rank(variable) == 2), None)
    vectors = [variable for variable in data if rank(variable) < 2]
    columns = [] if table is None else _of_table(store, table, names, times)
    one_folder = len({variable.folder for variable in data}) == 1
    own = [variable.leaf if one_folder else variable.name for variable in vectors]
    if table is None and names is not None and len(names) == 1 == len(own):
        own = list(names)
    for name, variable in zip(own, vectors, strict=True):
        columns.append(
            Column(
                name,
                variable.unit(),
                variable.size,
                _reader(variable),
                None,
                variable.attributes,
                variable.folder,
                variable.resolution == 1.0,
            )
        )
    return columns


def read_columns(columns: Sequence[Column], first: int, stop: int) -> Reals:
    """Samples of some channels, shape (channel, sample); of a table in one go."""
    values = np.empty((len(columns), stop - first))
    table = [i for i, column in enumerate(columns) if column.in_table]
    if table:
        values[table] = columns[table[0]].read([columns[i].row or 0 for i in table], first, stop)
    for i, column in enumerate(columns):
        if not column.in_table:
            values[i] = column.read([0], first, stop)[0]
    return values


def _reader(variable: Variable) -> Callable[[list[int], int, int], NDArray[np.generic]]:
    def read(_: list[int], first: int, stop: int) -> NDArray[np.generic]:
        slices = tuple(slice(first, stop) if n > 1 else slice(None) for n in variable.shape)
        return np.ravel(variable.read(slices))[None, :]

    return read


def _of_table(store: Store, table: Variable, names: tuple[str, ...] | None, times: int | None) -> list[Column]:
    where = f"{store.source}: '{table.name}'"
    axes = [axis for axis, length in enumerate(table.shape) if length > 1]
    along = _channel_axis(table, axes, names, times, where)
    channel_axis, sample_axis = axes[along], axes[1 - along]
    count, samples = table.shape[channel_axis], table.shape[sample_axis]
    if count > MOST_CHANNELS:
        what = "more channels than can be"
        raise InputError(what, where=where, value=table.shape, remedy="name the channels in an array 'channels'")
    if names is None:
        names = tuple(f"{table.leaf} {i + 1}" for i in range(count))

    def read(rows: list[int], first: int, stop: int) -> NDArray[np.generic]:
        span = range(min(rows), max(rows) + 1)
        slices = [slice(None)] * len(table.shape)
        slices[sample_axis], slices[channel_axis] = slice(first, stop), slice(span.start, span.stop)
        piece = np.asarray(table.read(tuple(slices)))
        piece = np.moveaxis(piece, (channel_axis, sample_axis), (0, 1)).reshape(len(span), stop - first)
        return piece[[row - span.start for row in rows]]

    return [
        Column(
            name,
            table.unit(),
            samples,
            read,
            row,
            table.attributes,
            table.folder,
            table.resolution == 1.0,
        )
        for row, name in enumerate(names)
    ]


def _channel_axis(
    table: Variable, axes: list[int], names: tuple[str, ...] | None, times: int | None, where: str
) -> int:
    """Which of the two axes counts the channels: by names of axes, by number of names or times, or the shorter."""
    lengths = [table.shape[axis] for axis in axes]
    if table.axes:
        named = [time_scale(table.axes[axis], "s", where)[0] or table.axes[axis] == "sample" for axis in axes]
        if sum(named) == 1:
            return named.index(False)
        known = [table.axes[axis].lower() in _CHANNEL_AXES for axis in axes]
        if sum(known) == 1:
            return known.index(True)
    if names is not None:
        fits = [length == len(names) for length in lengths]
        if not any(fits):
            what = f"{len(names)} names for an array of {lengths[0]} x {lengths[1]}"
            raise InputError(what, where=where, value=names, remedy="give one name for each channel")
        if sum(fits) == 1:
            return fits.index(True)
    if times is not None:
        fits = [length == times for length in lengths]
        if sum(fits) == 1:
            return fits.index(False)
    if lengths[0] == lengths[1]:
        what = "which axis counts the channels cannot be determined"
        raise InputError(what, where=where, value=table.shape, remedy="give another number of samples, or times")
    return lengths.index(min(lengths))
