"""Densities of what excites a train, on a record's fine grid, and of the hum that its channels pick up."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from scipy.special import ndtr

from permway.arrays import Reals
from permway.campaign.excitation import Push, TrackLines, WheelLines
from permway.campaign.parts import Condition, IrregularityKnown
from permway.campaign.predictions.grid import Grid
from permway.errors import InputError
from permway.model.irregularity import AnyIrregularity, Conversion
from permway.model.irregularity_spectra import RangeWarning
from permway.problem.model import Model
from permway.recordings.channel import Sensor

REACH_WIDTHS = 5.0
"""Standard deviations beyond which a broadened line has no power."""


def profile(model: Model, known: IrregularityKnown, condition: Condition, grid: Grid) -> Reals:
    """One-sided density of the profile that all wheels meet, m2/Hz, shape (N,).

    Raises
    ------
    InputError
        If the model has no irregularity.
    """
    return broad(model, known, condition, grid.frequency_Hz) + series(known, condition, grid)


def series(known: IrregularityKnown, condition: Condition, grid: Grid) -> Reals:
    """What lines of the profile add to its density, m2/Hz, (N,)."""
    speed = speed_of(condition)
    found = np.zeros(grid.frequency_Hz.size)
    for one in known.series:
        found = found + lines(grid, speed / one.length_m, one)
    return found


def broad(model: Model, known: IrregularityKnown, condition: Condition, frequency: Reals) -> Reals:
    """The same without its lines, at any frequencies (N,) above zero.

    Raises
    ------
    InputError
        If the model has no irregularity.
    """
    if model.irregularity is None:
        raise InputError(
            "the model has no irregularity", where="irregularity", remedy="name one in the model file"
        )
    speed = speed_of(condition)
    values = _spectrum(model.irregularity, model.conversion, speed, frequency.tobytes())
    level = known.level_dB + known.level_by_condition_dB.get(condition.name, 0.0)
    if known.slope_dB_per_octave:
        octaves = np.log2(2.0 * np.pi * frequency / speed)
        values = values * 10.0 ** (0.1 * (level + known.slope_dB_per_octave * octaves))
    else:
        values = values * 10.0 ** (0.1 * level)
    if known.shape_dB:
        values = values * 10.0 ** (0.1 * known.shape_at(speed / frequency))
    for band in known.bands:
        x = np.log2(speed / frequency / band.wavelength_m) / band.octaves
        values = values * (1.0 + (10.0 ** (0.1 * band.gain_dB) - 1.0) * np.exp(-0.5 * x**2))
    for dips in known.dips:
        values = values + 2.0 * np.pi / speed * dips.density(2.0 * np.pi * frequency / speed)
    if known.contact_patch_m:
        across = 2.0 * np.pi * frequency / speed * known.contact_patch_m
        values = values / (1.0 + 0.25 * np.pi * across**3)
    return np.asarray(values)


@lru_cache(maxsize=48)
def _spectrum(irregularity: AnyIrregularity, conversion: Conversion, speed: float, fine: bytes) -> Reals:
    with warnings.catch_warnings():
        # Stated when the model is solved; a recalibration would say it a thousand times.
        warnings.simplefilter("ignore", RangeWarning)
        values = irregularity.density(np.frombuffer(fine), speed, conversion)
    values.flags.writeable = False
    return values


def wheels(
    known: IrregularityKnown, condition: Condition, count: int, grid: Grid
) -> Iterator[tuple[Sequence[int], Reals]]:
    """Wheels by index, and the density of what each of them for itself adds to the profile, m2/Hz, (N,)."""
    turns = speed_of(condition) / (2.0 * np.pi * known.wheel_radius_m)
    for one in known.wheels:
        yield (
            range(count) if one.wheel is None else (one.wheel - 1,),
            lines(grid, one.order * turns, one),
        )


def push(source: Push, frequency_Hz: Reals) -> Reals:
    """One-sided density of a force, N2/Hz, shape of the frequencies."""
    shape = np.ones_like(frequency_Hz)
    if source.centre_Hz is not None and source.quality is not None:
        # 1 at the centre; 0 Hz, where a division by the frequency would fail, is nothing.
        ratio = frequency_Hz / source.centre_Hz
        shape = ratio**2 / (ratio**2 + (source.quality * (1.0 - ratio**2)) ** 2)
    elif source.centre_Hz is not None:
        shape = np.exp(-0.5 * (np.log2(frequency_Hz / source.centre_Hz) / source.octaves) ** 2)
    return source.density_N2_per_Hz * shape


def hum(sensors: Sequence[Sensor], grid: Grid) -> Iterator[tuple[Reals, Reals]]:
    """Every line of the mains: its share of power per hertz, (N,), and root-mean-square by channel, (sensors,)."""
    mains_of = [sensor.chain.mains for sensor in sensors]
    for frequency in dict.fromkeys(mains.frequency_Hz for mains in mains_of if mains is not None):
        mine = [[] if m is None or m.frequency_Hz != frequency else m.lines() for m in mains_of]
        for number in range(max(map(len, mine))):
            size = [
                sensor.to_SI * amplitudes[number] if number < len(amplitudes) else 0.0
                for sensor, amplitudes in zip(sensors, mine, strict=True)
            ]
            share = deposit(grid, np.array([(number + 1) * frequency]), np.ones(1), 0.0)
            yield share, np.sqrt(0.5) * np.array(size)


def lines(grid: Grid, first_Hz: float, series: TrackLines | WheelLines) -> Reals:
    """One-sided density of a harmonic series, m2/Hz, shape (N,)."""
    low, high = float(grid.frequency_Hz[0]), float(grid.frequency_Hz[-1])
    reach = 1.0 + REACH_WIDTHS * series.width
    last = int(high * reach / first_Hz)
    last = last if series.harmonics is None else min(last, series.harmonics)
    number = np.arange(max(1, int(low / reach / first_Hz)), last + 1, dtype=np.float64)
    power = 0.5 * series.amplitude(number) ** 2
    return deposit(grid, number * first_Hz, power, series.width)


def deposit(grid: Grid, frequency_Hz: Reals, power: Reals, width: float) -> Reals:
    """Lines as densities on the grid, their power kept.

    A line goes to its neighbours in proportion to their nearness, so that whatever varies linearly between points
    is taken at the line's own frequency; a broadened one likewise, its bell cut into such lines.

    Parameters
    ----------
    grid : Grid
    frequency_Hz, power : ndarray, shape (n,)
    width : float
        Standard deviation over frequency.

    Returns
    -------
    ndarray, shape (N,)
        Power per hertz; of lines outside the grid nothing.
    """
    found = np.zeros(grid.frequency_Hz.size)
    if not frequency_Hz.size:
        return found
    step = grid.step_Hz
    place = (frequency_Hz - grid.frequency_Hz[0]) / step
    spread = width * frequency_Hz / step
    reach = int(np.ceil(REACH_WIDTHS * spread.max())) + 1
    at = np.floor(place)[:, None] + np.arange(-reach + 1, reach + 1)
    away = at - place[:, None]
    weight = _ramp(away + 1.0, spread) - 2.0 * _ramp(away, spread) + _ramp(away - 1.0, spread)
    inside = (at >= 0) & (at < found.size)
    np.add.at(found, at[inside].astype(np.int64), (weight * power[:, None] / step)[inside])
    return found


def _ramp(x: Reals, spread: Reals) -> Reals:
    """Twice integrated: a bell of that standard deviation about 0, or a pulse where it is 0; x (n, k)."""
    if not spread.any():
        return np.maximum(x, 0.0)
    s = spread[:, None]
    return np.asarray(x * ndtr(x / s) + s * np.exp(-0.5 * (x / s) ** 2) / np.sqrt(2.0 * np.pi))


def speed_of(condition: Condition) -> float:
    """Of a train's condition, m/s."""
    assert condition.speed_m_per_s is not None
    return condition.speed_m_per_s
