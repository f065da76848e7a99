"""Hammer tests and runs of a plan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from permway.challenge.beams import Complexes, Reals
from permway.challenge.contact import TAPER_HZ
from permway.challenge.errors_of_measurement import calibration_error, struck
from permway.challenge.irregularity import deviation, profile
from permway.challenge.mesh import Mesh
from permway.challenge.plan import FLOOR, Plan
from permway.challenge.rolling import rolled
from permway.challenge.track import Location
from permway.challenge.under_train import Ridden
from permway.challenge.vehicle import wheel_load

GRID_HZ = ((0.25, 0.125), (24.0, 0.25), (40.0, 0.5), (100.0, 1.0))
"""Where the track is solved: from, step. Between the lines its receptance, which holds no lag, is smooth."""

TOP_HZ = 466.0

WIDE_HZ = np.arange(470.0, TAPER_HZ[1] + 8.0, 8.0)
"""Further lines, where wheels may leave the rail."""

FILTER_HZ = (412.0, 462.0)
"""Where the recorder's filter goes from one to nothing."""

SLOW_HZ = (0.25, 0.75)
"""Where its high-pass goes from nothing to one."""

SHARE = {"sensor": 0.8, "point": 0.6}
"""Of the calibration errors; the squares add to one."""


@dataclass(frozen=True)
class HammerTest:
    """H1 accelerance and coherence, (F, sensors, points)."""

    temperature_C: float
    frequency_Hz: Reals
    frf: Complexes
    coherence: Reals


@dataclass(frozen=True)
class Run:
    """Accelerations on board, (N, channels), m/s2."""

    speed_kmh: float
    sampling_Hz: float
    channels: tuple[str, ...]
    values: Reals


def measure(plan: Plan, random: np.random.Generator) -> tuple[list[HammerTest], list[Run]]:
    """All hammer tests, and all runs at the first of their temperatures."""
    tests = plan.tests
    start, stop, step = tests.lines_Hz
    lines = np.asarray(np.arange(start, stop + 0.5 * step, step))
    wheels: list[Location] = [("rail", x) for x in plan.layout.wheels_m(plan.values["vehicle"])]
    rows = list(dict.fromkeys([*tests.sensors, *wheels]))
    columns = list(dict.fromkeys([*tests.points, *wheels]))
    mesh = Mesh(plan.track, [*rows, *columns])
    wide = WIDE_HZ if plan.vehicle.hertz is not None else WIDE_HZ[:0]
    grid = np.unique(np.concatenate([_grid(), lines, wide]))
    hammers = []
    under = np.empty(0, dtype=np.complex128)
    errors = _errors(plan, random, lines)
    for index, written in enumerate(tests.temperatures_C):
        at = grid if index == 0 else lines
        displaced = mesh.receptance(at, written + plan.chain.warmer_C[index], rows, columns)
        if index == 0:
            r, c = ([names.index(wheel) for wheel in wheels] for names in (rows, columns))
            under = displaced[:, r][:, :, c]
        rates = displaced[np.searchsorted(at, lines)] * -((2.0 * np.pi * lines[:, None, None]) ** 2)
        r = [rows.index(location) for location in tests.sensors]
        c = [columns.index(location) for location in tests.points]
        hammers.append(_hammer(plan, random, written, lines, rates[:, r][:, :, c] * errors))
    off_dB = deviation(random)
    samples = round(tests.seconds * tests.sampling_Hz)
    frequency = np.asarray(np.fft.rfftfreq(samples, 1.0 / tests.sampling_Hz), dtype=np.float64)
    chains = [_calibration_error(plan, random, frequency, "sensor") for _ in tests.channels]
    under_wheels = (grid, under)
    runs = [
        _run(plan, random, index, np.column_stack(chains), off_dB, under_wheels)
        for index in range(len(tests.speeds_kmh))
    ]
    return hammers, runs


def _calibration_error(plan: Plan, random: np.random.Generator, frequency_Hz: Reals, of: str) -> Complexes:
    """The calibration error of one chain, which it has in all tests."""
    if plan.chain.clean:
        return np.ones(frequency_Hz.size, dtype=np.complex128)
    return calibration_error(random, frequency_Hz, size_dB=plan.chain.calibration_dB * SHARE[of])


def _errors(plan: Plan, random: np.random.Generator, lines: Reals) -> Complexes:
    """Of all pairs of a hammer test, (F, sensors, points)."""
    sensors = np.column_stack([_calibration_error(plan, random, lines, "sensor") for _ in plan.tests.sensors])
    points = np.column_stack([_calibration_error(plan, random, lines, "point") for _ in plan.tests.points])
    return np.asarray(sensors[:, :, None] * points[:, None, :])


def _grid() -> Reals:
    ends = [start for start, _ in GRID_HZ[1:]] + [TOP_HZ + 0.5]
    return np.concatenate([np.arange(start, end, step) for (start, step), end in zip(GRID_HZ, ends, strict=True)])


def _hammer(
    plan: Plan, random: np.random.Generator, written_C: float, lines: Reals, response: Complexes
) -> HammerTest:
    tests, chain = plan.tests, plan.chain
    for index, location in enumerate(tests.sensors):
        response[:, index] *= plan.gain_of(plan.line_gain.get(location, []), lines)[:, None]
    if chain.clean:
        return HammerTest(written_C, lines, response, np.ones(response.shape))
    # Ground unrest below, and a hammer that loses force above.
    tint = np.sqrt(1.0 + (6.0 / lines) ** 2) * np.sqrt(1.0 + (lines / 350.0) ** 2)
    each = np.array([plan.line_noise.get(location, 1.0) for location in tests.sensors])
    each = each * np.exp(0.3 * random.standard_normal(each.size)) * chain.noise
    frf, coherence = struck(random, response, tint[:, None] * each, blows=tests.blows)
    return HammerTest(written_C, lines, frf, coherence)


def _run(
    plan: Plan,
    random: np.random.Generator,
    index: int,
    errors: Complexes,
    off_dB: Callable[[Reals], Reals],
    under_wheels: tuple[Reals, Complexes],
) -> Run:
    tests, chain = plan.tests, plan.chain
    written = tests.speeds_kmh[index]
    speed = written / 3.6 * plan.speed_factor[index]
    samples = round(tests.seconds * tests.sampling_Hz)
    times = np.arange(samples) / tests.sampling_Hz
    frequency = np.asarray(np.fft.rfftfreq(samples, 1.0 / tests.sampling_Hz), dtype=np.float64)
    kept = (frequency >= SLOW_HZ[0]) & (frequency < FILTER_HZ[1])
    lines = frequency[kept]
    met = profile(random, off_dB, samples=samples, sampling_Hz=tests.sampling_Hz, speed=speed)
    met[~kept] = 0.0
    for shape in plan.shapes:
        met[kept] *= shape(lines, speed)
    if plan.rolls:
        rates = rolled(plan, met, speed, samples=samples, sampling_Hz=tests.sampling_Hz)[kept]
        rates = rates * _window(lines)[:, None]
    else:
        displaced = _stood(plan, met[kept], lines, np.flatnonzero(kept), times, speed, under_wheels)
        rates = displaced * (-((2.0 * np.pi * lines) ** 2) * _window(lines))[:, None]
    names = list(plan.vehicle.channels)
    spectrum = np.zeros((frequency.size, len(tests.channels)), dtype=np.complex128)
    for column, channel in enumerate(tests.channels):
        gain = plan.gain_of(plan.channel_gain.get(channel, []), lines) * errors[kept, column]
        spectrum[kept, column] = rates[:, names.index(channel)] * gain
    values = np.fft.irfft(spectrum, n=samples, axis=0)
    for column, channel in enumerate(tests.channels):
        for hum in plan.hums:
            values[:, column] += hum(channel, times)
        if not chain.clean:
            size = np.sqrt(0.5 * FLOOR * tests.sampling_Hz) * plan.channel_noise.get(channel, 1.0)
            values[:, column] += size * random.standard_normal(samples)
        for recorder in plan.recorders:
            values[:, column] = recorder(channel, values[:, column])
    return Run(written, tests.sampling_Hz, tests.channels, values)


def _stood(
    plan: Plan,
    met: Complexes,
    lines: Reals,
    bins: NDArray[np.int64],
    times: Reals,
    speed: float,
    under_wheels: tuple[Reals, Complexes],
) -> Complexes:
    """What channels move while the train stands and the profile moves, (L, channels)."""
    wheels = np.array(plan.layout.wheels_m(plan.values["vehicle"]))
    late = np.exp(-2j * np.pi * lines[:, None] * (wheels[0] - wheels) / speed)
    profiles = met[:, None] * late
    for extra in plan.wheel_profiles:
        profiles = profiles + np.fft.rfft(extra(times, speed), axis=1)[:, bins].T
    under = CubicSpline(*_as_ridden(plan, under_wheels, lines, profiles, times.size))
    profiles = plan.vehicle.leaving(lines, under, profiles, samples=times.size)
    return plan.vehicle.respond(lines, under(lines), profiles, bins=bins, samples=times.size)


def _as_ridden(
    plan: Plan, under_wheels: tuple[Reals, Complexes], lines: Reals, profiles: Complexes, samples: int
) -> tuple[Reals, Complexes]:
    """Grid and receptance under the wheels, the supports as this run finds them."""
    grid, _ = under_wheels
    if not plan.supports:
        return under_wheels
    wheels: list[Location] = [("rail", x) for x in plan.layout.wheels_m(plan.values["vehicle"])]
    temperature = plan.tests.temperatures_C[0] + plan.chain.warmer_C[0]
    ridden = Ridden(plan.track, wheels, plan.vehicle, wheel_load(plan.values), temperature)
    return grid, ridden.receptance(plan.supports, grid, lines_Hz=lines, profiles=profiles, samples=samples)


def _window(frequency_Hz: Reals) -> Reals:
    """The recorder's high-pass and filter: raised cosines, without phase."""
    rise = np.clip((frequency_Hz - SLOW_HZ[0]) / (SLOW_HZ[1] - SLOW_HZ[0]), 0.0, 1.0)
    fall = np.clip((FILTER_HZ[1] - frequency_Hz) / (FILTER_HZ[1] - FILTER_HZ[0]), 0.0, 1.0)
    return np.asarray(0.25 * (1.0 - np.cos(np.pi * rise)) * (1.0 - np.cos(np.pi * fall)))
