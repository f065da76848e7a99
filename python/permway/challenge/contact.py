"""Wheels on Hertz's contact, which may leave the rail: marched in time, as no frequency response describes it.

What the contact presses beyond a linear spring acts as a profile does that is higher by that force over the
spring's stiffness. So motion is known of the linear response, and the force of the motion, step by step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from permway.challenge.beams import Complexes, Reals
from permway.errors import SolveError

RATE_HZ = 8192.0
"""Of the steps."""

TAPER_HZ = (3000.0, 4000.0)
"""Where the response to an impact is cut: from 2 to 3 kHz a landing's peak was 10 % off, here 3 (a test)."""

LASTING_S, LINE_HZ = 1.0, 0.25
"""How long an impact acts, and the lines that its response is made of."""

ROUNDS, CLOSE = 100, 1e-7
"""Of a step, and the change of its force over the load at which it ends."""


@dataclass(frozen=True)
class Hertz:
    """Contact of two round bodies, about its rest.

    Parameters
    ----------
    load_N : float
        Of a wheel at rest.
    stiffness : float
        Of the linear spring that it is for small motion, N/m.
    """

    load_N: float
    stiffness: float

    def force(self, compression: Reals) -> Reals:
        """Force beyond the load per compression beyond that at rest; minus the load where wheels have left."""
        at_rest = 1.5 * self.load_N / self.stiffness
        return np.asarray(self.load_N * (np.maximum(1.0 + compression / at_rest, 0.0) ** 1.5 - 1.0))

    def beyond(self, compression: Reals) -> Reals:
        """What it presses more than the linear spring would."""
        return np.asarray(self.force(compression) - self.stiffness * compression)


def impact(pressed: Callable[[Reals], Complexes], stiffness: float) -> Reals:
    """How much compression is lost after a force of one step, 1 N.

    Made of the real part alone, so that nothing comes before the force.

    Parameters
    ----------
    pressed : callable
        Of frequencies above 0 (Hz): contact forces per profile under each wheel, shape (F, W, W), N/m.
    stiffness : float
        Of the linear contact, N/m.

    Returns
    -------
    ndarray, shape (steps, W, W)
        m/N.
    """
    lines = np.arange(0.0, 0.5 * RATE_HZ + 0.5 * LINE_HZ, LINE_HZ)
    solved = (lines > 0.0) & (lines < TAPER_HZ[1])
    force = pressed(lines[solved])
    wheels = np.eye(force.shape[1])
    spectrum = np.zeros((lines.size, *wheels.shape))
    # At rest a wheel's load is what it carries, whatever the profile.
    spectrum[0] = wheels / stiffness
    spectrum[solved] = (force / stiffness + wheels).real / stiffness
    share = np.clip((TAPER_HZ[1] - lines) / (TAPER_HZ[1] - TAPER_HZ[0]), 0.0, 1.0)
    spectrum *= 0.5 * (1.0 - np.cos(np.pi * share))[:, None, None]
    even = np.fft.irfft(spectrum, axis=0)[: round(LASTING_S * RATE_HZ)]
    return np.concatenate([even[:1], 2.0 * even[1:]])


def march(contact: Hertz, compression: Reals, after: Reals) -> Reals:
    """What contacts press beyond linear springs.

    Parameters
    ----------
    contact : Hertz
    compression : ndarray, shape (N, W)
        Of linear contacts, m, a step each.
    after : ndarray, shape (steps, W, W)
        From :func:`impact`.

    Returns
    -------
    ndarray, shape (N, W)
        N.

    Raises
    ------
    SolveError
        At a step whose force is not found.
    """
    steps, wheels = compression.shape
    reach = after.shape[0] - 1
    # The latest first, so that what has been lies in one piece before each step.
    pressed = np.zeros((steps + reach) * wheels)
    lost = np.ascontiguousarray(after[1:].transpose(1, 0, 2).reshape(wheels, reach * wheels))
    at_once, most = after[0], CLOSE * contact.load_N
    force = np.zeros(wheels)
    for step in range(steps):
        start = (steps - step) * wheels
        left = compression[step] - lost @ pressed[start : start + reach * wheels]
        for _ in range(ROUNDS):
            last, force = force, contact.beyond(left - at_once @ force)
            if np.abs(force - last).max() <= most:
                break
        else:
            raise SolveError(f"the contact's force does not settle at {step / RATE_HZ:g} s")
        pressed[start - wheels : start] = force
    return np.asarray(pressed[: steps * wheels].reshape(steps, wheels)[::-1])


def as_profile(
    contact: Hertz, pressed: Callable[[Reals], Complexes], lines_Hz: Reals, profiles: Complexes, *, samples: int
) -> Complexes:
    """The profiles under linear contacts that move wheels and track as these do under Hertz's.

    Parameters
    ----------
    contact : Hertz
    pressed : callable
        See :func:`impact`.
    lines_Hz : ndarray, shape (F,)
        Of a periodic record, whole multiples of its first.
    profiles : ndarray of complex128, shape (F, W)
        Transform of that record.
    samples : int
        Of the record.

    Returns
    -------
    ndarray of complex128, shape (F, W)
    """
    line = lines_Hz[1] - lines_Hz[0]
    bins = np.round(lines_Hz / line).astype(int)
    steps = round(RATE_HZ / line)
    spectrum = np.zeros((steps // 2 + 1, profiles.shape[1]), dtype=np.complex128)
    spectrum[bins] = np.einsum("fij,fj->fi", pressed(lines_Hz), profiles) * (steps / samples / contact.stiffness)
    compression = np.fft.irfft(spectrum, n=steps, axis=0)
    after = impact(pressed, contact.stiffness)
    # The record is periodic: its end comes before its beginning.
    before = min(after.shape[0], steps)
    beyond = march(contact, np.concatenate([compression[-before:], compression]), after)[before:]
    transform = np.fft.rfft(beyond, axis=0)[bins] * (samples / steps)
    return np.asarray(profiles - transform / contact.stiffness)
