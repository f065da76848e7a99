"""A vehicle on a rail that it rolls over: what a profile and its own weight move it by, harmonics coupled.

Contacts in series with wheels and rail take up the profile R: sum over k of Z_jk F_k = R_j, with Z_jk the wheels'
and contacts' receptance at w + j Omega where j = k, and the rail's K_(j-k)(w + j Omega); and F pushes the wheels
(with the profile of a standing train's, paper, equation (19)). A constant load is a profile K_k(k Omega) P at the
multiples of Omega alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.arrays import Complexes, Reals
from permway.model.vehicle import Vehicle
from permway.response.rolling.kernel import HARMONICS, Kernel

REACH = 3
"""Harmonics on either side of a line that are coupled with it."""


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
    orders = np.arange(-REACH, REACH + 1)
    rail = _Rail(by, lines_Hz, track, share)
    matrix, response = _coupled(vehicle, contact_m_per_N, rail, lines_Hz[:, None] + passing * orders)
    middle, wheels = REACH, track.shape[1]
    # A line's own row of the inverse is all that is needed.
    flat = matrix.reshape(lines_Hz.size, orders.size * wheels, -1)
    own = np.zeros((flat.shape[1], wheels))
    own[middle * wheels : (middle + 1) * wheels] = np.eye(wheels)
    rows = np.linalg.solve(np.swapaxes(flat, 1, 2), np.broadcast_to(own, (lines_Hz.size, *own.shape)))
    pressed = np.swapaxes(rows, 1, 2).reshape(lines_Hz.size, wheels, orders.size, wheels)
    per_profile = np.einsum("fdw,fwkv->kfdv", response[:, middle], pressed)
    return Rolled(orders, per_profile, passing, _lines(vehicle, contact_m_per_N, rail, passing, wheels))


def _lines(vehicle: Vehicle, contact: float, rail: _Rail, passing: float, wheels: int) -> Complexes:
    """Amplitudes at the first multiples of the passing frequency."""
    orders = np.concatenate([np.arange(-HARMONICS, 0), np.arange(1, HARMONICS + 1)])
    at = passing * orders[None, :]
    matrix, response = _coupled(vehicle, contact, rail, at)
    load = np.full(wheels, vehicle.share * 2.0 * vehicle.static_wheel_load_N)
    yields = np.stack([rail.harmonic(int(n), at[:, k])[0] @ load for k, n in enumerate(orders)])
    flat = matrix.reshape(orders.size * wheels, -1)
    force = np.linalg.solve(flat, yields.ravel()).reshape(orders.size, wheels)
    moved = np.einsum("kdw,kw->kd", response[0], force)
    # One of each pair of conjugates stands for both.
    return np.asarray(2.0 * moved[HARMONICS:])


def _coupled(vehicle: Vehicle, contact: float, rail: _Rail, at_Hz: Reals) -> tuple[Complexes, Complexes]:
    """Receptances between harmonics, (L, K, wheels, K, wheels), and the vehicle's degrees per force, (L, K, d, w).

    Frequencies (L, K) may be below zero; those of a row differ by multiples of the passing frequency.
    """
    size = np.maximum(np.abs(at_Hz), LEAST_HZ)
    degrees, contacts = (_signed(values, at_Hz) for values in _per_force(vehicle, size))
    wheels = contacts.shape[-1]
    matrix = np.zeros((*at_Hz.shape, wheels, at_Hz.shape[1], wheels), dtype=np.complex128)
    apart = np.round((at_Hz - at_Hz[:, :1]) / _passing(at_Hz)).astype(np.int64)[0]
    for j in range(at_Hz.shape[1]):
        for k in range(at_Hz.shape[1]):
            n = int(apart[j] - apart[k])
            if abs(n) <= HARMONICS:
                matrix[:, j, :, k, :] += rail.harmonic(n, at_Hz[:, j])
        matrix[:, j, :, j, :] += contacts[:, j] + contact * np.eye(wheels)
    return matrix, degrees


LEAST_HZ = 0.05
"""At rest a free vehicle has no receptance: nearer to it than this it is taken there."""


def _passing(at_Hz: Reals) -> float:
    return float(np.min(np.diff(np.sort(at_Hz[0]))))


def _per_force(vehicle: Vehicle, size_Hz: Reals) -> tuple[Complexes, Complexes]:
    found = vehicle.per_wheel_force(size_Hz.ravel())
    degrees, contacts = (values.reshape(*size_Hz.shape, *values.shape[1:]) for values in found)
    return degrees, contacts


def _signed(values: Complexes, at_Hz: Reals) -> Complexes:
    """Of real systems: conjugate below zero."""
    return np.asarray(np.where((at_Hz < 0.0)[..., None, None], values.conj(), values))


class _Rail:
    """The rail's harmonics at any frequency, of a track that differs a little from the kernel's."""

    def __init__(self, by: Kernel, lines_Hz: Reals, track: Complexes, share: float) -> None:
        self._by, self._share = by, share
        # What the track is beyond the kernel's, where it was solved; nothing further up.
        self._lines = lines_Hz
        self._beyond = track - _between(by.frequency_Hz, by.standing, lines_Hz)
        middle = by.harmonics[HARMONICS]
        self._mean = by.standing + share * (middle - by.standing)

    def harmonic(self, n: int, at_Hz: Reals) -> Complexes:
        """K_n at frequencies, (L, wheels, wheels); above the kernel's own the rail is taken to hold still."""
        size = np.abs(at_Hz)
        if n:
            values = self._by.harmonics[HARMONICS + n], self._by.harmonics[HARMONICS - n]
            positive, negative = (_between(self._by.frequency_Hz, one, size) for one in values)
            return np.asarray(self._share * np.where((at_Hz < 0.0)[:, None, None], negative.conj(), positive))
        found = _between(self._by.frequency_Hz, self._mean, size)
        inside = (size >= self._lines[0]) & (size <= self._lines[-1])
        found[inside] += _between(self._lines, self._beyond, size[inside])
        return _signed(found, at_Hz)


def _between(known_Hz: Reals, values: Complexes, at_Hz: Reals) -> Complexes:
    """Straight between lines; nothing above the last."""
    place = np.clip(np.searchsorted(known_Hz, at_Hz, side="right") - 1, 0, known_Hz.size - 2)
    away = ((at_Hz - known_Hz[place]) / (known_Hz[place + 1] - known_Hz[place]))[:, None, None]
    found = values[place] * (1.0 - away) + values[place + 1] * away
    found[at_Hz > known_Hz[-1]] = 0.0
    return np.asarray(found)
