"""Suspensions that slide or blow off: the dashpots that do the same work, and the forces that these leave over.

A force F erf(v / (sqrt(2) v0)) on a velocity of a normal distribution, of standard deviation s, is a dashpot
F sqrt(2/pi) / h, h^2 = v0^2 + s^2 (Booton 1954), and a remainder that is not correlated with the velocity. The
correlation of two such forces is F^2 (2/pi) arcsin(r s1 s2 / (h1 h2)), with r that of the velocities (Baum, IRE
Transactions on Information Theory 3 (1957) 193-197); that of their remainders is this less its linear part.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError, SolveError
from permway.model.vehicle import Vehicle
from permway.model.vehicle_additions import Slider

ROUNDS, CLOSE = 60, 1e-11
"""Of the search for the velocity at work, and relative change at which it counts as found."""

Motion = Callable[[Vehicle], Complexes]
"""From a vehicle to the motion of its degrees, m and rad per root of hertz, shape (F, degrees)."""


@dataclass(frozen=True, eq=False)
class Remainder:
    """Random forces along the suspensions of a kind, beside the dashpots.

    Attributes
    ----------
    rows : ndarray, shape (ties, degrees)
        Which way each acts: what its compression is of the degrees.
    density : ndarray of complex128, shape (F, ties, ties)
        One-sided cross-spectral density, N^2/Hz.
    """

    rows: Reals
    density: Complexes


def sliders_of(vehicle: Vehicle) -> list[Slider]:
    """Its sliders, in their order."""
    return [addition for addition in vehicle.additions if isinstance(addition, Slider)]


def at_work(vehicle: Vehicle, frequency_Hz: Reals, motion: Motion) -> Vehicle:
    """The vehicle whose sliders are at work: each moves as fast as its dashpot lets it.

    Parameters
    ----------
    vehicle : Vehicle
    frequency_Hz : ndarray, shape (F,)
        Ascending; what moves below and above is left out.
    motion : callable
        Of a vehicle over these frequencies.

    Returns
    -------
    Vehicle
        The same without sliders.

    Raises
    ------
    InputError
        For a single frequency, over which nothing has a velocity.
    SolveError
        If no velocity is found.
    """
    sliders = sliders_of(vehicle)
    if not sliders:
        return vehicle
    if frequency_Hz.size < 2:
        raise InputError(
            "a suspension that slides needs a band, for how it slides depends on how fast it moves",
            where="frequency_Hz",
            value=frequency_Hz.tolist(),
            remedy="give all frequencies over which it moves",
        )
    speeds = np.array([slider.rms_m_per_s for slider in sliders])
    found = _speeds(vehicle, speeds, frequency_Hz, motion)
    slope = np.zeros(speeds.size)
    for _ in range(ROUNDS):
        before, missed = speeds, found - speeds
        if np.all(np.abs(missed) <= CLOSE * found):
            return _moving(vehicle, found)
        # A secant for each; the first step, and one that would go astray, plainly.
        step = missed / np.where(slope < 0.5, 1.0 - slope, 1.0)
        speeds = np.maximum(speeds + step, 0.3 * found)
        old, found = found, _speeds(vehicle, speeds, frequency_Hz, motion)
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = np.nan_to_num((found - old) / (speeds - before))
        slope = np.clip(slope, -5.0, 0.5)
    raise SolveError(f"the sliders of the suspension find no velocity in {ROUNDS} rounds: {speeds} m/s")


def remainders(vehicle: Vehicle, step_Hz: float, motion: Complexes) -> list[Remainder]:
    """What the sliders of a vehicle at work give beside their dashpots.

    Parameters
    ----------
    vehicle : Vehicle
        As :func:`at_work` gives it.
    step_Hz : float
        From frequency to frequency, the first 0 Hz; finer than the inverse of the longest lag between suspensions.
    motion : ndarray of complex128, shape (F, degrees)

    Returns
    -------
    list of Remainder
        One for each slider, over the same frequencies.
    """
    omega = 2.0 * np.pi * step_Hz * np.arange(len(motion))
    found = []
    for slider in sliders_of(vehicle):
        rows = vehicle.stretches(slider.suspension)
        velocity = 1j * omega[:, None] * (motion @ rows.T)
        ties, samples = len(rows), 4 * len(motion)
        power = np.sum(np.abs(velocity) ** 2, axis=0) * step_Hz
        hard = np.sqrt(power + slider.velocity_m_per_s**2)
        force = slider.force_N * vehicle.share
        density = np.empty((len(motion), ties, ties), dtype=np.complex128)
        for i in range(ties):
            for j in range(i, ties):
                cross = np.fft.irfft(velocity[:, i] * velocity[:, j].conj(), n=samples) * (samples * step_Hz / 2.0)
                share = np.clip(cross / (hard[i] * hard[j]), -1.0, 1.0)
                left = force**2 * (2.0 / np.pi) * (np.arcsin(share) - share)
                spectrum = np.fft.rfft(left)[: len(motion)] * (2.0 / (samples * step_Hz))
                density[:, i, j], density[:, j, i] = spectrum, spectrum.conj()
        found.append(Remainder(rows, density))
    return found


def _moving(vehicle: Vehicle, speeds: Reals) -> Vehicle:
    left = iter(speeds.tolist())
    additions = tuple(
        a.model_copy(update={"rms_m_per_s": next(left)}) if isinstance(a, Slider) else a for a in vehicle.additions
    )
    return vehicle.model_copy(update={"additions": additions})


def _speeds(vehicle: Vehicle, speeds: Reals, frequency_Hz: Reals, motion: Motion) -> Reals:
    """Root mean square of each slider's velocity, the mean over its suspensions, if the sliders moved so fast."""
    displaced = 2.0 * np.pi * frequency_Hz[:, None] * motion(_moving(vehicle, speeds))
    power = [
        np.trapezoid(np.mean(np.abs(displaced @ vehicle.stretches(s.suspension).T) ** 2, axis=1), frequency_Hz)
        for s in sliders_of(vehicle)
    ]
    return np.asarray(np.sqrt(np.array(power)))
