"""Sensors on a train, and what of their readings does not depend on how it moves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from permway.arrays import Complexes, Reals
from permway.campaign.predictions import excitation
from permway.campaign.predictions.grid import Grid, grid_of
from permway.errors import InputError
from permway.recordings.channel import Direction, Quantity, Sensor, there

Reads = tuple[Quantity, Direction]


@dataclass(frozen=True, eq=False)
class Aboard:
    """Sensors on a train, in an order.

    Attributes
    ----------
    sensors : tuple of Sensor
    chosen : tuple of int
        The vehicle's degree of freedom that each reads.
    reads : tuple of (quantity, direction)
        What each reads of it.
    """

    sensors: tuple[Sensor, ...]
    chosen: tuple[int, ...]
    reads: tuple[Reads, ...]

    @cached_property
    def flat(self) -> bool:
        """Whether all transfers are mere gains."""
        return all(sensor.chain.flat for sensor in self.sensors)

    @cached_property
    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows and columns of the upper triangle of sensors against sensors, row by row."""
        return np.triu_indices(len(self.sensors))

    @cached_property
    def gains(self) -> Complexes:
        """Of each pair, where transfers are mere gains."""
        gain, (rows, columns) = self.chains(np.ones(1))[0], self.pairs
        return np.asarray(gain[rows] * gain[columns].conj())

    def chains(self, frequency_Hz: Reals) -> Complexes:
        """Transfers of the sensors' chains, (F, sensors)."""
        return np.stack([sensor.chain.transfer(frequency_Hz) for sensor in self.sensors], axis=-1)

    def there(self, frequency_Hz: Reals) -> Complexes:
        """What ideal chains read over the displacement down in m, (F, sensors)."""
        return _there(self.reads, frequency_Hz)

    def ideal(self, grid: Grid) -> Complexes:
        """:meth:`there` on a grid, (N, sensors), or (N, 1) where all read alike."""
        return _ideal(self.reads, grid)

    def apart(self, estimate_Hz: Reals, segment_s: float, duration_s: float | None) -> Complexes | None:
        """What clocks that run apart leave of cross spectra: the mean over segments of a phase that grows.

        Returns
        -------
        ndarray of complex128, shape (F, pairs), or None
            None for clocks that do not.

        Raises
        ------
        InputError
            If nobody states for how long they run apart.
        """
        slow = np.array([sensor.chain.clock_slow for sensor in self.sensors])
        if not slow.any():
            return None
        if duration_s is None:
            remedy = "give the dataset its attribute duration_s"
            raise InputError("clocks run apart in a run of unknown length", where="duration_s", remedy=remedy)
        rows, columns = self.pairs
        turns = estimate_Hz[:, None] * (slow[rows] - slow[columns])
        growing = np.sinc(turns * max(duration_s - segment_s, 0.0))
        return np.asarray(growing * np.exp(-1j * np.pi * turns * duration_s))


@lru_cache(maxsize=32)
def aboard(sensors: tuple[Sensor, ...], degrees: tuple[str, ...]) -> Aboard:
    """Sensors on a vehicle of these degrees of freedom."""
    chosen = tuple(degrees.index(str(sensor.degree)) for sensor in sensors)
    return Aboard(sensors, chosen, tuple((sensor.quantity, sensor.direction) for sensor in sensors))


def added_csd(sensors: tuple[Sensor, ...], lines_Hz: Reals, estimate_Hz: Reals, segment_s: float) -> Reals:
    """What chains add of their own, whatever moves: the noise of each, and hum, which they have in common.

    Parameters
    ----------
    sensors : tuple of Sensor
    lines_Hz : ndarray, shape (L,)
        Frequencies that were solved at.
    estimate_Hz : ndarray, shape (F,)
    segment_s : float

    Returns
    -------
    ndarray, shape (sensors, sensors, F)
        Units of the sensors in SI squared per hertz; not to be written to.
    """
    return _added(sensors, lines_Hz.tobytes(), estimate_Hz.tobytes(), segment_s)


@lru_cache(maxsize=16)
def _added(sensors: tuple[Sensor, ...], lines: bytes, estimate: bytes, segment_s: float) -> Reals:
    estimate_Hz, own = np.frombuffer(estimate), np.arange(len(sensors))
    found = np.zeros((own.size, own.size, estimate_Hz.size))
    if any(sensor.chain.mains is not None for sensor in sensors):
        grid = grid_of(np.frombuffer(lines), estimate_Hz, segment_s)
        for density, size in excitation.hum(sensors, grid):
            found += (grid.smear @ density) * np.outer(size, size)[:, :, None]
    found[own, own] += np.stack([sensor.noise(estimate_Hz) for sensor in sensors])
    found.flags.writeable = False
    return found


@lru_cache(maxsize=16)
def _ideal(reads: tuple[Reads, ...], grid: Grid) -> Complexes:
    found = _there(reads[:1] if len(set(reads)) == 1 else reads, grid.frequency_Hz)
    found.flags.writeable = False
    return found


def _there(reads: tuple[Reads, ...], frequency_Hz: Reals) -> Complexes:
    each = {one: there(*one, frequency_Hz) for one in set(reads)}
    return np.stack([each[one] for one in reads], axis=-1)
