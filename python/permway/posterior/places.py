"""Where the posterior mass lies: by place along the line, by channel, and by set of effects.

Of each set's amendments the places are drawn from the normal approximation about its fit (Laplace), so that a
place that the records hardly constrain is spread as far as they leave it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.hypothesis import Where
from permway.diagnosis.plain_names import spelled
from permway.diagnosis.weighed import Along, Aside, Rival, Weighed
from permway.model.line import Line
from permway.posterior.cells import Cell
from permway.posterior.masses import ALIKE, SHOWN, Masses
from permway.posterior.member import Member, tempered

DRAWS = 200
"""Of the places of one amendment: a probability of a half is then known to 0.035."""

PIECES = 80
"""Of a body over the length that has joints."""


def weighed(masses: Masses, tried: Sequence[Cell] = ()) -> Weighed:
    """Share the posterior mass out.

    Parameters
    ----------
    masses : Masses
    tried : sequence of Cell
        All starts of the search, for the places where something was tried.
    """
    shares, unknown = _shares(masses)
    line = masses.empty.fit.state.solved.campaign.model.line
    grid = _grid(line)
    along = {(what, family): x * 0.0 for what, x in grid.items() for family in _families(masses)}
    aside: dict[Aside, float] = defaultdict(float)
    for member, share in zip(masses.members, shares, strict=True):
        for index, hypothesis in enumerate(member.amendments if share >= SHOWN else ()):
            where = hypothesis.locate(member.values(index))
            what = _body(where)
            if where.x_m is None or what not in grid:
                aside[Aside(where.what, where.channels, hypothesis.domain, hypothesis.family, 0.0)] += share
            else:
                along[what, hypothesis.family] += share * _covered(member, index, grid[what])
    places = [
        Along(what, what in line.laws, family, grid[what], np.minimum(p, 1.0))
        for (what, family), p in along.items()
        if p.any()
    ]
    without = [replace(one, probability=min(p, 1.0)) for one, p in aside.items()]
    return Weighed(
        along=tuple(sorted(places, key=lambda one: -float(one.probability.max()))),
        aside=tuple(sorted(without, key=lambda one: -one.probability)),
        rivals=tuple(_rivals(masses, shares)),
        nothing=masses.nothing,
        unknown=unknown,
        tried=_tried(tried, grid),
    )


def _families(masses: Masses) -> list[str]:
    return list(dict.fromkeys(a.family for m in masses.members for a in m.amendments))


def _body(where: Where) -> str:
    """Law of joints, or body of which it may be a segment."""
    return where.what.split("[")[0]


def _shares(masses: Masses) -> tuple[list[float], float]:
    """Probability of each member, and of what no member is; all sum to one."""
    log = np.array(
        [m.log_prior + tempered(m.fit.log_evidence, m.fit.state.residuals.size, ALIKE) for m in masses.members]
    )
    known = np.array([bool(m.amendments) * (1.0 - m.fit.hyper.novel) for m in masses.members])
    weight = np.exp(log - log.max()) * known
    best = masses.best
    missing = 1.0 - (masses.nothing if best.amendments else masses.unamended)
    held = missing * (1.0 - best.fit.hyper.novel if best.amendments else 1.0) if weight.sum() > 0.0 else 0.0
    shares = weight / max(float(weight.sum()), 1e-300) * held
    shares[-1] = masses.nothing
    return shares.tolist(), max(1.0 - float(shares.sum()), 0.0)


def _grid(line: Line) -> dict[str, Reals]:
    """Places along each layer of joints, and along each body that reaches over some length."""
    table, laws = line.joint_table(), list(line.laws)
    found = {law: np.unique(table.x[table.law == index]) for index, law in enumerate(laws)}
    found = {law: x for law, x in found.items() if x.size}
    if table.x.size:
        low, high = float(table.x.min()), float(table.x.max())
        for _, segment in line.beams():
            first, last = max(low, segment.start), min(high, segment.stop)
            if last > first:
                step = max((high - low) / PIECES, 1e-3)
                count = max(1, round((last - first) / step))
                x = first + (np.arange(count) + 0.5) * (last - first) / count
                found[segment.body] = np.union1d(found.get(segment.body, np.zeros(0)), x)
    return found


def _covered(member: Member, index: int, x: Reals) -> Reals:
    """Of places along a line: the share of draws of an amendment that acts there."""
    hypothesis, own = member.amendments[index], member.own(index)
    low, high = np.array([f.limits for f in hypothesis.free]).reshape(-1, 2).T
    # Of a seed of its own: the same campaign gives the same page.
    draws = np.random.default_rng(0).multivariate_normal(
        member.fit.z[own], member.fit.spread[own, own], DRAWS, method="eigh"
    )
    found = np.zeros(x.size)
    for z in np.clip(draws, low, high):
        values = {f.name: f.value(float(v)) for f, v in zip(hypothesis.free, z, strict=True)}
        where = hypothesis.locate(values).x_m
        if where is not None:
            found += _within(x, where)
    return found / DRAWS


def _within(x: Reals, stretch: tuple[float, float]) -> Reals:
    """Places of a stretch, the nearest where none is in it."""
    inside = (x >= stretch[0] - 1e-6) & (x <= stretch[1] + 1e-6)
    if not inside.any():
        inside = np.arange(x.size) == np.argmin(np.abs(x - 0.5 * (stretch[0] + stretch[1])))
    return inside.astype(np.float64)


def _rivals(masses: Masses, shares: Sequence[float]) -> list[Rival]:
    """Members with what they are, the most probable first, and the best of each size."""
    best = max(m.log_prior + m.fit.log_evidence for m in masses.members)
    found = []
    every, none = (*masses.members, *masses.far_behind), [0.0] * len(masses.far_behind)
    for member, share in zip(every, [*shares, *none], strict=True):
        values = [member.values(i) for i in range(len(member.amendments))]
        both = list(zip(member.amendments, values, strict=True))
        found.append(
            Rival(
                names=tuple(a.entry for a in member.amendments),
                places=tuple(a.locate(v).label for a, v in both),
                laws=tuple(spelled(a.law(v)) for a, v in both),
                probability=share,
                behind_nats=best - member.log_prior - member.fit.log_evidence,
                parameters=sum(len(a.free) for a in member.amendments),
            )
        )
    # Of what is as good as impossible, evidence says which is less so.
    return sorted(found, key=lambda one: (-round(one.probability, 9), one.behind_nats))


def _tried(cells: Sequence[Cell], grid: dict[str, Reals]) -> dict[str, Reals]:
    """Places of all starts that have one, each once."""
    found: dict[str, set[float]] = defaultdict(set)
    for cell in cells:
        where = cell.hypothesis.locate(cell.values)
        if where.x_m is not None and _body(where) in grid:
            found[_body(where)].add(round(0.5 * sum(where.x_m), 3))
    return {what: np.array(sorted(x)) for what, x in sorted(found.items())}
