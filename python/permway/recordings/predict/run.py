"""What sensors on a train see of an irregularity: cross-spectral densities as Welch's method estimates them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.model.file import Model
from permway.model.vehicle import Vehicle
from permway.recordings.campaign_parts import Condition, IrregularityKnown
from permway.recordings.channel import Sensor
from permway.recordings.predict import excitation
from permway.recordings.predict.excitation import speed_of
from permway.recordings.predict.grid import Grid, grid_of, solved_lines

__all__ = ["amplitudes", "expected_csd", "influence", "solved_lines", "wheels_of"]


def wheels_of(model: Model, condition: Condition) -> Reals:
    """Where the wheels stand, the leading one first, m.

    Raises
    ------
    InputError
        If the model has no train.
    """
    if model.train is None:
        raise InputError("the model has no train", where="train", remedy="give the model file a [train]")
    if condition.wheels_m is not None:
        return np.array(condition.wheels_m, dtype=np.float64)
    centre = model.train.centre_m if condition.centre_m is None else condition.centre_m
    return np.asarray(centre + model.train.vehicle.wheel_positions_m())


def influence(model: Model, frequency_Hz: Reals, track: Complexes) -> Complexes:
    """Displacement of every degree of the vehicle per profile under every wheel.

    With wheel, track and contact receptances B: P = -(B_wheel + B_track + 1/k_c)^-1 R, and -P pushes the wheels
    (paper, equation (19)).

    Parameters
    ----------
    model : Model
    frequency_Hz : ndarray, shape (F,)
    track : ndarray of complex128, shape (F, wheels, wheels)
        Receptance at the contacts, m/N.

    Returns
    -------
    ndarray of complex128, shape (F, degrees, wheels)
    """
    assert model.train is not None
    vehicle = model.train.vehicle
    contact = model.train.contact.receptance(vehicle.share)
    return _influence(vehicle, contact, frequency_Hz.tobytes(), np.ascontiguousarray(track).tobytes())


@lru_cache(maxsize=8)
def _influence(vehicle: Vehicle, contact: float, lines: bytes, track: bytes) -> Complexes:
    response, wheel = _pushed(vehicle, lines)
    between = np.frombuffer(track, dtype=np.complex128).reshape(wheel.shape)
    found = np.asarray(response @ np.linalg.inv(wheel + between + contact * np.eye(wheel.shape[1])))
    found.flags.writeable = False
    return found


@lru_cache(maxsize=8)
def _pushed(vehicle: Vehicle, lines: bytes) -> tuple[Complexes, Complexes]:
    """Displacement of the free vehicle's degrees and of its contacts per force on the contacts, m/N."""
    found = vehicle.per_wheel_force(np.frombuffer(lines))
    for values in found:
        values.flags.writeable = False
    return found


@lru_cache(maxsize=8)
def _shaken(vehicle: Vehicle, degree: int, lines: bytes) -> Complexes:
    """Displacement of the free vehicle per force on one degree, m/N, shape (F, degrees)."""
    stiffness = vehicle.dynamic_stiffness(np.frombuffer(lines))
    push = np.eye(stiffness.shape[1])[:, [degree]]
    found = np.linalg.solve(stiffness, np.broadcast_to(push, (stiffness.shape[0], *push.shape)))[:, :, 0]
    found.flags.writeable = False
    return np.asarray(found)


def amplitudes(
    model: Model, condition: Condition, sensors: Sequence[Sensor], frequency_Hz: Reals, per_profile: Complexes
) -> Complexes:
    """What is there to be read, in SI, per profile under the leading wheel, shape (F, sensors).

    Parameters
    ----------
    per_profile : ndarray of complex128, shape (F, sensors, wheels)
        Of the sensors' degrees: see :func:`influence`. It holds no lag, so it may be interpolated over frequency.
    """
    wheels = wheels_of(model, condition)
    late = _late(frequency_Hz.tobytes(), ((wheels[0] - wheels) / speed_of(condition)).tobytes())
    moved = np.einsum("fsw,fw->fs", per_profile, late)
    return np.asarray(moved * _there(sensors, frequency_Hz))


@lru_cache(maxsize=8)
def _late(lines: bytes, lag: bytes) -> Complexes:
    """Phase by which what meets the leading wheel is late at each wheel, shape (F, wheels)."""
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
) -> Complexes:
    """Expectation of Welch's cross-spectral matrix with Hann's window, and the noise of the channels.

    All wheels meet one profile, so its part of the spectrum is of rank one; so is each wheel's own roughness and
    each force on the vehicle, and they add. The window, which cannot tell what comes late by a good part of a
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

    Returns
    -------
    ndarray of complex128, shape (F, sensors, sensors)
        E[x_i conj(x_j)], units of the sensors in SI squared per hertz.
    """
    assert model.train is not None
    grid = grid_of(lines_Hz, estimate_Hz, segment_s)
    degrees = model.train.vehicle.degrees
    chosen = [degrees.index(str(sensor.degree)) for sensor in sensors]
    mine = per_profile[:, chosen, :]
    flat = all(sensor.chain.flat for sensor in sensors)
    chains = _chains(sensors, grid.frequency_Hz[:1] if flat else grid.frequency_Hz)

    def expected(sources: Sequence[Complexes], density: Reals) -> Complexes:
        """Of independent sources that are linear between the solved lines."""
        if flat:
            return grid.expected_between([source * chains for source in sources], density)
        parts = [grid.expected(grid.spread(source) * chains, density) for source in sources]
        return np.asarray(np.sum(parts, axis=0))

    power = excitation.profile(model, known, condition, grid)
    if interpolated:
        upper = expected([amplitudes(model, condition, sensors, lines_Hz, mine)], power)
    else:
        spread = grid.spread(mine.reshape(lines_Hz.size, -1)).reshape(-1, *mine.shape[1:])
        upper = grid.expected(amplitudes(model, condition, sensors, grid.frequency_Hz, spread) * chains, power)
    for moved, density in _sources(model, known, condition, grid, lines_Hz, per_profile):
        upper += expected([source[:, chosen] * _there(sensors, lines_Hz) for source in moved], density)
    rows, columns = np.triu_indices(len(sensors))
    if any(sensor.chain.mains is not None for sensor in sensors):
        for density, size in excitation.hum(sensors, grid):
            upper += (grid.smear @ density)[:, None] * (size[rows] * size[columns])
    # Of a matrix that is its own adjoint the upper triangle is enough.
    matrix = np.empty((estimate_Hz.size, len(sensors), len(sensors)), dtype=np.complex128)
    matrix[:, columns, rows] = upper.conj()
    matrix[:, rows, columns] = upper
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
    wheels = vehicle.wheel_indices
    for of, density in excitation.wheels(known, condition, len(wheels), grid):
        yield [per_profile[:, :, wheel] for wheel in of], density
    for source in known.pushes:
        # The free vehicle moves by it, and the contacts answer as to a profile of the wheels' motion, reversed.
        lines, degree = lines_Hz.tobytes(), vehicle.degrees.index(source.degree)
        # What the push moves the contacts by is, reversed, what forces on the contacts move the degree by.
        at_contacts = _pushed(vehicle, lines)[0][:, degree, :]
        answer = np.einsum("fdw,fw->fd", per_profile, at_contacts)
        yield [_shaken(vehicle, degree, lines) - answer], excitation.push(source, grid.frequency_Hz)


def _chains(sensors: Sequence[Sensor], frequency_Hz: Reals) -> Complexes:
    return np.stack([sensor.chain.transfer(frequency_Hz) for sensor in sensors], axis=-1)


def _there(sensors: Sequence[Sensor], frequency_Hz: Reals) -> Complexes:
    each = {key: sensor.there(frequency_Hz) for key, sensor in ((_reads(s), s) for s in sensors)}
    return np.stack([each[_reads(sensor)] for sensor in sensors], axis=-1)


def _reads(sensor: Sensor) -> tuple[str, str]:
    return sensor.quantity, sensor.direction
