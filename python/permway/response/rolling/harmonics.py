"""A vehicle on a rail that it rolls over: what a profile and its own weight move it by, harmonics coupled.

Contacts in series with wheels and rail take up the profile R: sum over k of Z_jk F_k = R_j, with Z_jk the wheels'
and contacts' receptance at w + j Omega where j = k, and the rail's K_(j-k)(w + j Omega); and F pushes the wheels
(with the profile of a standing train's, paper, equation (19)). A constant load is a profile K_k(k Omega) P at the
multiples of Omega alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from permway.arrays import Complexes, Reals
from permway.model.vehicle import Vehicle
from permway.response.rolling.kernels import Kernel
from permway.response.rolling.passed import HARMONICS

REACH = 3
"""Harmonics on either side of a line that are coupled with it."""

LEAST_HZ = 0.05
"""At rest a free vehicle has no receptance: nearer to it than this it is taken there."""


@dataclass(frozen=True, eq=False)
class Rolled:
    """What a vehicle that rolls does.

    Attributes
    ----------
    orders : ndarray of int, shape (K,)
        The profile at f + k Omega / 2 pi moves the vehicle at f.
    per_profile : ndarray of complex128, shape (K, L, degrees, wheels)
        m/m, of the profile under each wheel.
    passing_Hz : float
        Omega / 2 pi.
    lines : ndarray of complex128, shape (n, degrees)
        Amplitudes of the degrees at n multiples of the passing frequency, m, by the wheels' load.
    """

    orders: np.ndarray
    per_profile: Complexes
    passing_Hz: float
    lines: Complexes


def rolled(
    vehicle: Vehicle,
    contact_m_per_N: float,
    lines_Hz: Reals,
    track: Complexes,
    by: Kernel,
    *,
    speed_m_per_s: float,
    share: float = 1.0,
) -> Rolled:
    """A vehicle on a rail that it rolls over.

    Parameters
    ----------
    vehicle : Vehicle
    contact_m_per_N : float
        Receptance of a wheelset's contact.
    lines_Hz : ndarray, shape (L,)
    track : ndarray of complex128, shape (L, wheels, wheels)
        Of the rail under the standing train, m/N. Where it differs from the kernel's own, rolling changes it as
        it changes the kernel's.
    by : Kernel
    speed_m_per_s : float
        Which passes the supports; the kernel's own may differ a little.
    share : float
        Of all that rolling changes: 0 stands.
    """
    passing = speed_m_per_s / by.spacing_m
    orders, wheels = tuple(range(-REACH, REACH + 1)), track.shape[1]
    # What the track is beyond the kernel's, where it was solved; nothing further up.
    beyond = lines_Hz, track - _between(by.frequency_Hz, by.standing, lines_Hz)
    matrix, response = _coupled(vehicle, contact_m_per_N, by, lines_Hz.tobytes(), passing, orders, share)
    flat = _with(matrix, beyond, lines_Hz[:, None] + passing * np.array(orders))
    # A line's own row of the inverse is all that is needed.
    own = np.zeros((flat.shape[1], wheels))
    own[REACH * wheels : (REACH + 1) * wheels] = np.eye(wheels)
    rows = np.linalg.solve(np.swapaxes(flat, 1, 2), np.broadcast_to(own, (lines_Hz.size, *own.shape)))
    pressed = np.swapaxes(rows, 1, 2).reshape(lines_Hz.size, wheels, len(orders), wheels)
    per_profile = response[:, REACH] @ pressed.reshape(lines_Hz.size, wheels, -1)
    per_profile = np.moveaxis(per_profile.reshape(lines_Hz.size, -1, len(orders), wheels), 2, 0)
    by_load = _lines(vehicle, contact_m_per_N, by, beyond, passing, share)
    return Rolled(np.array(orders), per_profile, passing, by_load)


Beyond = tuple[Reals, Complexes]
"""Frequencies, and what a track's receptance there is beyond the kernel's."""


def _lines(
    vehicle: Vehicle, contact: float, by: Kernel, beyond: Beyond, passing: float, share: float
) -> Complexes:
    """Amplitudes at the first multiples of the passing frequency."""
    orders = tuple(n for n in range(-HARMONICS, HARMONICS + 1) if n)
    matrix, response = _coupled(vehicle, contact, by, np.zeros(1).tobytes(), passing, orders, share)
    at = passing * np.array(orders, dtype=np.float64)
    wheels = response.shape[-1]
    load = np.full(wheels, vehicle.share * 2.0 * vehicle.static_wheel_load_N)
    yields = [share * _harmonic(by, n, at[[k]])[0] @ load for k, n in enumerate(orders)]
    force = np.linalg.solve(_with(matrix, beyond, at[None])[0], np.concatenate(yields)).reshape(-1, wheels)
    displaced = np.einsum("kdw,kw->kd", response[0], force)
    # One of each pair of conjugates stands for both.
    return np.asarray(2.0 * displaced[HARMONICS:])


@lru_cache(maxsize=16)
def _coupled(
    vehicle: Vehicle,
    contact: float,
    by: Kernel,
    lines: bytes,
    passing: float,
    orders: tuple[int, ...],
    share: float,
) -> tuple[Complexes, Complexes]:
    """Receptances between harmonics on the kernel's own track, and the vehicle's degrees per force.

    Returns
    -------
    ndarray of complex128, shapes (L, K, wheels, K, wheels) and (L, K, degrees, wheels)
    """
    at_Hz = np.frombuffer(lines)[:, None] + passing * np.array(orders, dtype=np.float64)
    found = vehicle.per_wheel_force(np.maximum(np.abs(at_Hz), LEAST_HZ).ravel())
    degrees, contacts = (_signed(values.reshape(*at_Hz.shape, *values.shape[1:]), at_Hz) for values in found)
    matrix = _of_track(by, lines, passing, orders, share).copy()
    for j in range(len(orders)):
        matrix[:, j, :, j, :] += contacts[:, j] + contact * np.eye(contacts.shape[-1])
    return matrix, degrees


@lru_cache(maxsize=8)
def _of_track(by: Kernel, lines: bytes, passing: float, orders: tuple[int, ...], share: float) -> Complexes:
    """What the kernel's own track has of the matrix, (L, K, wheels, K, wheels)."""
    at_Hz = np.frombuffer(lines)[:, None] + passing * np.array(orders, dtype=np.float64)
    wheels = by.standing.shape[-1]
    matrix = np.zeros((*at_Hz.shape, wheels, len(orders), wheels), dtype=np.complex128)
    for j, into in enumerate(orders):
        for k, of in enumerate(orders):
            if abs(into - of) <= HARMONICS:
                matrix[:, j, :, k, :] = share * _harmonic(by, into - of, at_Hz[:, j])
        standing = _signed(_between(by.frequency_Hz, by.standing, np.abs(at_Hz[:, j])), at_Hz[:, j])
        matrix[:, j, :, j, :] += (1.0 - share) * standing
    return matrix


def _with(matrix: Complexes, beyond: Beyond, at_Hz: Reals) -> Complexes:
    """The matrix of a track that differs from the kernel's, (L, K wheels, K wheels), at frequencies (L, K)."""
    known_Hz, values = beyond
    whole = matrix.copy()
    for k in range(at_Hz.shape[1]):
        size = np.abs(at_Hz[:, k])
        inside = (size >= known_Hz[0]) & (size <= known_Hz[-1])
        whole[inside, k, :, k, :] += _signed(_between(known_Hz, values, size[inside]), at_Hz[inside, k])
    size = matrix.shape[1] * matrix.shape[2]
    return whole.reshape(-1, size, size)


def _harmonic(by: Kernel, n: int, at_Hz: Reals) -> Complexes:
    """K_n at frequencies, (L, wheels, wheels); above the kernel's own the rail is taken to hold still."""
    found = _between(by.frequency_Hz, by.harmonics[HARMONICS + n], np.abs(at_Hz))
    if (at_Hz < 0.0).any():
        other = _between(by.frequency_Hz, by.harmonics[HARMONICS - n], np.abs(at_Hz))
        found = np.where((at_Hz < 0.0)[:, None, None], other.conj(), found)
    return np.asarray(found)


def _signed(values: Complexes, at_Hz: Reals) -> Complexes:
    """Of real systems: conjugate below zero."""
    return np.asarray(np.where((at_Hz < 0.0)[..., None, None], values.conj(), values))


def _between(known_Hz: Reals, values: Complexes, at_Hz: Reals) -> Complexes:
    """Straight between lines; nothing above the last."""
    place = np.clip(np.searchsorted(known_Hz, at_Hz, side="right") - 1, 0, known_Hz.size - 2)
    away = ((at_Hz - known_Hz[place]) / (known_Hz[place + 1] - known_Hz[place]))[:, None, None]
    found = values[place] * (1.0 - away) + values[place + 1] * away
    found[at_Hz > known_Hz[-1]] = 0.0
    return np.asarray(found)
