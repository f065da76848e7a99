"""Where wheels stand on a rail of elements, and what their forces do to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from permway.challenge.beams import Reals, shape, within
from permway.challenge.closed_mesh import ClosedMesh
from permway.challenge.newmark import Meshed

POINTS = 33
"""Of an element, at which it is known how far it yields within."""


class Rail:
    """Elements of the rail, and where a wheel is on them.

    Parameters
    ----------
    mesh : Meshed
        Round a ring wheels may run as far as they like.

    Attributes
    ----------
    ends : (float, float)
        From where to where wheels may run, m.
    degrees : ndarray of int
        The rail's degrees of freedom.
    """

    def __init__(self, mesh: Meshed) -> None:
        found = mesh.elements("rail")
        self._around = mesh.length_m if isinstance(mesh, ClosedMesh) else None
        self.dofs = np.array([dofs for dofs, _, _ in found])
        self.left = np.array([left for _, left, _ in found])
        self.ends = (float(self.left[0]), float(found[-1][2])) if self._around is None else (-np.inf, np.inf)
        self.length = np.array([right - left for _, left, right in found])
        self.section = mesh.track.beams["rail"].section
        # Alike for all elements of a length.
        self._lengths = self.length.round(6)
        self.share = np.linspace(0.0, 1.0, POINTS)
        tables = {h: within(self.section, h, h * self.share) for h in set(self._lengths.tolist())}
        self.yielding = np.array([tables[h] for h in self._lengths.tolist()])
        self.degrees: NDArray[np.int64] = np.unique(self.dofs)
        self.places = np.full(mesh.size, -1)
        self.places[self.degrees] = np.arange(self.degrees.size)

    def under(self, at: Reals) -> Under:
        """What a wheel at each place touches."""
        if self._around is not None:
            at = np.asarray(at % self._around)
        number = np.clip(np.searchsorted(self.left, at, side="right") - 1, 0, self.left.size - 1)
        within_m = at - self.left[number]
        shares = np.empty((at.size, 4))
        for h in np.unique(self._lengths[number]):
            alike = self._lengths[number] == h
            shares[alike] = shape(self.section, h, within_m[alike])
        along = within_m / self.length[number]
        yielding = [np.interp(share, self.share, self.yielding[i]) for i, share in zip(number, along, strict=True)]
        return Under(self.dofs[number], shares, np.array(yielding))


@dataclass(frozen=True)
class Under:
    """Degrees of freedom under wheels, shares of each, (wheels, 4); what elements yield inside, (wheels,)."""

    dofs: NDArray[np.int64]
    shares: Reals
    yielding: Reals

    def read(self, displaced: Reals, force: Reals | None = None) -> Reals:
        """Deflection under the wheels; without what their forces do within elements if these are not given."""
        nodal = (self.shares * displaced[self.dofs]).sum(axis=1)
        return np.asarray(nodal if force is None else nodal + self.yielding * force)

    def press(self, force: Reals, size: int) -> Reals:
        """Forces along all degrees that those of the wheels are, (n,)."""
        pressed = np.zeros(size)
        np.add.at(pressed, self.dofs, self.shares * force[:, None])
        return pressed

    def gathered(self, gives: Reals, places: NDArray[np.int64]) -> Reals:
        """How much a force of 1 N on each wheel moves all degrees, (wheels, n).

        `gives` is that of forces along some degrees, and `places` states which of them each degree is.
        """
        return np.asarray(np.einsum("wi,win->wn", self.shares, gives[places[self.dofs]]))

    def weigh(self, gathered: Reals) -> Reals:
        """How much wheels' forces move the rail under each, (wheels, wheels)."""
        between = np.einsum("wvi,vi->wv", gathered[:, self.dofs], self.shares)
        return np.asarray(between + np.diag(self.yielding))
