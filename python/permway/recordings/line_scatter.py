"""Noise of frequency responses without a coherence, from how far neighbouring lines scatter.

A response that is smooth over four lines has a third difference of nothing; what is left there is noise, new on
every line. Von Neumann (1941), Annals of Mathematical Statistics 12, 367-395, has the first difference for a mean.
"""

from __future__ import annotations

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import InputError

ORDER = 3
"""Of the difference: parabolas over four lines count as no noise."""

REACH = 8
"""Lines to either side whose differences count for a line. Half of it lets a line's own error set its weight."""

FREEDOM = 14.0
"""Degrees of freedom of a line's variance in mid-band: 17 differences of two parts, of which each has 0.56, 0.09
and 0.0025 of its square in common with the next three on either side."""

FEWEST = 12
"""Fewest lines that show a scatter."""


def scatter_variance(frequency_Hz: Reals, values: Complexes, *, where: str) -> Reals:
    """Variance of the log magnitude (neper), and of the phase (rad), line by line.

    Lines must have errors of their own: what is interpolated, zero-padded or smoothed shows less noise than it
    has. A resonance of fewer than about six lines counts as noise, and then weighs less than it should.

    Parameters
    ----------
    frequency_Hz : ndarray, shape (F,)
        Rising; steps may differ.
    values : ndarray of complex128, shape (..., F)
        NaN where a pair was not measured.
    where : str
        For messages.

    Returns
    -------
    ndarray, shape (..., F)
        NaN where a value is NaN, infinite where one is zero.

    Raises
    ------
    InputError
        For fewer than 12 lines.
    """
    count = frequency_Hz.size
    if count < FEWEST:
        raise InputError(
            f"{count} lines show no scatter, which takes {FEWEST} and more",
            where=where,
            remedy="take a wider band, or give a coherence",
        )
    weights = _weights(frequency_Hz)
    windows = np.lib.stride_tricks.sliding_window_view(values, ORDER + 1, axis=-1)
    differences = np.einsum("...fk,fk->...f", windows, weights)
    power = 0.5 * np.abs(differences) ** 2
    # A difference lies in the middle of its lines.
    middle = np.arange(count - ORDER) + 0.5 * ORDER
    near = np.abs(middle - np.arange(count)[:, None]) <= REACH
    variance = power @ (near / near.sum(axis=1, keepdims=True)).T
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(variance / np.abs(values) ** 2)


def _weights(frequency_Hz: Reals) -> Reals:
    """Of the lines in each divided difference, whose squares add up to one, shape (F - 3, 4)."""
    lines = np.lib.stride_tricks.sliding_window_view(frequency_Hz, ORDER + 1)
    apart = lines[:, :, None] - lines[:, None, :]
    apart[:, np.arange(ORDER + 1), np.arange(ORDER + 1)] = 1.0
    weights = 1.0 / apart.prod(axis=2)
    return np.asarray(weights / np.sqrt((weights**2).sum(axis=1, keepdims=True)))
