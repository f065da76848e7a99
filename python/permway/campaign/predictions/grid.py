"""The fine grid on which spectra are taken before Welch's window smears them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy import sparse

from permway import _core
from permway.arrays import Complexes, Reals

PER_LINE, NARROW = 4, 16
"""Points between two lines at which spectra are taken before the window smears them; and of what is narrower than
a line. The correlation of Hann's window ends after a segment, so that sums over 4 points are exact of all that has
died out after 3 segments: to 1.2e-3 of the power at a first line, 3e-5 in the mean; half as many err 3 to 4 times
as much."""

REACH_LINES = 4
"""Lines on either side beyond which Hann's window lets nothing through (below 1e-5 of the power)."""

FINE_LINES, FINER = 16.0, 4.0
"""Lines of an estimate below which is solved so many times as finely: there resonances are narrower than a line,
and the window brings the power of one to lines beside it."""

HANN = 1.5
"""Noise bandwidth of Hann's window, lines (Harris 1978, Proc. IEEE 66, table 1)."""

HALVED_LINES = 128.0
"""Lines up to which wheels are solved halfway between, too. Above, cubics miss the peak of what resonates with a
loss factor of 0.035 or more by 1.4 % at most."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Equally spaced frequencies, so many to a line of the estimate, and the ways onto it and off it.

    Attributes
    ----------
    frequency_Hz : ndarray, shape (N,)
    step_Hz : float
    cubic, straight : sparse array, shape (N, L)
        From the solved lines to the grid: by cubics through the four nearest, and linear between them.
    smear : sparse array, shape (F, N)
        Power of Hann's spectral window about every line of the estimate, each row of sum 1.
    estimate_Hz : ndarray, shape (F,)
    segment_s : float
    distance : bool
        Whether power counts by how far it is from its line, in lines.
    """

    frequency_Hz: Reals
    step_Hz: float
    cubic: sparse.csr_array
    straight: sparse.csr_array
    smear: sparse.csr_array
    estimate_Hz: Reals
    segment_s: float
    distance: bool = False

    @cached_property
    def away(self) -> Grid:
        """The same with the window's power times the distance from its line, in lines."""
        distance = self.smear.copy()
        rows = np.repeat(np.arange(distance.shape[0]), np.diff(distance.indptr))
        distance.data = (
            distance.data * (self.frequency_Hz[distance.indices] - self.estimate_Hz[rows]) * self.segment_s
        )
        return replace(self, smear=distance, distance=True)

    def spread(self, values: Complexes, late: Complexes | None = None, *, straight: bool) -> Complexes:
        """From the solved lines to the grid: linear between them if `straight`, else by cubics.

        Straight lines clip a resonance 4 Hz wide between lines 1 Hz apart by 6 %, cubics by 2 %, and between lines
        half as far apart by 0.3 %.

        Parameters
        ----------
        values : ndarray of complex128, shape (L, C) or (L, C, W)
        late : ndarray of complex128, shape (N, W), optional
            What the W are multiplied by on the grid, before they are summed.

        Returns
        -------
        ndarray of complex128, shape (N, C)
        """
        if late is None:
            late, values = np.ones((self.frequency_Hz.size, 1), dtype=np.complex128), values[:, :, None]
        return _core.spread(_rows(self.straight if straight else self.cubic), np.ascontiguousarray(values), late)

    def expected(self, fine: Complexes, density: Reals) -> Complexes:
        """What Welch's method expects of a source, channel against channel.

        Parameters
        ----------
        fine : ndarray of complex128, shape (N, C)
            What channels read per source.
        density : ndarray, shape (N,)
            Of the source.

        Returns
        -------
        ndarray of complex128, shape (F, C (C + 1) / 2)
            The upper triangle, row by row.
        """
        return _core.cross_spectra(_rows(self.smear), np.ascontiguousarray(fine * np.sqrt(density)[:, None]))

    def of_line(self, line_Hz: float, amplitudes: Complexes) -> Complexes:
        """The same of a source at one frequency, exactly.

        Parameters
        ----------
        line_Hz : float
        amplitudes : ndarray of complex128, shape (C,)
            Root-mean-square, of what channels read.

        Returns
        -------
        ndarray of complex128, shape (F, C (C + 1) / 2)
        """
        rows, columns = np.triu_indices(amplitudes.size)
        away = (line_Hz - self.estimate_Hz) * self.segment_s
        share = np.where(np.abs(away) <= REACH_LINES, self.segment_s / HANN * hann(away), 0.0)
        if self.distance:
            share = share * away
        return np.asarray(share[:, None] * (amplitudes[rows] * amplitudes[columns].conj()))


def hann(lines: Reals) -> Reals:
    """Power of Hann's window so many lines from its own, of integral :data:`HANN`."""
    return np.asarray((np.sinc(lines) + 0.5 * (np.sinc(lines - 1.0) + np.sinc(lines + 1.0))) ** 2)


def _rows(weights: sparse.csr_array) -> tuple[np.ndarray, np.ndarray, Reals]:
    return weights.indptr, weights.indices, weights.data


def weighed(weights: sparse.csr_array, values: Complexes) -> Complexes:
    """Real weights times complex values, whose parts are columns of their own."""
    real = np.ascontiguousarray(values).view(np.float64)
    return np.ascontiguousarray(weights @ real).view(np.complex128)


def grid_of(lines_Hz: Reals, estimate_Hz: Reals, segment_s: float, *, narrow: bool = True) -> Grid:
    """The grid of a record; the same arrays give the same one.

    Parameters
    ----------
    lines_Hz : ndarray, shape (L,)
        Frequencies that were solved at.
    estimate_Hz : ndarray, shape (F,)
    segment_s : float
    narrow : bool
        Whether it shall hold what is narrower than a line.
    """
    return _grid(lines_Hz.tobytes(), estimate_Hz.tobytes(), segment_s, NARROW if narrow else PER_LINE)


@lru_cache(maxsize=8)
def _grid(lines: bytes, estimate: bytes, segment_s: float, per_line: int) -> Grid:
    lines_Hz, estimate_Hz = np.frombuffer(lines), np.frombuffer(estimate)
    step = 1.0 / (segment_s * per_line)
    count = int(np.floor((lines_Hz[-1] - lines_Hz[0]) / step + 1e-9)) + 1
    fine = np.asarray(lines_Hz[0] + step * np.arange(count), dtype=np.float64)
    cubic, straight = (interpolating(lines_Hz, fine, through) for through in (4, 2))
    return Grid(fine, step, cubic, straight, _window(fine, estimate_Hz, segment_s), estimate_Hz, segment_s)


def interpolating(x: Reals, at: Reals, through: int = 4) -> sparse.csr_array:
    """Weights of values at ascending x for those at other places, by Lagrange's polynomials through the nearest.

    Parameters
    ----------
    x : ndarray, shape (L,)
        Of fewer than are asked for, the polynomial through all.
    at : ndarray, shape (N,)
        Not beyond the ends of x, but for rounding.
    through : int
        How many of the nearest: 4 for cubics, 2 for straight lines.

    Returns
    -------
    sparse array, shape (N, L)
    """
    many = min(through, x.size)
    at = np.clip(at, x[0], x[-1])
    first = np.clip(np.searchsorted(x, at, side="right") - many // 2, 0, x.size - many)
    columns = first[:, None] + np.arange(many)
    nodes = x[columns]
    away = at[:, None] - nodes
    weights = np.stack(
        [
            np.prod(np.delete(away, k, axis=1) / (nodes[:, [k]] - np.delete(nodes, k, axis=1)), axis=1)
            for k in range(many)
        ],
        axis=1,
    )
    pointers = many * np.arange(at.size + 1, dtype=np.int32)
    return sparse.csr_array((weights.ravel(), columns.ravel().astype(np.int32), pointers), shape=(at.size, x.size))


def _window(fine: Reals, estimate_Hz: Reals, segment_s: float) -> sparse.csr_array:
    rows, columns, values = [], [], []
    for index, frequency in enumerate(estimate_Hz):
        away = (fine - frequency) * segment_s
        near = np.flatnonzero(np.abs(away) <= REACH_LINES)
        x = away[near]
        power = hann(x)
        rows.append(np.full(near.size, index))
        columns.append(near)
        values.append(power / power.sum())
    at = (np.concatenate(rows).astype(np.int32), np.concatenate(columns).astype(np.int32))
    return sparse.csr_array((np.concatenate(values), at), shape=(estimate_Hz.size, fine.size))


def halved(lines_Hz: Reals, track: Complexes, segment_s: float) -> tuple[Reals, Complexes]:
    """The track at the solved lines and halfway between, where these are a line of the estimate apart, and low.

    A wheel on its track may resonate within a few lines; the track alone has nothing as narrow, so it may be
    interpolated, and what wheels do on it is solved at twice as many lines.

    Parameters
    ----------
    lines_Hz : ndarray, shape (L,)
    track : ndarray of complex128, shape (L, wheels, wheels)
    segment_s : float
    """
    solved = lines_Hz.tobytes()
    values = _halved(solved, np.ascontiguousarray(track).tobytes(), segment_s)
    return _halving(solved, segment_s)[0], values.reshape(-1, *track.shape[1:])


# Runs under one condition have one track, and so has a search that changes the train or its sensors.
@lru_cache(maxsize=8)
def _halved(solved: bytes, track: bytes, segment_s: float) -> Complexes:
    """The track's values at these lines, (lines, values)."""
    weights = _halving(solved, segment_s)[1]
    found = weighed(weights, np.frombuffer(track, dtype=np.complex128).reshape(weights.shape[1], -1))
    found.flags.writeable = False
    return found


@lru_cache(maxsize=8)
def _halving(solved: bytes, segment_s: float) -> tuple[Reals, sparse.csr_array]:
    """Lines and those halfway between, and the way from the one to the other."""
    lines_Hz = np.frombuffer(solved)
    wide = np.flatnonzero((np.diff(lines_Hz) > 0.9 / segment_s) & (lines_Hz[:-1] < HALVED_LINES / segment_s))
    lines = np.insert(lines_Hz, wide + 1, 0.5 * (lines_Hz[wide] + lines_Hz[wide + 1]))
    lines.flags.writeable = False
    return lines, interpolating(lines_Hz, lines)


def solved_lines(
    estimate_Hz: Reals, segment_s: float, interpolated_Hz: Sequence[tuple[float, float]] | None
) -> Reals:
    """Frequencies to solve at, so that the window's reach is covered, Hz.

    They lie a line of the estimate apart, and closer at low frequencies; or where those lay between which the
    record was interpolated. The same arrays give the same one, which is not to be written to.
    """
    ranges = None if interpolated_Hz is None else tuple((start, step) for start, step in interpolated_Hz)
    return _solved(float(estimate_Hz[0]), float(estimate_Hz[-1]), segment_s, ranges)


@lru_cache(maxsize=32)
def _solved(
    first_Hz: float, last_Hz: float, segment_s: float, interpolated_Hz: tuple[tuple[float, float], ...] | None
) -> Reals:
    reach = REACH_LINES / segment_s
    low, high = first_Hz - reach, last_Hz + reach
    usual = [(0.0, 1.0 / (FINER * segment_s)), (FINE_LINES / segment_s, 1.0 / segment_s)]
    ranges = list(interpolated_Hz or usual)
    parts = []
    for (start, step), stop in zip(ranges, [*(start for start, _ in ranges[1:]), np.inf], strict=True):
        first = int(np.floor((max(low, start) - start) / step + 1e-9))
        last = int(np.ceil((min(high, stop) - start) / step - 1e-9))
        parts.append(start + step * np.arange(first, last + 1, dtype=np.float64))
    lines = np.unique(np.round(np.concatenate(parts), 9))
    found = np.asarray(lines[lines > 0.0], dtype=np.float64)
    found.flags.writeable = False
    return found
