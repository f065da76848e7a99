"""Hypotheses held against the records: quickly, with the base moved in one linear step; then in full."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.bounded import bounded_step
from permway.diagnosis.evidence import Evidence, Solved
from permway.diagnosis.felt import changed
from permway.diagnosis.fit import Fit
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.quick import Quick, stacked, weaker
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.refit import moved
from permway.diagnosis.tangent import STEP
from permway.errors import InputError, SolveError

STEPS_BACK = 4
"""Further steps of a hypothesis that promises much and whose start is worse than nothing."""

STEPS_TOGETHER = 5
"""Of base and effect, where the effect alone does not gain what it promises."""

Progress = Callable[[str], object]


class Ring:
    """The recalibrated base, made ready for many hypotheses to be held against it.

    Parameters
    ----------
    fit : Fit
        The recalibrated base, with earlier effects in it or not.
    """

    def __init__(self, fit: Fit) -> None:
        self.fit = fit
        self.evidence: Evidence = fit.evidence
        solved = self.evidence.predicted(fit.campaign)
        self._solved: Solved = solved
        self.whitener = self.evidence.whitener
        self.reduced = self.whitener.reduce(fit.jacobian)
        normal = (fit.jacobian.T @ fit.jacobian - self.reduced.T @ self.reduced) / fit.heat
        self.factor = linalg.cho_factor(normal + np.eye(fit.z.size))
        self.start = self._objective(fit.deviations)[0]
        self._others: dict[tuple[tuple[str, float], ...], Ring] = {}

    def _about(self, hypothesis: Hypothesis) -> Ring:
        """The ring about the base that a hypothesis is tried from: its own, but where it names another."""
        if not hypothesis.about:
            return self
        key = tuple(sorted(hypothesis.about.items()))
        if key not in self._others:
            self._others[key] = Ring(moved(self.fit, hypothesis.about))
        return self._others[key]

    def _seen_from(self, other: Ring, quick: Quick) -> Quick:
        """What was gained over another ring's start, as gain over this one's; and back with the two exchanged."""
        return replace(quick, gain=quick.gain + self.start - other.start)

    def _objective(self, deviations: Reals) -> tuple[float, Reals]:
        """The least heated objective over linear moves of the base, and the move."""
        reduced = self.whitener.reduce(deviations)
        square = float(deviations @ deviations - reduced @ reduced) / self.fit.heat
        slope = (self.fit.jacobian.T @ deviations - self.reduced.T @ reduced) / self.fit.heat + self.fit.z
        move = -linalg.cho_solve(self.factor, slope, check_finite=False)
        return square + float(self.fit.z @ self.fit.z) + float(slope @ move), move

    def _deviations(self, hypothesis: Hypothesis, z: Reals) -> Reals | None:
        values = {f.name: f.value(float(v)) for f, v in zip(hypothesis.free, z, strict=True)}
        try:
            campaign = hypothesis.amend(self.fit.campaign, values)
            deviations = self.evidence.deviations(self.evidence.predicted(campaign, self._solved).datasets)
        except (InputError, SolveError):
            return None
        return deviations if np.isfinite(deviations).all() else None

    def felt(self, hypothesis: Hypothesis, z: Reals) -> float:
        """Largest change of what a sensor is predicted to read, neper, the base's parameters as they are."""
        values = {f.name: f.value(float(v)) for f, v in zip(hypothesis.free, z, strict=True)}
        after = self.evidence.predicted(hypothesis.amend(self.fit.campaign, values), self._solved)
        return changed(self.evidence, self._solved.datasets, after.datasets)

    def screen(self, hypothesis: Hypothesis, *, least: float = 0.0) -> Quick:
        """One step from the most promising of the hypothesis' starts.

        A start promises what the change that it makes to the deviations would gain, if it could be taken in any
        measure.

        Parameters
        ----------
        hypothesis : Hypothesis
        least : float
            Promised gain below which the step is not taken, and the promise is what it is said to gain.
        """
        other = self._about(hypothesis)
        if other is not self:
            found = other.screen(replace(hypothesis, about={}), least=least)
            return self._seen_from(other, replace(found, hypothesis=hypothesis))
        best: tuple[tuple[float, float], Quick, Reals] | None = None
        low, high = np.array([f.limits for f in hypothesis.free]).T
        tried = [np.clip(np.array(start, dtype=np.float64), low, high) for start in hypothesis.starts]
        for index, z in enumerate(tried):
            deviations = self._deviations(hypothesis, z)
            if deviations is None:
                continue
            curvature, slope = self._projected((deviations - self.fit.deviations)[:, None], self.fit.deviations)
            measure = max(-float(slope[0]), 0.0) / max(float(curvature[0, 0]), 1e-12)
            promise = measure * max(-float(slope[0]), 0.0)
            objective, move = self._objective(deviations)
            gain, direction = self.start - objective - float(z @ z), deviations - self.fit.deviations
            one = Quick(hypothesis, z, self.fit.z + move, gain, None, direction.astype(np.float32), z, promise)
            # What a start gains as it is counts before what it promises.
            rank = max(gain, 0.0), promise
            if best is None or rank > best[0]:
                best = rank, one, deviations
            if index < len(hypothesis.starts) and gain < 0.0 and promise > max(least, best[1].gain):
                # It does more than is asked for: as much as is.
                tried += weaker(hypothesis, z, measure)
        if best is None:
            return Quick(hypothesis, np.zeros(len(hypothesis.free)), self.fit.z, -np.inf)
        _, found, deviations = best
        if found.promise < least:
            return replace(found, gain=found.promise)
        found = self._descend(found, deviations, 1)
        # A start that is too strong takes some steps back before it gains.
        return found if found.gain > 0.0 else self.quick(hypothesis, after=found, steps=STEPS_BACK)

    def promise(self, old: Quick) -> float:
        """Linear gain of a hypothesis by what it did to the deviations about an earlier base."""
        columns = old.columns if old.columns is not None else old.direction
        if columns is None or columns.shape[0] != self.fit.deviations.size:
            # That base weighed other lines.
            return float("inf")
        slopes = np.asarray(columns, dtype=np.float64).reshape(self.fit.deviations.size, -1)
        normal, slope = self._projected(slopes, self.fit.deviations)
        return float(slope @ linalg.solve(normal + np.eye(slope.size), slope, assume_a="pos"))

    def effect(self, hypothesis: Hypothesis) -> tuple[Reals, Reals, Reals] | None:
        """The first start that can be solved: its coordinates, its change of the deviations, the slopes there."""
        low, high = np.array([f.limits for f in hypothesis.free]).T
        plain = self.evidence.deviations(self._solved.datasets)
        for start in hypothesis.starts:
            z = np.clip(np.array(start, dtype=np.float64), low, high)
            deviations = self._deviations(hypothesis, z)
            columns = None if deviations is None else self._columns(hypothesis, z, deviations, high)
            if deviations is not None and columns is not None:
                return z, deviations - plain, columns
        return None

    def quick(self, hypothesis: Hypothesis, *, after: Quick | None = None, steps: int = 6) -> Quick:
        """Follow a hypothesis on from where screening ended, while the base moves linearly."""
        other = self._about(hypothesis)
        if other is not self:
            begun = None if after is None else other._seen_from(self, after)
            found = other.quick(replace(hypothesis, about={}), after=begun, steps=steps)
            return self._seen_from(other, replace(found, hypothesis=hypothesis))
        found = self.screen(hypothesis) if after is None else after
        deviations = self._deviations(hypothesis, found.z)
        return found if deviations is None else self._descend(found, deviations, steps)

    def together(self, found: Quick) -> Quick:
        """Some steps of base and effect together, for what the base has to move far for."""
        fit = self.full(replace(found, columns=None), most_steps=STEPS_TOGETHER, settle=False)
        own = len(self.fit.free)
        objective = self.whitener.square(fit.deviations) / self.fit.heat + fit.prior
        gain = self.start - objective
        return replace(found, z=fit.z[own:], base_z=fit.z[:own], gain=gain) if gain > found.gain else found

    def _descend(self, found: Quick, deviations: Reals, steps: int) -> Quick:
        hypothesis, z, objective = found.hypothesis, found.z, self.start - found.gain
        move, columns = found.base_z - self.fit.z, found.columns
        low, high = np.array([f.limits for f in hypothesis.free]).T
        damping = 1e-2
        for _ in range(steps):
            slopes = self._columns(hypothesis, z, deviations, high)
            if slopes is None:
                break
            columns = slopes.astype(np.float32)
            normal, slope = self._projected(slopes, deviations)
            normal, slope = normal + np.eye(z.size), slope + z
            gained = 0.0
            for _ in range(5):
                tried = np.clip(z + bounded_step(normal, slope, z, low, high, damping), low, high)
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
        return replace(found, z=z, base_z=self.fit.z + move, gain=self.start - objective, columns=columns)

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

    def projected(self, columns: Reals, other: Reals) -> Reals:
        """Products of columns, (n, p) and (n, q), smooth errors and all moves of the base taken out."""
        mine, theirs = self.whitener.reduce(columns), self.whitener.reduce(other)
        inner = (columns.T @ other - mine.T @ theirs) / self.fit.heat
        left = (columns.T @ self.fit.jacobian - mine.T @ self.reduced) / self.fit.heat
        right = (other.T @ self.fit.jacobian - theirs.T @ self.reduced) / self.fit.heat
        return np.asarray(inner - left @ linalg.cho_solve(self.factor, right.T))

    def pull(self, columns: Reals) -> Reals:
        """Slope of half the objective along columns at the base, smooth errors and moves of the base taken out."""
        return self._projected(columns, self.fit.deviations)[1]

    def _projected(self, columns: Reals, deviations: Reals) -> tuple[Reals, Reals]:
        """Curvature and slope over the effect's parameters, the base moving along."""
        heat, jacobian = self.fit.heat, self.fit.jacobian
        reduced, left = self.whitener.reduce(columns), self.whitener.reduce(deviations)
        inner = (columns.T @ columns - reduced.T @ reduced) / heat
        cross = (columns.T @ jacobian - reduced.T @ self.reduced) / heat
        own = (columns.T @ deviations - reduced.T @ left) / heat
        base = (jacobian.T @ deviations - self.reduced.T @ left) / heat + self.fit.z
        return inner - cross @ linalg.cho_solve(self.factor, cross.T), own - cross @ linalg.cho_solve(
            self.factor, base
        )

    def full(
        self,
        quick: Quick,
        *,
        prefix: str = "",
        most_steps: int = 15,
        settle: bool = True,
        progress: Progress | None = None,
    ) -> Fit:
        """Fit base and effect together, from where the quick look ended.

        See :func:`permway.diagnosis.recalibrate.recalibrate`.
        """
        build, free = stacked(self.fit.build, quick.hypothesis, prefix)
        known = self._about(quick.hypothesis).fit
        return recalibrate(
            self.evidence,
            build=build,
            free=(*self.fit.free, *free),
            start=np.concatenate([quick.base_z, quick.z]),
            learn=False,
            slopes=None if quick.columns is None else np.hstack([known.jacobian, quick.columns]),
            most_steps=most_steps,
            settle=settle,
            progress=progress,
        )
