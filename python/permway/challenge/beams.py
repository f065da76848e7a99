"""Two-node beam elements, and a rail that goes on without end.

The shape functions are the static deflections of an element that only its nodes load: a cubic for the deflection,
and a rotation that shear makes differ from its slope.

Source: Cook, Malkus, Plesha and Witt, Concepts and Applications of Finite Element Analysis (2002), chapters 2, 11.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
Complexes = NDArray[np.complex128]

Blocks = tuple[Complexes, Complexes, Complexes, Complexes]
"""Dynamic stiffness by ends, see :func:`dynamic`."""

DOUBLINGS = 28
"""Of a piece of an endless rail: 2^28 pieces are longer than any wave that damping leaves."""

FINE_M = 0.0125
"""Longest element of a body whose shear matters."""

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
"""Gauss's rule of an element, exact for its polynomials."""


@dataclass(frozen=True)
class Section:
    """A beam's section, SI.

    Parameters
    ----------
    bending : float
        E I, N m2.
    mass : float
        rho A, kg/m.
    shear : float
        kappa G A, N; infinite for an Euler beam.
    rotary : float
        rho I, kg m; 0 for an Euler beam.
    loss : float
        Hysteretic loss factor of both stiffnesses.
    """

    bending: float
    mass: float
    shear: float = np.inf
    rotary: float = 0.0
    loss: float = 0.0


@lru_cache(maxsize=4096)
def element(section: Section, length: float) -> tuple[Reals, Reals]:
    """Stiffness and consistent mass of an element, each (4, 4), for deflection and rotation of its two nodes.

    Most elements of a mesh are alike, so that they are kept, and cannot be written to.
    """
    soft, polynomial = _polynomial(section, length)
    x = 0.5 * length * (_POINTS + 1.0)
    weights = 0.5 * length * _WEIGHTS
    one, zero = np.ones_like(x), np.zeros_like(x)
    deflection = np.stack([one, x, x**2, x**3], axis=1) @ polynomial
    rotation = np.stack([zero, one, 2.0 * x, 3.0 * x**2 + 6.0 * soft], axis=1) @ polynomial
    curvature = np.stack([zero, zero, 2.0 * one, 6.0 * x], axis=1) @ polynomial
    strain = np.stack([zero, zero, zero, -6.0 * soft * one], axis=1) @ polynomial
    stiffness = section.bending * np.einsum("p,pi,pj->ij", weights, curvature, curvature)
    if soft > 0.0:
        stiffness = stiffness + section.shear * np.einsum("p,pi,pj->ij", weights, strain, strain)
    mass = section.mass * np.einsum("p,pi,pj->ij", weights, deflection, deflection)
    mass = mass + section.rotary * np.einsum("p,pi,pj->ij", weights, rotation, rotation)
    found = np.asarray(stiffness), np.asarray(mass)
    for matrix in found:
        matrix.flags.writeable = False
    return found


def shape(section: Section, length: float, x: Reals) -> Reals:
    """Deflection at places of an element per deflection and rotation of its two nodes, shape (places, 4)."""
    _, polynomial = _polynomial(section, length)
    return np.asarray(np.stack([np.ones_like(x), x, x**2, x**3], axis=1) @ polynomial)


def within(section: Section, length: float, x: Reals) -> Reals:
    """How far a force within an element moves its place while the nodes are held, m/N.

    An element's shape functions leave that out, so that a wheel would find the rail stiffer between its nodes.
    """
    found = np.zeros(x.shape)
    for index, place in enumerate(x):
        if 0.0 < place < length:
            before, _ = element(section, float(place))
            behind, _ = element(section, float(length - place))
            found[index] = np.linalg.inv(before[2:, 2:] + behind[:2, :2])[0, 0]
    return found


def _polynomial(section: Section, length: float) -> tuple[float, Reals]:
    """Bending over shear stiffness, and the coefficients of 1, x, x2, x3 per motion of the nodes."""
    soft = section.bending / section.shear if np.isfinite(section.shear) else 0.0
    # The deflection is a polynomial 1, x, x2, x3; of a constant shear force it takes E I w''' / (kappa G A).
    at_ends = np.array(
        [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 6.0 * soft],
            [1.0, length, length**2, length**3],
            [0.0, 1.0, 2.0 * length, 3.0 * length**2 + 6.0 * soft],
        ]
    )
    return soft, np.linalg.inv(at_ends)


def dynamic(section: Section, length: float, frequency_Hz: Reals) -> Blocks:
    """Dynamic stiffness of a piece of beam at its two ends, put together from elements of `FINE_M` or less.

    Where shear matters, an element's constant shear strain is right only to second order in its length, so that
    rails need many; all of them are alike, so that doubling finds their sum.

    Returns
    -------
    tuple of ndarray of complex128, each shape (F, 2, 2)
        Force at the first end per motion there; at the first per motion at the last; at the last per first; at the
        last per last.
    """
    doublings = max(0, int(np.ceil(np.log2(length / FINE_M))))
    stiffness, mass = element(section, length / 2**doublings)
    omega2 = (2.0 * np.pi * frequency_Hz[:, None, None]) ** 2
    whole: Complexes = np.asarray((1.0 + 1j * section.loss) * stiffness - omega2 * mass)
    blocks: Blocks = (whole[:, :2, :2], whole[:, :2, 2:], whole[:, 2:, :2], whole[:, 2:, 2:])
    for _ in range(doublings):
        blocks = _doubled(blocks)
    return blocks


def endless(section: Section, length: float, frequency_Hz: Reals) -> tuple[Complexes, Complexes]:
    """Dynamic stiffness of a free beam that goes on without end, at the node where it begins.

    Pieces are put together two by two, then the pairs, and so on, until nothing that enters at one end leaves at
    the other. Needs some loss.

    Returns
    -------
    tuple of ndarray of complex128, each shape (F, 2, 2)
        Of a beam that goes on to the left of the node, and to the right.

    Notes
    -----
    Source of the doubling: Lopez Sancho and others, J. Phys. F 15 (1985) 851.
    """
    blocks = dynamic(section, length, frequency_Hz)
    for _ in range(DOUBLINGS):
        blocks = _doubled(blocks)
    return blocks[3], blocks[0]


def _doubled(blocks: Blocks) -> Blocks:
    """Two equal pieces, one after the other, with what lies between them eliminated."""
    first, there, back, last = blocks
    middle = np.linalg.inv(last + first)
    return (
        np.asarray(first - there @ middle @ back),
        np.asarray(-there @ middle @ there),
        np.asarray(-back @ middle @ back),
        np.asarray(last - back @ middle @ there),
    )


def cable_element(tension: float, length: float) -> Reals:
    """What a tension adds to an element's stiffness, (4, 4)."""
    h = length
    matrix: Any = np.array(
        [
            [36.0, 3.0 * h, -36.0, 3.0 * h],
            [3.0 * h, 4.0 * h**2, -3.0 * h, -(h**2)],
            [-36.0, -3.0 * h, 36.0, -3.0 * h],
            [3.0 * h, -(h**2), -3.0 * h, 4.0 * h**2],
        ]
    )
    return np.asarray(matrix * tension / (30.0 * h))
