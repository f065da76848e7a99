"""Hypotheses held against the records: quickly, with the base moved in one linear step; then in full."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.bounded import bounded_step
from permway.diagnosis.evidence import Evidence, Solved
from permway.diagnosis.felt import changed
from permway.diagnosis.fit import Fit, limits_of
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.quick import Quick, stacked, weaker
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.refit import moved
from permway.diagnosis.tangent import STEP, Problem
from permway.errors import InputError, SolveError

STEPS_BACK = 4
"""Further steps of a hypothesis that promises much and whose start is worse than nothing."""

STEPS_TOGETHER = 5
"""Of base and effect, where the effect alone does not gain what it promises."""

Progress = Callable[[str], object]


@dataclass(frozen=True)
class _Seen:
    """Deviations of an amended model, and what every use of them needs.

    Attributes
    ----------
    deviations : ndarray, shape (n,)
    reduced : ndarray, shape (c,)
        What smooth errors explain of them.
    slope : ndarray, shape (p,)
        Half the gradient of the heated objective by the base's parameters.
    """

    deviations: Reals
    reduced: Reals
    slope: Reals


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
        self._base = self._seen(fit.deviations)
        self._as_predicted = self._seen(self.evidence.deviations(solved.datasets))
        self.start = self._objective(self._base)[0]
        self._others: dict[tuple[tuple[str, float], ...], Ring] = {}

    def about(self, hypothesis: Hypothesis) -> Ring:
        """The ring about the base that a hypothesis is tried from: this one, but where it names another."""
        if not hypothesis.about:
            return self
        key = tuple(sorted(hypothesis.about.items()))
        if key not in self._others:
            self._others[key] = Ring(moved(self.fit, hypothesis.about))
        return self._others[key]

    def _seen_from(self, other: Ring, quick: Quick) -> Quick:
        """What was gained over another ring's start, as gain over this one's; and back with the two exchanged."""
        return replace(quick, gain=quick.gain + self.start - other.start)

    def _seen(self, deviations: Reals) -> _Seen:
        reduced, fit = self.whitener.reduce(deviations), self.fit
        slope = (fit.jacobian.T @ deviations - self.reduced.T @ reduced) / fit.heat + fit.z
        return _Seen(deviations, reduced, slope)

    def _objective(self, seen: _Seen) -> tuple[float, Reals]:
        """The least heated objective over linear moves of the base, and the move."""
        square = float(seen.deviations @ seen.deviations - seen.reduced @ seen.reduced) / self.fit.heat
        move = -linalg.cho_solve(self.factor, seen.slope, check_finite=False)
        return square + float(self.fit.z @ self.fit.z) + float(seen.slope @ move), move

    def _amended(self, hypothesis: Hypothesis, z: Reals) -> _Seen | None:
        """With a hypothesis in the base; None if that cannot be solved."""
        values = {f.name: f.value(float(v)) for f, v in zip(hypothesis.free, z, strict=True)}
        try:
            campaign = hypothesis.amend(self.fit.campaign, values)
            return self._seen_of(self.evidence.predicted(campaign, self._solved))
        except (InputError, SolveError):
            return None

    def _seen_of(self, solved: Solved) -> _Seen | None:
        """Of a prediction, what it has in common with the base's taken from there; None if not finite."""
        pairs = zip(solved.datasets, self._solved.datasets, strict=True)
        other = [index for index, (new, old) in enumerate(pairs) if new is not old]
        if len(other) == len(self.evidence.blocks):
            deviations = self.evidence.deviations(solved.datasets)
            return self._seen(deviations) if np.isfinite(deviations).all() else None
        before, fit = self._as_predicted, self.fit
        off, slope = np.zeros_like(before.deviations), before.slope.copy()
        for index in other:
            rows = self.whitener.columns.parts[index][0]
            off[rows] = self.evidence.blocks[index].deviations(solved.datasets[index]) - before.deviations[rows]
            if not np.isfinite(off[rows]).all():
                return None
            slope += fit.jacobian[rows].T @ off[rows] / fit.heat
        reduced = self.whitener.reduce(off, other)
        slope -= self.reduced.T @ reduced / fit.heat
        return _Seen(before.deviations + off, before.reduced + reduced, slope)

    def felt(self, hypothesis: Hypothesis, z: Reals) -> float:
        """As :func:`permway.diagnosis.felt.moved`, neper, the base's parameters as they are."""
        values = {f.name: f.value(float(v)) for f, v in zip(hypothesis.free, z, strict=True)}
        after = self.evidence.predicted(hypothesis.amend(self.fit.campaign, values), self._solved)
        return changed(self.evidence, self._solved.datasets, after.datasets, hypothesis.domain)

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
        other = self.about(hypothesis)
        if other is not self:
            found = other.screen(replace(hypothesis, about={}), least=least)
            return self._seen_from(other, replace(found, hypothesis=hypothesis))
        best: tuple[tuple[float, float], Quick, _Seen] | None = None
        low, high = limits_of(hypothesis.free)
        tried = [np.clip(np.array(start, dtype=np.float64), low, high) for start in hypothesis.starts]
        for index, z in enumerate(tried):
            seen = self._amended(hypothesis, z)
            if seen is None:
                continue
            direction = seen.deviations - self.fit.deviations
            curvature, slope = self._along(direction, seen)
            measure = max(-slope, 0.0) / max(curvature, 1e-12)
            promise = measure * max(-slope, 0.0)
            objective, move = self._objective(seen)
            gain = self.start - objective - float(z @ z)
            one = Quick(hypothesis, z, self.fit.z + move, gain, None, direction.astype(np.float32), z, promise)
            # What a start gains as it is counts before what it promises.
            rank = max(gain, 0.0), promise
            if best is None or rank > best[0]:
                best = rank, one, seen
            if index < len(hypothesis.starts) and gain < 0.0 and promise > max(least, best[1].gain):
                # It does more than is asked for: as much as is.
                tried += weaker(hypothesis, z, measure)
        if best is None:
            return Quick(hypothesis, np.zeros(len(hypothesis.free)), self.fit.z, -np.inf)
        _, found, seen = best
        if found.promise < least:
            return replace(found, gain=found.promise)
        found = self._descend(found, seen, 1)
        # A start that is too strong takes some steps back before it gains.
        return found if found.gain > 0.0 else self.quick(hypothesis, after=found, steps=STEPS_BACK)

    def promise(self, old: Quick) -> float:
        """Linear gain of a hypothesis by what it did to the deviations about an earlier base."""
        columns = old.columns if old.columns is not None else old.direction
        if columns is None or columns.shape[0] != self.fit.deviations.size:
            # That base weighed other lines.
            return float("inf")
        slopes = np.asarray(columns, dtype=np.float64).reshape(self.fit.deviations.size, -1)
        normal, slope = self._projected(slopes, self.whitener.reduce(slopes), self._base)
        return float(slope @ linalg.solve(normal + np.eye(slope.size), slope, assume_a="pos"))

    def effect(self, hypothesis: Hypothesis) -> tuple[Reals, Reals, Reals] | None:
        """The first start that can be solved: its coordinates, its change of the deviations, the slopes there."""
        low, high = limits_of(hypothesis.free)
        plain = self.evidence.deviations(self._solved.datasets)
        for start in hypothesis.starts:
            z = np.clip(np.array(start, dtype=np.float64), low, high)
            seen = self._amended(hypothesis, z)
            slopes = None if seen is None else self._columns(hypothesis, z, seen, high)
            if seen is not None and slopes is not None:
                return z, seen.deviations - plain, slopes[0]
        return None

    def quick(self, hypothesis: Hypothesis, *, after: Quick | None = None, steps: int = 6) -> Quick:
        """Follow a hypothesis on from where screening ended, while the base moves linearly."""
        other = self.about(hypothesis)
        if other is not self:
            begun = None if after is None else other._seen_from(self, after)
            found = other.quick(replace(hypothesis, about={}), after=begun, steps=steps)
            return self._seen_from(other, replace(found, hypothesis=hypothesis))
        found = self.screen(hypothesis) if after is None else after
        seen = self._amended(hypothesis, found.z)
        return found if seen is None else self._descend(found, seen, steps)

    def together(self, found: Quick) -> Quick:
        """Some steps of base and effect together, for what the base has to move far for."""
        fit = self.full(replace(found, columns=None), most_steps=STEPS_TOGETHER, settle=False)
        own = len(self.fit.free)
        objective = self.whitener.square(fit.deviations) / self.fit.heat + fit.prior
        gain = self.start - objective
        return replace(found, z=fit.z[own:], base_z=fit.z[:own], gain=gain) if gain > found.gain else found

    def _descend(self, found: Quick, seen: _Seen, steps: int) -> Quick:
        hypothesis, z, objective = found.hypothesis, found.z, self.start - found.gain
        move, columns = found.base_z - self.fit.z, found.columns
        low, high = limits_of(hypothesis.free)
        damping = 1e-2
        for _ in range(steps):
            slopes = self._columns(hypothesis, z, seen, high)
            if slopes is None:
                break
            columns = slopes[0].astype(np.float32)
            normal, slope = self._projected(*slopes, seen)
            normal, slope = normal + np.eye(z.size), slope + z
            gained = 0.0
            for _ in range(5):
                tried = np.clip(z + bounded_step(normal, slope, z, low, high, damping), low, high)
                new = self._amended(hypothesis, tried)
                if new is not None:
                    value, moved = self._objective(new)
                    value += float(tried @ tried)
                    if value < objective:
                        gained = objective - value
                        z, seen, objective, move = tried, new, value, moved
                        damping = max(damping / 5.0, 1e-9)
                        break
                damping *= 6.0
            if gained < 0.2:
                break
        return replace(found, z=z, base_z=self.fit.z + move, gain=self.start - objective, columns=columns)

    def _columns(self, hypothesis: Hypothesis, z: Reals, at: _Seen, high: Reals) -> tuple[Reals, Reals] | None:
        """Derivatives of the deviations by z, and what smooth errors explain of them."""
        columns, reduced = [], []
        for index in range(z.size):
            step = 10.0 * STEP if z[index] + 10.0 * STEP <= high[index] else -10.0 * STEP
            moved = z.copy()
            moved[index] += step
            new = self._amended(hypothesis, moved)
            if new is None:
                return None
            columns.append((new.deviations - at.deviations) / step)
            reduced.append((new.reduced - at.reduced) / step)
        return np.column_stack(columns), np.column_stack(reduced)

    def projected(self, columns: Reals, other: Reals) -> Reals:
        """Products of columns, (n, p) and (n, q), smooth errors and all moves of the base taken out."""
        mine, theirs = self.whitener.reduce(columns), self.whitener.reduce(other)
        inner = (columns.T @ other - mine.T @ theirs) / self.fit.heat
        left = (columns.T @ self.fit.jacobian - mine.T @ self.reduced) / self.fit.heat
        right = (other.T @ self.fit.jacobian - theirs.T @ self.reduced) / self.fit.heat
        return np.asarray(inner - left @ linalg.cho_solve(self.factor, right.T))

    def pull(self, columns: Reals) -> Reals:
        """Slope of half the objective along columns at the base, smooth errors and moves of the base taken out."""
        return self._projected(columns, self.whitener.reduce(columns), self._base)[1]

    def _projected(self, columns: Reals, reduced: Reals, seen: _Seen) -> tuple[Reals, Reals]:
        """Curvature and slope over the effect's parameters, the base moving along."""
        heat = self.fit.heat
        inner = (columns.T @ columns - reduced.T @ reduced) / heat
        cross = (columns.T @ self.fit.jacobian - reduced.T @ self.reduced) / heat
        own = (columns.T @ seen.deviations - reduced.T @ seen.reduced) / heat
        moved = linalg.cho_solve(self.factor, np.column_stack([cross.T, seen.slope]))
        return inner - cross @ moved[:, :-1], own - cross @ moved[:, -1]

    def _along(self, direction: Reals, seen: _Seen) -> tuple[float, float]:
        """Curvature and slope at the base along the way to other deviations, the base moving along."""
        heat, base = self.fit.heat, self._base
        reduced, cross = seen.reduced - base.reduced, seen.slope - base.slope
        inner = float(direction @ direction - reduced @ reduced) / heat
        own = float(direction @ base.deviations - reduced @ base.reduced) / heat
        moved = linalg.cho_solve(self.factor, np.column_stack([cross, base.slope]))
        return inner - float(cross @ moved[:, 0]), own - float(cross @ moved[:, 1])

    def _heated(self, problem: Problem, z: Reals) -> float:
        """Heated objective at a place; infinite where the model cannot be solved."""
        state = problem.at(z)
        if state is None:
            return np.inf
        return self.whitener.square(state.deviations) / self.fit.heat + float(z @ z)

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

        It moved the base in a straight line. Where that does worse than no effect, as over the ends of an earlier
        effect's stretch, the base is begun with as it was.

        See :func:`permway.diagnosis.recalibrate.recalibrate`.
        """
        build, free = stacked(self.fit.build, quick.hypothesis, prefix)
        known = self.about(quick.hypothesis).fit
        problem = Problem(self.evidence, build, (*self.fit.free, *free))
        ended, unmoved = (np.concatenate([base_z, quick.z]) for base_z in (quick.base_z, known.z))
        astray = self._heated(problem, ended)
        start = unmoved if astray > max(self.start, self._heated(problem, unmoved)) else ended
        return recalibrate(
            self.evidence,
            build=build,
            free=(*self.fit.free, *free),
            start=start,
            learn=False,
            slopes=None if quick.columns is None else np.hstack([known.jacobian, quick.columns]),
            most_steps=most_steps,
            settle=settle,
            progress=progress,
        )
