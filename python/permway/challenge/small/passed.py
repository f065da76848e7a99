"""A ballasted track as finite elements that axles pass, in time: no code is shared with the solver.

The rail is of beam elements, sleepers are masses, fasteners and bed springs with dashpots. The motion is that of
the complex modes of all degrees of freedom, each integrated exactly for forces that are linear within a step.
Source: Meirovitch, Fundamentals of Vibrations (2001), sections 7.15 and 9.5, for the modes of a damped system.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from permway.challenge.beams import Complexes, Reals, Section, element, shape

PARTS = 4
"""Elements to a bay: cubic ones of 0.15 m, which carry a rail's wave of 100 Hz, 3 m long, to 1e-5."""

FINER = 10
"""Steps to a sample: an axle at 40 m/s goes on by 10 mm at 400 samples a second."""

AFTER_S = 0.4
"""Time beyond the record that is solved, too, at whose end the track is at rest."""

FILTER = (0.3, 0.45)
"""Shares of the rate between which the recorder's filter goes from one to nothing."""

FASTEST = 0.9 * np.pi
"""Angle a step by which modes turn at most."""


@dataclass(frozen=True)
class Axles:
    """Wheels on one rail: loads, N; lags behind the first, m; speed, m/s; when the first enters, s."""

    loads_N: Reals
    lags_m: Reals
    speed: float
    entry_s: float


@dataclass(frozen=True)
class Ballasted:
    """A track with a sleeper at each station.

    Attributes
    ----------
    rail : Section
        Of Euler's beam, without loss of its own.
    ends_m : (float, float)
        Of the rail.
    stations_m : tuple of float
    sleeper_kg : float
    pad, bed : (float, float)
        Stiffness, N/m, and dashpot, N s/m, of each support.
    pad_factors, bed_factors : tuple of float
        By station, on both.
    """

    rail: Section
    ends_m: tuple[float, float]
    stations_m: tuple[float, ...]
    sleeper_kg: float
    pad: tuple[float, float]
    bed: tuple[float, float]
    pad_factors: tuple[float, ...]
    bed_factors: tuple[float, ...]

    @cached_property
    def nodes_m(self) -> Reals:
        """Of the rail; every station is one."""
        marks = [self.ends_m[0], *self.stations_m, self.ends_m[1]]
        parts = [np.linspace(a, b, PARTS + 1)[:-1] for a, b in pairwise(marks)]
        return np.array([*np.concatenate(parts), marks[-1]])

    @cached_property
    def size(self) -> int:
        """Degrees of freedom: deflection and rotation of nodes, then sleepers."""
        return 2 * self.nodes_m.size + len(self.stations_m)

    def sleeper(self, station: int) -> int:
        """Its degree of freedom."""
        return 2 * self.nodes_m.size + station

    def over(self, x_m: Reals) -> list[tuple[NDArray[np.int64], slice, Reals]]:
        """Of places on the rail, by element: which of them, its degrees, and their shares, (places, 4)."""
        number = np.clip(np.searchsorted(self.nodes_m, x_m, side="right") - 1, 0, self.nodes_m.size - 2)
        lengths, found = np.diff(self.nodes_m), []
        for index in np.unique(number).tolist():
            mine = np.flatnonzero(number == index)
            shares = shape(self.rail, float(lengths[index]), x_m[mine] - self.nodes_m[index])
            found.append((mine, slice(2 * index, 2 * index + 4), shares))
        return found

    def reads(self, body: str, x_m: float) -> Reals:
        """Share of each degree of freedom in what stands on the rail or on the sleeper there, (n,)."""
        found = np.zeros(self.size)
        if body == "rail":
            ((_, degrees, shares),) = self.over(np.array([x_m]))
            found[degrees] = shares[0]
        else:
            found[self.sleeper(self.stations_m.index(x_m))] = 1.0
        return found

    @cached_property
    def _matrices(self) -> tuple[Reals, Reals, Reals]:
        """Mass, damping, stiffness."""
        mass, damping, stiffness = (np.zeros((self.size, self.size)) for _ in range(3))
        for index, length in enumerate(np.diff(self.nodes_m)):
            k, m = element(self.rail, float(length))
            at = slice(2 * index, 2 * index + 4)
            stiffness[at, at] += k
            mass[at, at] += m
        for station in range(len(self.stations_m)):
            under, mine = 2 * PARTS * (station + 1), self.sleeper(station)
            mass[mine, mine] += self.sleeper_kg
            for table, which in ((stiffness, 0), (damping, 1)):
                pad = self.pad_factors[station] * self.pad[which]
                table[np.ix_([under, mine], [under, mine])] += pad * np.array([[1.0, -1.0], [-1.0, 1.0]])
                table[mine, mine] += self.bed_factors[station] * self.bed[which]
        return mass, damping, stiffness

    @cached_property
    def _modes(self) -> tuple[Complexes, Complexes, Complexes]:
        """Modes that are real or have a pole of positive imaginary part.

        Their poles, 1/s; displacement of all degrees by each coordinate, whose real part counts; the coordinate's
        rate by forces on all degrees.
        """
        mass, damping, stiffness = self._matrices
        n = self.size
        inverse = np.linalg.inv(mass)
        state = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
        poles, vectors = np.linalg.eig(state)
        driven = np.linalg.inv(vectors)[:, n:] @ inverse
        # Of a pair of conjugate modes one says both.
        kept = poles.imag >= 0.0
        twice = np.where(poles.imag[kept] > 0.0, 2.0, 1.0)
        return poles[kept], np.asarray(vectors[:n, kept] * twice), np.asarray(driven[kept])

    def acceleration(
        self, axles: Axles, degrees: Reals, *, rate_Hz: float, samples: int, ramp: tuple[float, float, float]
    ) -> Reals:
        """What a sensor reads, m/s2 down, behind a filter against aliasing, (samples,).

        Parameters
        ----------
        axles : Axles
        degrees : ndarray, shape (n,)
            As :meth:`reads` gives them.
        rate_Hz : float
        samples : int
        ramp : (from, to, length)
            m: loads come on from `from` over a length as half a cosine, and go off before `to`.
        """
        step = 1.0 / (rate_Hz * FINER)
        count = (samples + round(AFTER_S * rate_Hz)) * FINER
        time = np.arange(count) * step
        poles, moves, driven = self._modes
        start, stop, length = ramp
        forced = np.zeros((count, poles.size), dtype=np.complex128)
        for load, lag in zip(axles.loads_N, axles.lags_m, strict=True):
            x = start + (time - axles.entry_s) * axles.speed - lag
            on = np.flatnonzero((x > start) & (x < stop))
            share = np.minimum(x[on] - start, stop - x[on]) / length
            size = load * (0.5 - 0.5 * np.cos(np.pi * np.minimum(share, 1.0)))
            for mine, under, shares in self.over(x[on]):
                forced[on[mine]] += (size[mine, None] * shares) @ driven[:, under].T
        displaced = ((degrees @ moves) @ _coordinates(poles, forced.T, step)).real
        # At rest at both ends, so that the record may be taken for periodic.
        spectrum = np.fft.rfft(displaced)[: count // FINER // 2 + 1]
        hertz = np.fft.rfftfreq(count // FINER, 1.0 / rate_Hz)
        fall = np.clip((hertz / rate_Hz - FILTER[0]) / (FILTER[1] - FILTER[0]), 0.0, 1.0)
        spectrum = spectrum * -((2.0 * np.pi * hertz) ** 2) * 0.5 * (1.0 + np.cos(np.pi * fall))
        return np.asarray(np.fft.irfft(spectrum, n=count // FINER)[:samples] / FINER)


def _coordinates(poles: Complexes, forced: Complexes, step: float) -> Complexes:
    """Of q' = pole q + forced from rest, exactly for what is linear within steps, (modes, steps).

    Modes that steps are too long for follow at once: they would be folded into the band.
    """
    z = poles * step
    turn = np.exp(z)
    small = np.abs(z) < 1e-4
    safe = np.where(small, 1.0, z)
    # Integrals of exp(z (1 - s)) and of exp(z (1 - s)) s over s from 0 to 1; of small z by their series.
    whole = np.where(small, 1.0 + z / 2.0, (turn - 1.0) / safe)
    late = np.where(small, 0.5 + z / 6.0, (turn - 1.0 - z) / safe**2)
    found = np.empty_like(forced)
    for index in range(poles.size):
        if np.abs(poles[index]) * step > FASTEST:
            found[index] = -forced[index] / poles[index]
            continue
        pushed = step * np.array([late[index], whole[index] - late[index]])
        found[index] = signal.lfilter(pushed, [1.0, -turn[index]], forced[index])
    return found


def lost(factors: tuple[float, ...], numbers: NDArray[np.int64], factor: float) -> tuple[float, ...]:
    """Factors of which some are multiplied."""
    return tuple(f * factor if i in numbers else f for i, f in enumerate(factors))
