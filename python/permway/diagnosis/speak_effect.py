"""What a finalist says of an effect, as the verdict has it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from permway.arrays import Reals
from permway.diagnosis import decide
from permway.diagnosis.fit import Fit
from permway.diagnosis.plausible import beyond_belief
from permway.diagnosis.search import Finalist, Round, standing
from permway.diagnosis.verdict import NOVEL
from permway.diagnosis.verdict_parts import ClassMember, Effect, Estimate, Mechanics, Place

SHOWN = 0.8
"""Share of an effect's gain that its bands hold."""


def effect_of(
    one: Finalist,
    found: Round,
    amended: Fit,
    base: Fit,
    explained: float,
    ends_z: Mapping[str, tuple[float, float]],
    names: Sequence[str],
) -> Effect:
    """Place, bands, class and parameters, with the ends of their intervals.

    Parameters
    ----------
    one : Finalist
    found : Round
        Whose finalists rival it.
    amended, base : Fit
        What its parameters are told by, and what is without it.
    explained : float
        Share of the gap that the amended model closes.
    ends_z : mapping of parameter to (float, float)
        Ends of intervals, in z.
    names : sequence of str
        Of all effects that were accepted.
    """
    if beyond_belief(one):
        # Something acts there in this way; it is hardly this.
        explained = min(explained, decide.HALF)
    members = decide.members(found, explained=explained, beside=names)
    hypothesis, fit = one.hypothesis, amended
    index = {f.name: i for i, f in enumerate(fit.free)}
    z = np.array([fit.z[index[one.prefix + f.name]] for f in hypothesis.free])
    values = {f.name: f.value(float(v)) for f, v in zip(hypothesis.free, z, strict=True)}
    estimates = {}
    for f, name in zip(hypothesis.free, one.own, strict=True):
        ends = sorted(f.value(float(np.clip(end, *f.limits))) for end in ends_z[name])
        estimates[f.name] = Estimate(value=values[f.name], unit=f.unit, low=ends[0], high=ends[1])
    where = hypothesis.locate(values)
    words, within = hypothesis.law(values), None
    if where.x_m is not None:
        ends = list(where.x_m)
        for f, estimate in zip(hypothesis.free, estimates.values(), strict=True):
            for end in (estimate.low, estimate.high):
                moved = hypothesis.locate({**values, f.name: float(end if end is not None else values[f.name])})
                ends.extend(moved.x_m or ())
        for other in found.followed:
            # The same form elsewhere, which does as well: the records do not tell the two places apart.
            alike = (
                other.hypothesis.form == hypothesis.form and one.quick.gain - other.gain < decide.CLASS_DEVIANCE
            )
            ends.extend((other.hypothesis.locate(other.values).x_m or ()) if alike else ())
        for rival in _elsewhere(one, found):
            there = rival.hypothesis.locate(rival.values)
            ends.extend(there.x_m or ())
            words += (
                f"; or, hardly told apart by these records, {there.label}: {rival.hypothesis.law(rival.values)}"
            )
        within = (min(ends), max(ends))
    named = members[0].name != NOVEL and members[0].probability >= decide.NAMED
    base_square = base.clean**2
    amended_square = one.fit.clean**2
    return Effect(
        domain=hypothesis.domain,
        place=Place.of(where, amended.campaign.model.line, within=within),
        bands=bands_of(base.evidence.rows.frequency_Hz, base_square - amended_square),
        name=members[0].name if named else None,
        class_=tuple(members),
        law=Mechanics(words=words),
        parameters=estimates,
    )


def _elsewhere(one: Finalist, found: Round) -> list[Finalist]:
    """The same form of an effect at other places, fitted in full, that the records hardly tell from this one."""
    place = one.hypothesis.locate(one.values)
    alike = [f for f in found.finalists if f.hypothesis.form == one.hypothesis.form]
    return [
        f
        for f in alike
        if f.hypothesis.locate(f.values) != place
        and abs(standing(one, found.finalists) - standing(f, found.finalists)) < 0.5 * decide.CLASS_DEVIANCE
    ]


def bands_of(frequency_Hz: Reals, shown: Reals) -> tuple[tuple[float, float], ...]:
    """Bands, of whole third octaves, that hold most of what an effect shows."""
    cell = np.floor(3.0 * np.log2(frequency_Hz)).astype(np.int64)
    cells = np.arange(cell.min(), cell.max() + 1)
    share = np.bincount(cell - cell.min(), weights=np.maximum(shown, 0.0), minlength=cells.size)
    if share.sum() <= 0.0:
        return ()
    order = np.argsort(-share)
    needed = int(np.searchsorted(np.cumsum(share[order]) / share.sum(), SHOWN)) + 1
    chosen = np.zeros(cells.size, dtype=bool)
    chosen[order[:needed]] = True
    spans, start = [], None
    for index, inside in enumerate([*chosen, False]):
        if inside and start is None:
            start = index
        elif not inside and start is not None:
            spans.append((float(2.0 ** (cells[start] / 3.0)), float(2.0 ** ((cells[index - 1] + 1) / 3.0))))
            start = None
    return tuple(spans)


def of_another_form(effect: Effect) -> Effect:
    """Where an effect acts, without what it was taken for: outside the track its place is its form."""
    place = effect.place if effect.domain == "path" else Place()
    member = ClassMember(name=NOVEL, probability=1.0)
    return Effect(domain=effect.domain, place=place, bands=effect.bands, class_=(member,))
