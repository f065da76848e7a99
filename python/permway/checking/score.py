"""How well what was read agrees with what is predicted, as a log likelihood that is hard to impress.

Levels and phases deviate by Student's t of few degrees of freedom: what a model leaves out is wrong by much in
some lines. Its scale is free above a floor, so nothing is sure where the model fits badly whatever is changed.
"""

from __future__ import annotations

import numpy as np
from scipy import special

from permway.arrays import Reals
from permway.checking.change import Change
from permway.checking.compared import Compared

SCALES = np.array([0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0])
"""Standard deviations of what a model is wrong by, neper and rad: from 3 dB, which an honest one may be off."""

TAIL = 4.0
"""Degrees of freedom of the t distribution. At 2 a factor of ten is reported half as surely, at 8 twice."""


FEW = 3
"""Channels up to which what one of them reads moves the level that all share."""


class Scored:
    """A record with the log likelihood of each of its rows as it was read, to hold changes against.

    Parameters
    ----------
    given : Compared
    """

    def __init__(self, given: Compared) -> None:
        self.given = given
        self.offset, self._penalty = _common(given)
        self._rows = _by_row(given, self.offset)
        self.log_likelihood = float(self._rows.sum(axis=1).max()) + self._penalty

    def scale(self) -> float:
        """Of the deviations, neper and rad."""
        return float(SCALES[int(self._rows.sum(axis=1).argmax())])

    def gain(self, change: Change) -> float:
        """Log odds of a change over none."""
        given = self.given
        other, touched = given.changed(change), given.touched(change)
        if touched.all() or len(given.channels) <= FEW:
            offset, penalty = _common(other)
            rows = _by_row(other, offset)
        else:
            penalty, rows = self._penalty, self._rows.copy()
            rows[:, touched] = _by_row(other, self.offset, touched)
        found = float(rows.sum(axis=1).max()) + penalty + given.log_jacobian(change)
        return found - self.log_likelihood + change.log_prior


def _by_row(one: Compared, offset: Reals, rows: np.ndarray | slice = slice(None)) -> Reals:
    """Log likelihood by scale and row, shape (scales, rows)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.log(one.measured[rows] / one.predicted[rows])
    level, phase = ratio.real - offset, ratio.imag
    used, variance = one.used[rows], np.where(one.used[rows], one.variance[rows], 0.0)
    weight = one.weight * used
    found = np.zeros((SCALES.size, level.shape[0]))
    for index, scale in enumerate(SCALES):
        spread = np.sqrt(scale**2 + variance)
        for part, there in ((level, one.levelled[rows]), (phase, one.phased[rows])):
            found[index] += there * (weight * _log_t(np.where(used, part, 0.0), spread)).sum(axis=1)
    return found


def _log_t(deviation: Reals, spread: Reals) -> Reals:
    constant = special.gammaln(0.5 * (TAIL + 1.0)) - special.gammaln(0.5 * TAIL) - 0.5 * np.log(TAIL * np.pi)
    return np.asarray(constant - np.log(spread) - 0.5 * (TAIL + 1.0) * np.log1p((deviation / spread) ** 2 / TAIL))


def _common(one: Compared) -> tuple[Reals, float]:
    """A level and a slope that all rows share and nobody knows, shape (F,), and the log prior of as much.

    Of the median over rows, so that one channel that is off moves neither.
    """
    weight = one.weight * one.used[one.levelled].any(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        level = np.log(np.abs(one.measured[one.levelled] / one.predicted[one.levelled]))
    seen = one.used[one.levelled]
    # A line that no row constrains weighs nothing, and its level is any.
    middle = np.nanmedian(np.where(seen | ~seen.any(axis=0), np.where(seen, level, 0.0), np.nan), axis=0)
    octaves = np.log2(one.frequency_Hz)
    octaves = octaves - np.average(octaves, weights=np.maximum(weight, 1e-12))
    columns = np.stack([np.ones_like(octaves), octaves], axis=1)[:, : 2 if one.slope else 1]
    sizes = np.array([one.common, one.slope])[: columns.shape[1]]
    precision = weight / SCALES[0] ** 2
    normal = columns.T @ (precision[:, None] * columns) + np.diag(sizes**-2.0)
    found = np.linalg.solve(normal, columns.T @ (precision * middle))
    return columns @ found, float(-0.5 * np.sum((found / sizes) ** 2))
