"""What fixed sensors read while axles pass: loads that move over the line, statically and dynamically.

The equation is that of :mod:`permway.response.passby.carry`. Speed, loads and times act on receptances that are
solved once. Axles with a suspension push harder or less hard where the line moves under them.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.fft import irfft

from permway.arrays import Complexes, Reals
from permway.campaign.campaign import Campaign
from permway.campaign.parts import Condition
from permway.campaign.passage import offset_m, path_under, points_of, spectrum_of
from permway.campaign.predictions.suspended import suspended
from permway.campaign.predictions.sweeps import Location, Request
from permway.errors import InputError
from permway.model.bodies import Beam
from permway.problem.model import Model
from permway.recordings.channel import Sensor
from permway.response.passby.carry import arrivals, carried, harmonic_moments
from permway.response.passby.path import Path
from permway.response.passby.transfer import STATIC_SHARE
from permway.response.passby.window import FLAT

SEAM, LATE = 0.01, (0.8, 0.9)
"""Largest motion late in the rest after the train, over the largest of all, and where in the rest that is."""

RIGID = 5.0
"""Growth of the response from the first frequency down to its share, above which nothing holds the line."""


def request(
    campaign: Campaign, condition: Condition, names: list[str], temperature_C: float | None, data: xr.Dataset
) -> Request:
    """The receptances from every place of the path to every point that is read."""
    sensors = [campaign.sensor(name) for name in names]
    for sensor in sensors:
        if sensor.bends:
            _beam(campaign.model, sensor)
    path = path_under(campaign.model, condition, sensors, _highest(data))
    rows = dict.fromkeys((str(s.body), x) for s in sensors for x in points_of(campaign.model, s))
    columns = tuple((path.body, float(x)) for x in path.nodes.ravel())
    if condition.axles is not None and condition.axles.suspension is not None:
        rows |= dict.fromkeys(columns)
    frequency = _lines(data)
    frequency[0] = STATIC_SHARE * frequency[1]
    return Request(temperature_C, frequency, tuple(rows), columns)


def predicted(
    campaign: Campaign,
    condition: Condition,
    names: list[str],
    data: xr.Dataset,
    request: Request,
    receptance: Complexes,
) -> tuple[Complexes, float]:
    """Spectra as :func:`permway.campaign.passage.passage` gives them, (channel, frequency).

    Beside them the largest motion where the periodic window begins anew, over the largest of all: see
    :func:`check_seam`.

    Raises
    ------
    InputError
        For a line that nothing holds, a sensor whose beam does not bend as Euler's does.
    """
    sensors = [campaign.sensor(name) for name in names]
    path = path_under(campaign.model, condition, sensors, _highest(data))
    if np.abs(receptance[0]).max() > RIGID * np.abs(receptance[1]).max():
        raise InputError("nothing holds the line at rest", where="line", remedy="hold it, or give from_m and to_m")
    held = receptance.copy()
    held[0] = held[0].real
    frequency = _lines(data)
    read = _read(campaign.model, sensors, request.rows)
    moments = _moments(condition, path, frequency, request, held)
    spectrum, _ = carried(path.coefficients(np.einsum("sr,frp->fsp", read, held)), moments)
    share = np.arange(frequency.size) / max(frequency.size - 1, 1)
    low_pass = 0.5 * (1.0 + np.cos(np.pi * np.clip((share - FLAT) / (1.0 - FLAT), 0.0, 1.0)))
    turned = spectrum.T * low_pass * np.stack([s.transfer(frequency) for s in sensors])
    return _recorded(turned, frequency, condition, path, data)


def _highest(data: xr.Dataset) -> float:
    return float(data["frequency"].values[-1])


def _lines(data: xr.Dataset) -> Reals:
    """Of the periodic window from 0 Hz, kept whole up to the record's last line."""
    step = data.attrs["sampling_Hz"] / data.attrs["window_samples"]
    count = int(np.ceil(_highest(data) / FLAT / step)) + 1
    return np.asarray(np.arange(count) * step, dtype=np.float64)


def _read(model: Model, sensors: list[Sensor], rows: tuple[Location, ...]) -> Complexes:
    """What sensors read of the displacements at the points, (sensors, points), but for derivatives in time."""
    found = np.zeros((len(sensors), len(rows)), dtype=np.complex128)
    for index, sensor in enumerate(sensors):
        places = [rows.index((str(sensor.body), x)) for x in points_of(model, sensor)]
        if not sensor.bends:
            found[index, places[0]] = 1.0
            continue
        bent = np.array([1.0, -2.0, 1.0]) / offset_m(model, sensor) ** 2
        size = -sensor.height_m if sensor.height_m is not None else -_bending(model, sensor)
        found[index, places] = size * bent
    return found


def _bending(model: Model, sensor: Sensor) -> complex:
    """Bending stiffness where a sensor is, N m2."""
    x = float(sensor.x_m or 0.0)
    beam = _beam(model, sensor)
    factors = [c.bending_factor for c in beam.changes if c.from_m <= x <= c.to_m]
    return beam.bending_Nm2 * (factors[0] if factors else 1.0)


def _beam(model: Model, sensor: Sensor) -> Beam:
    where = f"sensors.{sensor.name}.body"
    segment = model.line.segments()[model.line.locate(str(sensor.body), float(sensor.x_m or 0.0), where=where)]
    beam = model.line.bodies[segment.body]
    if not isinstance(beam, Beam):
        raise InputError("only beams bend", where=where, value=sensor.body)
    if beam.theory != "euler":
        what = "strain and bending moment are read of Euler beams: of others shear bends the axis, too"
        raise InputError(what, where=where, value=sensor.body, remedy='take theory = "euler"')
    return beam


def check_seam(record: str, data: xr.Dataset, seam: float) -> None:
    """Refuse a prediction whose window does not hold what the line does after the train.

    Raises
    ------
    InputError
        With the length that may hold it.
    """
    window = data.attrs["window_samples"] / data.attrs["sampling_Hz"]
    if seam > SEAM:
        raise InputError(
            f"the line still moves where the window of {window:.3g} s ends, by {seam:.2g} of its largest value",
            where=f"records.{record}.window_s",
            remedy=f"give it {2.0 * window:.3g}, so that the line comes to rest after the train",
        )


def _moments(
    condition: Condition, path: Path, frequency_Hz: Reals, request: Request, receptance: Complexes
) -> Complexes:
    """Of all loads on the clock of the records, (F, panels, order)."""
    axles, speed = condition.axles, condition.speed_m_per_s
    assert axles is not None
    assert speed is not None
    omega = 2.0 * np.pi * frequency_Hz
    sign = 1.0 if axles.direction == "forward" else -1.0
    # Along -x the same integral over x, whose element is then negative.
    moments = sign * harmonic_moments(path, omega, sign * speed)
    loads = arrivals(omega, axles.loads, axles.arrivals_s(speed, path.start, path.stop))
    found = moments * loads[:, None, None]
    if axles.suspension is None:
        return np.asarray(found)
    nodes = [request.rows.index((path.body, float(x))) for x in path.nodes.ravel()]
    return suspended(axles, speed, path, frequency_Hz, path.coefficients(receptance[:, nodes]), found)


def _recorded(
    spectrum: Complexes, frequency_Hz: Reals, condition: Condition, path: Path, data: xr.Dataset
) -> tuple[Complexes, float]:
    """From spectra over the periodic window to those of the record, faded as it is; and the motion at the seam."""
    axles, speed = condition.axles, condition.speed_m_per_s
    assert axles is not None
    assert speed is not None
    rate, window = float(data.attrs["sampling_Hz"]), int(data.attrs["window_samples"])
    start, samples = float(data.attrs["start_s"]), int(data.attrs["samples"])
    whole = np.zeros((spectrum.shape[0], window // 2 + 1), dtype=np.complex128)
    whole[:, : frequency_Hz.size] = spectrum * np.exp(2j * np.pi * frequency_Hz * start)
    history = np.asarray(irfft(whole, n=window, axis=-1) * rate)
    crossing = (path.stop - path.start + axles.lags_m[-1]) / speed
    last = max(start + samples / rate, axles.entry_s + crossing)
    rest = window / rate - (last - min(start, axles.entry_s))
    # Late in the rest, and not at its end: laws of constant loss answer a little before they are asked.
    late = (last - start + rest * np.array(LATE)) * rate
    left = np.abs(history[:, np.arange(*late.astype(np.int64)) % window]).max(axis=1, initial=0.0)
    level = float((left / np.maximum(np.abs(history).max(axis=1), 1e-300)).max())
    lines = spectrum_of(history[:, :samples], rate)
    number = np.round(data["frequency"].values * samples / rate).astype(np.int64)
    return np.asarray(lines[:, number]), level
