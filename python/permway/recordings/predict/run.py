"""What sensors on a train see of an irregularity: cross-spectral densities as Welch's method estimates them."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from scipy import sparse

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.model.file import Model
from permway.model.irregularity_spectra import RangeWarning
from permway.recordings.campaign_parts import Condition, IrregularityKnown
from permway.recordings.channel import Sensor

PER_LINE = 16
"""Points between two lines at which spectra are taken before the window smears them."""

REACH_LINES = 4
"""Lines on either side beyond which Hann's window lets nothing through (below 1e-5 of the power)."""


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
    wheels = vehicle.wheel_indices
    stiffness = vehicle.dynamic_stiffness(frequency_Hz)
    push = np.broadcast_to(
        np.eye(stiffness.shape[1])[:, wheels], (frequency_Hz.size, stiffness.shape[1], len(wheels))
    )
    response = np.linalg.solve(stiffness, push)
    contact = model.train.contact.receptance(vehicle.share) * np.eye(len(wheels))
    return np.asarray(response @ np.linalg.inv(response[:, wheels, :] + track + contact))


def density(model: Model, known: IrregularityKnown, speed_m_per_s: float, frequency_Hz: Reals) -> Reals:
    """One-sided density of the profile, m2/Hz, with the campaign's level and slope, shape (F,)."""
    if model.irregularity is None:
        raise InputError(
            "the model has no irregularity", where="irregularity", remedy="name one in the model file"
        )
    with warnings.catch_warnings():
        # Said when the model is solved; a recalibration would say it a thousand times.
        warnings.simplefilter("ignore", RangeWarning)
        values = model.irregularity.density(frequency_Hz, speed_m_per_s, model.conversion)
    octaves = np.log2(2.0 * np.pi * frequency_Hz / speed_m_per_s)
    return np.asarray(values * 10.0 ** (0.1 * (known.level_dB + known.slope_dB_per_octave * octaves)))


def amplitudes(
    model: Model, condition: Condition, sensors: Sequence[Sensor], frequency_Hz: Reals, per_profile: Complexes
) -> Complexes:
    """What is read, in SI and without the chain, per profile under the leading wheel, shape (F, sensors).

    Parameters
    ----------
    per_profile : ndarray of complex128, shape (F, degrees, wheels)
        See :func:`influence`; it holds no lag, so it may be interpolated over frequency.
    """
    assert model.train is not None
    speed = _speed(condition)
    wheels = wheels_of(model, condition)
    omega = 2.0 * np.pi * frequency_Hz
    late = np.exp(-1j * omega[:, None] * (wheels[0] - wheels)[None, :] / speed)
    degrees = model.train.vehicle.degrees
    chosen = [degrees.index(str(sensor.degree)) for sensor in sensors]
    moved = np.einsum("fdw,fw->fd", per_profile[:, chosen, :], late)
    bare = [sensor.transfer(frequency_Hz) / sensor.chain.transfer(frequency_Hz) for sensor in sensors]
    return np.asarray(moved * np.stack(bare, axis=-1))


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

    All wheels meet one profile, so the spectrum itself is of rank one; the window, which cannot tell what comes
    late by a good part of a segment, makes it less coherent.

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
    spread = _between(tuple(lines_Hz.tolist()), segment_s)
    fine_Hz = _points(lines_Hz, segment_s)
    if interpolated:
        fine = np.asarray(spread @ amplitudes(model, condition, sensors, lines_Hz, per_profile))
    else:
        flat = np.asarray(spread @ per_profile.reshape(lines_Hz.size, -1))
        fine = amplitudes(model, condition, sensors, fine_Hz, flat.reshape(fine_Hz.size, *per_profile.shape[1:]))
    fine = fine * np.stack([sensor.chain.transfer(fine_Hz) for sensor in sensors], axis=-1)
    fine = fine * np.sqrt(density(model, known, _speed(condition), fine_Hz))[:, None]
    products = (fine[:, :, None] * fine.conj()[:, None, :]).reshape(fine_Hz.size, -1)
    step = float(fine_Hz[1] - fine_Hz[0])
    smear = _window(fine_Hz.size, float(fine_Hz[0]), step, tuple(estimate_Hz.tolist()), segment_s)
    matrix = np.asarray(smear @ products).reshape(estimate_Hz.size, len(sensors), len(sensors))
    matrix = matrix + np.diag([sensor.noise_density for sensor in sensors])
    return np.asarray(matrix, dtype=np.complex128)


def solved_lines(
    estimate_Hz: Reals, segment_s: float, interpolated_Hz: Sequence[tuple[float, float]] | None
) -> Reals:
    """Frequencies to solve at, so that the window's reach is covered, Hz.

    They lie a line of the estimate apart, or where those lay between which the record was interpolated.
    """
    reach = REACH_LINES / segment_s
    low, high = float(estimate_Hz[0]) - reach, float(estimate_Hz[-1]) + reach
    ranges = list(interpolated_Hz or [(0.0, 1.0 / segment_s)])
    parts = []
    for (start, step), stop in zip(ranges, [*(start for start, _ in ranges[1:]), np.inf], strict=True):
        first = int(np.floor((max(low, start) - start) / step + 1e-9))
        last = int(np.ceil((min(high, stop) - start) / step - 1e-9))
        parts.append(start + step * np.arange(first, last + 1, dtype=np.float64))
    lines = np.unique(np.round(np.concatenate(parts), 9))
    return np.asarray(lines[lines > 0.0])


def _speed(condition: Condition) -> float:
    assert condition.speed_m_per_s is not None
    return condition.speed_m_per_s


def _points(lines_Hz: Reals, segment_s: float) -> Reals:
    """Equally spaced frequencies from the first line to the last, `PER_LINE` to a line of the estimate."""
    step = 1.0 / (segment_s * PER_LINE)
    count = int(np.floor((lines_Hz[-1] - lines_Hz[0]) / step + 1e-9)) + 1
    return np.asarray(lines_Hz[0] + step * np.arange(count), dtype=np.float64)


@lru_cache(maxsize=8)
def _between(lines_Hz: tuple[float, ...], segment_s: float) -> sparse.csr_array:
    """Linear interpolation from the lines to the points."""
    lines = np.array(lines_Hz)
    points = _points(lines, segment_s)
    left = np.clip(np.searchsorted(lines, points, side="right") - 1, 0, lines.size - 2)
    share = np.clip((points - lines[left]) / (lines[left + 1] - lines[left]), 0.0, 1.0)
    at = np.arange(points.size)
    return sparse.csr_array(
        (np.concatenate([1.0 - share, share]), (np.concatenate([at, at]), np.concatenate([left, left + 1]))),
        shape=(points.size, lines.size),
    )


@lru_cache(maxsize=8)
def _window(
    count: int, first_Hz: float, step_Hz: float, estimate_Hz: tuple[float, ...], segment_s: float
) -> sparse.csr_array:
    """Power of Hann's spectral window about every line of the estimate, each row of sum 1."""
    fine = first_Hz + step_Hz * np.arange(count)
    rows, columns, values = [], [], []
    for index, frequency in enumerate(estimate_Hz):
        away = (fine - frequency) * segment_s
        near = np.flatnonzero(np.abs(away) <= REACH_LINES)
        x = away[near]
        power = (np.sinc(x) + 0.5 * (np.sinc(x - 1.0) + np.sinc(x + 1.0))) ** 2
        rows.append(np.full(near.size, index))
        columns.append(near)
        values.append(power / power.sum())
    at = (np.concatenate(rows), np.concatenate(columns))
    return sparse.csr_array((np.concatenate(values), at), shape=(len(estimate_Hz), count))
