"""The part of a campaign file that would use a file, in TOML, to be pasted and completed."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from permway.errors import InputError
from permway.recordings.channel import UNITS
from permway.recordings.ratio import ratio_of
from permway.recordings.record import FrfRecord
from permway.units import parse_unit

if TYPE_CHECKING:
    from permway.recordings.look import Asked

_SHOWN = 200


Places = Mapping[int, tuple[float, float, float]]
"""Of nodes, by their numbers, m."""


def time_part(
    rows: Sequence[Mapping[str, Any]], file: str, asked: Asked, faults: Sequence[str], places: Places
) -> str:
    """Sensors and a record for the channels of a record in time; what cannot be used is left out, and stated."""
    lines: list[str] = []
    channels: dict[str, str] = {}
    stated: dict[str, str] = {}
    rates = {row["sampling_Hz"] for row in rows if not row["problem"] and _motion(row["unit"])}
    common = max(rates, key=lambda rate: sum(row["sampling_Hz"] == rate for row in rows), default=None)
    for row in rows[:_SHOWN]:
        name = str(row["channel"])
        if row["problem"]:
            lines.append(f"# {_quoted(name)} is left out: {row['problem'][:160]}")
            continue
        found = _motion(row["unit"])
        if found is None:
            so = f'unit = {{ {_quoted(name)} = "m/s2" }} in the record, and the sensor\'s chain.gain'
            lines.append(f"# {_quoted(name)} is in {row['unit']}, which no sensor has; if it is a motion: {so}")
            continue
        if row["sampling_Hz"] != common:
            lines.append(f"# {_quoted(name)} is left out: another sampling rate, which needs a record of its own")
            continue
        quantity, unit = found
        lines += _sensor(name, quantity, unit, _place(name, places), known=row["unit"] is not None)
        channels[name] = name
    if not channels:
        return "\n".join(lines)
    lines += [
        *(f"# {fault}" for fault in faults),
        "[[records]]",
        'name = "run"',
        f"file = {_quoted(file)}",
        'condition = ""                  # name of one of [[conditions]], of kind "train"',
        'statistic = "csd"',
        *_hints(asked, stated),
        f"channels = {_table(channels)}",
    ]
    if common is None or asked.sampling_Hz is not None:
        expected = "0.0              # Hz: the file does not say it" if common is None else repr(float(common))
        lines.insert(-1, f"sampling_Hz = {expected}")
    return "\n".join(lines)


def frf_part(record: FrfRecord, file: str, asked: Asked, places: Places) -> str:
    """Sensors, force points and a record for frequency responses."""
    responses, references = list(dict.fromkeys(record.responses)), list(dict.fromkeys(record.references))
    unit = next((record.unit_of(row) for row in range(len(record.responses)) if record.unit_of(row)), None)
    ratio = ratio_of(unit)
    quantity, top, force = ratio or ("acceleration", "m/s2", "N")
    lines: list[str] = []
    for name in responses[:_SHOWN]:
        lines += _sensor(name, quantity, top, _place(name, places), known=ratio is not None)
    for name in references[:_SHOWN]:
        lines += [
            "[[forces]]",
            f"name = {_quoted('hit ' + name)}",
            'body = ""                       # a body of the model',
            _place(name, places),
            f"unit = {_quoted(force)}",
            "",
        ]
    if unit is not None and ratio is None:
        lines += [f"# The file is in {unit}, which no sensor over a force has: bring a copy of it to (m/s2)/N."]
    missing = unmeasured(record)
    if missing:
        count = len(responses) * len(references)
        lines += [f"# {len(record.responses)} of {count} pairs are there; not: {listed(missing)}"]
    averages = record.averages or "8                    # number of blows of each point: the file does not say it"
    lines += [
        "[[records]]",
        'name = "blows"',
        f"file = {_quoted(file)}",
        'condition = ""                  # name of one of [[conditions]], of kind "hammer"',
        'statistic = "frf"',
        f"averages = {averages}",
        *_hints(asked, {}),
        f"responses = {_table({name: name for name in responses[:_SHOWN]})}",
        f"references = {_table({name: 'hit ' + name for name in references[:_SHOWN]})}",
    ]
    if record.coherence is None:
        lines.append("# The file has no coherence, which a record of this statistic needs: export it, too.")
    return "\n".join(lines)


def unmeasured(record: FrfRecord) -> list[str]:
    """Pairs of the responses and references of a file that it does not have, as "response < reference"."""
    there = set(zip(record.responses, record.references, strict=True))
    responses, references = dict.fromkeys(record.responses), dict.fromkeys(record.references)
    return [f"{a} < {b}" for a in responses for b in references if (a, b) not in there]


def listed(names: Sequence[str], most: int = 12) -> str:
    """Names in one line; of many the first, and how many more."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def spectra_part(rows: Sequence[Mapping[str, Any]], file: str, asked: Asked, places: Places) -> str:
    """Sensors and a record for auto and cross spectra; the sensor's unit is what a density's is the square of."""
    lines: list[str] = []
    for row in rows[:_SHOWN]:
        quantity, unit = _root(row["unit"])
        name = str(row["channel"])
        lines += _sensor(name, quantity, unit, _place(name, places), known=row["unit"] is not None)
    names = [str(row["channel"]) for row in rows[:_SHOWN]]
    step = next((row["step_Hz"] for row in rows if row["step_Hz"]), 1.0)
    return "\n".join(
        [
            *lines,
            "# Densities by Hann's window; of several channels the cross spectra are needed, too.",
            "[[records]]",
            'name = "run"',
            f"file = {_quoted(file)}",
            'condition = ""                  # name of one of [[conditions]], of kind "train"',
            'statistic = "csd"',
            "averages = 0.0                  # independent ones: the file does not say it",
            f"segment_s = {1.0 / step:.9g}",
            *_hints(asked, {}),
            f"channels = {_table({name: name for name in names})}",
        ]
    )


def _root(unit: str | None) -> tuple[str, str]:
    """Quantity and unit of the sensor whose density has a unit; an acceleration where none has."""
    for quantity, units in UNITS.items():
        for name in units:
            try:
                if unit is not None and parse_unit(f"({name})^2/Hz").same(parse_unit(unit)):
                    return quantity, name
            except InputError:
                break
    return "acceleration", "m/s2"


def _place(label: str, places: Places) -> str:
    """Where on the body: the first coordinate of its node, where the file has it."""
    node = label.partition(":")[0]
    if not node.isdecimal() or int(node) not in places:
        return "x_m = 0.0                       # where on it"
    x, y, z = places[int(node)]
    return f"{f'x_m = {x:.9g}':<32}# of the file: node {node} at ({x:.9g}, {y:.9g}, {z:.9g}) m"


def _sensor(name: str, quantity: str, unit: str, place: str, *, known: bool) -> list[str]:
    return [
        "[[sensors]]",
        f"name = {_quoted(name)}",
        'body = ""                       # a body of the model; or degree = "car1.wheelset1"',
        place,
        f"quantity = {_quoted(quantity)}",
        f"unit = {_quoted(unit)}{'' if known else '                   # the file does not say it'}",
        "",
    ]


def _motion(unit: str | None) -> tuple[str, str] | None:
    """Quantity and unit of a sensor; an acceleration where the file states none. None if no sensor has it."""
    if unit is None:
        return "acceleration", "m/s2"
    try:
        found = parse_unit(unit)
    except InputError:
        return None
    for quantity, units in UNITS.items():
        for name in units:
            if parse_unit(name).same(found):
                return quantity, name
    return None


def _hints(asked: Asked, stated: Mapping[str, str]) -> list[str]:
    """Keys that were stated when the file was looked at."""
    lines = []
    keys = ("header_row", "skip_rows", "time_column", "decimal", "encoding")
    for key in keys:
        value = getattr(asked.hints, key)
        if value is not None:
            lines.append(f"{key} = {json.dumps(value)}")
    unit = asked.hints.unit
    if isinstance(unit, str):
        lines.append(f"unit = {_quoted(unit)}")
    elif unit or stated:
        lines.append(f"unit = {_table({**(unit or {}), **stated})}")
    if asked.hints.axes is not None:
        lines.append(f"axes = {json.dumps(list(asked.hints.axes))}")
    if asked.hints.pairs:
        pairs = ", ".join(f"{_quoted(key)} = {json.dumps(list(pair))}" for key, pair in asked.hints.pairs.items())
        lines.append(f"pairs = {{ {pairs} }}")
    if asked.part is not None:
        lines.append(f"part = {_quoted(asked.part)}")
    if asked.format is not None:
        lines.append(f"format = {_quoted(asked.format)}")
    return lines


def _table(pairs: Mapping[str, str]) -> str:
    return "{ " + ", ".join(f"{_quoted(key)} = {_quoted(value)}" for key, value in pairs.items()) + " }"


def _quoted(text: str) -> str:
    """A text as TOML quotes it, which is as JSON does."""
    return json.dumps(text, ensure_ascii=False)
