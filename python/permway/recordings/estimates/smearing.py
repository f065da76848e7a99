"""A known density as Welch's method sees it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from permway.arrays import Complexes
from permway.errors import InputError
from permway.recordings.estimates.checks import as_complexes, as_reals, check_positive
from permway.recordings.estimates.windows import window_values

_SIDELOBES = 16.0
"""Lines to either side over which a density is seen through a window."""

_WINDOW_POINTS = 256


def through_window(
    frequency_Hz: ArrayLike,
    density: ArrayLike,
    at_Hz: ArrayLike,
    *,
    segment_s: float,
    window: str | ArrayLike = "hann",
) -> Complexes:
    """What Welch's method gives in the mean for a known density: the density seen through the window.

    The convolution with |W(f)|^2 (Percival and Walden 1993, chapter 6), for power and cross densities alike.
    A prediction so treated is what an estimate of any resolution is to be compared with.

    Parameters
    ----------
    frequency_Hz : array_like, shape (n,)
        At equal steps of at most a quarter of a line, from 0 Hz and beyond the last of `at_Hz`.
    density : array_like, shape (..., n)
        One-sided, real or complex.
    at_Hz : array_like, shape (m,)
        Lines of the estimate, from 0 Hz excluded to half the sampling rate excluded.
    segment_s, window
        Of the estimate.

    Returns
    -------
    ndarray of complex, shape (..., m)
    """
    frequency, lines = as_reals(frequency_Hz, "frequency_Hz", ndim=1), as_reals(at_Hz, "at_Hz", ndim=1)
    values = as_complexes(density, "density")
    length = check_positive(segment_s, "segment_s")
    step = np.diff(frequency)
    if frequency.size < 2 or values.shape[-1:] != frequency.shape or np.ptp(step) > 1e-6 * abs(step[0]):
        raise InputError("must be equally spaced, one density each", where="frequency_Hz", value=values.shape)
    if (
        frequency[0] != 0.0
        or step[0] * length > 0.25 + 1e-9
        or np.any(lines > frequency[-1])
        or np.any(lines <= 0.0)
    ):
        raise InputError(
            "must run from 0 Hz past the last line, in steps of a quarter of a line at most",
            where="frequency_Hz",
            value=[float(frequency[0]), float(frequency[-1]), float(step[0])],
            remedy=f"take steps of {0.25 / length:.4g} Hz or less",
        )
    # Negative frequencies hold the conjugate; past the end the density is held, which the last few lines feel.
    reach = int(np.ceil(_SIDELOBES / length / step[0]))
    inside = np.pad(values, [(0, 0)] * (values.ndim - 1) + [(reach, reach)], mode="edge")
    inside[..., :reach] = values[..., 1 : reach + 1][..., ::-1].conj()
    place = np.arange(-reach, frequency.size + reach) * step[0]
    shape = window_values(window, _WINDOW_POINTS)
    answer = np.empty((*values.shape[:-1], lines.size), dtype=np.complex128)
    time = (np.arange(_WINDOW_POINTS) + 0.5) / _WINDOW_POINTS
    for index, line in enumerate(lines):
        near = np.abs(place - line) * length <= _SIDELOBES
        off = (place[near] - line) * length
        weight = np.abs(np.exp(-2j * np.pi * np.outer(off, time)) @ shape) ** 2
        answer[..., index] = inside[..., near] @ weight / weight.sum()
    return answer
