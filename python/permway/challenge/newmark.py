"""Structures marched in time, step by step: Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from permway.challenge.beams import Reals, element
from permway.challenge.track import Link, Location, Track
from permway.challenge.vehicle import Vehicle

GAMMA = 0.52
"""A little above one half, so that what steps are too long for is damped: by 0.4 % at w dt = 0.4."""

UNDAMPED = 0.5
"""Where nothing strikes what steps are too long for: a rail itself loses little more than GAMMA has it lose."""

COLUMNS = 512
"""Forces solved for at once."""

Matrices = tuple[sparse.csc_array, sparse.csc_array, sparse.csc_array]
"""Mass, damping, stiffness."""


class Meshed(Protocol):
    """Nodes of a track, as of :class:`permway.challenge.mesh.Mesh`."""

    track: Track
    size: int

    def elements(self, body: str) -> list[tuple[NDArray[np.int64], float, float]]:
        """Degrees of freedom of each element of a body, from where to where, m."""
        ...

    def tied(self, link: Link) -> list[int]:
        """Degrees of freedom of a link's points."""
        ...

    def at(self, location: Location) -> int:
        """The degree of freedom of a place's deflection."""
        ...


class Marched:
    """A structure's motion, a step at a time.

    Parameters
    ----------
    matrices : Matrices
    step_s : float
    gamma : float
        Newmark's; above one half it damps.

    Attributes
    ----------
    displaced, speed, velocities : ndarray, shape (n,)
        Displacement, velocity, acceleration.
    """

    def __init__(self, matrices: Matrices, step_s: float, gamma: float = GAMMA) -> None:
        self.mass, self.damping, self.stiffness = matrices
        self.step_s, self._gamma, self._beta = step_s, gamma, 0.25 * (gamma + 0.5) ** 2
        h, beta = step_s, self._beta
        effective = self.stiffness + gamma / (beta * h) * self.damping + 1.0 / (beta * h**2) * self.mass
        self._solve = splu(sparse.csc_array(effective)).solve
        size = self.mass.shape[0]
        self.displaced, self.speed, self.velocities = np.zeros(size), np.zeros(size), np.zeros(size)

    def free(self, force: Reals) -> Reals:
        """Where it would be a step later under forces at its end."""
        h, u, v, a = self.step_s, self.displaced, self.speed, self.velocities
        gamma, beta = self._gamma, self._beta
        inert = u / (beta * h**2) + v / (beta * h) + (0.5 / beta - 1.0) * a
        lost = gamma / (beta * h) * u + (gamma / beta - 1.0) * v + 0.5 * h * (gamma / beta - 2.0) * a
        return np.asarray(self._solve(force + self.mass @ inert + self.damping @ lost))

    def gives(self, degrees: NDArray[np.int64]) -> Reals:
        """How much a force of 1 N along each of some degrees moves all within a step, shape (degrees, n)."""
        found = np.empty((degrees.size, self.mass.shape[0]))
        for first in range(0, degrees.size, COLUMNS):
            rows = np.arange(first, min(first + COLUMNS, degrees.size))
            forces = np.zeros((self.mass.shape[0], rows.size))
            forces[degrees[rows], np.arange(rows.size)] = 1.0
            found[rows] = self._solve(forces).T
        return found

    def go_on(self, displaced: Reals) -> None:
        """Take a step to where it is."""
        h, by, beta = self.step_s, displaced - self.displaced, self._beta
        velocities = by / (beta * h**2) - self.speed / (beta * h) - (0.5 / beta - 1.0) * self.velocities
        self.speed = self.speed + h * ((1.0 - self._gamma) * self.velocities + self._gamma * velocities)
        self.displaced, self.velocities = displaced, velocities


def line_matrices(
    mesh: Meshed,
    *,
    viscous_at_Hz: float,
    beams_at_Hz: Mapping[str, float] | None = None,
    temperature_C: float = 20.0,
) -> Matrices:
    """A track's, with viscous losses that are the hysteretic ones at a frequency; viscous ones are as they are.

    Each beam may have a frequency of its own, `beams_at_Hz`.
    """
    omega = 2.0 * np.pi * viscous_at_Hz
    parts: dict[str, list[tuple[Reals, NDArray[np.int64]]]] = {"mass": [], "damping": [], "stiffness": []}
    for body, beam in mesh.track.beams.items():
        turning = 2.0 * np.pi * (beams_at_Hz or {}).get(body, viscous_at_Hz)
        for dofs, left, right in mesh.elements(body):
            section = beam.part(left, right)
            stiffness, mass = element(section, right - left)
            parts["mass"].append((mass, dofs))
            parts["stiffness"].append((stiffness, dofs))
            parts["damping"].append((section.loss / turning * stiffness, dofs))
    at = np.array([viscous_at_Hz])
    laws = {name: law(at, temperature_C)[0] for name, law in mesh.track.laws.items()}
    for link in mesh.track.links:
        tied, dofs = link.scale * laws[link.law], np.array(mesh.tied(link))
        parts["stiffness"].append((tied.real, dofs))
        parts["damping"].append((tied.imag / omega, dofs))
    put = {name: _put_together(entries, mesh.size) for name, entries in parts.items()}
    return put["mass"], put["damping"], put["stiffness"]


def _put_together(parts: list[tuple[Reals, NDArray[np.int64]]], size: int) -> sparse.csc_array:
    rows = np.concatenate([np.repeat(dofs, dofs.size) for _, dofs in parts])
    columns = np.concatenate([np.tile(dofs, dofs.size) for _, dofs in parts])
    values = np.concatenate([matrix.ravel() for matrix, _ in parts])
    return sparse.csc_array((values, (rows, columns)), shape=(size, size))


def train_matrices(car: Vehicle, cars: int) -> Matrices:
    """Of equal cars one behind the other, with springs and dampers alone."""
    at = 1.0 / (2.0 * np.pi)
    found = [np.diag(np.array(car.masses, dtype=float)), np.zeros((len(car.masses),) * 2)]
    found.append(np.zeros_like(found[1]))
    for arm, name in car.ties:
        row = np.zeros(len(car.masses))
        row[list(arm)] = list(arm.values())
        # At 1 rad/s the imaginary part is what a damper does.
        law = complex(car.laws[name](np.array([at]))[0])
        found[1] += law.imag * np.outer(row, row)
        found[2] += law.real * np.outer(row, row)
    mass, damping, stiffness = (sparse.csc_array(np.kron(np.eye(cars), one)) for one in found)
    return mass, damping, stiffness
