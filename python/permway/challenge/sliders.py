"""Forces on board that depend on a velocity's size: dry friction, dampers that blow off.

No frequency response describes these. The record is periodic, so that its motion can be found by going to and fro
between time, where the force is known of the velocity, and frequency, where the motion is known of the force.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from permway.challenge.beams import Complexes, Reals
from permway.errors import SolveError

ROUNDS = 400
CLOSE = 1e-4
"""Relative change of the force at which the motion counts as found."""


@dataclass(frozen=True)
class Slider:
    """A force along all ties of a name.

    Parameters
    ----------
    tie : str
    force : callable
        Of velocity (m/s), N; never falling, nowhere steeper than `slope`.
    slope : float
        N s/m.
    """

    tie: str
    force: Callable[[Reals], Reals]
    slope: float

    @property
    def dashpot(self) -> float:
        """Half the steepest slope: from it the force differs by no more than it either way, N s/m."""
        return 0.5 * self.slope


def settle(
    slider: Slider,
    driven: Complexes,
    flexible: Complexes,
    *,
    frequency_Hz: Reals,
    bins: NDArray[np.int64],
    samples: int,
) -> Complexes:
    """The force beyond the dashpot, once motion and force agree.

    Beside a dashpot, a passive structure gives way to a force no faster than the dashpot alone would. So each
    round brings force and motion nearer to each other, from any beginning.

    Parameters
    ----------
    slider : Slider
    driven : ndarray of complex128, shape (F, ties)
        Stretch of the ties without that force, as the transform of the record.
    flexible : ndarray of complex128, shape (F, ties, ties)
        Stretch per force along the ties, dashpots in place, m/N.
    frequency_Hz, bins : ndarray, shape (F,)
        The lines, and their numbers in the record's transform.
    samples : int

    Returns
    -------
    ndarray of complex128, shape (F, ties)
        Transform of the force, N.

    Raises
    ------
    SolveError
        If they do not agree in `ROUNDS` rounds.
    """
    turn = 2j * np.pi * frequency_Hz[:, None]
    beyond = np.zeros_like(driven)
    spectrum = np.zeros((samples // 2 + 1, driven.shape[1]), dtype=np.complex128)
    for _ in range(ROUNDS):
        spectrum[bins] = turn * (driven - np.einsum("fij,fj->fi", flexible, beyond))
        velocity = np.fft.irfft(spectrum, n=samples, axis=0)
        force = np.fft.rfft(slider.force(velocity) - slider.dashpot * velocity, axis=0)[bins]
        change = np.linalg.norm(force - beyond)
        beyond = np.asarray(force)
        if change <= CLOSE * np.linalg.norm(force):
            return beyond
    raise SolveError(f"the force of {slider.tie} does not settle in {ROUNDS} rounds")
