"""What every measurement has: calibration errors over frequency, and noise blow by blow."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline

from permway.challenge.beams import Complexes, Reals

OCTAVE = float(np.log(2.0))
NEPER_PER_DB = float(np.log(10.0) / 20.0)
_KNOTS = np.linspace(np.log(0.1), np.log(1000.0), 80)


def calibration_error(
    random: np.random.Generator, frequency_Hz: Reals, *, size_dB: float, length: float = OCTAVE
) -> Complexes:
    """A smooth complex gain: its level in dB and its phase in as many nepers vary by `size_dB`.

    Normal with a squared-exponential correlation over ln f.

    Returns
    -------
    ndarray of complex128, shape (F,)
    """
    parts = _root(length) @ random.standard_normal((_KNOTS.size, 2)) * size_dB * NEPER_PER_DB
    at = CubicSpline(_KNOTS, parts)(np.log(np.clip(frequency_Hz, 0.1, 1000.0)))
    return np.asarray(np.exp(at[:, 0] + 1j * at[:, 1]))


@cache
def _root(length: float) -> Reals:
    """A square root of the correlation between knots."""
    apart = (_KNOTS[:, None] - _KNOTS[None, :]) / length
    return np.asarray(np.linalg.cholesky(np.exp(-0.5 * apart**2) + 1e-8 * np.eye(_KNOTS.size)))


def struck(
    random: np.random.Generator, response: Complexes, noise: Reals, *, blows: int, cell: float = 1e-3
) -> tuple[Complexes, Reals]:
    """H1 and coherence of some blows of unequal strength.

    Parameters
    ----------
    response : ndarray of complex128, shape (F, sensors, points)
        True frequency response, per N.
    noise : ndarray, shape (F, sensors)
        Standard deviation of a sensor's noise at a line (complex), in the response's unit for a blow of 1 N.
    blows : int
    cell : float
        Noise of the force cell over the force.

    Returns
    -------
    tuple of ndarray
        H1, complex, and ordinary coherence, both of the shape of `response`.
    """
    lines, sensors, points = response.shape
    cross = np.zeros(response.shape, dtype=np.complex128)
    force = np.zeros((lines, points))
    power = np.zeros(response.shape)
    for _ in range(blows):
        strength = np.exp(0.25 * random.standard_normal(points))
        read = strength + cell * _complex(random, (lines, points))
        displaced = response * strength + noise[:, :, None] * _complex(random, (lines, sensors, points))
        cross += displaced * read.conj()[:, None, :]
        force += np.abs(read) ** 2
        power += np.abs(displaced) ** 2
    estimate = cross / force[:, None, :]
    return estimate, np.abs(cross) ** 2 / (force[:, None, :] * power)


def _complex(random: np.random.Generator, shape: tuple[int, ...]) -> Complexes:
    both = random.standard_normal((2, *shape))
    return np.asarray((both[0] + 1j * both[1]) / np.sqrt(2.0))
