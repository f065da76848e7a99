"""How a rail moves under wheels that roll, by the harmonics of the fasteners that they pass.

A force F exp(i w t) that moves at a speed V moves a point that keeps its distance d at w, and at w + n Omega, with
Omega = 2 pi V / h and h the fasteners' spacing: u(t) = sum over n of K_n(w + n Omega) F exp(i (w + n Omega) t).
Of the receptance G(x, y; w) in time, g(x, y; s), K is the transform along the wheel's way,

    K(p, w) = integral of g(y + d + V s, y; s) exp(-i w s) ds,    y at the share p of a bay,

and K_n its Fourier series over p (Sheng, Jones and Thompson, J. Sound Vib. 282 (2005) 1055, treat the same by
wavenumbers). That the point has moved on when a wave arrives is Doppler's effect, and in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.fft import next_fast_len

from permway.arrays import Complexes, Reals, is_real, real_numbers
from permway.errors import InputError
from permway.model.bodies import Beam
from permway.model.line import Line
from permway.model.place import Place
from permway.model.stations import TOUCH_M
from permway.response.core import Formulation
from permway.response.receptance import between
from permway.response.rolling.bays import bays
from permway.response.rolling.passed import AHEAD_S, BEHIND_M, HARMONICS, STEP_HZ, TAPER, passed

NEAR = (-6, -2, 2, 6)
"""Bays by which wheels are moved to places whose mean is taken where nothing below comes in pieces of a length."""

MOST = 24
"""Bays of a piece over which a mean is taken where something does: all, or as many as this, spread evenly."""

TOGETHER = 4
"""Bays that are solved at once."""


@dataclass(frozen=True, eq=False)
class Kernel:
    """Motion of the rail under wheels per force under wheels, all rolling.

    Attributes
    ----------
    frequency_Hz : ndarray, shape (F,)
        From 0 Hz, equally spaced; of the motion.
    harmonics : ndarray of complex128, shape (2 M + 1, F, wheels, wheels)
        K_n of n from -M to M, m/N, their mean over the bays of a piece, or over places some bays apart.
    standing : ndarray of complex128, shape (F, wheels, wheels)
        Receptance while the wheels stand where they are at the time 0.
    spacing_m, speed_m_per_s : float
    """

    frequency_Hz: Reals
    harmonics: Complexes
    standing: Complexes
    spacing_m: float
    speed_m_per_s: float


def kernel(
    line: Line,
    body: str,
    wheels_m: Reals,
    *,
    speed_m_per_s: float,
    spacing_m: float,
    to_Hz: float,
    temperature_C: float | None = None,
    formulation: Formulation = "chain",
    threads: int | None = None,
) -> Kernel:
    """The rail under wheels that roll.

    Parameters
    ----------
    line : Line
    body : str
        That the wheels roll on; it goes on without end, or for as far as they roll in 0.25 s.
    wheels_m : ndarray, shape (wheels,)
        Where they are at the time 0, the leading one first, m. Where something below comes in pieces, spans or
        slabs, the mean is taken over the longest under the train; else over places near, of what rolling changes.
    speed_m_per_s : float
    spacing_m : float
        Of what repeats along the rail.
    to_Hz : float
        Highest frequency.
    temperature_C, formulation, threads
        As of :func:`permway.response.receptance.receptance`.

    Raises
    ------
    InputError
        For a speed, a spacing or a frequency that is not above zero, places that the line does not have, and a
        body that is no beam.
    SolveError
        If the line cannot be solved.
    """
    for where, value in (("speed_m_per_s", speed_m_per_s), ("spacing_m", spacing_m), ("to_Hz", to_Hz)):
        if not (is_real(value) and np.isfinite(value) and value > 0.0):
            raise InputError("must be above zero", where=where, value=value)
    wheels = real_numbers(wheels_m, "wheels_m")
    solved: Reals = STEP_HZ * np.arange(1.0, next_fast_len(int(np.ceil(to_Hz / TAPER / STEP_HZ)), real=True) + 1.0)
    kept = int(to_Hz / STEP_HZ) + 1
    answer = partial(
        _answer, line, body, solved, temperature_C=temperature_C, formulation=formulation, threads=threads
    )
    displaced = partial(passed, answer, line, body, speed=speed_m_per_s, spacing=spacing_m, kept=kept)
    standing = answer(wheels, wheels)[:kept]
    ahead = wheels[:, None] - wheels
    harmonics = np.zeros((2 * HARMONICS + 1, *standing.shape), dtype=np.complex128)
    orders = np.arange(-HARMONICS, HARMONICS + 1)
    starts = _starts(line, body, wheels)
    if starts is None:
        for shift in NEAR:
            at = wheels + shift * spacing_m
            found = np.stack(displaced(at, ahead.T), axis=-1)
            # What rolling changes; whatever is below stays as it is where the train stands.
            found[HARMONICS] += standing - answer(at, at)[:kept]
            harmonics += found / len(NEAR)
    else:
        apart, which = np.unique(ahead.round(9), return_inverse=True)
        which = which.reshape(ahead.shape)
        for first in range(0, starts.size, TOGETHER):
            some = starts[first : first + TOGETHER]
            for x, found in zip(some, displaced(some, np.tile(apart, (some.size, 1))), strict=True):
                turned = np.exp(-2j * np.pi * np.outer(orders, x - wheels) / spacing_m)
                harmonics += found[:, :, which] * (turned / starts.size)[:, None, None, :]
    return Kernel(STEP_HZ * np.arange(kept, dtype=np.float64), harmonics, standing, spacing_m, speed_m_per_s)


def _starts(line: Line, body: str, wheels: Reals) -> Reals | None:
    """Where bays begin of the longest piece under the train, over which a mean is taken; None without a piece."""
    middle = float(wheels.mean())
    pieces = [
        (start, stop)
        for below in line.bodies.values()
        if isinstance(below, Beam) and below.intervals_m is not None and len(below.intervals_m) > 1
        for start, stop in below.intervals_m
        if start <= middle <= stop
    ]
    if not pieces:
        return None
    start, stop = max(pieces, key=lambda piece: piece[1] - piece[0])
    edges = bays(line, body, start, stop).edges_m
    edges = edges[(edges >= start - TOUCH_M) & (edges < stop - TOUCH_M)]
    return np.asarray(edges[np.unique(np.linspace(0, edges.size - 1, min(edges.size, MOST)).round().astype(int))])


def reach(
    line: Line, body: str, wheels_m: Reals, *, speed_m_per_s: float, spacing_m: float
) -> tuple[float, float]:
    """From where to where a rail is read for a :func:`kernel` of the same arguments, m."""
    starts, longest = _starts(line, body, wheels_m), float(np.ptp(wheels_m))
    if starts is None:
        first, last = wheels_m.min() + NEAR[0] * spacing_m, wheels_m.max() + NEAR[-1] * spacing_m
    else:
        first, last = starts.min() - longest, starts.max() + longest
    return float(first - spacing_m - BEHIND_M), float(last + spacing_m + AHEAD_S * speed_m_per_s)


def _answer(
    line: Line,
    body: str,
    lines_Hz: Reals,
    forces_m: Reals,
    sensors_m: Reals,
    *,
    temperature_C: float | None,
    formulation: Formulation,
    threads: int | None,
) -> Complexes:
    """Receptance at 0 Hz and lines, (1 + F, sensors, forces); at rest as at the lowest, without what it loses."""
    forces, sensors = (
        [Place(body=body, x_m=float(x), name=f"{i}") for i, x in enumerate(places)]
        for places in (forces_m, sensors_m)
    )
    found = between(
        line,
        lines_Hz,
        forces=forces,
        sensors=sensors,
        temperature_C=temperature_C,
        formulation=formulation,
        threads=threads,
    ).receptance
    return np.concatenate([found[:1].real.astype(np.complex128), found])
