"""Where the wheels run: the stretch of a body, cut into panels on which the response is a polynomial of x."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from permway.arrays import Complexes, Reals, is_real
from permway.errors import InputError
from permway.model.bodies import Beam, Shaft
from permway.model.line import Line, Segment
from permway.model.place import Place

MOST_NODES = 20_000
_QUARTER_WAVE = 0.25
"""Longest panel over the free bending wave of the highest frequency."""
_SAME = 1e-6
"""Places closer than this (m) are one."""


@lru_cache(maxsize=32)
def gauss(order: int) -> tuple[Reals, Reals]:
    """Gauss's nodes from -1 to 1 and their weights; read only."""
    found = leggauss(order)
    for values in found:
        values.flags.writeable = False
    return found


@dataclass(frozen=True)
class Path:
    """Panels of a stretch, with Gauss's nodes on each.

    The response of a beam is smooth between joints, beam's ends and the sensor, and has a kink in a derivative
    there; so panels end there, and on a panel a few Legendre polynomials are enough.

    Attributes
    ----------
    body : str
    edges : ndarray, shape (panels + 1,)
        m, ascending.
    order : int
        Nodes, and polynomials, on a panel.
    ramp_m : (float, float)
        Lengths at both ends over which forces come on and go off, as half a cosine.
    """

    body: str
    edges: Reals
    order: int
    ramp_m: tuple[float, float]

    @property
    def start(self) -> float:
        """Where wheels enter, m."""
        return float(self.edges[0])

    @property
    def stop(self) -> float:
        """Where wheels leave, m."""
        return float(self.edges[-1])

    @property
    def half(self) -> Reals:
        """Half lengths of the panels, m."""
        return np.asarray(0.5 * np.diff(self.edges))

    @property
    def middle(self) -> Reals:
        """Middles of the panels, m."""
        return np.asarray(0.5 * (self.edges[1:] + self.edges[:-1]))

    @cached_property
    def nodes(self) -> Reals:
        """Places of the nodes, shape (panels, order), m."""
        return self.points(gauss(self.order)[0])

    def points(self, inside: Reals) -> Reals:
        """Places of points from -1 to 1 inside each panel, shape (panels, points), m."""
        return np.asarray(self.middle[:, None] + self.half[:, None] * inside)

    def places(self) -> list[Place]:
        """The nodes as places on the body."""
        return [Place(body=self.body, x_m=float(x), name=f"node {i}") for i, x in enumerate(self.nodes.ravel())]

    def ramp(self, x_m: Reals) -> Reals:
        """Share of the force that acts at a place: 0 outside, 1 between the ramps."""
        value = np.where((x_m >= self.start) & (x_m <= self.stop), 1.0, 0.0)
        for length, inwards in zip(self.ramp_m, (x_m - self.start, self.stop - x_m), strict=True):
            if length > 0.0:
                value = value * 0.5 * (1.0 - np.cos(np.pi * np.clip(inwards / length, 0.0, 1.0)))
        return np.asarray(value)

    def coefficients(self, values: Complexes) -> Complexes:
        """Legendre coefficients of values at the nodes, the ramp put on them.

        Parameters
        ----------
        values : ndarray, shape (..., panels * order)

        Returns
        -------
        ndarray, shape (..., panels, order)
        """
        shaped = values.reshape(*values.shape[:-1], *self.nodes.shape) * self.ramp(self.nodes)
        return np.asarray(shaped @ self.analysis().T)

    def analysis(self) -> Reals:
        """Matrix (order, order) from values at the nodes to Legendre coefficients."""
        inside, weight = gauss(self.order)
        degree = np.arange(self.order)
        return np.asarray((degree[:, None] + 0.5) * legvander(inside, self.order - 1).T * weight)

    def interpolation(self, x_m: Reals) -> tuple[np.ndarray, Reals]:
        """Panel of each place and weights (places, order) on its nodes, the ramp put on them; 0 outside."""
        panel = np.clip(np.searchsorted(self.edges, x_m, side="right") - 1, 0, self.half.size - 1)
        inside = np.clip((x_m - self.middle[panel]) / self.half[panel], -1.0, 1.0)
        weights = legvander(inside, self.order - 1) @ self.analysis()
        return panel, np.asarray(weights * self.ramp(x_m)[:, None])


def path_of(
    line: Line,
    body: str,
    *,
    from_m: float | None,
    to_m: float | None,
    ramp_m: float | None,
    highest_Hz: float,
    order: int,
    kinks_m: tuple[float, ...] = (),
) -> Path:
    """The stretch that wheels run on.

    Parameters
    ----------
    line : Line
    body : str
        A beam, or a row of beams without gaps.
    from_m, to_m : float, optional
        By default the ends of the body; of one without end, its first and last joint.
    ramp_m : float, optional
        By default none at an end that is pinned, elsewhere a tenth of the stretch and at most 10 m.
    highest_Hz : float
        Sets the longest panel: a quarter of the free bending wave.
    order : int
        Nodes on a panel.
    kinks_m : tuple of float
        Further places where panels must end.

    Raises
    ------
    InputError
        For a body that is no beam, a stretch that leaves it, and more than :data:`MOST_NODES` nodes.
    """
    segments = [(beam, s) for beam, s in line.beams() if s.body == body or s.name == body]
    if not segments:
        beams = sorted({s.body for _, s in line.beams()})
        raise InputError("wheels run on a beam", where="body", value=body, remedy=f"use one of {beams}")
    index = {s.name: i for i, s in enumerate(line.segments())}
    mine = {index[s.name] for _, s in segments}
    table = line.joint_table()
    on = [i in mine or j in mine for i, j in zip(table.upper.tolist(), table.lower.tolist(), strict=True)]
    joints = table.x[np.array(on, dtype=bool)]
    low, high = min(s.start for _, s in segments), max(s.stop for _, s in segments)
    reach = [float(joints.min()), float(joints.max())] if joints.size else [np.nan, np.nan]
    start = _given("from_m", from_m, low if np.isfinite(low) else reach[0])
    stop = _given("to_m", to_m, high if np.isfinite(high) else reach[1])
    if not (low - _SAME <= start < stop <= high + _SAME):
        raise InputError(
            f"the stretch does not lie on {body!r}",
            where="from_m, to_m",
            value=(start, stop),
            remedy=f"it reaches from {low:g} to {high:g} m; from_m must lie before to_m",
        )
    covered = start
    for _, segment in segments:
        if segment.start <= covered + _SAME:
            covered = max(covered, segment.stop)
    if covered < stop - _SAME:
        raise InputError(
            f"{body!r} has a gap where the wheels run",
            where="from_m, to_m",
            value=f"{covered:g} m",
            remedy="choose a stretch without gaps, or let the wheels run on another body",
        )
    ramps = _ramps(segments, start, stop, ramp_m)
    kinks = [start, stop, start + ramps[0], stop - ramps[1], *joints.tolist(), *kinks_m]
    kinks += [x for _, s in segments for x in (s.start, s.stop) if np.isfinite(x)]
    kinks += [x for beam, _ in segments for change in beam.changes for x in (change.from_m, change.to_m)]
    longest = _QUARTER_WAVE * _wavelength(segments[0][0], highest_Hz)
    edges = _edges(tuple(kinks), start, stop, longest)
    if (edges.size - 1) * order > MOST_NODES:
        raise InputError(
            f"the stretch needs {(edges.size - 1) * order} places, more than {MOST_NODES}",
            where="highest_Hz, from_m, to_m",
            remedy="take a shorter stretch or a lower highest frequency",
        )
    return Path(body=body, edges=edges, order=order, ramp_m=ramps)


def _ramps(
    segments: list[tuple[Beam | Shaft, Segment]], start: float, stop: float, given: float | None
) -> tuple[float, float]:
    if given is not None:
        if not (np.isfinite(given) and 0.0 <= given <= 0.5 * (stop - start)):
            raise InputError(
                "must lie between 0 and half the stretch",
                where="ramp_m",
                value=given,
                remedy=f"the stretch is {stop - start:g} m long",
            )
        return float(given), float(given)
    usual = min(10.0, 0.1 * (stop - start))
    first, last = segments[0], segments[-1]
    at_start = first[0].pinned[0] and abs(first[1].start - start) < _SAME
    at_stop = last[0].pinned[1] and abs(last[1].stop - stop) < _SAME
    return 0.0 if at_start else usual, 0.0 if at_stop else usual


def _given(name: str, value: float | None, otherwise: float) -> float:
    if value is None:
        if not np.isfinite(otherwise):
            raise InputError(
                "a body without ends and joints needs a stretch to run on",
                where=name,
                remedy="give from_m and to_m",
            )
        return otherwise
    if not is_real(value) or not np.isfinite(value):
        raise InputError("must be a finite number", where=name, value=value, remedy="give it in m")
    return float(value)


def _wavelength(beam: Beam | Shaft, frequency_Hz: float) -> float:
    omega = 2.0 * np.pi * frequency_Hz
    if isinstance(beam, Shaft):
        return float(2.0 * np.pi / (omega * (beam.mass_kg_per_m / abs(beam.shear_N)) ** 0.5))
    wavenumber = (beam.mass_kg_per_m * omega**2 / abs(beam.bending_Nm2)) ** 0.25
    return float(2.0 * np.pi / wavenumber)


@lru_cache(maxsize=8)
def _edges(kinks: tuple[float, ...], start: float, stop: float, longest: float) -> Reals:
    """Ends of the panels; read only, for starts of a diagnosis have the same ones."""
    marks = [start]
    for x in sorted(x for x in kinks if start + _SAME < x < stop - _SAME):
        if x - marks[-1] > _SAME:
            marks.append(float(x))
    marks.append(stop)
    parts = [np.linspace(a, b, int(np.ceil((b - a) / longest)) + 1)[:-1] for a, b in pairwise(marks)]
    found = np.concatenate([*parts, [stop]])
    found.flags.writeable = False
    return found
