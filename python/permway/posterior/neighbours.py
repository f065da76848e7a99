"""Discrete moves of a fit at rest: stretches by whole joints, places by metres, frequencies by parts of octaves.

From a stretch to one that has a joint more there is no way that improves all along, and a resonance has a valley
of its own at each frequency. A fit that rests is therefore compared with its neighbours, all other parameters
moving along in a straight line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.diagnosis.catalogue._interval import spacing_of, stations_of
from permway.diagnosis.hypothesis import Hypothesis
from permway.diagnosis.side_by_side import SMALL, each
from permway.errors import InputError, SolveError
from permway.posterior.cells import coordinate
from permway.posterior.fit import STRETCH, Fit
from permway.posterior.fitter import Fitter

JOINTS = (-2, -1, 0, 1, 2)
"""By which either end moves, or metres along a body. More are reached in several moves."""

PLACES = (-4.0, -2.0, -1.0, 1.0, 2.0, 4.0)
"""By which a place moves, in spacings of joints, or metres along a body."""

OCTAVES = (-1.0, -0.5, -0.25, 0.25, 0.5, 1.0)
"""By which a frequency moves."""

WORTH = 2.0
"""Of the objective, that a move is predicted to gain before it is fitted."""

MOVES = 6
"""In a row, at most."""


def rested(fitter: Fitter, fit: Fit, own: slice, hypothesis: Hypothesis, steps: int) -> Fit:
    """A fit moved to better neighbours until none is predicted to gain more.

    Parameters
    ----------
    fitter : Fitter
    fit : Fit
    own : slice
        Where the hypothesis's parameters stand among the fit's.
    hypothesis : Hypothesis
    steps : int
        Of the fit after each move.
    """
    for _ in range(MOVES):
        moved = list(_moves(fit, own, hypothesis))
        if not moved:
            return fit
        predicted = [score for score, _ in _scored(fit, moved)]
        best = int(np.argmin(predicted))
        if not predicted[best] < fit.objective - WORTH:
            return fit
        try:
            start = fitter.begin(fit.model, moved[best][0], fit.hyper, fit.jacobian, fit.bend)
            new = fitter.fit(fitter.settled(start, fixed=own.start), steps=steps, fixed=own.start)
        except (InputError, SolveError):
            return fit
        if not new.objective < fit.objective:
            return fit
        fit = new
    return fit


def _moves(fit: Fit, own: slice, hypothesis: Hypothesis) -> Iterator[tuple[Reals, tuple[int, ...]]]:
    """Coordinates of neighbours, and which of them are set."""
    free = hypothesis.free
    names = [f.name for f in free]
    values = {f.name: f.value(float(z)) for f, z in zip(free, fit.z[own], strict=True)}
    line = fit.state.solved.campaign.model.line
    what = hypothesis.locate(values).what
    step = spacing_of(line, what) if what in line.laws else 1.0

    def changed(to: dict[str, float]) -> Iterator[tuple[Reals, tuple[int, ...]]]:
        z, places = fit.z.copy(), []
        for name, value in to.items():
            index = names.index(name)
            at = own.start + index
            found = coordinate(free[index], value)
            if name == hypothesis.size:
                # It moves along; a size beyond its limits stays as it is.
                z[at] = z[at] if found is None else found
                continue
            if found is None:
                return
            z[at] = found
            places.append(at)
        yield z, tuple(places)

    if all(name in names for name in STRETCH):
        for low, high in _stretches(values, stations_of(line, what) if what in line.laws else None, hypothesis):
            to = {"centre_m": 0.5 * (low + high), "length_m": high - low}
            here = hypothesis.locate(values).x_m
            same = here is not None and bool(np.allclose((low, high), here))
            if not same and hypothesis.size in names and np.isfinite(hypothesis.none):
                # More joints have less each: halfway between as much each and as much together.
                share = np.sqrt((values["length_m"] + step) / (high - low + step))
                to[hypothesis.size] = _shared(values[hypothesis.size], hypothesis.none, float(share))
            yield from changed(to)
    elif "x_m" in names:
        for away in PLACES:
            yield from changed({"x_m": values["x_m"] + away * step})
    for name, one in zip(names, free, strict=True):
        if one.unit == "Hz":
            for octaves in OCTAVES:
                yield from changed({name: values[name] * 2.0**octaves})


def _shared(size: float, none: float, share: float) -> float:
    """A size with a share of its effect: a factor by its logarithm, for little is left of it either way."""
    if size > 0.0 and none > 0.0:
        return float(none * (size / none) ** share)
    return none + share * (size - none)


def _stretches(
    values: Mapping[str, float], stations: Reals | None, hypothesis: Hypothesis
) -> Iterator[tuple[float, float]]:
    """Ends of stretches near one: of whole joints where there are any, itself brought to joints among them."""
    where = hypothesis.locate(values).x_m
    half = 0.5 * values["length_m"]
    low, high = where or (values["centre_m"] - half, values["centre_m"] + half)
    if stations is None or not stations.size:
        for left, right in product(JOINTS, repeat=2):
            if (left or right) and low + left <= high + right:
                yield low + left, high + right
        return
    first, last = (int(np.argmin(np.abs(stations - x))) for x in (low, high))
    for left, right in product(JOINTS, repeat=2):
        a, b = first + left, last + right
        if 0 <= a <= b < stations.size:
            yield float(stations[a]), float(stations[b])


def _scored(fit: Fit, moved: list[tuple[Reals, tuple[int, ...]]]) -> list[tuple[float, int]]:
    """The least objective of each neighbour while all that was not set moves along, and its index."""
    observations = fit.frame.observations
    rest = fit.objective - fit.covariance.square(fit.state.residuals) - float(fit.z @ fit.z)

    def residuals(one: tuple[Reals, tuple[int, ...]]) -> Reals | None:
        try:
            campaign = fit.model.build(fit.model.values(one[0]))
            found = observations.residuals(observations.predicted(campaign, fit.state.solved).datasets)
        except (InputError, SolveError):
            return None
        return found if np.isfinite(found).all() else None

    found = []
    for index, values in enumerate(each(residuals, moved, threads=observations.threads, least=SMALL)):
        if values is None:
            found.append((np.inf, index))
            continue
        z, places = moved[index]
        moving = np.setdiff1d(np.arange(z.size), places)
        roots = fit.covariance.roots(values[:, None])
        slope = fit.roots.times(roots)[moving, 0] + z[moving]
        normal = fit.normal[np.ix_(moving, moving)]
        gain = float(slope @ linalg.solve(normal, slope, assume_a="pos")) if moving.size else 0.0
        found.append((float(roots.squares()[0]) + float(z @ z) - gain + rest, index))
    return found
