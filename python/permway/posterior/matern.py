"""Calibration errors over frequency as a Markov process: a value and a slope at each node.

The error of a measuring chain is a Gaussian process of the logarithm of frequency with Matern's covariance of
order 3/2, s^2 (1 + u) exp(-u), u = sqrt(3) |x - x'| / l. Together with its slope it is a Markov process, so that
its precision over nodes is block tridiagonal whatever the length: rough errors cost no more than smooth ones.

Source: Hartikainen and Sarkka (2010), Kalman filtering and smoothing solutions to temporal Gaussian process
regression models, section 4; Rasmussen and Williams (2006), equation 4.17.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from permway.arrays import Reals

CLOSEST = 0.05
"""Octaves between nodes at least: a third of the shortest length, where interpolating between nodes loses 0.4 % of
the variance. Half of it costs twice the time and changes nothing; twice loses 3 % of the variance."""


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
        """How lines follow from values and slopes at the nodes to either side (cubic Hermite interpolation).

        Returns
        -------
        ndarray of int, shape (F,)
            The node before.
        ndarray, shape (F, 4)
            Weights of value and slope there, of value and slope at the next node, in the process's value.
        ndarray, shape (F, 4)
            The same in its slope.
        """
        if self.x.size == 1:
            weights = np.zeros((x.size, 4))
            weights[:, 0] = 1.0
            slopes = np.zeros((x.size, 4))
            slopes[:, 1] = 1.0
            return np.zeros(x.size, dtype=np.int64), weights, slopes
        before = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, self.x.size - 2)
        step = self.x[before + 1] - self.x[before]
        t = (x - self.x[before]) / step
        value = [2 * t**3 - 3 * t**2 + 1, step * (t**3 - 2 * t**2 + t), 3 * t**2 - 2 * t**3, step * (t**3 - t**2)]
        slope = [(6 * t**2 - 6 * t) / step, 3 * t**2 - 4 * t + 1, (6 * t - 6 * t**2) / step, 3 * t**2 - 2 * t]
        return before, np.stack(value, axis=1), np.stack(slope, axis=1)

    def precision(self, length: float) -> tuple[Reals, Reals, float]:
        """Of value and slope at all nodes, for a standard deviation of 1.

        Parameters
        ----------
        length : float
            Octaves.

        Returns
        -------
        ndarray, shape (K, 2, 2)
            Blocks on the diagonal.
        ndarray, shape (K - 1, 2, 2)
            Blocks below it.
        float
            Logarithm of the determinant.
        """
        rate = np.sqrt(3.0) / length
        u = rate * np.diff(self.x)
        e = np.exp(-u)
        # In units of the stationary standard deviations of value and slope, which are 1 and `rate`.
        go = np.stack([np.stack([e * (1 + u), e * u], -1), np.stack([-e * u, e * (1 - u)], -1)], -2)
        left = np.eye(2) - go @ go.swapaxes(1, 2)
        inverse = np.linalg.inv(left)
        diagonal = np.zeros((self.x.size, 2, 2))
        diagonal[0] = np.eye(2)
        diagonal[1:] += inverse
        diagonal[:-1] += go.swapaxes(1, 2) @ inverse @ go
        below = -inverse @ go
        scale = np.array([1.0, 1.0 / rate])
        both = scale[:, None] * scale
        log_determinant = -float(np.linalg.slogdet(left)[1].sum()) - 2.0 * self.x.size * float(np.log(rate))
        return diagonal * both, below * both, log_determinant
