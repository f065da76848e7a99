"""A rail between the places that hold it: read at a few places, known at all.

Between two fasteners nothing but its own mass holds a rail. At rest it bends along cubics there, Timoshenko's beam
as Euler's, so four places of a piece give all of it, where cubics that span a fastener round off its kink (the
shear force's). To the first order of w^2 its mass bends it further, by w^2 p with

    EI d4p/dx4 = m f - (rho I + m EI / (kappa G A)) d2f/dx2,    p = 0 at the four places,

f the cubic. A force has a kink of its own; with g(x - y) of a beam without supports, to the same order, G - g has
none where x and y are in one piece, so

    G(x, y) = sum over a, b of (f_a + w^2 p_a)(x) G(x_a, y_b) (f_b + w^2 p_b)(y) + L(x, y),
    L(x, y) = g(x - y) - sum over a, b of (f_a + w^2 p_a)(x) g(x_a - y_b) (f_b + w^2 p_b)(y)

in one piece, else 0; f_a the cubics that are 1 at one of the places where a piece is read and 0 at the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from permway.arrays import Complexes, Reals
from permway.errors import InputError
from permway.model.bodies import Beam
from permway.model.line import Line
from permway.model.stations import TOUCH_M

PARTS = 3
"""Of a piece between the places where it is read."""

LONGEST_M = 0.8
"""Of a piece: longer bays are several."""

Integers = np.ndarray[tuple[int], np.dtype[np.int64]]


def _cubics() -> tuple[list[Polynomial], list[Polynomial], list[Polynomial]]:
    """The cubics f over a piece from 0 to 1, and what their fourth and second integrals are beyond cubics."""
    places = np.arange(PARTS + 1) / PARTS
    one = []
    for x in places:
        others = Polynomial.fromroots(places[places != x])
        one.append(others / others(x))

    def beyond(integral: Polynomial) -> Polynomial:
        for height, f in zip(integral(places), one, strict=True):
            integral = integral - height * f
        return integral

    return one, [beyond(f.integ(4)) for f in one], [beyond(f.integ(2)) for f in one]


_STILL, _BENT, _SHEARED = _cubics()


@dataclass(frozen=True, eq=False)
class Bays:
    """Pieces of a beam, one after the other.

    Attributes
    ----------
    edges_m : ndarray, shape (pieces + 1,)
        Where joints hold the beam, its section changes, or a long bay is divided.
    beam : Beam
    """

    edges_m: Reals
    beam: Beam

    @property
    def read_m(self) -> Reals:
        """Where the beam is read, ascending, m: `PARTS` of each piece, edges among them."""
        parts = np.arange(PARTS) / PARTS
        inner = self.edges_m[:-1, None] + np.diff(self.edges_m)[:, None] * parts
        return np.append(inner.ravel(), self.edges_m[-1])

    def piece(self, x_m: Reals) -> Integers:
        """The piece in which a place is, or the nearest."""
        return np.clip(np.searchsorted(self.edges_m, x_m, side="right") - 1, 0, self.edges_m.size - 2)

    def shares(self, x_m: Reals) -> tuple[Integers, Reals, Reals]:
        """How places follow from those that are read.

        Returns
        -------
        ndarray of int, the shape of x
            Index of the first of the four places of `read_m` from which it follows.
        ndarrays, shape (4, *x)
            Their shares: of displacements, and, in s^2, of displacements times w^2.
        """
        piece = self.piece(x_m)
        long = np.diff(self.edges_m)[piece]
        at = (x_m - self.edges_m[piece]) / long
        still, bent, sheared = (np.stack([f(at) for f in each]) for each in (_STILL, _BENT, _SHEARED))
        bending = self.beam.bending_Nm2.real
        moving = self.beam.mass_kg_per_m / bending * long**4 * bent - self._slow_kg_m / bending * long**2 * sheared
        return np.asarray(PARTS * piece), still, np.asarray(moving)

    def beyond(self, x_m: Reals, y_m: float) -> tuple[Complexes, Complexes]:
        """L of the module's heading, at places x of a force at y: at rest, m/N, and by w^2, m s^2/N."""
        first, of_y, y_moving = self.shares(np.array([y_m]))
        _, of_x, x_moving = self.shares(x_m)
        places = self.read_m[first[0] : first[0] + PARTS + 1]
        still, moving = self._free(x_m - y_m)
        nodes, nodes_moving = self._free(places[:, None] - places)
        still = still - of_x.T @ nodes @ of_y[:, 0]
        moving = moving - of_x.T @ (nodes_moving @ of_y + nodes @ y_moving)[:, 0] - x_moving.T @ nodes @ of_y[:, 0]
        same = PARTS * self.piece(x_m) == first
        return np.asarray(np.where(same, still, 0.0)), np.asarray(np.where(same, moving, 0.0))

    @property
    def _slow_kg_m(self) -> float:
        """What turns and shears, rho I + m EI / (kappa G A)."""
        beam = self.beam
        sheared = beam.mass_kg_per_m * beam.bending_Nm2.real / beam.shear_N.real if beam.shear_N else 0.0
        return beam.rotary_kg_m + sheared

    def _free(self, away_m: Reals) -> tuple[Complexes, Complexes]:
        """Displacement so far from a unit force, at rest and by w^2; any cubic may be added to either."""
        away, beam, bending = np.abs(away_m), self.beam, self.beam.bending_Nm2
        soft = 1.0 / beam.shear_N if beam.shear_N else 0.0
        still = away**3 / (12.0 * bending) - soft * away / 2.0
        by_mass = away**7 / (10080.0 * bending) - soft * away**5 / 240.0
        by_slowness = away**5 / (240.0 * bending) - soft * away**3 / 12.0
        turned = soft * beam.rotary_kg_m * away**3 / 12.0
        moving = (beam.mass_kg_per_m * by_mass - self._slow_kg_m * by_slowness - turned) / bending
        return np.asarray(still), np.asarray(moving)


def bays(line: Line, body: str, from_m: float, to_m: float) -> Bays:
    """The pieces of a beam between two places, which are within the first and the last.

    Stiffness and mass are those of the uniform beam; where a section changes, pieces end.

    Parameters
    ----------
    line : Line
    body : str
        A beam that goes on without end, or beyond both places.
    from_m, to_m : float

    Raises
    ------
    InputError
        If the body is no beam, or its loss is viscous.
    """
    beam = line.bodies.get(body)
    if not isinstance(beam, Beam):
        raise InputError("wheels roll on beams", where="body", value=body, remedy="name a beam of the line")
    if beam.is_viscous:
        raise InputError(
            "wheels roll on beams of a constant loss factor",
            where=f"line.bodies.{body}",
            remedy="give loss_factor, which is twice the damping ratio at resonance",
        )
    table, mine = line.joint_table(), [i for i, s in enumerate(line.segments()) if s.body == body]
    held = table.x[np.isin(table.upper, mine) | np.isin(table.lower, mine)]
    changes = [x for change in beam.changes for x in (change.from_m, change.to_m)]
    kinks = np.unique(np.concatenate([held, changes]))
    kinks = kinks[np.append(True, np.diff(kinks) > TOUCH_M)] if kinks.size else kinks
    before, after = kinks[kinks <= from_m][-1:], kinks[kinks >= to_m][:1]
    inside = kinks[(kinks > from_m) & (kinks < to_m)]
    whole = np.concatenate([before if before.size else [from_m], inside, after if after.size else [to_m]])
    counts = np.maximum(1, np.ceil(np.diff(whole) / LONGEST_M - 1e-9)).astype(np.int64)
    pieces = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(whole[:-1], whole[1:], counts, strict=True)]
    edges = np.append(np.concatenate(pieces), whole[-1])
    return Bays(edges, beam)
