"""The track as a train finds it: supports that its weight presses, and that it shakes, are not those of a hammer.

What a support is depends on how far it is pressed and shaken, and these depend on it: both are found by turns.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from permway.challenge.beams import Complexes, Reals
from permway.challenge.mesh import Mesh
from permway.challenge.track import Link, Location, Track
from permway.challenge.vehicle import Vehicle
from permway.errors import SolveError

ROUNDS, CLOSE = 12, 1e-3
"""Turns, and the relative change of a support at which they end."""

STATIC_HZ = 0.25
"""Slow enough to be at rest."""


@dataclass(frozen=True)
class Worked:
    """What a train does to the links of a track, in their order; a link to the ground by its point's deflection.

    Attributes
    ----------
    carried : ndarray, shape (links,)
        What each carries of its weight, N; below zero where it pulls.
    shaken : ndarray, shape (links,)
        Root mean square of how far each is moved about that, m.
    would_press : ndarray, shape (links,)
        How far its weight would press each if all supports were as under a hammer, m.
    """

    carried: Reals
    shaken: Reals
    would_press: Reals


Support = Callable[[Track, Worked], Complexes]
"""From the track under a hammer and what a train does to its links, factors on these, shape (links,)."""


@dataclass(frozen=True)
class Ridden:
    """A train on a track.

    Parameters
    ----------
    track : Track
        As a hammer finds it.
    wheels : sequence of Location
    vehicle : Vehicle
    load_N : float
        Of each wheel at rest.
    temperature_C : float
    """

    track: Track
    wheels: Sequence[Location]
    vehicle: Vehicle
    load_N: float
    temperature_C: float

    def receptance(
        self,
        supports: Sequence[Support],
        grid_Hz: Reals,
        *,
        lines_Hz: Reals,
        profiles: Complexes,
        samples: int,
    ) -> Complexes:
        """Under the wheels, once supports and what they are worked by agree, shape (F, W, W), m/N.

        Parameters
        ----------
        supports : sequence of Support
        grid_Hz : ndarray, shape (F,)
        lines_Hz : ndarray, shape (L,)
        profiles : ndarray of complex128, shape (L, W)
            Transform of the profile under each wheel, of a record of so many samples.

        Raises
        ------
        SolveError
            If they do not agree.
        """
        grid = np.unique(np.concatenate([[STATIC_HZ], grid_Hz]))
        factor = np.ones(len(self.track.links), dtype=np.complex128)
        would_press, stiffness = np.zeros(factor.size), self._stiffness()
        for turn in range(ROUNDS):
            under, stretch = self._solved(factor, grid)
            forces = self.vehicle.pressed(lines_Hz, _between(grid, under, lines_Hz)) @ profiles[:, :, None]
            pressed = stretch[0].real.sum(axis=1) * self.load_N
            carried = (stiffness * factor * stretch[0].sum(axis=1)).real * self.load_N
            would_press = would_press if turn else pressed
            shaken = _shaken(grid, stretch, lines_Hz, forces[:, :, 0] / samples)
            last, factor = factor, np.ones_like(factor)
            for support in supports:
                factor = factor * support(self.track, Worked(carried, shaken, would_press))
            if np.abs(factor - last).max() <= CLOSE * np.abs(factor).max():
                return under[np.searchsorted(grid, grid_Hz)]
        raise SolveError(f"supports under a train do not settle in {ROUNDS} rounds")

    def _stiffness(self) -> Complexes:
        """Of each link at rest under a hammer, N/m."""
        at = np.array([STATIC_HZ])
        laws = {name: law(at, self.temperature_C)[0, 0, 0] for name, law in self.track.laws.items()}
        return np.array([link.scale * laws[link.law] for link in self.track.links])

    def _solved(self, factor: Complexes, grid_Hz: Reals) -> tuple[Complexes, Complexes]:
        """Receptances under the wheels, and of each link's stretch by them, (F, links, W)."""
        links = [replace(one, scale=one.scale * f) for one, f in zip(self.track.links, factor, strict=True)]
        changed = replace(self.track, links=links)
        locations = list(dict.fromkeys([*self.wheels, *(location for link in links for location in _ends(link))]))
        displaced = Mesh(changed, locations).receptance(grid_Hz, self.temperature_C, self.wheels, locations)
        at = {location: index for index, location in enumerate(locations)}
        stretch = np.zeros((grid_Hz.size, len(links), len(self.wheels)), dtype=np.complex128)
        for index, link in enumerate(links):
            for location, sign in zip(_ends(link), (1.0, -1.0), strict=False):
                stretch[:, index] += sign * displaced[:, :, at[location]]
        return displaced[:, :, [at[wheel] for wheel in self.wheels]], stretch


def _ends(link: Link) -> tuple[Location, ...]:
    """Of a link between two points or to the ground; of others none."""
    return link.locations if len(link.locations) <= 2 else ()


def _between(grid_Hz: Reals, values: Complexes, lines_Hz: Reals) -> Complexes:
    """Taken straight between the lines of the grid: good enough for what supports are worked by."""
    place = np.clip(np.searchsorted(grid_Hz, lines_Hz) - 1, 0, grid_Hz.size - 2)
    share = (lines_Hz - grid_Hz[place]) / (grid_Hz[place + 1] - grid_Hz[place])
    share = share[(slice(None), *[None] * (values.ndim - 1))]
    return np.asarray(values[place] * (1.0 - share) + values[place + 1] * share)


def _shaken(grid_Hz: Reals, stretch: Complexes, lines_Hz: Reals, amplitudes: Complexes) -> Reals:
    """Root mean square of each link's stretch, the forces' powers gathered at the nearest lines of the grid.

    Amplitudes are of the two-sided series.
    """
    edges = 0.5 * (grid_Hz[1:] + grid_Hz[:-1])
    place: NDArray[np.int64] = np.searchsorted(edges, lines_Hz)
    wheels = amplitudes.shape[1]
    cross = np.zeros((grid_Hz.size, wheels, wheels), dtype=np.complex128)
    np.add.at(cross, place, 2.0 * amplitudes[:, :, None] * amplitudes[:, None, :].conj())
    square = np.einsum("flw,fwv,flv->l", stretch, cross, stretch.conj()).real
    return np.asarray(np.sqrt(np.maximum(square, 0.0)))
