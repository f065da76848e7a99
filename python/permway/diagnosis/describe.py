"""Whether small elements describe what acts better than any named effect does."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from permway.diagnosis import crossed, decide, grammar
from permway.diagnosis.choose import lines, penalty
from permway.diagnosis.clock import Clock
from permway.diagnosis.compete import Ring
from permway.diagnosis.crossed import Loss
from permway.diagnosis.ends import SPACING_M
from permway.diagnosis.fit import Fit
from permway.diagnosis.hypothesis import Hypothesis, Situation
from permway.diagnosis.locate import scanned
from permway.diagnosis.plausible import beyond_belief
from permway.diagnosis.recalibrate import UNFIT
from permway.diagnosis.recovered import same_place
from permway.diagnosis.search import Finalist, Round, search, standing
from permway.diagnosis.spot import Found, Spot
from permway.diagnosis.twice import SPREAD, twice_of
from permway.model.bodies import Beam

FOLLOWED = 16
"""Elements that are followed after screening: one step tells little of a law's frequency."""

ONE_FOR_TWO = 0.1
"""Share of the gain of one effect found twice that one thing in their place may lack: two of a kind are rare."""

OPEN = 0.05
"""Share of the gap to a free stiffness that a named effect that fits may leave before elements are tried."""

WAVES = 1.05
"""Mean square of the deviations from which joints that are named as lost may be such that waves have to cross."""

LEAVES = 1.05
"""The same of names of other domains, from which elements of the path are tried in their place: two absorbers on
axle boxes left 1.16 where pads lost by a dashpot."""

TELLS = 45.0
"""Surplus of a free stiffness at one place from which elements of few constants are tried, which ask for less of
BIC: with nothing missing the largest of all places was -3 to 17 (four campaigns)."""


class Description:
    """What elements make of one campaign.

    Parameters
    ----------
    searched, base : Fit
        What a search begins from, and the recalibrated base.
    found : tuple of Found
        The scan.
    clock : Clock
    """

    def __init__(self, searched: Fit, base: Fit, found: tuple[Found, ...], clock: Clock) -> None:
        self.searched, self.base, self.found, self.clock = searched, base, found, clock
        self._plain: Round | None = None
        self._rods: tuple[list[Loss], Round | None] = [], None
        self._lumped: tuple[Finalist, Round] | None = None
        self._left: dict[int, tuple[Fit, tuple[Found, ...]]] = {}

    def left(self, fit: Fit) -> tuple[Found, ...]:
        """Scan of an amended model, the place among it that told most of the base; made once."""
        if id(fit) not in self._left:
            self.clock("scan what is left")
            before, after = self.base.campaign.model.line, fit.campaign.model.line
            told = self.found[0].spot if self.found else None

            def also(spot: Spot) -> bool:
                return told is not None and same_place(before, told, after, spot)

            self._left[id(fit)] = fit, scanned(fit, also)
        return self._left[id(fit)][1]

    def instead(self, first: Round) -> bool:
        """Whether elements explain most of what the first named effect leaves: then no further is sought."""
        named = first.finalists[0]
        if named.hypothesis.domain != "path":
            return False
        described = self.of([first], [named])
        if described is None:
            return False
        # While something else is missing, what was found first may be bent beyond belief by that.
        strange = beyond_belief(named) or self._blind(named.fit)
        # What does not fit itself is not all that is missing: names may yet explain it together.
        fits = described.finalists[0].fit.heat < UNFIT
        return (named.fit.heat < UNFIT and strange) or (fits and self._closes(described, named.fit))

    def of(self, rounds: Sequence[Round], accepted: Sequence[Finalist]) -> Round | None:
        """What small elements make of it, where they do better than names.

        Parameters
        ----------
        rounds : sequence of Round
        accepted : sequence of Finalist
        """
        return self._crossed(rounds, accepted) or self._elements(rounds, accepted)

    def _crossed(self, rounds: Sequence[Round], accepted: Sequence[Finalist]) -> Round | None:
        """Rods in place of joints that are named as lost, if waves across them explain what the name leaves."""
        laws = self.base.campaign.model.line.laws if accepted else ()
        # A cracked girder has lost stiffness over a stretch, too, and no joints.
        losses = [loss for loss in map(_loss, accepted) if loss is not None and loss.law in laws]
        if not losses or accepted[-1].fit.heat < WAVES:
            return None
        if losses != self._rods[0]:
            situation = Situation(self.searched, self.found)
            offered = crossed.over_stretch(situation, losses)
            self._rods = losses, self._held(self.searched, offered, rounds[0].threshold)
        result, best = self._rods[1], accepted[-1].fit
        if result is None or not result.finalists:
            return None
        one = result.finalists[0]
        better = best.objective - one.fit.objective - penalty(one.quick, result.ring)
        return result if better + _asked(accepted, result.ring) > rounds[0].threshold else None

    def _elements(self, rounds: Sequence[Round], accepted: Sequence[Finalist]) -> Round | None:
        """Small elements, where no named effect explains what a free stiffness does, if they do it better.

        Or where one effect was found twice at one place: that is one thing that the catalogue has no name for. Or
        where the effect has constants that no such thing has.

        Parameters
        ----------
        rounds : sequence of Round
        accepted : sequence of Finalist
        """
        least, twice, explained, strange, blind = rounds[0].threshold, twice_of(accepted), 0.0, False, False
        if accepted:
            best = accepted[-1].fit
            explained = decide.explained(self.base, best, self.left(best))
            # Of a large gap a small share may still be far more than errors explain.
            left = explained < 1.0 - OPEN or best.heat > UNFIT
            strange, blind = beyond_belief(accepted[0]), self._blind(best)
            if accepted[0].hypothesis.domain != "path":
                # What is missing in the path may have been taken for a fault of a sensor, or of the vehicle.
                if best.heat < LEAVES:
                    return None
            elif not (left or strange or blind or twice is not None):
                return self._hung(accepted, least)
        else:
            best = self.base
            # Of a base that is missed by far the scan is of blunted records, and tells little.
            if best.heat < UNFIT and not self._tells(least):
                return None
        result = self._searched(least, twice)
        if not result.finalists:
            return None
        one = result.finalists[0]
        better = best.objective - one.fit.objective - penalty(one.quick, result.ring)
        if twice is not None:
            # What stands for two effects has fewer constants, and need not do quite what both do.
            better += _asked(accepted, result.ring)
            better += ONE_FOR_TWO * (self.base.objective - best.objective)
        elif blind and better + _asked(accepted, result.ring) > least:
            return result
        elif explained > decide.EXPLAINED and not strange and not self._closes(result, best):
            return None
        return result if better > 0.0 else None

    def _hung(self, accepted: Sequence[Finalist], least: float) -> Round | None:
        """One mass on a spring, or some over a stretch, where one effect is such a mass all along a body.

        To the few sensors that a body has both may look alike, in all that a free stiffness closes.
        """
        first = accepted[0]
        at = first.hypothesis.locate(first.values)
        if len(accepted) > 1 or at.x_m is not None or first.values.keys() != SPREAD:
            return None
        if self._lumped is None or self._lumped[0] is not first:
            situation = Situation(self.searched, self.found)
            offered = tuple(grammar.hung(situation, at.what, self._each_metre(at.what, first)))
            self._lumped = first, self._held(self.searched, offered, least)
        result = self._lumped[1]
        if not result.finalists:
            return None
        result = replace(result, finalists=_simplest(result.finalists, result.ring))
        one = result.finalists[0]
        better = first.fit.objective - one.fit.objective - penalty(one.quick, result.ring)
        return result if better + _asked(accepted, result.ring) > least else None

    def _each_metre(self, name: str, one: Finalist) -> dict[str, float]:
        """What hangs all along a body, by what does on a metre."""
        body = self.base.campaign.model.line.bodies[name]
        assert isinstance(body, Beam)
        return {**one.values, "mass_kg": one.values["mass_share"] * body.mass_kg_per_m * SPACING_M}

    def _tells(self, least: float) -> bool:
        """Whether a free stiffness at one place tells so much that small elements may explain it."""
        if not self.found:
            return False
        first = self.found[0]
        # About a bent base the scan is of blunted records, and tells less surely.
        tells = self.searched is self.base and first.surplus > TELLS
        return tells or first.gain - first.degrees * np.log(lines(self.base)) > least

    def _blind(self, named: Fit) -> bool:
        """Whether what BIC asks of a free stiffness is more than the share of the gap that may stay open."""
        gained = self.base.objective - named.objective
        return bool(self.found) and OPEN * gained < self.found[0].degrees * np.log(lines(self.base))

    def _closes(self, described: Round, named: Fit) -> bool:
        """Whether a description closes most of the gap to a free stiffness, and half of what a name leaves."""
        fit = described.finalists[0].fit
        explained = decide.explained(self.base, fit, self.left(fit))
        gap = 1.0 - decide.explained(self.base, named, self.left(named))
        return explained > decide.EXPLAINED and 1.0 - explained < decide.HALF * gap

    def _searched(self, least: float, twice: Finalist | None) -> Round:
        """Elements at the most telling place, or where one effect was found twice; from either base."""
        if twice is None and self._plain is not None:
            return self._plain
        result = self._from(self.searched, self.found, least, twice)
        if not result.finalists and self.searched is not self.base:
            self.clock("locate")
            result = self._from(self.base, scanned(self.base), least, twice)
        if twice is None:
            self._plain = result
        return result

    def _from(self, start: Fit, found: tuple[Found, ...], least: float, twice: Finalist | None) -> Round:
        like = None
        if twice is not None:
            at, like = twice.hypothesis.locate(twice.values), twice.values
            if at.x_m is None:
                like = self._each_metre(at.what, twice)
            else:
                there = at.x_m[0]
                found = tuple(sorted(found, key=lambda f: abs(f.spot.x_m[0] - there)))
            found = tuple(sorted(found, key=lambda f: f.spot.name != at.what))
        situation = Situation(start, found)
        result = self._held(start, grammar.hypotheses(situation, like), least)
        if not result.finalists:
            return result
        first = _simplest(result.finalists, result.ring)[0]
        near = grammar.alike(situation, like, first.hypothesis, _ended(first))
        fitted = [*result.finalists, *self._finalists(start, near, least)]
        return replace(result, finalists=_simplest(fitted, result.ring))

    def _finalists(self, start: Fit, hypotheses: Iterable[Hypothesis], least: float) -> tuple[Finalist, ...]:
        offered = tuple(hypotheses)
        return self._held(start, offered, least).finalists if offered else ()

    def _held(self, start: Fit, hypotheses: Iterable[Hypothesis], least: float) -> Round:
        """Held against the records, beside nothing else."""
        return search(
            start,
            hypotheses,
            learnt_base=self.base,
            prefix="1.",
            threshold=lambda _ring, _screened: least,
            most=FOLLOWED,
            progress=self.clock,
        )


def _ended(one: Finalist) -> tuple[float, ...]:
    """Coordinates of an effect's own parameters where its fit ended."""
    ended = dict(zip((f.name for f in one.fit.free), one.fit.z.tolist(), strict=True))
    return tuple(ended[name] for name in one.own)


def _simplest(rivals: Sequence[Finalist], ring: Ring) -> tuple[Finalist, ...]:
    """The best first: by BIC, for of two descriptions that do as well the one of fewer constants says more.

    Where none fits, by what they do to blunted responses, as effects are ranked.
    """
    if min(one.fit.heat for one in rivals) > UNFIT:
        return tuple(sorted(rivals, key=lambda f: -standing(f, rivals)))
    return tuple(sorted(rivals, key=lambda f: f.fit.objective + penalty(f.quick, ring)))


def _asked(accepted: Sequence[Finalist], ring: Ring) -> float:
    """What BIC asks of all that was named."""
    return sum(penalty(one.quick, ring) for one in accepted)


def _loss(one: Finalist) -> Loss | None:
    """The stretch of joints that a name says has lost stiffness; None if it says something else."""
    values = one.values
    if {"centre_m", "length_m", "factor"} != values.keys():
        return None
    where = one.hypothesis.locate(values)
    return Loss(where.what, values["centre_m"], values["length_m"], values["factor"])
