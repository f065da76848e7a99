"""Spectra of forces carried along a path: X(omega) = 1/V sum_w integral H(x; omega) F_w(tau) e^(-i omega tau) dx.

x = x_w + V tau. On a panel H is a sum of Legendre polynomials, whose products with exp(-i kappa x) have closed
integrals, 2 (-i)^l j_l(kappa h) h/2 e^(-i kappa middle) over a panel of half length h; so a force that is
constant or harmonic is carried without sampling the phase. A force of any other course is sampled at Gauss's
points, as many as phase and force need.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import legvander
from scipy.special import spherical_jn

from permway.arrays import Complexes, Reals
from permway.response.passby.path import Path, gauss

Course = Callable[[Reals], Reals]
"""Force over time: from times in s to values in N, of the same shape."""

_POINTS = 2**22
"""Samples of phase held at once."""

_KEPT = 2**24
"""Bytes of moments that are kept for the next force of the same waves, at most; eight of them."""


def harmonic_moments(path: Path, omega: Reals, speed: float, force_rad_per_s: float = 0.0) -> Complexes:
    """Moments of a unit force exp(i omega_0 tau) that is at x = V tau, shape (F, panels, order), s.

    Parameters
    ----------
    path : Path
    omega : ndarray, shape (F,)
        rad/s.
    speed : float
        V, m/s.
    force_rad_per_s : float
        omega_0; 0 for a constant force.
    """
    waves = np.ascontiguousarray((omega - force_rad_per_s) / speed)
    moments = _moments if 16 * waves.size * path.nodes.size < _KEPT else _moments.__wrapped__
    return moments(path.edges.tobytes(), path.order, waves.tobytes()) / speed


@lru_cache(maxsize=8)
def _moments(edges: bytes, order: int, waves: bytes) -> Complexes:
    """The same over V, of panels and wavenumbers as they stand in memory."""
    path, kappa = Path("", np.frombuffer(edges), order, (0.0, 0.0)), np.frombuffer(waves)
    half, place = np.unique(np.round(path.half, 12), return_inverse=True)
    degree = np.arange(path.order)
    argument = kappa[:, None, None] * half[:, None]
    # j_l(-z) = (-1)^l j_l(z)
    sign = np.where(argument < 0.0, (-1.0) ** degree, 1.0)
    bessel = sign * spherical_jn(degree, np.abs(argument))
    on_panel = (2.0 * half[:, None] * bessel * (-1j) ** degree)[:, place, :]
    return np.asarray(on_panel * np.exp(-1j * kappa[:, None] * path.middle)[:, :, None])


def arrivals(omega: Reals, loads: Reals, entry_s: Reals, force_rad_per_s: float = 0.0) -> Complexes:
    """Sum of wheels that carry the same force from other times, shape (F,), N.

    Parameters
    ----------
    omega : ndarray, shape (F,)
    loads : ndarray, shape (wheels,)
        N.
    entry_s : ndarray, shape (wheels,)
        When each wheel is at x = 0.
    force_rad_per_s : float
        omega_0: the force of every wheel is that of one clock, exp(i omega_0 t).
    """
    return np.asarray(np.exp(-1j * np.outer(omega - force_rad_per_s, entry_s)) @ loads)


def sampled_moments(
    path: Path,
    omega: Reals,
    speed: float,
    courses: Sequence[Course],
    entry_s: Reals,
    highest_rad_per_s: float,
) -> Complexes:
    """Moments of forces of any course over time, all wheels together, shape (F, panels, order), N s.

    Parameters
    ----------
    path : Path
    omega : ndarray, shape (F,)
        rad/s.
    speed : float
        V, m/s.
    courses : sequence of callable, one for each wheel
        Force over the clock's time.
    entry_s : ndarray, shape (wheels,)
        When each wheel is at x = 0.
    highest_rad_per_s : float
        Highest frequency in the forces.
    """
    inside, weight = gauss(points_needed(path, float(omega[-1]), highest_rad_per_s, speed))
    x = path.points(inside)
    times = [x / speed + start for start in entry_s]
    force = np.stack([course(t.ravel()) for course, t in zip(courses, times, strict=True)])
    basis = legvander(inside, path.order - 1) * weight[:, None]
    moments = np.empty((omega.size, *x.shape[:1], path.order), dtype=np.complex128)
    step = max(1, _POINTS // x.size)
    for first in range(0, omega.size, step):
        chunk = omega[first : first + step]
        imposed = np.exp(-1j * np.outer(chunk, entry_s)) @ force
        imposed *= np.exp(-1j * np.outer(chunk, x.ravel() / speed))
        shaped = imposed.reshape(chunk.size, *x.shape)
        moments[first : first + step] = (shaped @ basis) * (path.half[:, None] / speed)
    return moments


def points_needed(path: Path, highest: float, force: float, speed: float) -> int:
    """Gauss's points on a panel: half the phase across half of it, the polynomials, and sixteen more."""
    phase = (highest + force) / speed * float(path.half.max())
    return int(np.ceil(0.5 * phase + 0.5 * path.order)) + 16


def carried(coefficients: Complexes, moments: Complexes) -> tuple[Complexes, Complexes]:
    """Spectrum at the sensors, and the part of it that the highest two polynomials bring.

    Parameters
    ----------
    coefficients : ndarray, shape (F, sensors, panels, order)
        Of :meth:`permway.response.passby.path.Path.coefficients`, m/N.
    moments : ndarray, shape (F, panels, order)
        N s.

    Returns
    -------
    (ndarray, ndarray), each of shape (F, sensors)
        m/Hz.
    """
    by_degree = np.einsum("fspl,fpl->fsl", coefficients, moments, optimize=True)
    return by_degree.sum(-1), by_degree[:, :, -2:].sum(-1)
