"""A deck that repeats without end: its last station is its first, so that a train may run round it for long."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from permway.challenge.mesh import Mesh
from permway.challenge.track import TOUCH_M, Link, Location, Track

CLOSED = ("rail", "base")
"""Bodies that go on where the ring closes; slabs and girders end there, as at every pier."""


class ClosedMesh:
    """Nodes of a deck that goes on into itself.

    Parameters
    ----------
    track : Track
        A deck with its approaches, which are left out.
    locations : sequence of Location
        Where it will be read.

    Attributes
    ----------
    track : Track
        Without approaches.
    size : int
        Degrees of freedom.
    length_m : float
        Of the deck, and of a lap.
    """

    def __init__(self, track: Track, locations: Sequence[Location] = ()) -> None:
        self.length_m = track.beams["girder"].stop
        self.track = self._closed(track)
        self._mesh = Mesh(self.track, locations)
        self._same = self._numbers()
        self.size = int(self._same.max()) + 1

    def at(self, location: Location) -> int:
        """The degree of freedom of a place's deflection."""
        return int(self._same[self._mesh.at(location)])

    def elements(self, body: str) -> list[tuple[NDArray[np.int64], float, float]]:
        """Degrees of freedom of each element of a body, from where to where, m."""
        return [(self._same[dofs], left, right) for dofs, left, right in self._mesh.elements(body)]

    def tied(self, link: Link) -> list[int]:
        """Degrees of freedom of a link's points."""
        return [int(self._same[dof]) for dof in self._mesh.tied(link)]

    def _closed(self, track: Track) -> Track:
        """The deck alone; where it closes there are two pads on one place, of which each has half."""
        beams = {
            body: replace(beam, start=0.0, stop=self.length_m, endless=False) for body, beam in track.beams.items()
        }
        links = [
            replace(link, scale=0.5 * link.scale) if self._is_end_pad(link) else link
            for link in track.links
            if link.law != "approach"
        ]
        return replace(track, beams=beams, links=links)

    def _is_end_pad(self, link: Link) -> bool:
        x = link.locations[0][1]
        return link.law == "pad" and (abs(x) < TOUCH_M or abs(x - self.length_m) < TOUCH_M)

    def _numbers(self) -> NDArray[np.int64]:
        """The ring's number of each degree of freedom of the straight mesh."""
        first_of = np.arange(self._mesh.size)
        for body in CLOSED:
            elements = self._mesh.elements(body)
            first_of[elements[-1][0][2:]] = elements[0][0][:2]
        _, numbers = np.unique(first_of, return_inverse=True)
        return np.asarray(numbers, dtype=np.int64)
