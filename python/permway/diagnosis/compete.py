"""Hypotheses held against the records: quickly, with the base moved in one linear step; then in full."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.evidence import Evidence, Solved, Whitener
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.recalibrate import STEP, Fit, free_parameters, recalibrate
from permway.errors import InputError, SolveError
from permway.recordings.campaign import Campaign

Progress = Callable[[str], object]


@dataclass(frozen=True)
class Quick:
    """What a hypothesis gains while the base moves linearly.

    Attributes
    ----------
    hypothesis : Hypothesis
    z : ndarray
        Of the effect's parameters.
    base_z : ndarray
        Of the base's parameters, moved along.
    gain : float
        Of the heated objective.
    """

    hypothesis: Hypothesis
    z: Reals
    base_z: Reals
    gain: float


class Ring:
    """The recalibrated base, made ready for many hypotheses to be held against it.

    Parameters
    ----------
    owner : Campaign
        With the model as its owner believes it, or as earlier effects amended it.
    fit : Fit
        The recalibrated base.
    """

    def __init__(self, owner: Campaign, fit: Fit) -> None:
        self.owner, self.fit = owner, fit
        self.evidence: Evidence = fit.evidence
        self._base = {f.name: f.value(float(z)) for f, z in zip(fit.free, fit.z, strict=True)}
        solved = self.evidence.predicted(fit.campaign)
        self._solved: Solved = solved
        self._whitener = Whitener.of(*self.evidence.smooth(solved.datasets), self.evidence.sizes)
        self._reduced = self._whitener.reduce(fit.jacobian)
        normal = (fit.jacobian.T @ fit.jacobian - self._reduced.T @ self._reduced) / fit.heat
        self._factor = linalg.cho_factor(normal + np.eye(fit.z.size))
        self.start = self._objective(fit.deviations)[0]

    def _objective(self, deviations: Reals) -> tuple[float, Reals]:
        """The least heated objective over linear moves of the base, and the move."""
        reduced = self._whitener.reduce(deviations)
        square = float(deviations @ deviations - reduced @ reduced) / self.fit.heat
        slope = (self.fit.jacobian.T @ deviations - self._reduced.T @ reduced) / self.fit.heat + self.fit.z
        move = -linalg.cho_solve(self._factor, slope)
        return square + float(self.fit.z @ self.fit.z) + float(slope @ move), move

    def _deviations(self, hypothesis: Hypothesis, z: Reals) -> Reals | None:
        values = {f.name: f.value(float(v)) for f, v in zip(hypothesis.free, z, strict=True)}
        try:
            campaign = hypothesis.build(self.owner)({**self._base, **values})
            deviations = self.evidence.deviations(self.evidence.predicted(campaign, self._solved).datasets)
        except (InputError, SolveError):
            return None
        return deviations if np.isfinite(deviations).all() else None

    def quick(self, hypothesis: Hypothesis, *, steps: int = 6) -> Quick:
        """Find the effect's values while the base moves linearly, from each of the hypothesis' starts."""
        best = Quick(hypothesis, np.zeros(len(hypothesis.free)), self.fit.z, -np.inf)
        for start in hypothesis.starts:
            found = self._from(hypothesis, np.array(start, dtype=np.float64), steps)
            if found.gain > best.gain:
                best = found
        return best

    def _from(self, hypothesis: Hypothesis, z: Reals, steps: int) -> Quick:
        low, high = np.array([f.limits for f in hypothesis.free]).T
        z = np.clip(z, low, high)
        deviations = self._deviations(hypothesis, z)
        if deviations is None:
            return Quick(hypothesis, z, self.fit.z, -np.inf)
        objective, move = self._objective(deviations)
        objective += float(z @ z)
        damping = 1e-2
        for _ in range(steps):
            columns = self._columns(hypothesis, z, deviations, high)
            if columns is None:
                break
            normal, slope = self._projected(columns, deviations)
            normal, slope = normal + np.eye(z.size), slope + z
            gained = 0.0
            for _ in range(5):
                shift = -linalg.solve(normal + damping * np.diag(np.diag(normal)), slope, assume_a="pos")
                tried = np.clip(z + shift, low, high)
                new = self._deviations(hypothesis, tried)
                if new is not None:
                    value, moved = self._objective(new)
                    value += float(tried @ tried)
                    if value < objective:
                        gained = objective - value
                        z, deviations, objective, move = tried, new, value, moved
                        damping = max(damping / 5.0, 1e-9)
                        break
                damping *= 6.0
            if gained < 0.2:
                break
        return Quick(hypothesis, z, self.fit.z + move, self.start - objective)

    def _columns(self, hypothesis: Hypothesis, z: Reals, at: Reals, high: Reals) -> Reals | None:
        columns = []
        for index in range(z.size):
            step = 10.0 * STEP if z[index] + 10.0 * STEP <= high[index] else -10.0 * STEP
            moved = z.copy()
            moved[index] += step
            new = self._deviations(hypothesis, moved)
            if new is None:
                return None
            columns.append((new - at) / step)
        return np.column_stack(columns)

    def _projected(self, columns: Reals, deviations: Reals) -> tuple[Reals, Reals]:
        """Curvature and slope over the effect's parameters, the base moving along."""
        heat, jacobian = self.fit.heat, self.fit.jacobian
        reduced, left = self._whitener.reduce(columns), self._whitener.reduce(deviations)
        inner = (columns.T @ columns - reduced.T @ reduced) / heat
        cross = (columns.T @ jacobian - reduced.T @ self._reduced) / heat
        own = (columns.T @ deviations - reduced.T @ left) / heat
        base = (jacobian.T @ deviations - self._reduced.T @ left) / heat + self.fit.z
        return inner - cross @ linalg.cho_solve(self._factor, cross.T), own - cross @ linalg.cho_solve(
            self._factor, base
        )

    def full(
        self, quick: Quick, *, learn: bool = False, most_steps: int = 15, progress: Progress | None = None
    ) -> Fit:
        """Fit base and effect together, from where the quick look ended."""
        hypothesis = quick.hypothesis
        base = free_parameters(self.owner)
        low, high = np.array([f.limits for f in base]).T
        return recalibrate(
            self.evidence,
            build=hypothesis.build(self.owner),
            free=(*base, *hypothesis.free),
            start=np.concatenate([np.clip(quick.base_z, low, high), quick.z]),
            learn=learn,
            most_steps=most_steps,
            progress=progress,
        )
