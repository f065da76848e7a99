"""Slope of a fit's objective by its hyperparameters, its parameters moving along in a straight line.

Errors and parameters are what a Gaussian model of the residuals has for its unknowns. The slope by the size of one
kind of them is what its prior expects of their squares, less their mean squares given the residuals (Rasmussen and
Williams 2006, equation 5.9). Of chains, these mean squares are needed only where their precision has entries, and
so is the inverse of the normal matrix (Takahashi, Fagan and Chen 1973).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.posterior.chains import Factor
from permway.posterior.covariance import Covariance
from permway.posterior.fit import Fit
from permway.posterior.hyper import Hyper
from permway.posterior.matern import STATES

STEP = 1e-4
"""Of logarithms, by which priors and the precision of a chain are differenced."""


def hyper_slope(fit: Fit, covariance: Covariance) -> Reals:
    """Of minus two log posterior by the logarithm of each hyperparameter.

    Parameters
    ----------
    fit : Fit
        Its own hyperparameters do not matter.
    covariance : Covariance
        With the hyperparameters at which the slope is asked for.

    Returns
    -------
    ndarray, shape (h,)
    """
    hyper, frame, weights = covariance.hyper, covariance.frame, covariance.weights
    unknown = _unknown(fit, covariance)
    off = weights * unknown.left
    # Of the inverse of the residuals' covariance, the diagonal.
    inverse = weights - weights**2 * unknown.variance
    found = dict.fromkeys(hyper.names, 0.0)
    for name, rows in frame.of_statistic.items():
        grown = 2.0 * (1.0 / weights[rows] - 1.0)
        found[f"discrepancy {name}"] = float(grown @ (inverse[rows] - off[rows] ** 2))
    for name in set(frame.sized) - {""}:
        found[name] = float(2.0 * (1.0 - unknown.squares[np.flatnonzero(frame.sized == name)]).sum())
    for factor, states in zip(covariance.factors, unknown.states, strict=True):
        chains, length = factor.chains, hyper["length"]
        squares = _mean_squares(factor, states)
        sizes = np.array([hyper[kind] for kind in chains.kinds])
        expected = chains.parts * STATES * chains.nodes.x.size
        met = _traces(squares, chains.nodes.precision(length)[:2]) / sizes**2
        for kind, each in zip(chains.kinds, met.tolist(), strict=True):
            found[kind] += 2.0 * (expected - each)
        more, less = (chains.nodes.precision(length * np.exp(step)) for step in (STEP, -STEP))
        change = (more[0] - less[0], more[1] - less[1])
        grown = _traces(squares, change) / sizes**2 - chains.parts * (more[2] - less[2])
        found["length"] += float(grown.sum()) / (2.0 * STEP)
    return np.array([found[name] for name in hyper.names]) - 2.0 * _prior_slope(hyper)


@dataclass(frozen=True)
class _Unknown:
    """Means and variances of errors and parameters, given the residuals.

    Attributes
    ----------
    left : ndarray, shape (n,)
        Residuals less all that errors and parameters explain.
    variance : ndarray, shape (n,)
        Of what they explain.
    squares : ndarray, shape (b,)
        Mean squares of the errors that a few columns span, in units of their prior.
    states : list of ndarray, shape (parts states, k)
        Of each chain, columns whose outer products sum to the mean products of its states, but for what its own
        normal matrix leaves open.
    """

    left: Reals
    variance: Reals
    squares: Reals
    states: list[Reals]


def _unknown(fit: Fit, covariance: Covariance) -> _Unknown:
    columns = np.hstack([covariance.columns, fit.jacobian])
    # About the middle of the parameters' prior.
    residuals = fit.state.residuals - fit.jacobian @ fit.z
    values = np.column_stack([columns, residuals])
    weighted, rest = covariance.weights[:, None] * values, values.copy()
    variance, states = np.zeros(residuals.size), []
    for factor in covariance.factors:
        at = factor.chains.local
        states.append(factor.states(weighted[at]))
        rest[at] -= np.asarray(factor.chains.acts @ states[-1])
        variance[at] += factor.variance
    normal = np.eye(columns.shape[1]) + columns.T @ (covariance.weights[:, None] * rest[:, :-1])
    root = linalg.cholesky(normal, lower=True)
    mean = linalg.cho_solve((root, True), columns.T @ (covariance.weights * rest[:, -1]))

    def spread(of: Reals) -> Reals:
        return np.asarray(linalg.solve_triangular(root, of[:, :-1].T, lower=True))

    variance += np.einsum("qn,qn->n", *[spread(rest)] * 2)
    inverse = linalg.cho_solve((root, True), np.eye(root.shape[0]))
    each = [np.column_stack([spread(of).T, of[:, -1] - of[:, :-1] @ mean]) for of in states]
    return _Unknown(rest[:, -1] - rest[:, :-1] @ mean, variance, mean**2 + np.diag(inverse), each)


def _mean_squares(factor: Factor, states: Reals) -> tuple[Reals, Reals]:
    """Mean products of states of one process at one node, and of a node with the one before it.

    Returns
    -------
    ndarray, shape (K, processes, 3, 3)
    ndarray, shape (K - 1, processes, 3, 3)
    """
    chains = factor.chains
    count, processes = chains.nodes.x.size, len(chains.kinds)
    each = states.reshape(chains.parts, count, processes, STATES, -1)
    at = np.sum(each @ np.swapaxes(each, -1, -2), axis=0)
    below = np.sum(each[:, 1:] @ np.swapaxes(each[:, :-1], -1, -2), axis=0)
    own = np.arange(processes)
    for found, open_ in zip((at, below), factor.inverse, strict=True):
        blocks = open_.reshape(-1, processes, STATES, processes, STATES)
        found += chains.parts * np.moveaxis(blocks[:, own, :, own, :], 0, 1)
    return at, below


def _traces(squares: tuple[Reals, Reals], precision: tuple[Reals, Reals]) -> Reals:
    """Of the precision of one process times the mean products of each, shape (processes,)."""
    at, below = (np.einsum("kpij,kij->p", *both) for both in zip(squares, precision, strict=True))
    return np.asarray(at + 2.0 * below)


def _prior_slope(hyper: Hyper) -> Reals:
    """Of the log density of the hyperparameters."""
    found = np.empty(hyper.log.size)
    for index in range(found.size):
        ends = []
        for step in (STEP, -STEP):
            log = hyper.log.copy()
            log[index] += step
            ends.append(Hyper(hyper.names, log).log_prior)
        found[index] = (ends[0] - ends[1]) / (2.0 * STEP)
    return found
