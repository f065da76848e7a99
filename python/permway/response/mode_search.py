"""All modes of a band, window by window, each compared with a second fit through other lines.

Over several octaves one rational function does not do: accelerances there differ by powers of ten, and what is
small is lost to rounding. In a window of an octave it is not. A pole counts if the function through the other half
of the lines has it too; of modes that overlap too much for that, none does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from permway.arrays import Complexes, Reals
from permway.errors import SolveError
from permway.response.loewner import Pencil, pencil
from permway.response.poles import HEAVIEST, SAME

DIRECTIONS = 8
"""Of every line; poles that lie close together are distinguished by these."""

LINES, UNKNOWNS = 160, 320
"""Lines of a window, margins among them, and the size of a pencil: of fewer directions more lines are taken."""

MARGIN = 2.0**0.25
"""Factor by which the lines of a window reach beyond it: poles at its edges are inside."""

NARROWEST = 2.0 ** (1.0 / 16.0)
"""A window with more poles than its lines bear is halved, down to this ratio."""

FAINT = 1e-6
"""Peak of a pole over the response, in root mean squares, below which a pole that does not settle is rounding."""

ONE = 0.999
"""Cosine between how a mode moves and how it is moved, which are one shape unless modes share the pole."""

Response = Callable[[Reals, bool], Complexes]
"""From frequencies in Hz, (F,), to receptances in m/N, (F, rows, columns); of all rows, or those of forces."""


@dataclass(frozen=True)
class SearchResult:
    """Modes of a band, by ascending frequency.

    Attributes
    ----------
    omega : ndarray of complex128, shape (M,)
        Poles, rad/s.
    shape : ndarray of complex128, shape (M, rows)
        The largest 1.
    modal_mass_kg : ndarray, shape (M,)
        Modulus, for that scale; NaN of modes that share a pole, whose shapes are a choice of many.
    unsettled_Hz : ndarray, shape (U,)
        Natural frequencies of poles that the two fits place differently.
    """

    omega: Complexes
    shape: Complexes
    modal_mass_kg: Reals
    unsettled_Hz: Reals


def search(response: Response, low_Hz: float, high_Hz: float, columns: list[int]) -> SearchResult:
    """Modes between two frequencies.

    Parameters
    ----------
    response : callable
    low_Hz, high_Hz : float
    columns : list of int
        Which row each column is.

    Raises
    ------
    SolveError
        If even in the narrowest window the response is not that of few poles.
    """
    count = max(1, int(np.ceil(np.log2(high_Hz / low_Hz) - 1e-9)))
    edges = np.geomspace(low_Hz, high_Hz, count + 1)
    # Windows still to do, the lowest last.
    waiting = [(float(a), float(b)) for a, b in pairwise(edges)][::-1]
    done: list[SearchResult] = []
    while waiting:
        low, high = waiting.pop()
        answer = _window(response, low, high, columns)
        if answer is None:
            if high / low < NARROWEST:
                raise SolveError(
                    f"the response between {low:g} and {high:g} Hz is not that of few modes: a rational function "
                    f"of {UNKNOWNS // 2} poles does not suffice"
                )
            middle = float(np.sqrt(low * high))
            waiting += [(middle, high), (low, middle)]
            continue
        done.append(answer)
    return SearchResult(
        np.concatenate([one.omega for one in done]),
        np.concatenate([one.shape for one in done]),
        np.concatenate([one.modal_mass_kg for one in done]),
        np.concatenate([one.unsettled_Hz for one in done]),
    )


def _window(response: Response, low_Hz: float, high_Hz: float, columns: list[int]) -> SearchResult | None:
    """Modes above `low_Hz` and up to `high_Hz`; None if the lines do not bear so many poles."""
    directions = min(DIRECTIONS, len(columns))
    # Four sets of lines: left and right, of either fit.
    lines = max(LINES, 4 * (UNKNOWNS // directions))
    frequency = np.geomspace(low_Hz / MARGIN, high_Hz * MARGIN, lines)
    omega = 2.0 * np.pi * frequency
    struck = response(frequency, False) * omega[:, None, None] ** 2
    size = np.sqrt(np.sqrt(np.mean(np.abs(struck[:, range(len(columns)), range(len(columns))]) ** 2, axis=0)))
    scaled = struck / (size[:, None] * size[None, :])
    first = pencil(omega[::2], scaled[::2], directions, seed=1)
    second = pencil(omega[1::2], scaled[1::2], directions, seed=2)
    if first.full or second.full:
        return None
    peak = _peaks(first, first.displaced(scaled[::2][first.right]))
    modulus = np.abs(first.poles)
    off = np.abs(first.poles[:, None] - second.poles).min(axis=1, initial=np.inf) / modulus
    inside = (modulus > 2.0 * np.pi * low_Hz) & (modulus <= 2.0 * np.pi * high_Hz) & (first.poles.real > 0.0)
    inside &= (first.poles.imag < HEAVIEST * modulus) & (first.poles.imag > -SAME * modulus)
    settled = np.flatnonzero(inside & (off < SAME))
    settled = settled[np.argsort(modulus[settled])]
    loose = modulus[inside & (off >= SAME) & (peak > FAINT)] / (2.0 * np.pi)
    at = frequency[::2][first.right]
    everywhere = response(at if settled.size else at[:1], True)
    displaced = np.zeros((everywhere.shape[1], 0), dtype=np.complex128)
    if settled.size:
        weight = (2.0 * np.pi * at[:, None, None]) ** 2 / size
        displaced = first.displaced(everywhere * weight)[:, settled]
    return _read(first.poles[settled], displaced, first.force[settled] * size, columns, np.sort(loose))


def _peaks(fit: Pencil, motion: Complexes) -> Reals:
    """Largest modulus of every pole's part of the response, above it on the real axis."""
    with np.errstate(divide="ignore", invalid="ignore"):
        peak = np.abs(motion).max(axis=0) * np.abs(fit.force).max(axis=1) / np.abs(fit.poles.imag)
    return np.asarray(np.nan_to_num(peak, nan=0.0))


def _read(
    omega: Complexes, displaced: Complexes, force: Complexes, columns: list[int], loose: Reals
) -> SearchResult:
    """Shapes and modal masses from factors of the residues of accelerance, omega phi_r phi_c / (2 m)."""
    top = np.abs(displaced).argmax(axis=0)
    largest = displaced[top, range(omega.size)]
    shape = (displaced / largest).T
    known = shape[:, columns]
    alike = np.abs((known.conj() * force).sum(axis=1)) / (
        np.linalg.norm(known, axis=1) * np.linalg.norm(force, axis=1)
    )
    at = np.abs(force).argmax(axis=1)
    each = range(omega.size)
    mass = np.abs(omega * known[each, at] / (2.0 * largest * force[each, at]))
    return SearchResult(omega, shape, np.where(alike > ONE, mass, np.nan), loose)
