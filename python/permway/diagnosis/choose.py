"""Which hypotheses are followed, and which fitted in full."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from permway.diagnosis.compete import Ring
from permway.diagnosis.fit import Fit
from permway.diagnosis.quick import Quick
from permway.diagnosis.verdict import NOVEL

FOLLOWED, PER_FORM = 10, 2
"""Hypotheses that are followed after screening, in all and of one form of an effect."""

FINALISTS = 3
"""Effects of which hypotheses are fitted in full."""

WORTH = 0.05
"""Share of the best gain below which a hypothesis is not followed."""

RIVAL = 0.3
"""Share of the best gain below which a hypothesis is no finalist."""

CLOSE = 0.7
"""Share of the best finalist's gain from which a rival may yet be the better one."""

TIED = 0.99
"""Share of the gain of a form's best from which another place of it is a finalist, too."""

PLACES = ("x_m", "centre_m")
"""Constants by which one hypothesis reaches other places."""

BEYOND = 5.0
"""Standard deviations of its prior beyond which nobody would believe a parameter."""


def penalty(quick: Quick, ring: Ring) -> float:
    """What BIC asks of a hypothesis: its parameters times the logarithm of the number of lines."""
    return float(len(quick.hypothesis.free) * np.log(lines(ring.fit)))


def lines(fit: Fit) -> int:
    """Lines of all records: real and imaginary parts are two rows of one."""
    return max(2, fit.deviations.size // 2)


def chosen_of(screened: Sequence[Quick], ring: Ring, most: int) -> list[Quick]:
    """The best, not too many of one form of an effect."""
    if not screened:
        return []
    best = max(q.gain for q in screened)
    found: list[Quick] = []
    for quick in screened:
        taken = sum(q.hypothesis.form == quick.hypothesis.form for q in found)
        # A step that has not arrived may still double its gain.
        promising = 3.0 * quick.gain > penalty(quick, ring) and quick.gain > WORTH * best
        if promising and taken < PER_FORM and len(found) < most:
            found.append(quick)
    return found


def finalists_of(followed: Sequence[Quick], ring: Ring, threshold: float) -> list[Quick]:
    """The best of each effect that passes the threshold, and of its other forms that do nearly as well.

    Where the place is none of a form's constants, the next best place, too, if it does as well: a step from the
    base does not tell the whole rail from the rail on the deck.
    """
    found: dict[tuple[str, ...], Quick] = {}
    leading: dict[str, float] = {}
    tied: list[Quick] = []
    for quick in followed:
        form, entry = quick.hypothesis.form, quick.hypothesis.entry
        best = max(leading.values(), default=quick.gain)
        passes = quick.gain - penalty(quick, ring) > threshold and quick.gain > RIVAL * best
        # Elements are of no one effect: each is a rival of the others.
        nearly = entry in leading and (quick.gain > CLOSE * leading[entry] or entry == NOVEL)
        if passes and form not in found and (nearly or (entry not in leading and len(leading) < FINALISTS)):
            found[form] = quick
            leading.setdefault(entry, quick.gain)
        elif passes and form in found and not tied and _ties(quick, found[form]):
            tied.append(quick)
    return [*list(found.values())[: FINALISTS + 1], *tied]


def _ties(quick: Quick, best: Quick) -> bool:
    """Whether a hypothesis of the same form does as well at a place that the best cannot reach."""
    return not _reaches(best) and quick.gain > TIED * best.gain


def elsewhere(fitted: Sequence[tuple[Quick, Fit]], followed: Sequence[Quick]) -> list[Quick]:
    """The next best place of the leading effect, where that is not one of its constants, or strains the base.

    One of two bearings that is softer, and the other that is stiffer, both of them softer, differ in what their
    owner said of them alone.
    """
    if not fitted:
        return []
    leading, fit = fitted[0]
    known = fit.evidence.campaign.parameters.known
    strained = any(abs(float(z)) > BEYOND for f, z in zip(fit.free, fit.z, strict=True) if f.name in known)
    place = leading.hypothesis.locate(leading.values)
    if not strained and (place.x_m is None or _reaches(leading)):
        return []
    alike = [q for q in followed if q.hypothesis.form == leading.hypothesis.form]
    taken = [q.hypothesis.locate(q.values) for q, _ in fitted if q.hypothesis.form == leading.hypothesis.form]
    return [q for q in alike if q.hypothesis.locate(q.values) not in taken][:1]


def _reaches(quick: Quick) -> bool:
    """Whether the place is one of a hypothesis' constants."""
    return bool(set(PLACES) & {f.name for f in quick.hypothesis.free})
