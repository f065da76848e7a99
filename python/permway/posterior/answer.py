"""From posterior masses to the verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from permway.arrays import Reals
from permway.diagnosis.fit import WIDTH
from permway.diagnosis.plain_names import spelled
from permway.diagnosis.tolerances import outside
from permway.diagnosis.verdict import NOVEL, RIGHT, Status, Verdict
from permway.diagnosis.verdict_parts import (
    ClassMember,
    Effect,
    Estimate,
    HeldOutGain,
    Mechanics,
    Moved,
    Place,
    Recalibrated,
    Weight,
)
from permway.posterior.fit import Fit
from permway.posterior.held_out import Gain
from permway.posterior.masses import CLASS, LIKELY, Masses

SHOWN = 0.8
"""Share of an effect's gain that its bands hold."""

NAMED = 0.9
"""Posterior probability from which an effect is named."""

SUSPECTED = 0.2
"""Posterior probability of nothing missing from which an effect is a suspicion and no more. It counts in the
probabilities of names, too. Of 39 small campaigns with nothing missing none had less than 0.5."""


def verdict_of(
    masses: Masses, held_out: Sequence[Gain], before: Mapping[str, Moved], after: Mapping[str, Moved]
) -> Verdict:
    """Put the verdict together.

    Parameters
    ----------
    masses : Masses
    held_out : sequence of Gain
        Of the best set over the empty one; empty where nothing is missing.
    before, after : mapping of str to Moved
        Nominal parameters as the empty set and as the best one has them.
    """
    best, empty = masses.best, masses.empty
    effects = tuple(_effect(masses, index) for index in range(len(best.amendments)))
    status = _status(masses, effects, before)
    if status in RIGHT:
        effects = ()
    elif status == "located":
        effects = tuple(_anonymous(effect) for effect in effects[:1])
    amended = best.fit if effects else None
    return Verdict(
        status=status,
        effects=effects,
        evidence=Weight(
            log10_bayes_factor=(best.fit.log_evidence - empty.fit.log_evidence) / float(np.log(10.0)),
            misfit_before=_misfit(empty.fit),
            misfit_after=None if amended is None else _misfit(amended),
            unmet=("misfit",) if status == "insufficient" else (),
        ),
        held_out={
            f"{g.axis}: {g.name}": HeldOutGain(
                gain_nats=g.nats,
                db_before=g.before_dB if np.isfinite(g.before_dB) else None,
                db_after=g.after_dB if np.isfinite(g.after_dB) else None,
            )
            for g in held_out
        },
        recalibrated=Recalibrated(before=dict(before), after={} if amended is None else dict(after)),
    )


def _status(masses: Masses, effects: tuple[Effect, ...], before: Mapping[str, Moved]) -> Status:
    best = masses.best
    if masses.nothing >= LIKELY:
        return "outside_tolerance" if outside(before) else "recalibrated"
    if not best.amendments or masses.nothing >= SUSPECTED:
        return "insufficient"
    if best.fit.hyper.novel >= LIKELY:
        return "located" if any(e.domain == "path" for e in effects) else "insufficient"
    if any(effect.name is None for effect in effects):
        first = effects[0].class_[0]
        return "described" if first.name == NOVEL and first.probability >= NAMED else "ambiguous"
    return "measurement" if all(effect.domain == "measurement" for effect in effects) else "named"


def _effect(masses: Masses, index: int) -> Effect:
    """Of one amendment of the best set: place, bands, class, parameters."""
    best, empty = masses.best, masses.empty
    hypothesis, own = best.amendments[index], best.own(index)
    values = best.values(index)
    sigma = np.sqrt(np.diag(best.fit.spread))[own]
    estimates, ends = {}, list(hypothesis.locate(values).x_m or ())
    for f, z, s in zip(hypothesis.free, best.fit.z[own], sigma, strict=True):
        low, high = sorted(f.value(float(np.clip(z + side * WIDTH * s, *f.limits))) for side in (-1.0, 1.0))
        estimates[f.name] = Estimate(value=values[f.name], unit=f.unit, low=low, high=high)
        for end in (low, high):
            ends.extend(hypothesis.locate({**values, f.name: end}).x_m or ())
    at = best.moved(index)
    if at is not None:
        first = hypothesis.free[0]
        both = np.array([1.0, first.value(1.0)])
        half = WIDTH * float(np.sqrt(both @ best.fit.spread[np.ix_([at, own.start], [at, own.start])] @ both))
        value = values[first.name]
        estimates[first.name] = Estimate(value=value, unit=first.unit, low=value - half, high=value + half)
    where = hypothesis.locate(values)
    members = _class(masses.names(index))
    named = members[0].name != NOVEL and members[0].probability >= NAMED
    line = best.fit.state.solved.campaign.model.line
    gained = empty.fit.state.residuals**2 - best.fit.state.residuals**2
    return Effect(
        domain=hypothesis.domain,
        place=Place.of(where, line, within=(min(ends), max(ends)) if ends else None),
        bands=_bands(best.fit.frame.observations.rows.frequency_Hz, gained),
        name=members[0].name if named else None,
        class_=members,
        law=Mechanics(words=spelled(hypothesis.law(values))),
        parameters=estimates,
        size=hypothesis.size or None,
    )


def _class(names: Sequence[tuple[str, float]]) -> tuple[ClassMember, ...]:
    """The smallest set of names that holds the posterior mass of a class."""
    kept, held, whole = [], 0.0, sum(probability for _, probability in names)
    for name, probability in names:
        kept.append(ClassMember(name=name, probability=min(float(probability), 1.0)))
        held += probability
        if held >= CLASS * whole:
            break
    return tuple(kept)


def _bands(frequency_Hz: Reals, shown: Reals) -> tuple[tuple[float, float], ...]:
    """Bands, of third octaves as far as there are lines, that hold most of what an effect shows."""
    cell = np.floor(3.0 * np.log2(frequency_Hz)).astype(np.int64)
    cells = np.arange(cell.min(), cell.max() + 1)
    share = np.bincount(cell - cell.min(), weights=np.maximum(shown, 0.0), minlength=cells.size)
    if share.sum() <= 0.0:
        return ()
    order = np.argsort(-share)
    needed = int(np.searchsorted(np.cumsum(share[order]) / share.sum(), SHOWN)) + 1
    chosen = np.zeros(cells.size, dtype=bool)
    chosen[order[:needed]] = True
    spans, start, ends = [], None, (float(frequency_Hz.min()), float(frequency_Hz.max()))
    for index, inside in enumerate([*chosen, False]):
        if inside and start is None:
            start = index
        elif not inside and start is not None:
            low, high = 2.0 ** (cells[start] / 3.0), 2.0 ** ((cells[index - 1] + 1) / 3.0)
            spans.append((max(float(low), ends[0]), min(float(high), ends[1])))
            start = None
    return tuple(spans)


def _anonymous(effect: Effect) -> Effect:
    """Where something acts, without what it was taken for."""
    return Effect(
        domain=effect.domain,
        place=effect.place,
        bands=effect.bands,
        class_=(ClassMember(name=NOVEL, probability=1.0),),
    )


def _misfit(fit: Fit) -> float:
    """Mean square of the residuals if the model lacked nothing."""
    hyper = fit.hyper.exact()
    covariance = fit.frame.covariance(hyper)
    return covariance.square(fit.state.residuals) / fit.state.residuals.size
