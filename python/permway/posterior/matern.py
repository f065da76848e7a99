"""Calibration errors over frequency as a Markov process: value, slope and curvature at each node.

The error of a measuring chain is a Gaussian process of the logarithm of frequency with Matern's covariance of
order 5/2, s^2 (1 + u + u^2 / 3) exp(-u), u = sqrt(5) |x - x'| / l. Together with its first two derivatives it is a
Markov process, so that its precision over nodes is block tridiagonal whatever the length: rough errors cost no
more than smooth ones.

Source: Hartikainen and Sarkka (2010), Kalman filtering and smoothing solutions to temporal Gaussian process
regression models, section 4; Rasmussen and Williams (2006), equation 4.17.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.arrays import Reals

STATES = 3
"""Of a process at a node: value, slope, curvature."""

CLOSEST = 0.05
"""Octaves between nodes at least: a third of the shortest length. Interpolation loses 6e-5 of the variance there,
and 2e-3 at twice the spacing."""

_DRIFT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, -3.0, -3.0]])
_NILPOTENT = _DRIFT + np.eye(STATES)
_DRIVE = 16.0 / 3.0
"""Intensity of the white noise that drives it, for a standard deviation and a rate of 1."""

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(10)

_STATIONARY = np.array([[1.0, 0.0, -1.0 / 3.0], [0.0, 1.0 / 3.0, 0.0], [-1.0 / 3.0, 0.0, 1.0]])
"""Covariance of value, slope and curvature, each in units of the rate's power, for a standard deviation of 1."""


@dataclass(frozen=True)
class Nodes:
    """Where the processes are represented, and how lines are interpolated from there.

    Attributes
    ----------
    x : ndarray, shape (K,)
        Octaves, ascending.
    """

    x: Reals

    @staticmethod
    def of(x: Reals) -> Nodes:
        """Nodes at lines, but none closer to the one before than :data:`CLOSEST`.

        Parameters
        ----------
        x : ndarray, shape (F,)
            Octaves of the lines, in any order.
        """
        lines = np.unique(x)
        kept = [lines[0]]
        for value in lines[1:]:
            if value - kept[-1] >= CLOSEST:
                kept.append(value)
        if lines[-1] > kept[-1]:
            kept.append(lines[-1])
        return Nodes(np.array(kept))

    def at(self, x: Reals) -> tuple[np.ndarray, Reals, Reals]:
        """How lines follow from the states of the nodes to either side (quintic Hermite interpolation).

        Returns
        -------
        ndarray of int, shape (F,)
            The node before.
        ndarray, shape (F, 6)
            Weights of the states of that node and of the next in the process's value.
        ndarray, shape (F, 6)
            The same in its slope.
        """
        if self.x.size == 1:
            weights = np.zeros((2, x.size, 2 * STATES))
            weights[0, :, 0] = 1.0
            weights[1, :, 1] = 1.0
            return np.zeros(x.size, dtype=np.int64), weights[0], weights[1]
        before = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, self.x.size - 2)
        step = (self.x[before + 1] - self.x[before])[:, None]
        t = (x - self.x[before])[:, None] / step
        powers = t ** np.arange(6)
        slopes = np.arange(1, 6) * t ** np.arange(5)
        scale = np.concatenate([step**0, step, step**2] * 2, axis=1)
        return before, (powers @ _QUINTIC) * scale, (slopes @ _QUINTIC[1:]) * scale / step

    def precision(self, length: float) -> tuple[Reals, Reals, float]:
        """Of the states at all nodes, for a standard deviation of 1.

        Parameters
        ----------
        length : float
            Octaves.

        Returns
        -------
        ndarray, shape (K, 3, 3)
            Blocks on the diagonal.
        ndarray, shape (K - 1, 3, 3)
            Blocks below it.
        float
            Logarithm of the determinant.
        """
        rate = np.sqrt(5.0) / length
        u = (rate * np.diff(self.x))[:, None, None]
        go = np.exp(-u) * (np.eye(STATES) + u * _NILPOTENT + 0.5 * u**2 * (_NILPOTENT @ _NILPOTENT))
        left = np.where(u < 1.0, _gained(u), _STATIONARY - go @ _STATIONARY @ go.swapaxes(1, 2))
        inverse = np.linalg.inv(left)
        first = np.linalg.inv(_STATIONARY)
        diagonal = np.zeros((self.x.size, STATES, STATES))
        diagonal[0] = first
        diagonal[1:] += inverse
        diagonal[:-1] += go.swapaxes(1, 2) @ inverse @ go
        below = -inverse @ go
        scale = rate ** -np.arange(float(STATES))
        both = scale[:, None] * scale
        log_determinant = -float(np.linalg.slogdet(left)[1].sum()) - float(np.linalg.slogdet(_STATIONARY)[1])
        log_determinant += 2.0 * self.x.size * float(np.log(scale).sum())
        return diagonal * both, below * both, log_determinant


def _gained(u: Reals) -> Reals:
    """Covariance that the process gains over steps, by Gauss's rule: between near nodes a difference would round.

    Parameters
    ----------
    u : ndarray, shape (K, 1, 1)
        Steps in units of the rate, at most about 1.
    """
    s = 0.5 * u * (_POINTS + 1.0)
    driven = (
        np.eye(STATES)[:, 2, None]
        + s * _NILPOTENT[:, 2, None]
        + 0.5 * s**2 * (_NILPOTENT @ _NILPOTENT)[:, 2, None]
    )
    driven = driven * np.exp(-s)
    return np.asarray(_DRIVE * np.einsum("kip,kjp,kp->kij", driven, driven, 0.5 * u[:, 0] * _WEIGHTS))


def _quintic() -> Reals:
    """Coefficients of 1, t, ... t^5 (rows) of each of value, slope, curvature at 0, then at 1 (columns)."""
    at = np.zeros((6, 6))
    for row, (t, order) in enumerate([(0.0, 0), (0.0, 1), (0.0, 2), (1.0, 0), (1.0, 1), (1.0, 2)]):
        for power in range(order, 6):
            factor = np.prod(np.arange(power, power - order, -1.0)) if order else 1.0
            at[row, power] = factor * t ** (power - order)
    return np.asarray(np.linalg.inv(at))


_QUINTIC = _quintic()
