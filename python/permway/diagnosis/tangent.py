"""Residuals as a function of the free parameters, and their slopes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.diagnosis.fit import Build, Free
from permway.diagnosis.nearby import Nearby
from permway.diagnosis.observations import Observations, Solved
from permway.diagnosis.side_by_side import SMALL, each
from permway.diagnosis.whitener import Whitener
from permway.errors import InputError, SolveError

STEP = 1e-5
"""Of finite differences, in standard deviations of the prior."""


@dataclass(frozen=True)
class State:
    """Values of the free parameters in z, and the standardised residuals there."""

    z: Reals
    solved: Solved
    residuals: Reals


@dataclass(frozen=True)
class Tangent:
    """Slopes and calibration errors about a state, also used near it."""

    at: State
    whitener: Whitener
    jacobian: Reals
    curvature: Reals
    """J' V^-1 J."""
    reduced: Reals
    blocks: float
    """Log determinant of what the blocks take out themselves."""

    def chi2(self, state: State) -> float:
        """Quadratic form of the residuals, calibration errors integrated out, and the blocks' log determinant."""
        return self.whitener.square(state.residuals) + self.blocks

    def inflated(self, state: State, inflation: float) -> float:
        """Minus twice the log posterior, the records counting so much less."""
        return self.chi2(state) / inflation + float(state.z @ state.z) + self.whitener.log_determinant

    def normal(self, inflation: float) -> Reals:
        """Half the curvature of the inflated objective, (p, p)."""
        return np.asarray(self.curvature / inflation + np.eye(self.jacobian.shape[1]))

    def curved(self, state: State, tried: State) -> State:
        """A state with the part of its change on the way to another that slopes do not predict."""
        further = tried.residuals - self.jacobian @ (tried.z - state.z)
        return State(state.z, state.solved, further)

    def slope(self, state: State, inflation: float) -> Reals:
        """Half its gradient, (p,)."""
        reduced = self.whitener.reduce(state.residuals)
        return np.asarray((self.jacobian.T @ state.residuals - self.reduced.T @ reduced) / inflation + state.z)


def tangent_of(at: State, whitener: Whitener, jacobian: Reals, blocks: float) -> Tangent:
    """A tangent, with the products that every use of it needs."""
    reduced = whitener.reduce(jacobian)
    return Tangent(at, whitener, jacobian, jacobian.T @ jacobian - reduced.T @ reduced, reduced, blocks)


class Problem:
    """Residuals as a function of z."""

    def __init__(self, observations: Observations, build: Build, free: tuple[Free, ...]) -> None:
        self.observations, self.build, self.free = observations, build, free
        self.evaluations = 0

    def residuals(self, z: Reals, near: Solved | None = None) -> tuple[Reals, Solved]:
        """Of a model with these values, and its predictions; those of one near by save solves."""
        self.evaluations += 1
        predicted = self.observations.predicted(self._campaign(z), near)
        return self.observations.residuals(predicted.datasets), predicted

    def _near(self, predicted: Solved, state: State) -> Reals:
        """Residuals, those of datasets that are the state's own taken from it."""
        found, start = [], 0
        for block, new, old in zip(
            self.observations.blocks, predicted.datasets, state.solved.datasets, strict=True
        ):
            rows = slice(start, start + block.rows.channel.size)
            found.append(state.residuals[rows] if new is old else block.residuals(new))
            start = rows.stop
        return np.concatenate(found)

    def _campaign(self, z: Reals) -> Campaign:
        return self.build({f.name: f.value(float(v)) for f, v in zip(self.free, z, strict=True)})

    def at(self, z: Reals, near: Solved | None = None) -> State | None:
        """The state; None if the model cannot be solved there. Predictions near by save solves."""
        try:
            residuals, predicted = self.residuals(z, near)
        except (SolveError, InputError):
            return None
        return State(z, predicted, residuals) if np.isfinite(residuals).all() else None

    def tangent(self, state: State, slopes: Reals | None = None) -> Tangent:
        """About a state, by finite differences unless slopes are given."""
        slopes = self.jacobian(state) if slopes is None else slopes
        return tangent_of(state, self.observations.whitener, slopes, self.observations.log_determinant)

    def jacobian(self, state: State) -> Reals:
        """Derivative of the residuals by z: forward differences, without solves where derivatives serve."""
        nearby = Nearby(self.observations, state.solved)
        nearby.derive()
        return self.columns(state, range(len(self.free)), nearby)

    def columns(self, state: State, indices: Sequence[int], nearby: Nearby | None = None) -> Reals:
        """Columns of the Jacobian, of some parameters; by derivatives where they are given, else by solves."""

        def column(index: int) -> Reals:
            forward = state.z[index] + STEP <= self.free[index].limits[1]
            try:
                return self._slope(state, index, STEP if forward else -STEP, nearby)
            except (SolveError, InputError):
                # A number may stand at the edge of what there can be: then from its other side.
                return self._slope(state, index, -STEP if forward else STEP, nearby)

        columns = each(column, indices, threads=self.observations.threads, least=SMALL)
        return np.column_stack(columns) if columns else np.zeros((state.residuals.size, 0))

    def _slope(self, state: State, index: int, step: float, nearby: Nearby | None) -> Reals:
        moved = state.z.copy()
        moved[index] += step
        campaign = self._campaign(moved)
        near = None if nearby is None else nearby.predicted(campaign)
        predicted = near or self.observations.predicted(campaign, state.solved)
        return np.asarray((self._near(predicted, state) - state.residuals) / step)
