"""The one front of all readers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

from permway.errors import InputError
from permway.recordings.readers import (
    hdf5,
    lvm,
    mat,
    mdf,
    netcdf3,
    npz,
    table,
    tdms,
    text,
    text_frf,
    uff55,
    uff58,
    wav,
)
from permway.recordings.readers.formats import Format, recognise
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES, check_size, existing_file, foreign
from permway.recordings.readers.mat_objects import with_tables
from permway.recordings.readers.store import as_time
from permway.recordings.readers.store_beside import with_units_beside
from permway.recordings.readers.store_frf import as_frf, as_table
from permway.recordings.readers.stored import Store
from permway.recordings.readers.text_numbers import in_decibels
from permway.recordings.readers.timefile import (
    TimeFile,
    Timing,
    agreed_rate,
    agreed_timing,
    agreed_units,
    check_channels,
    check_finite,
    rows_of,
)
from permway.recordings.readers.uff import next_block, open_text, skip_block
from permway.recordings.record import FrfRecord, TableRecord, TimeRecord

_STORES = ("mat", "mat73", "npz", "hdf5", "netcdf", "netcdf3")


def read_time(
    path: str | Path,
    *,
    channels: Sequence[str] | None = None,
    units: str | Mapping[str, str] | None = None,
    sampling_Hz: float | None = None,
    samples: tuple[int, int] | None = None,
    format: str | None = None,  # noqa: A002 - the word for it
    part: str | None = None,
    hints: Hints = NO_HINTS,
    keep_nonfinite: bool = False,
    max_bytes: int = MOST_BYTES,
) -> TimeRecord:
    """Read a record in time, as it stands in the file.

    Parameters
    ----------
    path : path
        UFF 58 or 58b, MAT, CSV, TSV, NPZ, HDF5, NetCDF, TDMS, LVM, MDF or WAV.
    channels : sequence of str, optional
        Which, in which order; by default all. Only these have to be sound, and to go together.
    units : str or dict of channel to str, optional
        As known beside the file: taken where the file has none, and refused where its own means another.
    sampling_Hz : float, optional
        As known beside the file, likewise.
    samples : (first, stop), optional
        Only these.
    format : str, optional
        One of :data:`permway.recordings.readers.formats.Format`; by default determined from content and name.
    part : str, optional
        Group of a TDMS, MDF or HDF5 file, array of samples, or number of a segment of LVM, if there are several.
    hints : Hints
        What is known of the file and wins over what it states.
    keep_nonfinite : bool
        Keep samples that are not finite, to look at them; else they are refused.
    max_bytes : int
        Most that the samples may take in memory.

    Returns
    -------
    TimeRecord

    Raises
    ------
    InputError
        For whatever in the file cannot be used or contradicts, with channel, line or sample, value and remedy.
    """
    with opened(path, format, part, hints, keep_nonfinite, max_bytes) as (file, kind):
        rows = rows_of(file, channels)
        timing = _timing(file, kind, rows, sampling_Hz)
        first, stop = _range(timing, samples)
        check_size(len(rows) * (stop - first), file.source, max_bytes=max_bytes)
        stated = agreed_units(file, rows, units, hints)
        return _record(file, kind, rows, stated, timing, first, stop, keep_nonfinite)


def time_blocks(
    path: str | Path,
    *,
    block_samples: int = 2**18,
    channels: Sequence[str] | None = None,
    units: str | Mapping[str, str] | None = None,
    sampling_Hz: float | None = None,
    format: str | None = None,  # noqa: A002 - the word for it
    part: str | None = None,
    hints: Hints = NO_HINTS,
    keep_nonfinite: bool = False,
) -> Iterator[TimeRecord]:
    """Read a record in time in blocks, for records that memory does not hold. MAT of version 5 is read as a whole.

    Parameters
    ----------
    block_samples : int
        Of each block; the last may be shorter.

    Yields
    ------
    TimeRecord
        Each with the time of its own first sample.

    Raises
    ------
    InputError
        As :func:`read_time`.
    """
    if isinstance(block_samples, bool) or not isinstance(block_samples, int) or block_samples < 1:
        raise InputError("must be a whole number above 0", where="block_samples", value=block_samples)
    with opened(path, format, part, hints, keep_nonfinite, MOST_BYTES) as (file, kind):
        rows = rows_of(file, channels)
        timing = _timing(file, kind, rows, sampling_Hz)
        stated = agreed_units(file, rows, units, hints)
        check_size(len(rows) * min(block_samples, timing.samples), file.source)
        for first in range(0, timing.samples, block_samples):
            stop = min(first + block_samples, timing.samples)
            yield _record(file, kind, rows, stated, timing, first, stop, keep_nonfinite)


def read_frf(
    path: str | Path,
    *,
    responses: Sequence[str] | None = None,
    references: Sequence[str] | None = None,
    format: str | None = None,  # noqa: A002 - the word for it
    part: str | None = None,
    hints: Hints = NO_HINTS,
    keep_nonfinite: bool = False,
    max_bytes: int = MOST_BYTES,
) -> FrfRecord:
    """Read frequency responses, with their coherence where the file has it.

    Parameters
    ----------
    path : path
        UFF 58, 58b or 55, MAT, NPZ, HDF5 or NetCDF; or a table of text with a row for each frequency, sensor and
        point.
    responses, references : sequence of str, optional
        Labels: only pairs of these are read, and have to be sound; by default all. If no pair has them, all are
        given.
    format : str, optional
        As of :func:`read_time`.
    part : str, optional
        Group of an HDF5 file, struct of a MAT file, or array, if there are several.
    hints : Hints
        As of :func:`read_time`.
    keep_nonfinite : bool
        Keep numbers that are not finite; else they are refused but at 0 Hz, which nothing uses.
    max_bytes : int
        Most that they may take in memory.

    Raises
    ------
    InputError
        For whatever in the file cannot be used or contradicts, with pair, line, value and remedy.
    """
    source = existing_file(path)
    kind = recognise(source, format, hints.encoding)
    with foreign(source, kind):
        if kind == "uff":
            if 58 in _datasets(source):
                record = uff58.read_frf(
                    source, responses=responses, references=references, hints=hints, max_bytes=max_bytes
                )
            else:
                record = uff55.read_frf(source, max_bytes=max_bytes)
        elif kind in _STORES:
            with _store(source, kind, part, max_bytes) as (store, array):
                record = as_frf(store, array, hints=hints, max_bytes=max_bytes)
        elif kind == "text":
            record = text_frf.read_frf(
                source, responses=responses, references=references, hints=hints, max_bytes=max_bytes
            )
        else:
            remedy = "give UFF, MAT, NPZ, HDF5, NetCDF, or a table of text"
            raise InputError(
                "frequency responses are not read from this format", where=str(source), value=kind, remedy=remedy
            )
    stated = hints.unit if isinstance(hints.unit, str) else None
    if kind == "text" and in_decibels(stated):
        # The levels of a table were taken by it.
        stated = None
    record = record.of(responses, references).with_unit(stated)
    record.check_ratio()
    record.check_coherence()
    if not keep_nonfinite:
        record.check_finite(record.frequency_Hz > 0.0)
    return record


def read_table(
    path: str | Path,
    *,
    texts: Sequence[str] = (),
    format: str | None = None,  # noqa: A002 - the word for it
    part: str | None = None,
    hints: Hints = NO_HINTS,
    max_bytes: int = MOST_BYTES,
) -> TableRecord:
    """Read a table: decay rates in bands, moduli, mode shapes.

    Parameters
    ----------
    path : path
        CSV, TSV, MAT, NPZ, HDF5, NetCDF, or UFF 55.
    texts : sequence of str
        Columns of a text table that are texts though they look like numbers.
    format, part, hints, max_bytes
        As of :func:`read_frf`.

    Raises
    ------
    InputError
        For whatever in the file cannot be used, with line and column, value and remedy.
    """
    source = existing_file(path)
    kind = recognise(source, format, hints.encoding)
    with foreign(source, kind):
        if kind == "text":
            return table.read_text_table(source, texts=texts, hints=hints, max_bytes=max_bytes)
        if kind == "uff":
            return uff55.read_shapes(source, max_bytes=max_bytes)
        if kind in _STORES:
            with _store(source, kind, part, max_bytes) as (store, _):
                return as_table(store, max_bytes=max_bytes)
    raise InputError(
        "tables are not read from this format", where=str(source), value=kind, remedy="export it as CSV"
    )


@contextmanager
def opened(
    path: str | Path, stated: str | None, part: str | None, hints: Hints, keep: bool, max_bytes: int
) -> Iterator[tuple[TimeFile, Format]]:
    """A file of records in time, opened, and its format.

    Raises
    ------
    InputError
        As :func:`read_time`.
    """
    source = existing_file(path)
    kind = recognise(source, stated, hints.encoding)
    with ExitStack() as stack:
        # What a reader raises while it opens or reads is made one clear error; what is raised by whoever uses the
        # record between blocks is not its concern, and passes.
        with foreign(source, kind):
            file: TimeFile
            if kind in _STORES:
                store, array = stack.enter_context(_store(source, kind, part, max_bytes))
                file = as_time(store, array, hints)
            else:
                entered: AbstractContextManager[TimeFile]
                if kind == "text":
                    entered = text.open_time(source, keep, hints)
                elif kind == "lvm":
                    entered = lvm.open_time(source, hints, part=part, max_bytes=max_bytes)
                elif kind == "uff":
                    entered = uff58.open_time(source, hints, keep=keep)
                elif kind == "mdf":
                    entered = mdf.open_time(source, group=part, hints=hints, max_bytes=max_bytes)
                else:
                    entered = (
                        tdms.open_time(source, group=part, hints=hints)
                        if kind == "tdms"
                        else wav.open_time(source)
                    )
                file = stack.enter_context(entered)
            check_channels(file)
        yield file, kind


def _timing(file: TimeFile, kind: Format, rows: list[int], stated: float | None) -> Timing:
    """The timing of the channels asked for, its rate as file and caller say it."""
    with foreign(Path(file.source), kind):
        timing = agreed_timing(file, rows)
    return replace(timing, sampling_Hz=agreed_rate(file, timing, stated))


@contextmanager
def _store(source: Path, kind: Format, part: str | None, max_bytes: int) -> Iterator[tuple[Store, str | None]]:
    """The arrays of a file, and which of them was chosen; of HDF5 a part may be a group as well."""
    opened: AbstractContextManager[Store]
    if kind == "npz":
        opened = npz.open_store(source)
    elif kind == "mat":
        opened = mat.open_store(source, max_bytes=max_bytes)
    elif kind == "netcdf3":
        opened = netcdf3.open_store(source, max_bytes=max_bytes)
    else:
        hdf5.check_sound(source)
        group = part if part is not None and hdf5.is_group(source, part) else None
        opened, part = hdf5.open_store(source, group=group), None if group is not None else part
    with opened as store:
        if kind in ("mat", "mat73"):
            store = with_tables(store, source, max_bytes=max_bytes)
        yield with_units_beside(store), part


def _record(
    file: TimeFile,
    kind: Format,
    rows: list[int],
    units: tuple[str | None, ...],
    timing: Timing,
    first: int,
    stop: int,
    keep: bool,
) -> TimeRecord:
    with foreign(Path(file.source), kind):
        values = file.read(rows, first, stop)
    if not keep:
        check_finite(file, rows, values, first, timing)
    rate, start = timing.sampling_Hz, timing.start_s
    if first and rate is not None:
        start = (start or 0.0) + first / rate
    return TimeRecord(
        channels=tuple(file.channels[row] for row in rows),
        units=units,
        values=values,
        sampling_Hz=rate,
        start_s=start,
        source=file.source,
        notes=file.notes,
    )


def _range(timing: Timing, samples: tuple[int, int] | None) -> tuple[int, int]:
    if samples is None:
        return 0, timing.samples
    whole = len(samples) == 2 and all(isinstance(x, int) and not isinstance(x, bool) for x in samples)
    if not whole or not 0 <= samples[0] < samples[1] <= timing.samples:
        remedy = f"give first and stop within 0 and {timing.samples}"
        raise InputError("no range of samples of this record", where="samples", value=samples, remedy=remedy)
    return samples


def _datasets(source: Path) -> set[int]:
    """The number of the first dataset in a universal file that is read here."""
    with open_text(source) as data:
        at = 0
        while (block := next_block(data, at)) is not None:
            if block.kind in (55, 58):
                return {block.kind}
            at = skip_block(data, block)
    raise InputError(
        "holds neither functions (dataset 58) nor data at nodes (55)", where=str(source), remedy="export them too"
    )
