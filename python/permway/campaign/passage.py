"""Records of a train that passes fixed sensors: histories, as their spectra over the whole record."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from scipy import signal
from scipy.fft import next_fast_len

from permway.arrays import Complexes, Reals
from permway.campaign.parts import Condition, Record
from permway.errors import InputError, SolveError
from permway.model.place import Place
from permway.problem.model import Model
from permway.recordings.channel import Sensor
from permway.response.modes import poles_between
from permway.response.passby.path import Path, path_of
from permway.response.passby.window import FLAT
from permway.response.receptance import frequency_coordinate

if TYPE_CHECKING:
    from permway.campaign.campaign import Campaign

TAPERED = 0.05
"""Share of the record at either end over which it is faded, so that a train cut off does not ring."""

QUIET, FEWEST_QUIET = 0.9, 50
"""Share of the time before the train enters that states the noise, and of how many samples at least."""

AFTER, LEAST_S, MOST_S = 1.0, 4.0, 120.0
"""Times the passage that the line has after it to come to rest, and seconds at least and at most."""

DECAYS = 6.0
"""Times the slowest mode, and the bounce of axles, fall by e in that rest, to a 400th: unless `window_s` states
how long it is."""

LOWEST = 0.02
"""Share of the highest frequency from which modes are looked for."""

ORDER = 6
"""Polynomials of x between two supports."""

OFFSET_M = 1e-3
"""Distance of three points that show how a beam is bent, over its length; of one without end over 10 m."""

SI = {
    "displacement": "m",
    "velocity": "m/s",
    "acceleration": "m/s2",
    "strain": "1",
    "bending_moment": "N m",
}


def passage(campaign: Campaign, record: Record) -> xr.Dataset:
    """The spectra of a record over the lines of its band.

    Returns
    -------
    xarray.Dataset
        `spectrum` (channel, frequency), integral of the faded history times exp(-i omega t) dt, SI s;
        `noise_sd`, of its real and of its imaginary part; attributes `samples`, `sampling_Hz`, `start_s`, and
        `window_samples`, over which the prediction is periodic.

    Raises
    ------
    InputError
        For a record without a rate, in several blocks, sampled too slowly for its band; for noise that nothing
        states.
    """
    condition = campaign.condition(record.condition)
    names = list(record.channels.values())
    sensors = [campaign.sensor(name) for name in names]
    values, rate, start = _history(campaign, record, sensors)
    assert record.band_Hz is not None
    low, high = record.band_Hz
    if high > 0.5 * FLAT * rate:
        what = f"reaches beyond {0.5 * FLAT * rate:g} Hz, which samples at {rate:g} Hz hold"
        raise InputError(what, where="band_Hz", value=high, remedy="take a lower band")
    frequency = np.arange(values.shape[1] // 2 + 1) * rate / values.shape[1]
    used = (frequency > 0.0) & (frequency >= low) & (frequency <= high)
    if used.sum() < 3:
        what = f"holds {used.sum()} lines of {rate / values.shape[1]:.3g} Hz"
        raise InputError(what, where="band_Hz", value=(low, high), remedy="take a wider band or a longer record")
    axles, speed = condition.axles, condition.speed_m_per_s
    assert axles is not None
    assert speed is not None
    path = path_under(campaign.model, condition, sensors, high)
    crossing = (path.stop - path.start + axles.lags_m[-1]) / speed
    stop = start + values.shape[1] / rate
    leaves = axles.entry_s + crossing
    if axles.entry_s >= stop or leaves <= start:
        what = f"the train is on the stretch from {axles.entry_s:.3g} to {leaves:.3g} s, and the record is over"
        raise InputError(what, where="axles.entry_s", value=(start, stop), remedy="count from its first sample")
    rest = max(AFTER * crossing, _decay_s(campaign.model, condition, sensors, high))
    if axles.suspension is not None:
        rest = max(rest, min(DECAYS / axles.suspension.decay_per_s(axles.loads), MOST_S))
    rest = rest if record.window_s is None else 0.0
    reach = max(stop, leaves + rest) - min(start, axles.entry_s)
    if record.window_s is not None:
        if record.window_s < reach:
            what = f"is shorter than record and passage together, {reach:.4g} s"
            raise InputError(what, where="window_s", value=record.window_s)
        reach = record.window_s
    lines = spectrum_of(values, rate)[:, used]
    noise = np.stack(
        [_noise(s, v, rate, start, axles.entry_s, frequency[used]) for s, v in zip(sensors, values, strict=True)]
    )
    data = xr.Dataset(
        {
            "spectrum": (("channel", "frequency"), lines),
            "noise_sd": (("channel", "frequency"), noise),
        },
        coords={"frequency": frequency_coordinate(frequency[used]), "channel": names},
        attrs={
            "samples": int(values.shape[1]),
            "sampling_Hz": float(rate),
            "start_s": float(start),
            "window_samples": int(next_fast_len(int(np.ceil(reach * rate)), real=True)),
        },
    )
    data["spectrum"].attrs = {"long_name": "spectrum of the passage", "units": "SI s"}
    data["noise_sd"].attrs = {"long_name": "standard deviation by noise, of each part", "units": "SI s"}
    return data


def _decay_s(model: Model, condition: Condition, sensors: list[Sensor], highest_Hz: float) -> float:
    """How long the line's slowest mode of the band takes to decay, s; the least where it has none."""
    locations = dict.fromkeys((str(s.body), float(s.x_m or 0.0)) for s in sensors)
    temperature = model.temperature_C if condition.temperature_C is None else condition.temperature_C
    try:
        found = poles_between(
            model.line,
            LOWEST * highest_Hz,
            highest_Hz,
            places=[Place(body=body, x_m=x) for body, x in locations],
            temperature_C=temperature,
            formulation=model.formulation,
        )
    except (SolveError, InputError):
        # An endless track has none; whether the window holds the decay is seen of the prediction.
        return LEAST_S
    slowest = float(found.omega.imag.min(initial=np.inf))
    return min(max(DECAYS / max(slowest, 1e-9), LEAST_S), MOST_S)


def path_under(model: Model, condition: Condition, sensors: list[Sensor], highest_Hz: float) -> Path:
    """Where the axles run, panels ending at every point that is read.

    Loads come on at once where a body begins, and not over a ramp, unless the condition states otherwise.
    """
    axles = condition.axles
    assert axles is not None
    ramp = axles.ramp_m
    ends = [s for _, s in model.line.beams() if axles.body in (s.body, s.name)]
    if ramp is None and axles.from_m is None and axles.to_m is None and ends:
        low, high = min(s.start for s in ends), max(s.stop for s in ends)
        ramp = 0.0 if np.isfinite(low) and np.isfinite(high) else None
    return path_of(
        model.line,
        axles.body,
        from_m=axles.from_m,
        to_m=axles.to_m,
        ramp_m=ramp,
        highest_Hz=highest_Hz / FLAT,
        order=ORDER,
        kinks_m=tuple(x for sensor in sensors for x in points_of(model, sensor)),
    )


def points_of(model: Model, sensor: Sensor) -> tuple[float, ...]:
    """Where displacement states what a sensor reads: there, or of a bent beam at three points about it."""
    x = float(sensor.x_m or 0.0)
    if not sensor.bends:
        return (x,)
    h = offset_m(model, sensor)
    return x - h, x, x + h


def offset_m(model: Model, sensor: Sensor) -> float:
    """Distance of the three points about a sensor of strain or bending moment.

    Raises
    ------
    InputError
        For a place too close to an end of the beam.
    """
    where = f"sensors.{sensor.name}.x_m"
    x = float(sensor.x_m or 0.0)
    segment = model.line.segments()[model.line.locate(str(sensor.body), x, where=where)]
    length = segment.stop - segment.start
    h = OFFSET_M * (length if np.isfinite(length) else 10.0)
    if not segment.start + h <= x <= segment.stop - h:
        what = f"a beam's bending is read {h:g} m and more from its ends"
        raise InputError(what, where=where, value=x)
    return h


def spectrum_of(values: Reals, sampling_Hz: float) -> Complexes:
    """Integral of faded histories times exp(-i omega t) dt from their first sample on, (channel, frequency)."""
    window = signal.windows.tukey(values.shape[1], 2.0 * TAPERED)
    return np.asarray(np.fft.rfft(values * window, axis=-1) / sampling_Hz)


def _history(campaign: Campaign, record: Record, sensors: list[Sensor]) -> tuple[Reals, float, float]:
    """Samples in SI, rate, and time of the first."""
    blocks = list(campaign.samples(record))
    if not blocks:
        raise InputError("holds no samples", where=record.file)
    rate = blocks[0].sampling_Hz
    if rate is None:
        remedy = "give it in the record"
        raise InputError("missing: the file does not say it", where="sampling_Hz", remedy=remedy)
    rows = [blocks[0].index(label) for label in record.channels]
    values = np.concatenate([block.values[rows] for block in blocks], axis=1)
    scale = np.array([sensor.to_SI for sensor in sensors])[:, None]
    return values * scale, rate, blocks[0].start_s or 0.0


def _noise(sensor: Sensor, values: Reals, rate: float, start: float, entry: float, frequency: Reals) -> Reals:
    """Standard deviation of the real part of every line: as the sensor states its noise, or as it is at rest."""
    if sensor.noise_density > 0.0 or sensor.chain.noise_flicker > 0.0:
        density = sensor.noise(frequency)
    else:
        quiet = int(QUIET * (entry - start) * rate)
        if quiet < FEWEST_QUIET:
            raise InputError(
                "nothing states the noise: the record does not begin long enough before the train",
                where=f"sensors.{sensor.name}.chain.noise_floor",
                remedy="state it, as unit squared per hertz",
            )
        density = np.full(frequency.size, 2.0 * float(np.var(signal.detrend(values[:quiet]))) / rate)
    window = signal.windows.tukey(values.size, 2.0 * TAPERED)
    return np.asarray(np.sqrt(0.25 * density * float((window**2).sum()) / rate))
