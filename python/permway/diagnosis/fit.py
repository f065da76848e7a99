"""What a recalibration finds: free parameters, their most probable values, and what is left."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.observations import Observations

Z_LIMIT = 8.0
"""Beyond which no parameter is sought, in standard deviations of the prior."""

WIDTH = 1.6449
"""Half of a 90 % interval, in standard deviations."""

Build = Callable[[Mapping[str, float]], Campaign]
"""From values of the free parameters to a campaign."""


@dataclass(frozen=True)
class Free:
    """A number that is free: its centre and standard deviation in a coordinate z, 0 at the centre.

    Attributes
    ----------
    name, unit : str
    value : callable
        From z to the value.
    limits : (float, float)
        Of z.
    """

    name: str
    unit: str
    value: Callable[[float], float]
    limits: tuple[float, float] = (-Z_LIMIT, Z_LIMIT)


def limits_of(free: Sequence[Free]) -> tuple[Reals, Reals]:
    """Lowest and highest z of each, shapes (p,); p may be 0."""
    low, high = np.array([f.limits for f in free], dtype=np.float64).reshape(len(free), 2).T
    return low, high


@dataclass(frozen=True)
class Fit:
    """The most probable values and what is left.

    Attributes
    ----------
    free : tuple of Free
    z : ndarray, shape (p,)
        In standard deviations of the priors.
    covariance : ndarray, shape (p, p)
        Of z (Laplace).
    campaign : Campaign
        With these values, and no amendment.
    observations : Observations
        With the sizes of calibration errors.
    residuals : ndarray, shape (n,)
        Standardised, calibration errors not taken out.
    clean : ndarray, shape (n,)
        With the most probable calibration errors taken out.
    chi2 : float
        Quadratic form of the residuals, calibration errors integrated out.
    prior : float
        Sum of squares of z.
    log_determinant : float
        Of the covariance of calibration errors and noise, over that of noise.
    jacobian : ndarray, shape (n, p)
        Derivative of the residuals by z.
    inflation : float
        Mean square of the residuals, at least 1: the records count so much less while no model fits.
    evaluations : int
    build : callable
        From values of `free` to a campaign.
    """

    free: tuple[Free, ...]
    z: Reals
    covariance: Reals
    campaign: Campaign
    observations: Observations
    residuals: Reals
    clean: Reals
    chi2: float
    prior: float
    log_determinant: float
    jacobian: Reals
    inflation: float
    evaluations: int
    build: Build

    @property
    def objective(self) -> float:
        """Minus twice the log posterior density, up to a constant."""
        return self.chi2 + self.prior + self.log_determinant

    @property
    def log_evidence(self) -> float:
        """Laplace's approximation of the marginal likelihood, up to a constant of the records."""
        sign, value = np.linalg.slogdet(self.covariance)
        return -0.5 * self.objective + 0.5 * float(value if sign > 0 else -np.inf)

    def values(self) -> dict[str, float]:
        """Values by name."""
        return {f.name: f.value(float(z)) for f, z in zip(self.free, self.z, strict=True)}

    def intervals(self, width: float = WIDTH) -> dict[str, tuple[float, float]]:
        """90 % intervals by name, by default.

        Parameters
        ----------
        width : float
            Half of an interval, in standard deviations.
        """
        sigma = np.sqrt(np.diag(self.covariance))
        return {
            f.name: (f.value(float(z - width * s)), f.value(float(z + width * s)))
            for f, z, s in zip(self.free, self.z, sigma, strict=True)
        }


def free_parameters(campaign: Campaign) -> tuple[Free, ...]:
    """The campaign's parameters, each about its nominal value."""
    found = []
    for known in campaign.parameters.known.values():
        low, high = known.bounds
        limits = [-Z_LIMIT, Z_LIMIT]
        if np.isfinite(low) and (low > 0.0 or not known.log):
            limits[0] = max(limits[0], known.z(low))
        if np.isfinite(high):
            limits[1] = min(limits[1], known.z(high))
        found.append(Free(known.name, known.parameter.unit, known.value, (limits[0], limits[1])))
    return tuple(found)
