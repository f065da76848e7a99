"""A model with a set of amendments, its fit, and Laplace's evidence where the fit ends.

Source: Kass and Raftery (1995), Bayes factors, section 4.1, for Laplace's approximation.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.catalogue._interval import spacing_of
from permway.diagnosis.fit import Build, Free
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.tangent import State
from permway.posterior.covariance import Covariance, Frame
from permway.posterior.hyper import Hyper
from permway.posterior.roots import Roots

STRETCH = ("centre_m", "length_m")
"""Parameters of what acts over a stretch."""

STEP = 1e-4
"""Of differences, in standard deviations of a prior."""


@dataclass(frozen=True)
class Model:
    """A set of amendments on the nominal model, as a function of standard normal parameters.

    Attributes
    ----------
    build : callable
        From values to a campaign.
    free : tuple of Free
        Nominal parameters first.
    stretches : tuple of (int, int, float)
        Of each stretch of joints where its centre and its length stand among these, and the joints' spacing, m.
    """

    build: Build
    free: tuple[Free, ...]
    stretches: tuple[tuple[int, int, float], ...] = ()

    @property
    def limits(self) -> tuple[Reals, Reals]:
        """Bounds of z."""
        both = np.array([f.limits for f in self.free]).reshape(-1, 2)
        return both[:, 0], both[:, 1]

    def values(self, z: Reals) -> dict[str, float]:
        """By name."""
        return {f.name: f.value(float(v)) for f, v in zip(self.free, z, strict=True)}


@dataclass(frozen=True)
class Fit:
    """The most probable parameters of a model, given hyperparameters.

    Attributes
    ----------
    model : Model
    frame : Frame
    hyper : Hyper
    state : State
        Parameters z, predictions and residuals.
    jacobian : ndarray, shape (n, p)
        Slopes of the residuals at, or near, the state.
    bend : ndarray, shape (h, h), optional
        Curvature of the objective by the logarithms of hyperparameters, as it was met where they were estimated.
    exact : bool
        Whether all slopes are those at the state.
    """

    model: Model
    frame: Frame
    hyper: Hyper
    state: State
    jacobian: Reals
    bend: Reals | None = None
    exact: bool = False

    @cached_property
    def covariance(self) -> Covariance:
        """Of the residuals."""
        return self.frame.covariance(self.hyper)

    @property
    def z(self) -> Reals:
        """Parameters, in standard deviations of their priors."""
        return self.state.z

    @cached_property
    def objective(self) -> float:
        """Minus two log posterior density of z and hyperparameters, up to a constant of the records."""
        return self.objective_of(self.covariance, self.covariance.square(self.state.residuals))

    def objective_of(self, covariance: Covariance, square: float) -> float:
        """The same with another covariance, by which this is the square of the residuals."""
        of_hyper = covariance.log_determinant - 2.0 * covariance.hyper.log_prior
        return square + float(self.z @ self.z) + of_hyper

    @cached_property
    def roots(self) -> Roots:
        """Of the slopes."""
        return self.covariance.roots(self.jacobian)

    def slope(self, residuals: Reals) -> Reals:
        """Half the slope of the objective by z where the residuals are these, shape (p,)."""
        return self.roots.times(self.covariance.roots(residuals[:, None]))[:, 0]

    @cached_property
    def normal(self) -> Reals:
        """Half the curvature of the objective by z, (p, p)."""
        return self.roots.times(self.roots) + np.eye(self.z.size)

    @cached_property
    def curvature(self) -> Reals:
        """The same for Laplace's approximation: a stretch has its joints, and its ends are no freer than these.

        While an end stays between two joints nothing changes (half of their spacing, see
        :func:`permway.diagnosis.catalogue._interval.weakened`), so that its slope there says nothing of how far it
        may go.
        """
        found = self.normal.copy()
        for centre, length, spacing_m in self.model.stretches:
            # Of an end that is evenly likely over half a spacing; the centre is the mean of two, the length their
            # difference.
            end = 12.0 / (0.5 * spacing_m) ** 2
            for index, precision in ((centre, 2.0 * end), (length, 0.5 * end)):
                free, z = self.model.free[index], float(self.z[index])
                slope = (free.value(z + STEP) - free.value(z - STEP)) / (2.0 * STEP)
                found[index, index] = max(found[index, index], 1.0 + precision * slope**2)
        return found

    @cached_property
    def spread(self) -> Reals:
        """Covariance of z (Laplace)."""
        return np.asarray(linalg.inv(self.curvature)) if self.z.size else np.zeros((0, 0))

    @property
    def log_evidence(self) -> float:
        """Laplace's approximation of the marginal likelihood over z, at the most probable hyperparameters."""
        curvature = float(np.linalg.slogdet(self.curvature)[1]) if self.z.size else 0.0
        return -0.5 * (self.objective + curvature)

    def values(self) -> dict[str, float]:
        """By name."""
        return self.model.values(self.z)

    def light(self) -> Fit:
        """The same without what is quickly found again: of a large campaign its covariance and roots are 30 MB."""
        new = replace(self)
        new.__dict__.update(objective=self.objective, curvature=self.curvature)
        return new

    def only(self, statistic: str) -> Fit:
        """The same fit of one kind of record alone."""
        blocks = self.frame.observations.blocks
        kept = [i for i, block in enumerate(blocks) if block.dataset.record.statistic == statistic]
        rows = np.isin(self.frame.observations.block_of, kept)
        frame = Frame.of(self.frame.observations.with_blocks(tuple(blocks[i] for i in kept)))
        columns = self.frame.whole[rows]
        frame = replace(frame, columns=columns, spanned=np.arange(columns.shape[0]), sources=self.frame.sources)
        solved = self.state.solved
        solved = replace(
            solved, needs=tuple(solved.needs[i] for i in kept), datasets=[solved.datasets[i] for i in kept]
        )
        state = State(self.z, solved, self.state.residuals[rows])
        return replace(self, frame=frame, state=state, jacobian=self.jacobian[rows])


def grown(fit: Fit, hypothesis: Hypothesis, prefix: str) -> Model:
    """A fit's model with an amendment more, whose parameters' names get a prefix."""
    return extended(fit.model, hypothesis, prefix, fit.frame.observations.campaign)


def extended(model: Model, hypothesis: Hypothesis, prefix: str, campaign: Campaign) -> Model:
    """A model with an amendment more; the campaign is that of the nominal parameters."""
    build, free = hypothesis.stacked_on(model.build, prefix, campaign)
    return Model(build, (*model.free, *free), (*model.stretches, *_stretch(hypothesis, campaign, len(model.free))))


def _stretch(hypothesis: Hypothesis, campaign: Campaign, before: int) -> Iterator[tuple[int, int, float]]:
    """Of an amendment of a stretch of joints: where centre and length stand among all, and the spacing."""
    names = [free.name for free in hypothesis.free]
    if all(name in names for name in STRETCH):
        what = hypothesis.locate({free.name: free.value(0.0) for free in hypothesis.free}).what
        if what in campaign.model.line.laws:
            centre, length = (before + names.index(name) for name in STRETCH)
            yield centre, length, spacing_of(campaign.model.line, what)
