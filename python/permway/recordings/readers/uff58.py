"""Functions at nodes (datasets 58 and 58b): records in time, and frequency responses with their coherence."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.timebase import TimeBase, whole_rate
from permway.recordings.readers.timefile import TimeFile
from permway.recordings.readers.uff import Text, open_text
from permway.recordings.readers.uff58_function import WIDTHS, Function, functions
from permway.recordings.record import FrfRecord

GENERAL, TIME, FRF, COHERENCE = 0, 1, 4, 6
_TIME_AXIS, _FREQUENCY_AXIS = 17, 18


@contextmanager
def open_time(source: Path) -> Iterator[TimeFile]:
    """Open the functions over time of a universal file, one channel each.

    A channel is named by node and direction, or by the first identification line where the node is 0.
    """
    with open_text(source) as text:
        found = [
            item
            for item in functions(text)
            if item.function == TIME or (item.function == GENERAL and item.axis == _TIME_AXIS and not item.complex)
        ]
        if not found:
            what = "holds no function over time (dataset 58 of type 1)"
            raise InputError(what, where=str(source), remedy="is it a file of frequency responses? use read_frf")
        first = found[0]
        for item in found[1:]:
            if (item.count, item.start, item.step, item.even) != (
                first.count,
                first.start,
                first.step,
                first.even,
            ):
                raise text.error(
                    f"channel {item.response} has other samples than {first.response}: "
                    f"{item.count} of {item.step:.6g} s from {item.start:.6g} s, "
                    f"not {first.count} of {first.step:.6g} s from {first.start:.6g} s",
                    item.at,
                    remedy="put records of another rate or length into files of their own",
                )
        rate, start = _rate(text, first)
        yield TimeFile(
            source=str(source),
            channels=tuple(_channel(item) for item in found),
            units=tuple(item.unit for item in found),
            samples=first.count,
            sampling_Hz=rate,
            start_s=start,
            read=lambda rows, a, b: _time_values(text, [found[row] for row in rows], a, b),
        )


def read_frf(source: Path, *, max_bytes: int = MOST_BYTES) -> FrfRecord:
    """Read the frequency responses (type 4) of a universal file, with their coherence (type 6).

    A pair without a coherence, in a file that has some, has NaN there.
    """
    with open_text(source) as text:
        everything = list(functions(text))
        rows = [
            item
            for item in everything
            if item.function == FRF or (item.function == GENERAL and item.axis == _FREQUENCY_AXIS and item.complex)
        ]
        if not rows:
            what = "holds no frequency response (dataset 58 of type 4)"
            raise InputError(what, where=str(source), remedy="is it a record in time? use read_time")
        check_size(3 * len(rows) * rows[0].count, str(source), max_bytes=max_bytes)
        index = {(item.response, item.reference): i for i, item in enumerate(rows)}
        if len(index) < len(rows):
            at = next(item for i, item in enumerate(rows) if index[item.response, item.reference] != i)
            value = f"{at.response} / {at.reference}"
            remedy = "keep one, or put repeats into files of their own"
            raise text.error("a pair measured twice", at.at, value=value, remedy=remedy)
        frequency: Reals | None = None
        values = np.empty((len(rows), rows[0].count), dtype=np.complex128)
        for i, item in enumerate(rows):
            abscissa, ordinate = _values(text, item)
            frequency = _same_lines(text, item, abscissa, frequency, rows[0])
            values[i] = ordinate
        assert frequency is not None
        units = {item.unit for item in rows}
        if len(units) > 1:
            what = "frequency responses of several units in one file"
            raise InputError(
                what, where=str(source), value=sorted(map(str, units)), remedy="put them into files apart"
            )
        return FrfRecord(
            responses=tuple(item.response for item in rows),
            references=tuple(item.reference for item in rows),
            frequency_Hz=frequency,
            values=values,
            coherence=_coherence(text, everything, rows, index, frequency),
            unit=units.pop(),
            averages=None,
            source=str(source),
        )


def _coherence(
    text: Text,
    everything: list[Function],
    rows: list[Function],
    index: dict[tuple[str, str], int],
    frequency: Reals,
) -> Reals | None:
    found = [item for item in everything if item.function == COHERENCE]
    if not found:
        return None
    coherence = np.full((len(rows), frequency.size), np.nan)
    seen: set[int] = set()
    for item in found:
        pair = f"{item.response} / {item.reference}"
        row = index.get((item.response, item.reference))
        if row is None:
            raise text.error("a coherence without its frequency response", item.at, value=pair)
        if row in seen:
            raise text.error("two coherences of one pair", item.at, value=pair, remedy="keep one")
        seen.add(row)
        if item.complex:
            raise text.error("a coherence must be real", item.at, value=pair)
        abscissa, ordinate = _values(text, item)
        _same_lines(text, item, abscissa, frequency, rows[0])
        coherence[row] = ordinate.real
    return coherence


def _same_lines(text: Text, item: Function, abscissa: Reals, known: Reals | None, first: Function) -> Reals:
    if known is None:
        return abscissa
    if abscissa.shape != known.shape or not np.allclose(abscissa, known, rtol=1e-5, atol=0.0):
        raise text.error(
            f"{item.response} / {item.reference} has other frequencies than {first.response} / {first.reference}",
            item.at,
            value=f"{abscissa.size} from {abscissa[0]:g} Hz, not {known.size} from {known[0]:g} Hz",
            remedy="put them into files apart",
        )
    return known


def _channel(item: Function) -> str:
    return item.label if item.response == "0" and item.label.upper() not in ("", "NONE") else item.response


def _values(text: Text, item: Function) -> tuple[Reals, Complexes]:
    """Abscissa and ordinate."""
    total = item.count * item.fields
    if item.binary is not None:
        raw = text.binary(item.values_at, item.binary, total)
        if not np.isfinite(raw).all():
            point = int(np.flatnonzero(~np.isfinite(raw))[0]) // item.fields
            what = f"point {point} of {item.response} / {item.reference} is not finite"
            raise text.error(what, item.at, remedy="measure it again")
    else:
        raw, _ = text.numbers(item.values_at, WIDTHS[item.kind, item.even], total)
    table: Reals = np.asarray(raw, dtype=np.float64).reshape(item.count, item.fields)
    if item.even:
        return np.asarray(item.start + item.step * np.arange(item.count), dtype=np.float64), _ordinate(table, item)
    return np.array(table[:, 0]), _ordinate(table[:, 1:], item)


def _ordinate(table: Reals, item: Function) -> Complexes:
    return np.asarray(table[:, 0] + 1j * table[:, 1] if item.complex else table[:, 0] + 0j)


def _time_values(text: Text, items: Sequence[Function], first: int, stop: int) -> Reals:
    values = np.empty((len(items), stop - first))
    for row, item in enumerate(items):
        if item.complex:
            raise text.error("samples in time must be real", item.at, value=item.response)
        if item.binary is not None:
            raw = text.binary(item.values_at, item.binary, item.count * item.fields)
            values[row] = raw.reshape(item.count, item.fields)[first:stop, -1]
        else:
            raw, _ = text.numbers(item.values_at, WIDTHS[item.kind, item.even], item.count * item.fields)
            values[row] = raw.reshape(item.count, item.fields)[first:stop, -1]
    return values


def _rate(text: Text, item: Function) -> tuple[float | None, float | None]:
    if item.even:
        # The step is printed with six digits at best: 9.76562e-04 s is 1024 Hz.
        return (whole_rate(1.0 / item.step, 5e-6) if item.count > 1 else None), item.start
    abscissa, _ = _values(text, item)
    top = float(np.abs(abscissa).max())
    printed = 1e-5 * 10.0 ** np.floor(np.log10(top)) if top > 0.0 else 0.0
    base = TimeBase(
        0.0 if item.binary else float(printed), lambda sample: f"{text.source}: {item.response}, sample {sample}"
    )
    base.feed(abscissa)
    return base.sampling_Hz, base.start_s
