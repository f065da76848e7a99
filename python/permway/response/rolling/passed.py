"""What points see that roll on, ahead of forces that pass a bay and leave waves behind."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial.legendre import leggauss

from permway.arrays import Complexes, Reals
from permway.model.line import Line
from permway.response.rolling.bays import PARTS, Bays, bays

PHASES = 12
"""Places of a bay from which forces start, Gauss's: over a fastener K has a kink; equal steps would blur it."""

HARMONICS = 5
"""Of the passing, on either side."""

STEP_HZ = 1.0
"""Of the transform: what is left after 1 s wraps around."""

BEHIND_M, AHEAD_S = 3.0, 0.25
"""The rail is read from so far behind the last wheel to where the first will be so much later."""

TAPER = 0.6
"""Share of the highest frequency from which the transform fades out."""

FORWARD = 0.75
"""Share of the transform's period that is time after the force; the rest is before it, where hysteretic laws
answer."""


def passed(
    answer: Callable[[Reals, Reals], Complexes],
    line: Line,
    body: str,
    places: Reals,
    ahead: Reals,
    *,
    speed: float,
    spacing: float,
    kept: int,
) -> list[Complexes]:
    """What points see that roll on, ahead of forces that pass the bays in which places are.

    Parameters
    ----------
    answer : callable
        From places of forces and of sensors, m, to receptances (F, sensors, forces), every `STEP_HZ` from 0 Hz.
    line : Line
    body : str
    places : ndarray, shape (places,)
        m.
    ahead : ndarray, shape (places, points)
        How far points are ahead of each force, m.
    speed, spacing : float
        m/s; of bays, m.
    kept : int
        Lines that are wanted.

    Returns
    -------
    list of ndarray of complex128, shape (2 M + 1, kept, points)
        K_n, by how far forces are from `places`, of each.
    """
    nodes, weights = leggauss(PHASES)
    far = places[:, None] + ahead
    rail = bays(line, body, far.min() - spacing - BEHIND_M, far.max() + spacing + AHEAD_S * speed)
    begins = rail.edges_m[rail.piece(places)]
    pushed_from = begins[:, None] + 0.5 * spacing * (nodes + 1.0)
    first = np.unique(rail.shares(pushed_from)[0])
    pushed = np.unique(first[:, None] + np.arange(PARTS + 1))
    answers, found = answer(rail.read_m[pushed], rail.read_m), []
    for x, starts, away in zip(places, pushed_from, ahead, strict=True):
        mine = np.unique(rail.shares(starts)[0])
        used = np.searchsorted(pushed, np.arange(mine[0], mine[-1] + PARTS + 1))
        seen = _under_wheels(rail, answers[:, :, used], int(mine[0]), starts, away, speed)[:, :kept]
        turns = np.outer(np.arange(-HARMONICS, HARMONICS + 1), starts - x) / spacing
        found.append(np.tensordot(0.5 * weights * np.exp(-2j * np.pi * turns), seen, axes=1))
    return found


def _under_wheels(
    rail: Bays, answer: Complexes, first: int, from_m: Reals, ahead_m: Reals, speed: float
) -> Complexes:
    """Transform of what points see that roll on, `ahead_m` of a force at each of `from_m`: (places, F, points).

    `answer` is of the rail where it is read, per force at those places that follow the `first`, (F, read, forces).
    """
    history, second = _in_time(answer)
    size, read = history.shape[0], rail.read_m
    time = np.arange(size) / (size * STEP_HZ)
    time = np.where(time > FORWARD / STEP_HZ, time - 1.0 / STEP_HZ, time)
    from_first, still, moving = rail.shares(from_m)
    squared = (2.0 * np.pi * STEP_HZ * np.arange(answer.shape[0], dtype=np.float64))[:, None] ** 2
    seen = np.empty((from_m.size, answer.shape[0], ahead_m.size), dtype=np.complex128)
    for index, x in enumerate(from_m):
        place = x + ahead_m + speed * time[:, None]
        # Beyond what is read the force has been left behind.
        inside = (place >= read[0]) & (place <= read[-1])
        rows = np.flatnonzero(inside.any(axis=1))
        near, *shares = rail.shares(place[rows])
        four = slice(from_first[index] - first, from_first[index] - first + PARTS + 1)
        by, by_mass = still[:, index], moving[:, index]
        displaced = np.zeros(place.shape)
        for k, (share, of_mass) in enumerate(zip(*shares, strict=True)):
            here, there = (of[:, :, four][rows[:, None], near + k] for of in (history, second))
            displaced[rows] += share * (here @ by - there @ by_mass) - of_mass * (there @ by)
        seen[index] = np.fft.rfft(np.where(inside, displaced, 0.0), axis=0)
        at_once, by_mass_too = rail.beyond(x + ahead_m, x)
        seen[index] += at_once + squared * by_mass_too
    return seen


def _in_time(answer: Complexes) -> tuple[Reals, Reals]:
    """Response to an impulse and its second derivative, faded out towards the highest frequency.

    Of (F, ...) they are (2 F - 2, ...).
    """
    lines = answer.shape[0]
    edge = TAPER * (lines - 1)
    fade = 0.5 * (1.0 + np.cos(np.pi * np.clip((np.arange(lines) - edge) / (lines - 1 - edge), 0.0, 1.0)))
    twice = -((2.0 * np.pi * STEP_HZ * np.arange(lines)) ** 2)
    return (
        np.fft.irfft(answer * fade[:, None, None], axis=0),
        np.fft.irfft(answer * (fade * twice)[:, None, None], axis=0),
    )
