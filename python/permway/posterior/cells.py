"""Where the search begins: hypotheses of the catalogue at every place, each start with its prior probability."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import cast

import numpy as np
from scipy.special import ndtr, ndtri

from permway.arrays import Reals
from permway.diagnosis.catalogue import entries
from permway.diagnosis.evidence import Solved
from permway.diagnosis.fit import Fit as Base
from permway.diagnosis.fit import Free
from permway.diagnosis.hypothesis import Entry, Hypothesis, Situation
from permway.diagnosis.quick import weaker
from permway.diagnosis.spot import Found, Spot
from permway.posterior import generic, stated
from permway.posterior.fit import Fit

SPACING_M = 1.0
"""Between places along a body, m: a third of what the places' priors span."""

BEYOND = 2.0**0.5
"""Factor beyond the ends of the records' band that a resonator's frequency may lie at: it still shows there."""

APART = 0.4
"""Octaves between frequencies at which a resonator is begun. A peak is narrower, but at a discrepancy of 1 a fit
reaches it from as far as that."""

BAND_HZ, BANDS = (8.0, 200.0), 24
"""What a place that was not scanned is handed on with: frequencies where nothing stands out."""

WIDER = 4.0
"""Times the standard deviation that an entry states of the logarithm of its size: what is a factor of 2.5 of what
engineers meet is a factor of 40 of what clean records show. Twice as much costs every such effect ln 2 nats."""

SPREADS = (1.0, 1 / 4, 1 / 16, 1 / 64)
"""Of what is many numbers about none, as factors of pads that scatter: over how far an entry states that they
scatter, each equally likely. With one of them each number is paid for as if it were large."""

SMALL = 0.03
"""Share of a start's size at which a small effect's direction is taken: resonances then move in proportion."""

BESIDE = {stated.ID: cast(Entry, stated), generic.ID: cast(Entry, generic)}
"""What is tried beside the catalogue: values that are stated wrongly, and elements of no catalogue."""

SOMETHING = 0.5
"""Prior probability that something is missing: shared by the entries, and in each by its places."""


@dataclass(frozen=True)
class Cell:
    """A start of the search.

    Attributes
    ----------
    hypothesis : Hypothesis
    z : ndarray
        Of its parameters.
    log_prior : float
        Of the hypothesis among all, nats; beside that its parameters have priors of their own.
    """

    hypothesis: Hypothesis
    z: Reals
    log_prior: float

    @property
    def values(self) -> dict[str, float]:
        """Of its parameters, by name."""
        return {f.name: f.value(float(v)) for f, v in zip(self.hypothesis.free, self.z, strict=True)}


def cells(base: Fit, ruled_out: Collection[str] = ()) -> list[Cell]:
    """All starts about a fitted model.

    Parameters
    ----------
    base : Fit
        Whose line says where joints and bodies are.
    ruled_out : collection of str
        Entries that are left out.
    """
    offered: dict[str, list[Hypothesis]] = {}
    situations = list(_situations(base))
    frequency = base.frame.evidence.rows.frequency_Hz
    band = float(frequency.min()) / BEYOND, float(frequency.max()) * BEYOND
    for name, entry in {**entries(), **BESIDE}.items():
        if name not in ruled_out:
            found = [
                scaled
                for hypothesis in _offered(entry, situations)
                for scaled in spread_out(
                    begun(widened(hypothesis if name == generic.ID else tuned(hypothesis, band)))
                )
            ]
            if found:
                offered[name] = found
    found_cells = []
    named = max(sum(name != generic.ID for name in offered), 1)
    for name, hypotheses in offered.items():
        share = math.log(SOMETHING * (generic.PRIOR if name == generic.ID else (1.0 - generic.PRIOR) / named))
        forms: dict[tuple[str, ...], list[Hypothesis]] = defaultdict(list)
        for hypothesis in hypotheses:
            forms[hypothesis.form].append(hypothesis)
        for alike in forms.values():
            each = share - math.log(len(forms)) - math.log(len(alike) / _overlap(alike))
            for hypothesis in alike:
                for start in hypothesis.starts:
                    found_cells.append(Cell(hypothesis, np.array(start, dtype=np.float64), each))
    return found_cells


def small(cells_at_hand: Sequence[Cell]) -> list[Cell]:
    """The same with sizes near none, each direction once: what a small effect does, in proportion to its size."""
    found: dict[tuple[object, ...], Cell] = {}
    for cell in cells_at_hand:
        weak = weaker(cell.hypothesis, cell.z, SMALL)
        z = weak[0] if weak else cell.z
        sized = [f.name == cell.hypothesis.size for f in cell.hypothesis.free]
        others = tuple(float(v) for v, own in zip(cell.z, sized, strict=True) if not own)
        # A size may lie to either side of none.
        side = math.copysign(1.0, float(cell.z[sized.index(True)])) if weak and not _positive(cell) else 0.0
        found.setdefault((id(cell.hypothesis), others, side), replace(cell, z=z))
    return list(found.values())


def resized(cell: Cell, measure: float) -> Cell:
    """A cell with its size so many times as far from none, as far as its limits allow."""
    names = [f.name for f in cell.hypothesis.free]
    if cell.hypothesis.size not in names or math.isinf(cell.hypothesis.none):
        return cell
    index = names.index(cell.hypothesis.size)
    free, none = cell.hypothesis.free[index], cell.hypothesis.none
    ends = sorted(free.value(limit) for limit in free.limits)
    value = none + measure * (free.value(float(cell.z[index])) - none)
    found = coordinate(free, min(max(value, ends[0]), ends[1]))
    if found is None:
        return cell
    z = cell.z.copy()
    z[index] = found
    return replace(cell, z=z)


def _positive(cell: Cell) -> bool:
    """Whether its size lies to one side of none only."""
    free = next(f for f in cell.hypothesis.free if f.name == cell.hypothesis.size)
    ends = [free.value(limit) - cell.hypothesis.none for limit in free.limits]
    return ends[0] * ends[1] >= 0.0


def coordinate(free: Free, value: float) -> float | None:
    """Z of a value, by halving; None outside the parameter's limits."""
    low, high = free.limits
    ends = free.value(low), free.value(high)
    if not min(ends) <= value <= max(ends):
        return None
    for _ in range(60):
        middle = 0.5 * (low + high)
        if (free.value(middle) < value) == (ends[0] < ends[1]):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def begun(hypothesis: Hypothesis) -> Hypothesis:
    """The same with starts on either side, in place of those at which there is nothing: no look tells of these."""
    at = next((i for i, f in enumerate(hypothesis.free) if f.name == hypothesis.size), None)
    if at is None:
        return hypothesis
    starts: list[tuple[float, ...]] = []
    for start in hypothesis.starts:
        away = (0.0,) if hypothesis.free[at].value(start[at]) != hypothesis.none else (-1.0, 1.0)
        starts.extend((*start[:at], start[at] + side, *start[at + 1 :]) for side in away)
    return replace(hypothesis, starts=tuple(starts))


def widened(hypothesis: Hypothesis) -> Hypothesis:
    """The same with a prior of its size that spans what clean records can show.

    An entry states sizes that engineers meet. What is a thousandth of them shows in clean records, too.
    """
    free = []
    starts = np.array(hypothesis.starts, dtype=np.float64)
    for index, one in enumerate(hypothesis.free):
        if one.name != hypothesis.size or hypothesis.none != 0.0 or not _logarithmic(one):
            free.append(one)
            continue
        low, high = one.limits
        free.append(replace(one, value=partial(_wider, one.value), limits=(min(low, -high), high / WIDER)))
        starts[:, index] /= WIDER
    return replace(hypothesis, free=tuple(free), starts=tuple(tuple(map(float, row)) for row in starts))


def tuned(hypothesis: Hypothesis, band_Hz: tuple[float, float]) -> Hypothesis:
    """The same with a frequency of its own anywhere in a band, evenly likely in its logarithm.

    An entry states the frequencies that engineers met; a damper may be tuned to any.
    """
    at = next((i for i, f in enumerate(hypothesis.free) if f.name == "frequency_Hz" and _logarithmic(f)), None)
    if at is None:
        return hypothesis
    free = list(hypothesis.free)
    free[at] = replace(free[at], value=partial(_between, band_Hz), limits=(-4.0, 4.0))
    low, high = np.log2(band_Hz)
    count = max(1, round((high - low) / APART))
    places = ndtri((np.arange(count) + 0.5) / count)
    others = dict.fromkeys((start[:at], start[at + 1 :]) for start in hypothesis.starts)
    starts = tuple((*before, float(z), *after) for before, after in others for z in places)
    return replace(hypothesis, free=tuple(free), starts=starts)


def _between(band: tuple[float, float], z: float) -> float:
    return float(band[0] * (band[1] / band[0]) ** float(ndtr(z)))


def _logarithmic(free: Free) -> bool:
    """Whether its values go with the exponential of z."""
    ends = [free.value(z) for z in (0.0, 1.0, 2.0)]
    return ends[0] > 0.0 and math.isclose(ends[1] ** 2, ends[0] * ends[2], rel_tol=1e-9)


def spread_out(hypothesis: Hypothesis) -> Iterator[Hypothesis]:
    """The same with its many numbers about none scattering less, if it is such."""
    alone = hypothesis.size or len(hypothesis.free) < 3
    if alone or any(
        f.value(0.0) != 0.0 or not math.isclose(f.value(-1.0), -f.value(1.0)) for f in hypothesis.free
    ):
        yield hypothesis
        return
    for spread in SPREADS:
        free = tuple(replace(f, value=partial(_times, f.value, spread)) for f in hypothesis.free)
        yield replace(hypothesis, free=free)


def _times(value: Callable[[float], float], factor: float, z: float) -> float:
    return factor * value(z)


def _wider(value: Callable[[float], float], z: float) -> float:
    return value(WIDER * z)


def _overlap(alike: list[Hypothesis]) -> float:
    """How many hypotheses of one form, at places side by side, share one place: their priors add up there."""
    found = 1.0
    for index, free in enumerate(alike[0].free):
        if free.unit == "m" and len(alike) > 1:
            sigma = free.value(1.0) - free.value(0.0)
            centres = np.unique(np.round([h.free[index].value(0.0) for h in alike], 6))
            if centres.size > 1 and sigma > 0.0:
                apart = float(np.median(np.diff(centres)))
                found *= max(1.0, min(sigma * math.sqrt(2.0 * math.pi) / apart, float(centres.size)))
    return found


def _offered(entry: Entry, situations: list[Situation]) -> Iterator[Hypothesis]:
    """What an entry offers anywhere, each once."""
    everywhere = getattr(entry, "everywhere", None)
    if everywhere is not None:
        yield from everywhere(situations[0])
        return
    seen = set()
    for situation in situations if entry.DOMAIN == "path" else situations[:1]:
        for hypothesis in entry.hypotheses(situation):
            key = _key(hypothesis)
            if key not in seen:
                seen.add(key)
                yield hypothesis


def _key(hypothesis: Hypothesis) -> tuple[object, ...]:
    """What tells two hypotheses apart: form, place and what their parameters are at some coordinates."""
    places = []
    for start in hypothesis.starts[:1]:
        values = {f.name: f.value(float(z)) for f, z in zip(hypothesis.free, start, strict=True)}
        where = hypothesis.locate(values)
        places.append((where.what, where.x_m and tuple(round(x, 2) for x in where.x_m), where.channels))
    spans = tuple(tuple(round(f.value(z), 6) for z in (0.0, 0.5)) for f in hypothesis.free)
    return hypothesis.form, tuple(places), spans, hypothesis.starts


def _situations(base: Fit) -> Iterator[Situation]:
    """No place in particular, then every joint, then every place of every body."""
    fit = _as_base(base)
    line = fit.campaign.model.line
    yield Situation(fit, ())
    table, laws = line.joint_table(), list(line.laws)
    for index in range(table.x.size):
        yield Situation(fit, (_place("joint", laws[table.law[index]], float(table.x[index]), (index,)),))
    if not table.x.size:
        return
    low, high = float(table.x.min()), float(table.x.max())
    for _, segment in line.beams():
        first, last = max(low, segment.start), min(high, segment.stop)
        for x in np.arange(first + 0.5 * SPACING_M, last, SPACING_M):
            yield Situation(fit, (_place("body", segment.name, float(x), ()),))


def _place(kind: str, name: str, x: float, joints: tuple[int, ...]) -> Found:
    """A place about which nothing is known."""
    frequency = np.geomspace(*BAND_HZ, BANDS)
    flat = np.full(BANDS, 1.0 / BANDS)
    return Found(
        Spot(kind, name, (x, x), joints), 1e6, BANDS, frequency, flat * (0.0 + 0.0j), np.ones(BANDS), flat, 1e6
    )


def _as_base(fit: Fit) -> Base:
    """What entries of the catalogue are handed."""
    residuals = fit.state.deviations
    solved: Solved = fit.state.solved
    return Base(
        free=fit.model.free,
        z=fit.z,
        covariance=fit.spread,
        campaign=solved.campaign,
        evidence=fit.frame.evidence,
        deviations=residuals,
        clean=residuals,
        chi2=float(residuals @ residuals),
        prior=float(fit.z @ fit.z),
        log_determinant=0.0,
        jacobian=fit.jacobian,
        heat=1.0,
        evaluations=0,
        build=fit.model.build,
    )
