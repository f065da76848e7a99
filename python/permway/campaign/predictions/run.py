"""What sensors on a train see of an irregularity: cross-spectral densities as Welch's method estimates them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.parts import Condition, IrregularityKnown
from permway.campaign.predictions import excitation
from permway.campaign.predictions.excitation import speed_of
from permway.campaign.predictions.grid import Grid, grid_of, solved_lines
from permway.campaign.predictions.motion import influence, pushed, wheels_of
from permway.campaign.predictions.rolling import passing
from permway.campaign.predictions.sliding import shares
from permway.errors import InputError
from permway.problem.model import Model
from permway.recordings.channel import Direction, Quantity, Sensor, there
from permway.response.rolling import Rolled
from permway.response.sliding import Remainder

__all__ = ["expected_csd", "influence", "solved_lines", "wheels_of"]


Reads = tuple[Quantity, Direction]


@lru_cache(maxsize=32)
def _late(lines: bytes, lag: bytes) -> Complexes:
    """Phase by which what meets the leading wheel comes later to each wheel, shape (F, wheels)."""
    found = np.asarray(np.exp((-2j * np.pi * np.frombuffer(lines))[:, None] * np.frombuffer(lag)))
    found.flags.writeable = False
    return found


def expected_csd(
    model: Model,
    known: IrregularityKnown,
    condition: Condition,
    sensors: Sequence[Sensor],
    lines_Hz: Reals,
    per_profile: Complexes,
    estimate_Hz: Reals,
    *,
    segment_s: float,
    interpolated: bool,
    duration_s: float | None = None,
    left: Sequence[Remainder] = (),
    rolls: Rolled | None = None,
    away: bool = False,
) -> Complexes:
    """Expectation of Welch's cross-spectral matrix with Hann's window, and the noise of the channels.

    All wheels meet one profile, so its part of the spectrum is of rank one; so is each wheel's own roughness and
    each force on the vehicle, and they add. The window, which cannot resolve what comes late by a good part of a
    segment, makes them less coherent.

    Parameters
    ----------
    lines_Hz : ndarray, shape (L,)
        Frequencies of `per_profile`, from below the first estimate to above the last: see :func:`solved_lines`.
    per_profile : ndarray of complex128, shape (L, degrees, wheels)
    estimate_Hz : ndarray, shape (F,)
    segment_s : float
    interpolated : bool
        Whether the record was computed by interpolating transfer functions, lags and all, between `lines_Hz`.
    duration_s : float, optional
        Of the run, over which clocks run apart.
    left : sequence of Remainder
        Forces of suspensions that slide, as :func:`permway.campaign.predictions.sliding.worked` gives them.
    rolls : Rolled, optional
        Of a train that rolls, over the same lines; `per_profile` is then that of the standing train still, by
        which a wheel's own roughness and forces act.
    away : bool
        Whether each part counts by how far it is from its line, in lines, and noise not at all: what an error
        acts on that grows from line to line.

    Returns
    -------
    ndarray of complex128, shape (F, sensors, sensors)
        E[x_i conj(x_j)], units of the sensors in SI squared per hertz.

    Raises
    ------
    InputError
        If clocks run apart and nobody states how long.
    """
    assert model.train is not None
    # Straight lines between transfers that turn have kinks.
    broad, narrow = (
        grid_of(lines_Hz, estimate_Hz, segment_s, narrow=fine or interpolated) for fine in (False, True)
    )
    if away:
        broad, narrow = broad.away, narrow.away
    degrees = model.train.vehicle.degrees
    chosen = [degrees.index(str(sensor.degree)) for sensor in sensors]
    flat = all(sensor.chain.flat for sensor in sensors)
    reads = tuple(_reads(sensor) for sensor in sensors)
    wheels = wheels_of(model, condition)
    lag = ((wheels[0] - wheels) / speed_of(condition)).tobytes()

    def read(fine: Complexes, grid: Grid) -> Complexes:
        """By chains whose transfers are no mere gains."""
        if not flat:
            fine *= _chains(sensors, grid.frequency_Hz)
        return fine

    def expected(grid: Grid, source: Complexes, density: Reals) -> Complexes:
        """Of what a source is read as at the solved lines, but for chains."""
        return grid.expected(read(grid.spread(source, straight=interpolated), grid), density)

    def met(grid: Grid, part: Complexes, met_Hz: Reals, density: Reals) -> Complexes:
        """Of the profile at some frequencies, by which the vehicle moves at the grid's."""
        if interpolated and rolls is None:
            shifted = np.einsum("fsw,fw->fs", part[:, chosen, :], _late(lines_Hz.tobytes(), lag))
            return expected(grid, shifted * _there(sensors, lines_Hz), density)
        shifted = grid.spread(part[:, chosen], _late(met_Hz.tobytes(), lag), straight=False)
        shifted *= _ideal(reads, grid)
        return grid.expected(read(shifted, grid), density)

    passing_Hz, orders, moved = 0.0, [0], [per_profile]
    if rolls is not None:
        passing_Hz, orders, moved = rolls.passing_Hz, rolls.orders.tolist(), list(rolls.per_profile)
    parts = []
    for order, part in zip(orders, moved, strict=True):
        met_Hz = broad.frequency_Hz + order * passing_Hz
        density = excitation.broad(model, known, condition, np.maximum(np.abs(met_Hz), broad.frequency_Hz[0]))
        parts.append(met(broad, part, met_Hz, density))
        if known.series and not order:
            density = excitation.series(known, condition, narrow)
            parts.append(met(narrow, part, narrow.frequency_Hz, density))
    for line_Hz, amplitudes in () if rolls is None else passing(rolls):
        at_Hz = np.array([line_Hz])
        seen = amplitudes[chosen] * _there(sensors, at_Hz)[0]
        parts.append(broad.of_line(line_Hz, seen if flat else seen * _chains(sensors, at_Hz)[0]))
    upper = np.asarray(np.sum(parts, axis=0))
    for sources, density in _sources(model, known, condition, narrow, lines_Hz, per_profile):
        for source in sources:
            upper += expected(narrow, source[:, chosen] * _there(sensors, lines_Hz), density)
    for remainder in left:
        per_force = pushed(model.train.vehicle, lines_Hz, remainder.rows, per_profile)[:, :, chosen]
        per_force = per_force * _there(sensors, lines_Hz)[:, None, :]
        fine = narrow.spread(per_force.reshape(lines_Hz.size, -1), straight=interpolated)
        fine = fine.reshape(-1, *per_force.shape[1:])
        if not flat:
            fine *= _chains(sensors, narrow.frequency_Hz)[:, None, :]
        mixed = np.einsum("ntk,ntc->knc", shares(remainder, narrow.frequency_Hz), fine)
        upper += np.sum([narrow.expected(one, np.ones(len(fine))) for one in mixed], axis=0)
    rows, columns = np.triu_indices(len(sensors))
    if flat:
        gains = _chains(sensors, broad.frequency_Hz[:1])
        upper *= gains[:, rows] * gains[:, columns].conj()
    if any(sensor.chain.clock_slow for sensor in sensors):
        if duration_s is None:
            remedy = "give the dataset its attribute duration_s"
            raise InputError("clocks run apart in a run of unknown length", where="duration_s", remedy=remedy)
        upper *= _apart(sensors, estimate_Hz, segment_s, duration_s)
    # Of a matrix that is its own adjoint the upper triangle is enough.
    matrix = np.empty((estimate_Hz.size, len(sensors), len(sensors)), dtype=np.complex128)
    matrix[:, columns, rows] = upper.conj()
    matrix[:, rows, columns] = upper
    return matrix if away else matrix + added_csd(sensors, lines_Hz, estimate_Hz, segment_s)


def _apart(sensors: Sequence[Sensor], estimate_Hz: Reals, segment_s: float, duration_s: float) -> Complexes:
    """What clocks that run apart leave of cross spectra: the mean over segments of a phase that grows.

    Returns
    -------
    ndarray of complex128, shape (F, pairs)
        Pairs in the order of the upper triangle.
    """
    slow = np.array([sensor.chain.clock_slow for sensor in sensors])
    rows, columns = np.triu_indices(len(sensors))
    turns = estimate_Hz[:, None] * (slow[rows] - slow[columns])
    growing = np.sinc(turns * max(duration_s - segment_s, 0.0))
    return np.asarray(growing * np.exp(-1j * np.pi * turns * duration_s))


def added_csd(sensors: Sequence[Sensor], lines_Hz: Reals, estimate_Hz: Reals, segment_s: float) -> Reals:
    """What chains add of their own, whatever moves: the noise of each, and hum, which they have in common.

    Parameters
    ----------
    lines_Hz, estimate_Hz, segment_s
        As of :func:`expected_csd`.

    Returns
    -------
    ndarray, shape (F, sensors, sensors)
    """
    matrix = np.zeros((estimate_Hz.size, len(sensors), len(sensors)))
    if any(sensor.chain.mains is not None for sensor in sensors):
        grid = grid_of(lines_Hz, estimate_Hz, segment_s)
        for density, size in excitation.hum(sensors, grid):
            matrix += (grid.smear @ density)[:, None, None] * np.outer(size, size)
    own = np.arange(len(sensors))
    matrix[:, own, own] += np.stack([sensor.noise(estimate_Hz) for sensor in sensors], axis=-1)
    return matrix


def _sources(
    model: Model,
    known: IrregularityKnown,
    condition: Condition,
    grid: Grid,
    lines_Hz: Reals,
    per_profile: Complexes,
) -> Iterator[tuple[list[Complexes], Reals]]:
    """Sources beside the profile: how each moves the vehicle's degrees, (L, degrees), and their density, (N,)."""
    assert model.train is not None
    vehicle = model.train.vehicle
    for of, density in excitation.wheels(known, condition, len(vehicle.wheel_indices), grid):
        yield [per_profile[:, :, wheel] for wheel in of], density
    for source in known.pushes:
        row = np.eye(len(vehicle.degrees))[[vehicle.degrees.index(source.degree)]]
        yield [pushed(vehicle, lines_Hz, row, per_profile)[:, 0]], excitation.push(source, grid.frequency_Hz)


def _chains(sensors: Sequence[Sensor], frequency_Hz: Reals) -> Complexes:
    return np.stack([sensor.chain.transfer(frequency_Hz) for sensor in sensors], axis=-1)


def _there(sensors: Sequence[Sensor], frequency_Hz: Reals) -> Complexes:
    return _each(tuple(_reads(sensor) for sensor in sensors), frequency_Hz)


@lru_cache(maxsize=16)
def _ideal(reads: tuple[Reads, ...], grid: Grid) -> Complexes:
    """:func:`_there` on a grid, (N, sensors), or (N, 1) where all read alike."""
    found = _each(reads[:1] if len(set(reads)) == 1 else reads, grid.frequency_Hz)
    found.flags.writeable = False
    return found


def _each(reads: tuple[Reads, ...], frequency_Hz: Reals) -> Complexes:
    each = {one: there(*one, frequency_Hz) for one in set(reads)}
    return np.stack([each[one] for one in reads], axis=-1)


def _reads(sensor: Sensor) -> Reads:
    return sensor.quantity, sensor.direction
