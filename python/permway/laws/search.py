"""The search for the best coordinates: evolution first, several local finishes after.

A differential evolution run to its end settles in whichever valley it entered first; for FVMP on measured
rubber that was the best one in about one seed of five. Stopped early, its population still holds all the
valleys: the best members that differ are then each carried to the bottom by least squares, and the lowest
bottom wins. On the same rubber every seed then ends in the same place.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import optimize

from permway.arrays import Reals
from permway.laws.dma import DmaTable
from permway.laws.families import Family
from permway.laws.shift_fit import ShiftFamily, middle, shift_family

Progress = Callable[[int, int], None]
"""Reported the steps done and the steps in all."""

STEPS = 100
"""Of one identification."""

_POPULATION = 20
_GENERATIONS = 60
_STARTS = 14
_FEW_STARTS = 6
_FEW_COORDINATES = 7
"""Up to so many coordinates all finishes have always agreed, and few are enough."""
_APART = 0.05
"""Members nearer than this in every coordinate, over its range, count as one start."""
_SAME = 1e-4
"""Costs nearer than this, relative, count as one optimum."""
_FREE_STARTS = 3
_STEP = 1e-6


@dataclass(frozen=True)
class Problem:
    """Law and shift families over one table, as residuals over their coordinates."""

    law: Family
    shift: ShiftFamily
    bounds: Reals
    log_frequency: Reals
    vertical: Reals
    target: Reals
    weights: Reals
    lg_scale: float = 0.0
    """Decades of the vertical factor at the user's reference, relative to that in the middle of the table."""

    def at_reference(self, x: Reals) -> Reals:
        """The law's own coordinates at the user's reference, from those of the search."""
        own = len(x) - len(self.shift.bounds)
        return self.law.shifted(x[:own], self.shift.at_reference(x[own:]), self.lg_scale)

    def residuals(self, x: Reals) -> Reals:
        """Weighted errors of log modulus and phase, shape (..., 2 n), for coordinates of shape (..., d)."""
        parts = [x[..., index, None] for index in range(x.shape[-1])]
        split = len(parts) - len(self.shift.bounds)
        lg_shift = self.shift.log10(parts[split:] if x.ndim > 1 else [part[0] for part in parts[split:]])
        # The search visits absurd corners; what overflows there is priced out below.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            s = np.asarray(2j * np.pi * 10.0 ** (self.log_frequency + lg_shift), dtype=np.complex128)
            modulus = np.log(self.law.value(parts[:split], s) * self.vertical)
        both = np.concatenate([modulus.real, modulus.imag], axis=-1) - self.target
        return np.nan_to_num(both * self.weights, nan=1e3, posinf=1e3, neginf=-1e3)

    def slopes(self, x: Reals) -> Reals:
        """Jacobian of the residuals by central differences, all in one call, shape (2 n, d)."""
        steps = np.diag(_STEP * (self.bounds[:, 1] - self.bounds[:, 0]))
        if self.shift.name == "free":
            # Its interpolation takes one set of coordinates at a time.
            rows = np.array([self.residuals(x + step) - self.residuals(x - step) for step in steps])
        else:
            rows = self.residuals(x + steps) - self.residuals(x - steps)
        return np.asarray((rows / (2.0 * steps.diagonal()[:, None])).T)

    def cost(self, x: Reals) -> Reals:
        """Mean square, for coordinates of shape (d,) or (d, p)."""
        return np.asarray(np.mean(self.residuals(x.T) ** 2, axis=-1))


@dataclass(frozen=True)
class SearchResult:
    """The optimum: coordinates, Jacobian of the residuals there, and how it was reached."""

    x: Reals
    jacobian: Reals
    evaluations: int
    starts: int
    agreeing: int


def nodes_of(table: DmaTable) -> Reals:
    """Isotherms, the outermost moved to the outermost rows so that a free shift reaches them all."""
    nodes = table.isotherms()
    if table.temperature_C is not None and len(nodes) > 1:
        nodes[0], nodes[-1] = table.temperature_C.min(), table.temperature_C.max()
    return nodes


def search(problem: Problem, table: DmaTable, seed: int, progress: Progress | None) -> SearchResult:
    """Find the optimum of a problem.

    A free shift is searched for as WLF first, and freed in the last step from where that ended.
    """
    wide = problem
    own = len(problem.bounds) - len(problem.shift.bounds)
    if problem.shift.name == "free" and table.temperature_C is not None:
        # For the middle of the table, so that the user's reference has no part in the search.
        centre = middle(table.temperature_C)
        stand_in = shift_family("wlf", table.temperature_C, nodes_of(table), centre)
        bounds = np.concatenate([problem.bounds[:own], np.array(stand_in.bounds)])
        wide = replace(problem, shift=stand_in, bounds=bounds)
    starts, evaluations = _evolve(wide, seed, progress)
    finishes = []
    for index, start in enumerate(starts):
        finishes.append(_finish(wide, start))
        if progress is not None:
            progress(60 + 35 * (index + 1) // len(starts), STEPS)
    finishes.sort(key=lambda result: float(result.cost))
    evaluations += sum(int(result.nfev + 2 * result.njev * len(wide.bounds)) for result in finishes)
    if wide is not problem:
        freed = [
            _finish(problem, _freed(wide, result.x, own, nodes_of(table))) for result in finishes[:_FREE_STARTS]
        ]
        evaluations += sum(int(result.nfev + 2 * result.njev * len(problem.bounds)) for result in freed)
        finishes = sorted(freed, key=lambda result: float(result.cost))
    best = finishes[0]
    return SearchResult(
        x=np.asarray(best.x, dtype=np.float64),
        jacobian=np.asarray(best.jac, dtype=np.float64),
        evaluations=evaluations,
        starts=len(finishes),
        agreeing=sum(float(result.cost) <= (1.0 + _SAME) * float(best.cost) for result in finishes),
    )


def _evolve(problem: Problem, seed: int, progress: Progress | None) -> tuple[list[Reals], int]:
    """Best members of an early population that differ, and the evaluations spent."""
    generation = 0

    def each_generation(best: Reals, convergence: float) -> None:
        nonlocal generation
        generation += 1
        if progress is not None:
            progress(60 * generation // _GENERATIONS, STEPS)

    # With vectorized=True the cost takes a whole population, which the published stubs do not know.
    evolve: Any = optimize.differential_evolution
    result = evolve(
        problem.cost,
        [(float(low), float(high)) for low, high in problem.bounds],
        strategy="rand1bin",
        vectorized=True,
        updating="deferred",
        popsize=_POPULATION,
        maxiter=_GENERATIONS,
        tol=0.0,
        init="sobol",
        mutation=(0.5, 1.0),
        recombination=0.8,
        polish=False,
        seed=seed,
        callback=each_generation,
    )
    ranked = np.asarray(result.population)[np.argsort(result.population_energies)]
    width = problem.bounds[:, 1] - problem.bounds[:, 0]
    wanted = _FEW_STARTS if len(width) <= _FEW_COORDINATES else _STARTS
    chosen: list[Reals] = []
    for member in ranked:
        if all(np.max(np.abs(member - other) / width) > _APART for other in chosen):
            chosen.append(member)
        if len(chosen) == wanted:
            break
    return chosen, len(ranked) * (generation + 1)


def _finish(problem: Problem, start: Reals) -> Any:
    low, high = problem.bounds.T
    margin = 1e-6 * (high - low)
    return optimize.least_squares(
        problem.residuals,
        np.clip(start, low + margin, high - margin),
        jac=problem.slopes,
        bounds=(low, high),
        x_scale="jac",
        ftol=1e-10,
        xtol=1e-10,
        gtol=1e-10,
    )


def _freed(wide: Problem, x: Reals, own: int, nodes: Reals) -> Reals:
    """Coordinates with a free shift that say the same as those with WLF."""
    shift = wide.shift.shift(x[own:])
    assert shift is not None
    return np.concatenate([x[:own], -np.diff(shift.log10_factor(nodes))])
