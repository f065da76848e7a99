"""What a file of recordings holds, as it is read here, and the part of a campaign file that would use it."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from permway.errors import InputError
from permway.recordings.look_campaign import Places, frf_part, spectra_part, time_part, unmeasured
from permway.recordings.readers.formats import recognise
from permway.recordings.readers.front import opened, read_frf, read_table
from permway.recordings.readers.hints import NO_HINTS, Hints
from permway.recordings.readers.limits import MOST_BYTES, existing_file
from permway.recordings.readers.timefile import TimeFile, Timing
from permway.recordings.readers.uff58_spectra import spectra_held
from permway.recordings.readers.uff_nodes import read_nodes
from permway.recordings.record import FrfRecord

MOST_SAMPLES = 2**20
"""Samples of a channel that are read to see whether they are sound: 8 MB, and seconds of text.

Half or twice of it halves or doubles the time that a look takes at long files; what lies beyond is read when it is
used.
"""

_HEADER_ROW = re.compile(r"header_row = (\d+)")


class _UntimedError(Exception):
    """When the samples of a channel were taken is not known."""


@dataclass(frozen=True)
class Asked:
    """What whoever looks knows of a file."""

    format: str | None = None
    part: str | None = None
    sampling_Hz: float | None = None
    hints: Hints = NO_HINTS


def look(path: str | Path, asked: Asked | None = None) -> dict[str, Any]:
    """Look at a file.

    Parameters
    ----------
    path : path
    asked : Asked, optional

    Returns
    -------
    dict
        `file` and `format`; `channels` of records in time, a dict each: channel, unit, samples, sampling_Hz,
        start_s, and `problem` where it cannot be used; `responses`: pairs, frequencies, unit, coherence;
        `spectra`: channel, unit and lines of each; or else `columns` of a table. `notes` are what was left aside;
        `missing` is what the campaign file has to state; `problems` why the file is not read as one of these;
        `campaign` is the part of a campaign file, in TOML.

    Raises
    ------
    InputError
        If it is no file, or of no format that is read.
    """
    asked = asked or Asked()
    source = existing_file(path)
    kind = recognise(source, asked.format, asked.hints.encoding)
    result: dict[str, Any] = {"file": str(source), "format": kind}
    problems: list[InputError] = []
    places: Places = {}
    if kind == "uff":
        try:
            places = read_nodes(source)
        except InputError as error:
            problems.append(error)
    if kind not in ("tdms", "wav", "lvm", "mdf"):
        try:
            record, known = _frf(source, asked)
        except InputError as error:
            problems.append(error)
        else:
            result |= _responses(record)
            result["campaign"] = frf_part(record, source.name, known, places)
    if not (kind == "text" and "responses" in result):
        try:
            result |= _in_time(source, asked, result.get("campaign", ""), places)
        except InputError as error:
            problems.append(error)
    if kind == "uff" and "channels" not in result and "responses" not in result:
        held = spectra_held(source, asked.hints)
        if held:
            return result | {"spectra": held, "campaign": spectra_part(held, source.name, asked, places)}
    if "channels" not in result and "responses" not in result:
        result |= _columns(source, asked)
        if kind == "text":
            # What a table lacks of responses helps where it is over frequency; else what a record in time lacks.
            names = [str(row["column"]).lower() for row in result.get("columns", ())]
            problems = problems[:1] if any(re.match(r"f(req|\b)", name) for name in names) else problems[-1:]
        result["problems"] = [str(error) for error in problems]
    result.setdefault("campaign", "")
    return result


def _frf(source: Path, asked: Asked) -> tuple[FrfRecord, Asked]:
    """Frequency responses; where lines stand above the table, with the header's line, which is stated."""

    def read(known: Asked) -> FrfRecord:
        return read_frf(source, format=known.format, part=known.part, hints=known.hints, keep_nonfinite=True)

    try:
        return read(asked), asked
    except InputError as error:
        found = _HEADER_ROW.search(error.remedy)
        if found is None or asked.hints.header_row is not None:
            raise
        known = replace(asked, hints=replace(asked.hints, header_row=int(found[1])))
        return read(known), known


def _responses(record: FrfRecord) -> dict[str, Any]:
    frequency = record.frequency_Hz
    bad = ~np.isfinite(record.values)
    step = float(np.diff(frequency).min()) if frequency.size > 1 else None
    return {
        "responses": {
            "pairs": len(record.responses),
            "missing": unmeasured(record),
            "read": list(dict.fromkeys(record.responses)),
            "struck": list(dict.fromkeys(record.references)),
            "from_Hz": float(frequency[0]),
            "to_Hz": float(frequency[-1]),
            "step_Hz": step,
            "unit": sorted({str(record.unit_of(row)) for row in range(len(record.responses))}),
            "coherence": record.coherence is not None,
            "averages": record.averages,
            "not_finite_Hz": [float(f) for f in frequency[bad.any(axis=0)][:12]],
        }
    }


def _in_time(source: Path, asked: Asked, before: str, places: Places) -> dict[str, Any]:
    """Channels of a record in time; where lines stand above the table, once more with the header's line."""
    try:
        return _channels(source, asked, before, places)
    except InputError as error:
        found = _HEADER_ROW.search(error.remedy)
        if found is None or asked.hints.header_row is not None:
            raise
        hints = replace(asked.hints, header_row=int(found[1]))
        found_so = _channels(source, replace(asked, hints=hints), before, places)
        return found_so | {"supposed": str(error)}


def _channels(source: Path, asked: Asked, before: str, places: Places) -> dict[str, Any]:
    rows: list[dict[str, Any]] = []
    missing: list[str] = []
    with opened(source, asked.format, asked.part, asked.hints, False, MOST_BYTES) as (file, _):
        for row in range(len(file.channels)):
            rows.append(_channel(file, row, asked))
        notes = list(file.notes)
        if file.times is not None:
            notes.append(f"times: {file.times}")
    usable = [row for row in rows if not row["problem"]]
    unstated = usable and asked.sampling_Hz is None and all(row["sampling_Hz"] is None for row in usable)
    if unstated and not any(row["fault"] for row in usable):
        missing.append("sampling_Hz: the file does not say the sampling rate")
    faults = [fault for fault in dict.fromkeys(row.pop("fault") for row in rows) if fault]
    missing += faults
    if any(row["unit"] is None for row in usable):
        missing.append("unit of the sensors: the file does not say the unit of every channel")
    part = time_part(rows, source.name, asked, faults, places)
    return {
        "channels": rows,
        "notes": notes,
        "missing": missing,
        "campaign": "\n".join(text for text in (before, part) if text),
    }


def _channel(file: TimeFile, row: int, asked: Asked) -> dict[str, Any]:
    """One channel: what it is, and why it cannot be used, if so."""
    name = file.channels[row]
    unit = asked.hints.channel_unit(name) or file.units[row]
    timing: Timing | None = None
    problem = fault = ""
    low = high = None
    try:
        timing = file.timing(row)
    except InputError as error:
        fault = str(error)
    try:
        if timing is None:
            raise _UntimedError
        fault = "" if timing.fault is None or asked.sampling_Hz is not None else str(timing.fault)
        if file.channels.count(name) > 1:
            problem = "another channel has this name, too"
        values = file.read([row], 0, min(timing.samples, MOST_SAMPLES))
        bad = int((~np.isfinite(values)).sum())
        if bad:
            problem = f"{bad} samples are missing or no finite numbers"
        elif values.size:
            low, high = float(values.min()), float(values.max())
    except _UntimedError:
        pass
    except InputError as error:
        problem = str(error)
    rate = asked.sampling_Hz or (None if timing is None or timing.fault is not None else timing.sampling_Hz)
    return {
        "channel": name,
        "unit": unit,
        "samples": None if timing is None else timing.samples,
        "sampling_Hz": rate,
        "start_s": None if timing is None else timing.start_s,
        "least": low,
        "most": high,
        "problem": problem,
        "fault": fault,
    }


def _columns(source: Path, asked: Asked) -> dict[str, Any]:
    """The columns of a table, if it is one."""
    try:
        table = read_table(source, format=asked.format, part=asked.part, hints=asked.hints)
    except InputError:
        return {}
    rows = [
        {
            "column": name,
            "unit": table.units[name],
            "rows": len(cells),
            "holds": "numbers" if isinstance(cells, np.ndarray) else "texts",
        }
        for name, cells in table.columns.items()
    ]
    return {"columns": rows}
