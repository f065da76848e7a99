"""How a rail moves under wheels that roll, by the harmonics of the fasteners that they pass.

A force F exp(i w t) that moves at a speed V moves a point that keeps its distance d at w, and at w + n Omega, with
Omega = 2 pi V / h and h the fasteners' spacing: u(t) = sum over n of K_n(w + n Omega) F exp(i (w + n Omega) t).
Of the receptance G(x, y; w) in time, g(x, y; s), K is the transform along the wheel's way,

    K(p, w) = integral of g(y + d + V s, y; s) exp(-i w s) ds,    y at the share p of a bay,

and K_n its Fourier series over p (Sheng, Jones and Thompson, J. Sound Vib. 282 (2005) 1055, treat the same by
wavenumbers). That the point has moved on when a wave arrives is Doppler's effect, and in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.model.bodies import Beam
from permway.model.line import Line
from permway.response.core import Formulation
from permway.response.receptance import Place, between

PHASES = 8
"""Places of a bay from which forces start."""

HARMONICS = 3
"""Of the passing, on either side, which so many places tell apart."""

STEP_HZ = 1.0
"""Of the transform: what is left after 1 s wraps around."""

PER_BAY = PHASES
"""Places to a bay where the rail is read, forces' own among them, for it has a kink there; between them cubics."""

BEHIND_M, AHEAD_S = 3.0, 0.25
"""The rail is read from so far behind the last wheel to where the first will be so much later."""

NEAR = (-6, -2, 2, 6)
"""Bays by which wheels are moved to places whose mean is taken where nothing below comes in pieces of a length."""

EVERY = 2
"""Where something does, a mean over every second bay of a piece."""

TAPER = 0.85
"""Share of the highest frequency from which the transform fades out."""

FORWARD = 0.75
"""Share of the transform's period that is time after the force; the rest is before it, where hysteretic laws
answer."""


@dataclass(frozen=True, eq=False)
class Kernel:
    """Motion of the rail under wheels per force under wheels, all rolling.

    Attributes
    ----------
    frequency_Hz : ndarray, shape (F,)
        From 0 Hz, equally spaced; of the motion.
    harmonics : ndarray of complex128, shape (2 M + 1, F, wheels, wheels)
        K_n of n from -M to M, m/N, their mean over places some bays apart.
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
        For a speed, a spacing or a frequency that is not above zero, and places that the line does not have.
    SolveError
        If the line cannot be solved.
    """
    for where, value in (("speed_m_per_s", speed_m_per_s), ("spacing_m", spacing_m), ("to_Hz", to_Hz)):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError("must be above zero", where=where, value=value)
    wheels = np.asarray(wheels_m, dtype=np.float64)
    solved = np.arange(1, next_fast_len(int(np.ceil(to_Hz / TAPER / STEP_HZ)), real=True) + 1) * STEP_HZ
    step = spacing_m / PER_BAY
    reach = float(np.ptp(wheels)) + BEHIND_M, float(np.ptp(wheels)) + spacing_m + AHEAD_S * speed_m_per_s
    read = step * np.arange(-np.ceil(reach[0] / step), np.ceil(reach[1] / step) + 1.0)
    phases = spacing_m / PHASES * np.arange(PHASES)
    kept = int(to_Hz / STEP_HZ) + 1
    standing = np.empty((kept, wheels.size, wheels.size), dtype=np.complex128)
    harmonics = np.zeros((2 * HARMONICS + 1, *standing.shape), dtype=np.complex128)
    orders = np.arange(-HARMONICS, HARMONICS + 1)
    series = np.exp(-2j * np.pi * np.outer(orders, np.arange(PHASES)) / PHASES) / PHASES
    shifts, over_all = _places(line, wheels, spacing_m)
    for shift in (None, *shifts):
        at = wheels if shift is None else wheels + shift * spacing_m
        points = [Place(body=body, x_m=float(x), name=f"wheel {i}") for i, x in enumerate(at)]
        for source, x in enumerate(at):
            sensors = points + [Place(body=body, x_m=float(x + r), name=f"{i}") for i, r in enumerate(read)]
            answer = between(
                line,
                solved,
                forces=[Place(body=body, x_m=float(x + p), name=f"{p:g}") for p in phases],
                sensors=points if shift is None else sensors,
                temperature_C=temperature_C,
                formulation=formulation,
                threads=threads,
            ).receptance
            # At rest as at the lowest frequency, without what it loses.
            answer = np.concatenate([answer[:1].real.astype(np.complex128), answer])
            still = answer[:kept, : wheels.size, 0]
            if shift is None:
                standing[:, :, source] = still
                continue
            seen = np.empty((PHASES, kept, wheels.size), dtype=np.complex128)
            for index, p in enumerate(phases):
                starts = at - x + p
                seen[index] = _along(answer[:, wheels.size :, index], read, starts, speed_m_per_s)[:kept]
            found = np.tensordot(series, seen, axes=1)
            if not over_all:
                # What rolling changes; whatever is below stays as it is where the train stands.
                found[HARMONICS] += standing[:, :, source] - still
            harmonics[:, :, :, source] += found / len(shifts)
    return Kernel(STEP_HZ * np.arange(kept, dtype=np.float64), harmonics, standing, spacing_m, speed_m_per_s)


def _places(line: Line, wheels: Reals, spacing: float) -> tuple[Sequence[int], bool]:
    """Bays by which wheels are moved, and whether what is below comes back after them."""
    middle = float(wheels.mean())
    pieces = [
        stop - start
        for body in line.bodies.values()
        if isinstance(body, Beam) and body.intervals_m is not None and len(body.intervals_m) > 1
        for start, stop in body.intervals_m
        if start <= middle <= stop
    ]
    if not pieces:
        return NEAR, False
    bays = max(1, round(max(pieces) / spacing))
    count = -(-bays // EVERY)
    return [round(bays * (i / count - 0.5)) for i in range(count)], True


def _along(answer: Complexes, read: Reals, starts: Reals, speed: float) -> Complexes:
    """Transform of what points see that move from `starts` on, (F, points); `answer` (F, places) of one force."""
    lines = answer.shape[0]
    edge = TAPER * (lines - 1)
    fade = 0.5 * (1.0 + np.cos(np.pi * np.clip((np.arange(lines) - edge) / (lines - 1 - edge), 0.0, 1.0)))
    history = np.fft.irfft(answer * fade[:, None], axis=0)
    size = history.shape[0]
    time = np.arange(size) / (size * STEP_HZ)
    time = np.where(time > FORWARD / STEP_HZ, time - 1.0 / STEP_HZ, time)
    step = read[1] - read[0]
    place = (starts + speed * time[:, None] - read[0]) / step
    near = np.clip(np.floor(place).astype(np.int64), 1, read.size - 3)
    away = place - near
    # Cubics through the four nearest; beyond what is read the force has been left behind.
    weights = (
        -away * (away - 1.0) * (away - 2.0) / 6.0,
        (away + 1.0) * (away - 1.0) * (away - 2.0) / 2.0,
        -(away + 1.0) * away * (away - 2.0) / 2.0,
        (away + 1.0) * away * (away - 1.0) / 6.0,
    )
    rows = np.arange(size)[:, None]
    seen = sum(weight * history[rows, near + k - 1] for k, weight in enumerate(weights))
    inside = (place >= 0.0) & (place <= read.size - 1.0)
    return np.asarray(np.fft.rfft(np.where(inside, seen, 0.0), axis=0))
