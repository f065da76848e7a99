"""The irregularity of the rail: a profile whose level varies from place to place, and is not Gaussian."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.challenge.errors_of_measurement import calibration_error

STRETCH_M = (60.0, 400.0)
"""Lengths over which the level stays."""

LEVEL_DB = 3.0
"""Standard deviation of the level from stretch to stretch."""

TAIL = 5
"""Degrees of freedom of Student's distribution, from which the profile's increments come."""

WITHIN_DB = 1.9
"""How far the spectrum goes from the sheet's."""


def density(wavenumber: Reals) -> Reals:
    """The sheet's one-sided spectrum, m2/(rad/m): German, low disturbance, to 1 m; then as W^-3.06, continuous."""
    edge = 2.0 * np.pi

    def german(w: Reals | float) -> Reals:
        return np.asarray(4.032e-7 * 0.8246**2 / ((w**2 + 0.0206**2) * (w**2 + 0.8246**2)))

    longer = german(np.minimum(wavenumber, edge))
    return np.asarray(longer * np.maximum(wavenumber / edge, 1.0) ** -3.06)


def deviation(random: np.random.Generator) -> Callable[[Reals], Reals]:
    """By how many dB the line's spectrum differs from the sheet's, at wavenumbers in rad/m: one draw."""
    wavenumber = np.geomspace(1e-3, 1e3, 400)
    off = 20.0 * np.log10(np.abs(calibration_error(random, wavenumber * 10.0, size_dB=1.0, length=1.0)))
    off = np.clip(off, -WITHIN_DB, WITHIN_DB)
    return lambda at: np.interp(np.log(at), np.log(wavenumber), off)


def profile(
    random: np.random.Generator,
    off_dB: Callable[[Reals], Reals],
    *,
    samples: int,
    sampling_Hz: float,
    speed: float,
) -> Complexes:
    """The profile that the leading wheel meets, as the transform of a periodic record.

    Parameters
    ----------
    random : Generator
    off_dB : callable
        From :func:`deviation`.
    samples : int
    sampling_Hz : float
    speed : float
        m/s.

    Returns
    -------
    ndarray of complex128, shape (samples // 2 + 1,)
        Such that `numpy.fft.irfft` gives metres. The mean is zero.
    """
    shots = random.standard_t(TAIL, samples) * _levels(random, samples, speed / sampling_Hz)
    spectrum = np.fft.rfft(shots / np.sqrt(np.mean(shots**2)))
    frequency = np.fft.rfftfreq(samples, 1.0 / sampling_Hz)
    wavenumber = 2.0 * np.pi * np.maximum(frequency, frequency[1]) / speed
    per_hertz = density(wavenumber) * 2.0 * np.pi / speed
    shaped = spectrum * np.sqrt(per_hertz * 0.5 * sampling_Hz) * 10.0 ** (0.05 * off_dB(wavenumber))
    shaped[0] = 0.0
    return np.asarray(shaped)


def _levels(random: np.random.Generator, samples: int, step_m: float) -> Reals:
    levels = np.empty(samples)
    at = 0
    while at < samples:
        stretch = int(random.uniform(*STRETCH_M) / step_m)
        levels[at : at + stretch] = 10.0 ** (0.05 * LEVEL_DB * random.standard_normal())
        at += max(stretch, 1)
    return levels
