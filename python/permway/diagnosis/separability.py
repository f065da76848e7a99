"""What the sensors of a campaign can separate, before what they read is looked at.

Every effect of the catalogue is put into the nominal model at the size it starts from; what it does to the
records, with all that recalibration and calibration errors could do taken out, is compared with what every other
effect could do at any size. Measured values play no part: only where, what and how well was measured.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from permway.arrays import Reals
from permway.campaign.campaign import Campaign
from permway.campaign.predict import predict
from permway.diagnosis.catalogue import hypotheses
from permway.diagnosis.clock import Progress
from permway.diagnosis.fit import Fit, free_parameters, limits_of
from permway.diagnosis.gather import gather, predictable
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.location import Location, step_m, stretches
from permway.diagnosis.plain_names import spelled
from permway.diagnosis.recalibrate import recalibrate
from permway.diagnosis.side_by_side import one_thread_of_blas
from permway.diagnosis.tangent import Problem
from permway.errors import InputError, SolveError
from permway.model.line import Line

CLASS_DEVIANCE = 9.0
"""Deviance below which two effects are one class, and an effect and nothing are."""

SHARES = (0.5, 0.25, 0.75)
"""Of a layer or a body, where an effect is put."""

BANDS = 24
"""Frequencies with which a place is handed on that was not looked at."""


@dataclass(frozen=True)
class Separability:
    """Expected deviances between effects.

    Attributes
    ----------
    names : tuple of str
        Effect and place of every hypothesis.
    entries, families : tuple of str
    size : tuple of str
        At which each was put in, in words.
    seen : ndarray, shape (H,)
        Deviance from the best recalibrated base: below about 15 there is not enough information.
    apart : ndarray, shape (H, H)
        Deviance of effect i from the best that effect j could do.
    """

    names: tuple[str, ...]
    entries: tuple[str, ...]
    families: tuple[str, ...]
    size: tuple[str, ...]
    seen: Reals
    apart: Reals

    def inseparable(self) -> list[tuple[str, str, float]]:
        """Pairs of different effects that are seen and cannot be separated, with their deviance."""
        found: dict[tuple[str, str], float] = {}
        count = len(self.names)
        for i in range(count):
            for j in range(count):
                one, other = self.entries[i], self.entries[j]
                if one == other or self.seen[i] < CLASS_DEVIANCE or self.apart[i, j] >= CLASS_DEVIANCE:
                    continue
                key = (min(one, other), max(one, other))
                found[key] = min(found.get(key, np.inf), float(self.apart[i, j]))
        return [(a, b, value) for (a, b), value in sorted(found.items(), key=lambda item: item[1])]

    def summary(self) -> dict[str, object]:
        """For people and machines."""
        best: dict[str, int] = {}
        for i, entry in enumerate(self.entries):
            if entry not in best or self.seen[i] > self.seen[best[entry]]:
                best[entry] = i
        return {
            "effects": [
                {"effect": e, "at": self.names[i], "size": self.size[i], "deviance": round(float(self.seen[i]), 1)}
                for e, i in sorted(best.items(), key=lambda item: -self.seen[item[1]])
            ],
            "inseparable": [{"one": a, "other": b, "deviance": round(v, 1)} for a, b, v in self.inseparable()],
        }


@one_thread_of_blas()
def separability(
    campaign: Campaign, *, threads: int | None = None, progress: Progress | None = None
) -> Separability:
    """What a campaign's records could separate.

    Parameters
    ----------
    campaign : Campaign
        Its records are read for their frequencies, averages and coherence.
    threads : int, optional
    progress : callable, optional

    Raises
    ------
    InputError
        If no record can be predicted, or a file cannot be read.
    """
    say = progress or (lambda stage, done, total: None)
    say("read", 0, 0)
    datasets = predictable(campaign).kept
    datasets = [
        replace(dataset, data=dataset.data.assign({name: right[name] for name in right.data_vars}))
        for dataset, right in zip(datasets, predict(campaign, datasets, threads=threads), strict=True)
    ]
    observations = gather(campaign, datasets, threads=threads)
    stated = np.zeros(len(free_parameters(campaign)))
    fit = _untouched(recalibrate(observations, start=stated, most_steps=0))
    base = _Base(fit)
    offered = list(hypotheses(Situation(fit, tuple(places(fit)))))
    kept: list[tuple[Hypothesis, Reals, Reals, Reals]] = []
    for index, hypothesis in enumerate(offered):
        say("effects", index, len(offered))
        tried = base.effect(hypothesis)
        if tried is not None:
            kept.append((hypothesis, *tried))
    say("compare", 0, 0)
    if not kept:
        raise InputError("no effect of the catalogue can be in this model", where="model")
    directions = np.column_stack([d for _, _, d, _ in kept])
    seen = np.maximum(np.diag(base.projected(directions, directions)), 0.0)
    apart = np.zeros((len(kept), len(kept)))
    for j, (_, _, direction, slopes) in enumerate(kept):
        # At any size of its own, and at any near values.
        columns = np.column_stack([direction, slopes])
        inner = base.projected(columns, columns) + np.eye(columns.shape[1])
        across = base.projected(directions, columns)
        explained = np.einsum("ip,pi->i", across, linalg.solve(inner, across.T, assume_a="pos"))
        apart[:, j] = np.maximum(seen - explained, 0.0)
    values = [{f.name: f.value(float(v)) for f, v in zip(h.free, z, strict=True)} for h, z, _, _ in kept]
    return Separability(
        names=tuple(
            f"{h.entry} {h.locate(v).label}".strip() for (h, _, _, _), v in zip(kept, values, strict=True)
        ),
        entries=tuple(h.entry for h, _, _, _ in kept),
        families=tuple(h.family for h, _, _, _ in kept),
        size=tuple(spelled(h.law(v)) for (h, _, _, _), v in zip(kept, values, strict=True)),
        seen=seen,
        apart=apart,
    )


def _untouched(fit: Fit) -> Fit:
    """As if the records were what a fit predicts: its slopes and covariance, and no residual."""
    nothing = np.zeros_like(fit.residuals)
    return replace(fit, residuals=nothing, clean=nothing, chi2=0.0, prior=0.0, inflation=1.0)


def places(fit: Fit) -> Iterator[Location]:
    """A quarter, the middle and three quarters of each layer and body."""
    for share in SHARES:
        for locations in _locations(fit.campaign.model.line):
            yield locations[round(share * (len(locations) - 1))]


def _locations(line: Line) -> Iterator[list[Location]]:
    """The joints of each layer and the places of each body, in order."""
    table = line.joint_table()
    order = np.argsort(table.x, kind="stable")
    for index, law in enumerate(line.laws):
        mine = [int(j) for j in order if table.law[j] == index]
        if mine:
            yield [Location("joint", law, float(table.x[j])) for j in mine]
    for segment, low, high in stretches(line):
        inside = np.linspace(low, high, max(2, round((high - low) / step_m(high - low)) + 1))
        yield [Location("body", segment.name, float(x)) for x in inside]


class _Base:
    """The nominal model, and what its moves and calibration errors take out of a change of the residuals."""

    def __init__(self, fit: Fit) -> None:
        self.fit, self.whitener = fit, fit.observations.whitener
        self._solved = fit.observations.predicted(fit.campaign)
        self._plain = fit.observations.residuals(self._solved.datasets)
        self._reduced = self.whitener.reduce(fit.jacobian)
        normal = fit.jacobian.T @ fit.jacobian - self._reduced.T @ self._reduced
        self._factor = linalg.cho_factor(normal + np.eye(fit.z.size))

    def effect(self, hypothesis: Hypothesis) -> tuple[Reals, Reals, Reals] | None:
        """The first start that can be solved: its coordinates, its change of the residuals, the slopes there."""
        fit, own = self.fit, self.fit.z.size
        build, free = hypothesis.stacked_on(fit.build, "effect.", fit.observations.campaign)
        problem = Problem(fit.observations, build, (*fit.free, *free))
        low, high = limits_of(hypothesis.free)
        for start in hypothesis.starts:
            z = np.clip(np.array(start, dtype=np.float64), low, high)
            state = problem.at(np.concatenate([fit.z, z]), self._solved)
            if state is None:
                continue
            try:
                slopes = problem.columns(state, range(own, own + z.size))
            except (InputError, SolveError):
                continue
            return z, state.residuals - self._plain, slopes
        return None

    def projected(self, columns: Reals, other: Reals) -> Reals:
        """Products of columns, (n, p) and (n, q), calibration errors and all moves of the base taken out."""
        mine, theirs = self.whitener.reduce(columns), self.whitener.reduce(other)
        left = columns.T @ self.fit.jacobian - mine.T @ self._reduced
        right = other.T @ self.fit.jacobian - theirs.T @ self._reduced
        inner = columns.T @ other - mine.T @ theirs
        return np.asarray(inner - left @ linalg.cho_solve(self._factor, right.T))
