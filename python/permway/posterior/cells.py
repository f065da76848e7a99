"""Where the search begins: hypotheses of the catalogue at every place, each start with its prior probability."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.catalogue import entries
from permway.diagnosis.fit import Fit as Base
from permway.diagnosis.fit import Free, free_parameters
from permway.diagnosis.hypothesis import Entry, Hypothesis, Situation
from permway.diagnosis.location import Location, step_m, stretches
from permway.posterior import generic, stated
from permway.posterior.fit import Fit
from permway.posterior.spans import BEYOND, spread_out, tuned, widened, with_starts

FARTHEST = 40.0
"""Standard deviations, beyond which no value is looked for: places on a rail without ends have no limits."""

SMALL = 1e-3
"""Share of a start's change at which a small effect's direction is taken: resonances then move in proportion, in
clean records, too. At 0.03 a tenth of all directions there changed thousands of deviations, and were bent."""

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
    by_entry: dict[str, list[Hypothesis]] = {}
    situations = list(_situations(base))
    frequency = base.frame.observations.rows.frequency_Hz
    band = float(frequency.min()) / BEYOND, float(frequency.max()) * BEYOND
    for name, entry in {**entries(), **BESIDE}.items():
        if name not in ruled_out:
            found = [
                scaled
                for hypothesis in offered(entry, situations)
                for scaled in spread_out(
                    with_starts(widened(hypothesis if name == generic.ID else tuned(hypothesis, band)))
                )
            ]
            if found:
                by_entry[name] = found
    found_cells = []
    named = max(sum(name != generic.ID for name in by_entry), 1)
    for name, hypotheses in by_entry.items():
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
    # Of the sizes that are begun, that which is met most often.
    for cell in sorted(cells_at_hand, key=_unusual):
        cell = replace(cell, z=_at_rest(cell))
        sized = [f.name == cell.hypothesis.size for f in cell.hypothesis.free]
        others = tuple(float(v) for v, own in zip(cell.z, sized, strict=True) if not own)
        found.setdefault((id(cell.hypothesis), others), resized(cell, SMALL ** (1.0 / cell.hypothesis.power)))
    return list(found.values())


def _unusual(cell: Cell) -> float:
    """How far its size is from the middle of what it may be, standard deviations."""
    sizes = [
        abs(float(z)) for f, z in zip(cell.hypothesis.free, cell.z, strict=True) if f.name == cell.hypothesis.size
    ]
    return max(sizes, default=0.0)


def _at_rest(cell: Cell) -> Reals:
    """With factors of what is there already at 1, beside a size: they would be a change whatever the size is."""
    hypothesis = cell.hypothesis
    if not hypothesis.size:
        return cell.z
    factors = [f.name != hypothesis.size and f.unit == "1" and f.value(0.0) == 1.0 for f in hypothesis.free]
    return np.where(factors, 0.0, cell.z)


def _all_sizes(hypothesis: Hypothesis) -> bool:
    """Whether each parameter is a size of its own, with nothing there where all are 0."""
    return not hypothesis.size and all(f.value(0.0) == 0.0 for f in hypothesis.free)


def resized(cell: Cell, measure: float) -> Cell:
    """A cell with its size so many times as far from none, as far as its limits allow."""
    names = [f.name for f in cell.hypothesis.free]
    if _all_sizes(cell.hypothesis):
        limits = np.array([f.limits for f in cell.hypothesis.free]).reshape(-1, 2)
        return replace(cell, z=np.clip(measure * cell.z, limits[:, 0], limits[:, 1]))
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


def least_measure(cell: Cell) -> float:
    """In which its change may come: 1 is the change as it stands, 0 none, minus infinity if it has another side.

    A gain may be above or below 1; a mass is no less than none; a sensor is turned or it is not.
    """
    if _all_sizes(cell.hypothesis):
        return -math.inf
    if not cell.hypothesis.free:
        return 1.0
    ends = [away / _away(cell) for away in _ends(cell)] if _away(cell) else [0.0]
    return min(ends) if min(ends) >= 0.0 else -math.inf


def times(cell: Cell, before: Cell) -> float:
    """How many times as far from none the size of a cell is as that of the cell it was made from."""
    if _all_sizes(cell.hypothesis):
        largest = int(np.argmax(np.abs(before.z)))
        return float(cell.z[largest] / before.z[largest]) if before.z[largest] else 1.0
    return _away(cell) / _away(before) if _away(before) else 1.0


def _away(cell: Cell) -> float:
    """How far its size is from none; 0 if it has no such size."""
    hypothesis = cell.hypothesis
    sizes = [(f, float(z)) for f, z in zip(hypothesis.free, cell.z, strict=True) if f.name == hypothesis.size]
    return sum(f.value(z) - hypothesis.none for f, z in sizes) if math.isfinite(hypothesis.none) else 0.0


def _ends(cell: Cell) -> list[float]:
    """How far its size may be from none."""
    hypothesis = cell.hypothesis
    return [f.value(z) - hypothesis.none for f in hypothesis.free if f.name == hypothesis.size for z in f.limits]


def coordinate(free: Free, value: float) -> float | None:
    """Z of a value, by halving; None outside the parameter's limits."""
    low, high = max(free.limits[0], -FARTHEST), min(free.limits[1], FARTHEST)
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


def offered(entry: Entry, situations: Sequence[Situation]) -> list[Hypothesis]:
    """What an entry offers anywhere, each once, with all its starts.

    The same change offered at two places is one hypothesis: as two, each would be half as likely.
    """
    everywhere = getattr(entry, "everywhere", None)
    if everywhere is not None:
        return list(everywhere(situations[0]))
    seen: dict[tuple[object, ...], Hypothesis] = {}
    for situation in situations:
        situation.asked.clear()
        for hypothesis in entry.hypotheses(situation):
            key = _key(hypothesis)
            known = seen.get(key, hypothesis)
            seen[key] = replace(known, starts=tuple(dict.fromkeys((*known.starts, *hypothesis.starts))))
        if entry.DOMAIN != "path" or not situation.asked:
            # Of other places it would offer the same.
            break
    return list(seen.values())


def _key(hypothesis: Hypothesis) -> tuple[object, ...]:
    """What distinguishes two hypotheses: form, priors, and the place at the middle of these."""
    values = {f.name: f.value(0.0) for f in hypothesis.free}
    where = hypothesis.locate(values)
    at = where.x_m and tuple(round(x, 2) for x in where.x_m)
    # Two girders that meet have bearings at one place: the words tell them apart.
    place = where.what, at, where.channels, hypothesis.law(values)
    spans = tuple(tuple(round(f.value(z), 6) for z in (0.0, 0.5)) for f in hypothesis.free)
    return hypothesis.form, place, spans


def _situations(base: Fit) -> Iterator[Situation]:
    """No place in particular, then every joint, then every place of every body."""
    fit = _as_base(base)
    line = fit.campaign.model.line
    yield Situation(fit, ())
    table, laws = line.joint_table(), list(line.laws)
    for law, x in zip(table.law, table.x, strict=True):
        yield Situation(fit, (Location("joint", laws[law], float(x)),))
    for segment, first, last in stretches(line):
        step = step_m(last - first)
        for x in np.arange(first + 0.5 * step, last, step):
            yield Situation(fit, (Location("body", segment.name, float(x)),))


def _as_base(fit: Fit) -> Base:
    """What entries of the catalogue are handed: the line without amendments, which a hypothesis might keep."""
    residuals = fit.state.residuals
    nominal = fit.frame.observations.campaign
    names = {free.name for free in free_parameters(nominal)}
    campaign = nominal.with_values({name: v for name, v in fit.values().items() if name in names})
    return Base(
        free=fit.model.free,
        z=fit.z,
        covariance=fit.spread,
        campaign=campaign,
        observations=fit.frame.observations,
        residuals=residuals,
        clean=residuals,
        chi2=float(residuals @ residuals),
        prior=float(fit.z @ fit.z),
        log_determinant=0.0,
        jacobian=fit.jacobian,
        inflation=1.0,
        evaluations=0,
        build=fit.model.build,
    )
