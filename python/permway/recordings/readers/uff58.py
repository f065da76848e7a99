"""Functions at nodes (datasets 58 and 58b): records in time, and frequency responses with their coherence."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES, check_size
from permway.recordings.readers.scales import hertz_in, seconds_in
from permway.recordings.readers.timebase import TimeBase, whole_rate
from permway.recordings.readers.timefile import TimeFile, Timing
from permway.recordings.readers.uff import Text, open_text
from permway.recordings.readers.uff58_function import Function, functions, values_of
from permway.recordings.readers.uff58_labels import (
    Naming,
    Pair,
    channel_labels,
    pair_labels,
    pair_namings,
    plain_pair,
    type_name,
)
from permway.recordings.readers.uff58_units import ordinate_unit
from permway.recordings.record import FrfRecord

GENERAL, TIME, AUTO, CROSS, FRF, COHERENCE, DENSITY = 0, 1, 2, 3, 4, 6, 9
_UNSTATED, _TIME_AXIS, _FREQUENCY_AXIS = 0, 17, 18
_PRINTED = 5e-6
"""Relative rounding of a step that is printed with six digits: 9.76562e-04 s is 1024 Hz."""


@contextmanager
def open_time(source: Path, hints: Hints = NO_HINTS, *, keep: bool = False) -> Iterator[TimeFile]:
    """Open the functions over time of a universal file, one channel each.

    A channel is named by node and direction, or by the entity's name or the first identification line where the
    node is 0; what ties is distinguished by entity, quantity, identification or the function's number.
    """
    with open_text(source, hints.encoding) as text:
        everything = list(functions(text))
        found = [
            item
            for item in everything
            if item.function == TIME
            or (item.function == GENERAL and item.abscissa.kind == _TIME_AXIS and not item.complex)
        ]
        if not found:
            raise _nothing(source, everything, "function over time (dataset 58 of type 1)")

        @cache
        def timing(row: int) -> Timing:
            return _timing(text, found[row], hints)

        yield TimeFile(
            source=str(source),
            channels=channel_labels(found),
            units=tuple(ordinate_unit(item.ordinate, item.denominator, item.system) for item in found),
            timing=timing,
            read=lambda rows, a, b: _time_values(text, [found[row] for row in rows], a, b, keep),
        )


def _nothing(source: Path, everything: list[Function], wanted: str) -> InputError:
    """That a file does not hold what is looked for, and what it holds."""
    counts: dict[str, int] = {}
    for item in everything:
        name = f"{type_name(item.function)} (type {item.function})"
        counts[name] = counts.get(name, 0) + 1
    kinds = {item.function for item in everything}
    if not everything:
        remedy = "export records in time (type 1) or frequency responses (type 4)"
    elif kinds & {FRF}:
        remedy = 'is it a file of frequency responses? use read_frf, in a campaign statistic = "frf"'
    elif kinds & {TIME}:
        remedy = 'is it a record in time? use read_time, in a campaign statistic = "csd"'
    elif kinds & {AUTO, DENSITY}:
        remedy = 'it holds spectra: in a campaign statistic = "csd" with averages and the segment_s of its lines'
    else:
        remedy = (
            "it holds neither records in time (type 1) nor frequency responses (type 4) nor densities (type 9): "
        )
        remedy += "export one of them"
    held = ", ".join(f"{count} x {name}" for name, count in counts.items()) or None
    return InputError(f"holds no {wanted}", where=str(source), value=held, remedy=remedy)


def read_frf(
    source: Path,
    *,
    responses: Sequence[str] | None = None,
    references: Sequence[str] | None = None,
    hints: Hints = NO_HINTS,
    max_bytes: int = MOST_BYTES,
) -> FrfRecord:
    """Read the frequency responses (type 4) of a universal file, with their coherence (type 6).

    A pair without a coherence, in a file that has some, has NaN there. Numbers that are not finite are kept.

    Parameters
    ----------
    responses, references : sequence of str, optional
        Labels of the pairs that are read; by default all.
    """
    with open_text(source, hints.encoding) as text:
        everything = list(functions(text))
        found = [
            item
            for item in everything
            if item.function == FRF
            or (item.function == GENERAL and item.abscissa.kind == _FREQUENCY_AXIS and item.complex)
        ]
        if not found:
            raise _nothing(source, everything, "frequency response (dataset 58 of type 4)")
        states = pair_namings(found)
        every = pair_labels(found, states)
        chosen = [
            i
            for i, (response, reference) in enumerate(every)
            if (responses is None or response in responses) and (references is None or reference in references)
        ]
        # Where no pair is asked for rightly, all are given: whoever asked states what there is.
        chosen = chosen or list(range(len(found)))
        rows, labels = [found[i] for i in chosen], [every[i] for i in chosen]
        check_size(3 * len(rows) * rows[0].count, str(source), max_bytes=max_bytes)
        twice = next((i for i, label in enumerate(labels) if label in labels[:i]), None)
        if twice is not None:
            remedy = "number the functions, name them in an identification line, or put repeats into files apart"
            value = " / ".join(labels[twice])
            raise text.error("a pair measured twice", rows[twice].at, value=value, remedy=remedy)
        frequency: Reals | None = None
        values = np.empty((len(rows), rows[0].count), dtype=np.complex128)
        for i, item in enumerate(rows):
            if not item.complex:
                what = f"the response {' / '.join(labels[i])} is of real numbers: a magnitude without its phase"
                remedy = "export real and imaginary part (ordinates of type 5 or 6)"
                raise text.error(what, item.at, value=item.kind, remedy=remedy)
            abscissa, ordinate = over_frequency(text, item)
            frequency = same_lines(text, item, abscissa, frequency, rows[0])
            values[i] = ordinate
        assert frequency is not None
        units = tuple(ordinate_unit(item.ordinate, item.denominator, item.system) for item in rows)
        return FrfRecord(
            responses=tuple(label[0] for label in labels),
            references=tuple(label[1] for label in labels),
            frequency_Hz=frequency,
            values=values,
            coherence=_coherence(text, everything, _Chosen(rows, labels, every, states), frequency),
            unit=units[0] if len(set(units)) == 1 else None,
            units=units,
            averages=None,
            source=str(source),
        )


@dataclass(frozen=True)
class _Chosen:
    """Responses that are read and their labels, the labels of all, and what distinguishes those of one pair."""

    rows: list[Function]
    labels: list[Pair]
    every: list[Pair]
    states: dict[Pair, Naming]


def _coherence(text: Text, everything: list[Function], chosen: _Chosen, frequency: Reals) -> Reals | None:
    """Of the pairs that are read: distinguished as the responses are."""
    found = [item for item in everything if item.function == COHERENCE]
    if not found:
        return None
    rows, labels = chosen.rows, chosen.labels
    index = {label: i for i, label in enumerate(labels)}
    asked = {plain_pair(item) for item in rows}
    coherence = np.full((len(rows), frequency.size), np.nan)
    seen: set[int] = set()
    for item, label in zip(found, pair_labels(found, chosen.states), strict=True):
        pair = " / ".join(label)
        if label not in chosen.every and (plain_pair(item) in asked or len(rows) == len(chosen.every)):
            remedy = "identify it as its response is: by names, an identification line, or the function's number"
            raise text.error("a coherence without its frequency response", item.at, value=pair, remedy=remedy)
        if label not in index:
            continue
        row = index[label]
        if row in seen:
            raise text.error("two coherences of one pair", item.at, value=pair, remedy="keep one")
        seen.add(row)
        abscissa, ordinate = over_frequency(text, item)
        if np.any(ordinate.imag):
            raise text.error("a coherence must be real", item.at, value=pair)
        same_lines(text, item, abscissa, frequency, rows[0])
        coherence[row] = ordinate.real / (100.0 if item.ordinate.unit == "%" else 1.0)
    return coherence


def same_lines(text: Text, item: Function, abscissa: Reals, known: Reals | None, first: Function) -> Reals:
    """The frequencies of a function, which must be those of the first.

    Raises
    ------
    InputError
        If they are others.
    """
    if known is None:
        return abscissa
    if abscissa.shape != known.shape or not np.allclose(abscissa, known, rtol=1e-5, atol=0.0):
        raise text.error(
            f"{_pair(item)} has other frequencies than {_pair(first)}",
            item.at,
            value=f"{abscissa.size} from {abscissa[0]:g} Hz, not {known.size} from {known[0]:g} Hz",
            remedy="put them into files apart, or ask for pairs that go together",
        )
    return known


def _pair(item: Function) -> str:
    return f"{item.response.label} / {item.reference.label}"


def over_frequency(text: Text, item: Function) -> tuple[Reals, Complexes]:
    """Abscissa in Hz and ordinate.

    Raises
    ------
    InputError
        For a function that does not stand over frequency.
    """
    if item.abscissa.kind not in (_UNSTATED, _FREQUENCY_AXIS):
        what = f"{_pair(item)} does not stand over frequency: its abscissa is of type {item.abscissa.kind}"
        remedy = "export it over frequency (type 18)"
        raise text.error(what, item.at, value=item.abscissa.label or item.abscissa.unit, remedy=remedy)
    scale = hertz_in(item.abscissa.unit, f"{text.source}: {_pair(item)}, abscissa")
    table = values_of(text, item, keep=True)
    abscissa = item.start + item.step * np.arange(item.count) if item.even else np.array(table[:, 0])
    if not np.isfinite(abscissa).all():
        point = int(np.flatnonzero(~np.isfinite(abscissa))[0])
        raise text.error(f"a frequency of {_pair(item)} is not a finite number", item.at, value=f"point {point}")
    ordinate = table if item.even else table[:, 1:]
    values = ordinate[:, 0] + (1j * ordinate[:, 1] if item.complex else 0j)
    return np.asarray(abscissa * scale, dtype=np.float64), np.asarray(values, dtype=np.complex128)


def _time_values(text: Text, items: Sequence[Function], first: int, stop: int, keep: bool) -> Reals:
    values = np.empty((len(items), stop - first))
    for row, item in enumerate(items):
        values[row] = values_of(text, item, keep=keep or item.binary is not None)[first:stop, -1]
    return values


def _timing(text: Text, item: Function, hints: Hints) -> Timing:
    """Samples, rate and start of a channel.

    Raises
    ------
    InputError
        If it is no channel over time, or not evenly so.
    """
    if item.complex:
        raise text.error("samples in time must be real", item.at, value=item.response.label)
    if hints.no_times:
        return Timing(samples=item.count, sampling_Hz=None)
    if item.abscissa.kind not in (_UNSTATED, _TIME_AXIS):
        what = (
            f"channel {item.response.label} does not stand over time: its abscissa is of type {item.abscissa.kind}"
        )
        remedy = 'export it over time (type 17); time_column = "none" and sampling_Hz read it all the same'
        raise text.error(what, item.at, value=item.abscissa.label or item.abscissa.unit, remedy=remedy)
    where = f"{text.source}: channel {item.response.label}, abscissa"
    scale = seconds_in(hints.unit_of("time") or item.abscissa.unit or "s", where)
    if item.even:
        rate = whole_rate(1.0 / (item.step * scale), _PRINTED) if item.count > 1 else None
        return Timing(samples=item.count, sampling_Hz=rate, start_s=item.start * scale, uncertainty=_PRINTED)
    abscissa = values_of(text, item, keep=True)[:, 0]
    if item.binary is not None:
        single = item.single_abscissa or item.binary.endswith("f4")
        top = float(np.abs(abscissa).max(initial=0.0, where=np.isfinite(abscissa)))
        worth = top * float(np.finfo(np.float32 if single else np.float64).eps)
    else:
        top = float(np.abs(abscissa).max(initial=0.0, where=np.isfinite(abscissa)))
        worth = 1e-5 * 10.0 ** np.floor(np.log10(top)) if top > 0.0 else 0.0
    place = f"{text.source}: {item.response.label}"
    base = TimeBase(float(worth) * scale, lambda sample: f"{place}, sample {sample}", scale)
    base.feed(abscissa)
    return base.timing(item.count)
