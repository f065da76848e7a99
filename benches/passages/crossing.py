"""A supported beam that axles cross, in time: constant forces, or masses on springs that roll over it.

Shares no code with the solver. Modes of Euler's beam, each integrated exactly for a force that is linear between
fine samples; masses on springs by turns with the beam, until neither moves the other any more.
Fryba, Vibration of Solids and Structures under Moving Loads (1999), chapters 1.4 and 8.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import signal

MODES, FINER = 60, 16
"""Modes, and fine samples a sample of the record."""

TURNS, SETTLED = 30, 1e-8


@dataclass(frozen=True)
class Beam:
    """A beam on two supports: length, m; bending stiffness, N m2; mass, kg/m; damping ratio of all modes."""

    length_m: float
    bending_Nm2: float
    kg_per_m: float
    damping: float

    @property
    def first_Hz(self) -> float:
        """Its first natural frequency."""
        return float(0.5 * np.pi * np.sqrt(self.bending_Nm2 / self.kg_per_m) / self.length_m**2)


@dataclass(frozen=True)
class Train:
    """Axles: loads, N; distances behind the first, m; speed, m/s; when the first enters, s.

    With a spring, N/m, and a damper, N s/m, of each axle all of its load is a mass on them.
    """

    loads_N: np.ndarray
    lags_m: np.ndarray
    speed: float
    entry_s: float
    spring: float = 0.0
    damper: float = 0.0


@dataclass(frozen=True)
class Sensor:
    """What stands where: "displacement", "velocity", "acceleration", "strain" or "bending_moment"."""

    quantity: str
    x_m: float
    height_m: float = 0.0


def histories(beam: Beam, train: Train, sensors: list[Sensor], rate_Hz: float, samples: int) -> np.ndarray:
    """What sensors read, SI, behind an anti-aliasing filter, shape (sensors, samples)."""
    step = 1.0 / (rate_Hz * FINER)
    time = np.arange((samples + 100) * FINER) * step
    place = (time - train.entry_s)[None, :] * train.speed - train.lags_m[:, None]
    on = (place >= 0.0) & (place <= beam.length_m)
    number = np.arange(1, MODES + 1)
    omega = 2.0 * np.pi * beam.first_Hz * number**2
    force = np.where(on, train.loads_N[:, None], 0.0)
    if train.spring > 0.0:
        force = _sprung(beam, train, omega, place, on, step)
    q, u, a = _modal(beam, omega, _driven(beam, place, force, number), step)
    held = omega < 0.9 * np.pi / step
    read = []
    for sensor in sensors:
        shape = np.sin(number * np.pi * sensor.x_m / beam.length_m)
        bent = shape * (number * np.pi / beam.length_m) ** 2
        read.append(
            {
                "displacement": shape @ q,
                "velocity": shape @ u,
                # Modes beyond the fine samples would be folded into the band.
                "acceleration": shape[held] @ a[held],
                "strain": sensor.height_m * (bent @ q),
                "bending_moment": beam.bending_Nm2 * (bent @ q),
            }[sensor.quantity]
        )
    return np.asarray(signal.resample_poly(np.stack(read), 1, FINER, axis=1)[:, :samples])


def _driven(beam: Beam, place: np.ndarray, force: np.ndarray, number: np.ndarray) -> np.ndarray:
    """Modal forces over modal masses, shape (modes, samples)."""
    return np.stack(
        [
            2.0 / (beam.kg_per_m * beam.length_m) * (force * np.sin(n * np.pi * place / beam.length_m)).sum(axis=0)
            for n in number
        ]
    )


def _modal(
    beam: Beam, omega: np.ndarray, driven: np.ndarray, step: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacement, velocity and acceleration of each mode."""
    q, u = np.empty_like(driven), np.empty_like(driven)
    for i, w in enumerate(omega):
        q[i], u[i] = _oscillator(w, beam.damping, driven[i], step)
    a = driven - 2.0 * beam.damping * omega[:, None] * u - omega[:, None] ** 2 * q
    return q, u, a


def _oscillator(omega: float, damping: float, driven: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Of q'' + 2 damping omega q' + omega^2 q = driven, exactly for what is linear between samples."""
    system = (
        np.array([[0.0, 1.0], [-(omega**2), -2.0 * damping * omega]]),
        np.array([[0.0], [1.0]]),
        np.eye(2),
        np.zeros((2, 1)),
    )
    numerator, denominator = signal.ss2tf(*signal.cont2discrete(system, step, "foh")[:4])
    return tuple(signal.lfilter(row, denominator, driven) for row in numerator)  # type: ignore[return-value]


def _sprung(
    beam: Beam, train: Train, omega: np.ndarray, place: np.ndarray, on: np.ndarray, step: float
) -> np.ndarray:
    """Forces under masses on springs, shape (axles, samples)."""
    number = np.arange(1, omega.size + 1)
    mass = train.loads_N / 9.81
    shapes = np.where(on, np.sin(number[:, None, None] * np.pi * place / beam.length_m), 0.0)
    force = np.where(on, train.loads_N[:, None], 0.0)
    for _ in range(TURNS):
        q, _, _ = _modal(beam, omega, _driven(beam, place, force, number), step)
        under = np.einsum("nt,nat->at", q, shapes)
        rises = np.gradient(under, step, axis=1)
        new = force.copy()
        for i, m in enumerate(mass):
            # Of the mass, down from rest: the spring stands on the beam, which is level before and behind it.
            w0 = np.sqrt(train.spring / m)
            pushed = (train.spring * under[i] + train.damper * rises[i]) / m
            z, v = _oscillator(w0, 0.5 * train.damper / (m * w0), pushed, step)
            more = train.spring * (z - under[i]) + train.damper * (v - rises[i])
            new[i] = np.where(on[i], train.loads_N[i] + more, 0.0)
        moved = np.abs(new - force).max() / train.loads_N.max()
        force = new
        if moved < SETTLED:
            return force
    raise ArithmeticError(f"axles and beam do not settle: {moved:.1g}")
