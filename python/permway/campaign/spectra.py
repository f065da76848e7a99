"""Spectra that another program estimated, as a record of a run: densities, averages, and the lines they have."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from permway.campaign.parts import Record
from permway.errors import InputError
from permway.recordings.channel import Sensor
from permway.recordings.estimates.welch import spectra_dataset
from permway.recordings.estimates.windows import segments
from permway.recordings.readers.formats import recognise
from permway.recordings.readers.limits import existing_file, foreign
from permway.recordings.readers.timefile import check_unit
from permway.recordings.readers.uff58_spectra import SpectraRecord, read_spectra
from permway.units import parse_unit

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign

_STEP_OFF = 1e-3
"""How far lines may lie apart from 1/segment_s, relative: frequencies are printed with few digits."""


def from_file(campaign: Campaign, record: Record) -> xr.Dataset:
    """Cross spectra as :func:`permway.recordings.estimates.welch.cross_spectra` gives them, in the sensors' units.

    Raises
    ------
    InputError
        For a file of another format; for spectra that are not stated to be densities, or of another unit than the
        sensors squared per hertz; for lines that `segment_s` does not set apart.
    """
    path = existing_file(campaign.path(record))
    kind = recognise(path, record.format, record.encoding)
    if kind != "uff":
        what = "spectra are read from universal files only, and averages say that it holds spectra"
        raise InputError(what, where=record.file, value=kind, remedy="leave averages out for a record in time")
    sensors = [campaign.sensor(name) for name in record.channels.values()]
    with foreign(path, kind):
        file = read_spectra(path, list(record.channels), hints=record.hints)
    for row, sensor in enumerate(sensors):
        _check_density(file, row, sensor, record)
    step = _step(file, record)
    assert record.averages is not None
    count = max(round(record.averages), 1)
    first = round(float(file.frequency_Hz[0]) / step)
    lines = first + file.frequency_Hz.size
    length = 2 * (lines - 1)
    rate = length * step
    layout = segments(count * length, sampling_Hz=rate, segment_s=1.0 / step, overlap=0.0)
    csd = np.zeros((*file.csd.shape[:2], lines), dtype=np.complex128)
    csd[:, :, first:] = file.csd
    data = spectra_dataset(
        csd,
        layout=layout,
        sampling_Hz=rate,
        detrended=False,
        channels=[sensor.name for sensor in sensors],
        units=[sensor.unit for sensor in sensors],
        window="hann",
        duration_s=record.averages / step,
    )
    # Averages need not be a whole number.
    data["degrees_of_freedom"] = data["degrees_of_freedom"] * (record.averages / count)
    data["line_covariance"] = data["line_covariance"] * (count / record.averages)
    return data.isel(frequency=slice(first, None)).assign_attrs(averages=float(record.averages))


def _check_density(file: SpectraRecord, row: int, sensor: Sensor, record: Record) -> None:
    name = file.channels[row]
    where = f"{record.file}: channel '{name}'"
    stated = record.hints.channel_unit(name)
    found = stated or file.units[row]
    reported = f"({sensor.unit})^2/Hz"
    if found is None and file.plain[row]:
        return
    try:
        density = found is not None and parse_unit(found).dimension == parse_unit(reported).dimension
    except InputError:
        density = False
    if not density:
        raise InputError(
            "whether these are densities is not stated: a power of each line, its root and a density differ",
            where=where,
            value=found,
            remedy=f'if they are one-sided densities, say so in the record: unit = {{ "{name}" = "{reported}" }}',
        )
    assert found is not None
    check_unit(found, reported, where, name, stated is not None)


def _step(file: SpectraRecord, record: Record) -> float:
    """Distance of the lines, Hz, which must be 1/segment_s; they must begin at a whole number of it."""
    frequency = file.frequency_Hz
    if frequency.size < 2:
        raise InputError("a spectrum has two lines at least", where=record.file, value=frequency.size)
    steps = np.diff(frequency)
    step = float(np.mean(steps))
    if np.any(np.abs(steps / step - 1.0) > 10 * _STEP_OFF):
        raise InputError("the lines of a spectrum must lie evenly", where=record.file, value=float(steps.max()))
    if abs(step * record.segment_s - 1.0) > _STEP_OFF:
        raise InputError(
            f"lines {step:.6g} Hz apart, and segment_s means {1.0 / record.segment_s:.6g} Hz",
            where=record.file,
            value=record.segment_s,
            remedy=f"say segment_s = {1.0 / step:.6g} if the segments were so long (with Hann's window)",
        )
    first = frequency[0] * record.segment_s
    if abs(first - round(first)) > 0.01:
        raise InputError("the first line lies between two", where=record.file, value=float(frequency[0]))
    return 1.0 / record.segment_s
