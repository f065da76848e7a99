"""An effect's own parameters sampled: its evidence and its intervals without Laplace's approximation.

At each draw all other parameters move to where they do best, by slopes of the fit, and are integrated out in
closed form, so only the few of the effect are drawn: by importance, from Student's t about the fit (Geweke 1989,
Econometrica 57), once to see how the posterior lies and once to count. That takes hundreds of solves where nested
sampling of the same takes thousands (`tests/diagnosis/test_sampling.py` holds the two against each other).
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg, stats

from permway.arrays import Reals
from permway.diagnosis.clock import Progress
from permway.diagnosis.fit import Fit, limits_of
from permway.diagnosis.search import Round
from permway.errors import InputError, SolveError

FREEDOM, WIDER = 5, 1.3
"""Degrees of freedom of the t that is drawn from, and times that it is wider than the fit's covariance."""

FIRST = 0.4
"""Share of the draws that only tell how the posterior lies."""

FEWEST = 20.0
"""Effective draws below which nothing is said."""

ENDS = (0.05, 0.95)

MOST_MOVES, SETTLED = 4, 0.05
"""Linear moves of the other parameters at a draw, and the change of the objective at which they end."""


@dataclass(frozen=True)
class Sampled:
    """What the draws say of an effect's own parameters.

    Attributes
    ----------
    correction : float
        Logarithm of the evidence over Laplace's approximation of it, nats.
    standard_error : float
        Of that.
    effective : float
        Number of independent draws that would say as much.
    spans : dict of str to (float, float)
        Ends of 90 % intervals in z, by parameter.
    """

    correction: float
    standard_error: float
    effective: float
    spans: dict[str, tuple[float, float]]


class Posterior:
    """Logarithm of the posterior density of some parameters, over its value at the fit; all others integrated out.

    Parameters
    ----------
    fit : Fit
    own : sequence of str
        Names of the parameters.
    """

    def __init__(self, fit: Fit, own: Sequence[str]) -> None:
        names = [f.name for f in fit.free]
        self.fit, self.at = fit, [names.index(name) for name in own]
        self._rest = [i for i in range(len(names)) if i not in self.at]
        self._slopes = np.ascontiguousarray(fit.jacobian[:, self._rest])
        self._whitener = fit.evidence.whitener
        self._reduced = self._whitener.reduce(self._slopes)
        normal = (self._slopes.T @ self._slopes - self._reduced.T @ self._reduced) / fit.heat
        self._factor = linalg.cho_factor(normal + np.eye(len(self._rest)))
        # How the others move along as the fit has it.
        between = fit.covariance[np.ix_(self._rest, self.at)]
        self._along = between @ np.linalg.inv(self.covariance)
        self._near = fit.evidence.predicted(fit.campaign)
        self.limits = np.array(limits_of([fit.free[i] for i in self.at]))
        self._start = self._objective(fit.deviations, fit.z[self._rest])[0] + float(self.centre @ self.centre)

    @property
    def centre(self) -> Reals:
        """Where the fit is."""
        return self.fit.z[self.at]

    @property
    def covariance(self) -> Reals:
        """Of the fit, the others moving along."""
        return self.fit.covariance[np.ix_(self.at, self.at)]

    def __call__(self, z: Reals) -> float:
        """At some coordinates; minus infinity outside their limits, and where nothing can be solved."""
        if np.any(z < self.limits[0]) or np.any(z > self.limits[1]):
            return -np.inf
        rest = self.fit.z[self._rest] + self._along @ (z - self.centre)
        low, high = limits_of([self.fit.free[i] for i in self._rest])
        value = np.inf
        for _ in range(MOST_MOVES):
            rest = np.clip(rest, low, high)
            deviations = self._deviations(z, rest)
            if deviations is None:
                break
            objective, move = self._objective(deviations, rest)
            settled = abs(objective - value) < SETTLED
            value, rest = objective, rest + move
            if settled:
                break
        return -0.5 * (value + float(z @ z) - self._start)

    def _deviations(self, z: Reals, rest: Reals) -> Reals | None:
        every = np.empty(self.fit.z.size)
        every[self.at], every[self._rest] = z, rest
        values = {f.name: f.value(float(v)) for f, v in zip(self.fit.free, every, strict=True)}
        evidence = self.fit.evidence
        try:
            found = evidence.deviations(evidence.predicted(self.fit.build(values), self._near).datasets)
        except (InputError, SolveError):
            return None
        return found if np.isfinite(found).all() else None

    def _objective(self, deviations: Reals, rest: Reals) -> tuple[float, Reals]:
        """The least heated objective over linear moves of the others from where they are, and the move."""
        reduced = self._whitener.reduce(deviations)
        square = float(deviations @ deviations - reduced @ reduced) / self.fit.heat
        slope = (self._slopes.T @ deviations - self._reduced.T @ reduced) / self.fit.heat + rest
        move = -np.asarray(linalg.cho_solve(self._factor, slope, check_finite=False))
        return square + float(rest @ rest) + float(slope @ move), move


def sampled(
    fit: Fit, own: Sequence[str], *, draws: int, seed: int = 0, progress: Progress | None = None
) -> Sampled | None:
    """Draw the parameters of an effect.

    Parameters
    ----------
    fit : Fit
        Base and effect together.
    own : sequence of str
        Names of the effect's parameters among the fit's.
    draws : int
    seed : int
    progress : callable, optional
        Told the stage, draws done, and of how many.

    Returns
    -------
    Sampled, or None, with a warning, where the draws say too little
    """
    found = _sampled(fit, own, draws=draws, seed=seed, progress=progress)
    if found is None:
        warnings.warn(
            f"{draws} draws of {', '.join(own)} count for less than {FEWEST:g} independent ones: curvature "
            "is kept; take more draws",
            stacklevel=2,
        )
    return found


def _sampled(fit: Fit, own: Sequence[str], *, draws: int, seed: int, progress: Progress | None) -> Sampled | None:
    posterior = Posterior(fit, own)
    random = np.random.default_rng(seed)
    centre, covariance = posterior.centre, posterior.covariance
    first = max(2 * len(own), round(FIRST * draws))
    drawn, log_weight, share = np.zeros((0, len(own))), np.zeros(0), np.ones(1)
    done = 0
    for count in (first, max(draws - first, 1)):
        proposal = stats.multivariate_t(centre, WIDER**2 * covariance, df=FREEDOM, allow_singular=True)
        drawn = np.reshape(proposal.rvs(size=count, random_state=random), (count, len(own)))
        log_weight = np.empty(count)
        for index, z in enumerate(drawn):
            log_weight[index] = posterior(z) - proposal.logpdf(z)
            done += 1
            if progress is not None:
                progress("sample", done, draws)
        found = _shares(log_weight)
        if found is None:
            return None
        share = found
        if _effective(share) > 4.0 * len(own):
            centre = share @ drawn
            covariance = (drawn - centre).T @ ((drawn - centre) * share[:, None]) + 1e-12 * np.eye(len(own))
    effective = _effective(share)
    if effective < FEWEST:
        return None
    mean = float(np.logaddexp.reduce(log_weight)) - float(np.log(log_weight.size))
    laplace = 0.5 * len(own) * float(np.log(2.0 * np.pi)) + 0.5 * _log_det(posterior.covariance)
    spans = {name: _ends(drawn[:, i], share) for i, name in enumerate(own)}
    return Sampled(mean - laplace, float(np.sqrt(1.0 / effective)), effective, spans)


def corrected(found: Round, *, draws: int, seed: int, progress: Progress | None = None) -> Round:
    """A round with the evidence of its finalists corrected, if there are several to tell apart.

    Where the draws of one say too little, all keep Laplace's approximation.
    """
    if len({f.hypothesis.entry for f in found.finalists}) < 2:
        return found
    finalists = []
    for one in found.finalists:
        drawn = sampled(one.fit, one.own, draws=draws, seed=seed, progress=progress)
        if drawn is None:
            return found
        finalists.append(replace(one, correction=drawn.correction))
    return replace(found, finalists=tuple(finalists))


def _log_det(matrix: Reals) -> float:
    """Of a positive definite matrix."""
    return float(np.linalg.slogdet(matrix)[1])


def _effective(share: Reals) -> float:
    """Number of draws of one weight that say as much."""
    return 1.0 / float(share @ share)


def _shares(log_weight: Reals) -> Reals | None:
    """Weights that add up to 1; None where all draws are impossible."""
    highest = float(log_weight.max())
    if not np.isfinite(highest):
        return None
    weight = np.exp(log_weight - highest)
    return np.asarray(weight / weight.sum())


def _ends(values: Reals, share: Reals) -> tuple[float, float]:
    order = np.argsort(values)
    reached = np.cumsum(share[order]) - 0.5 * share[order]
    low, high = np.interp(ENDS, reached, values[order])
    return float(low), float(high)
